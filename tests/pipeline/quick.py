"""The small study that tests make variants of: flat pictures, hashes for vectors, fifty texts as baseline."""

from pathlib import Path

from oodscen import StudyConfig

ORDINARY = Path(__file__).with_name("ordinary.txt")
QUICK = StudyConfig.quick(simulator="flat", encoder="hash", baseline=str(ORDINARY), seed=3)
