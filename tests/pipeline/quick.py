"""The small study that tests make variants of: flat pictures, hashes for vectors, fifty texts as baseline."""

from pathlib import Path

from oodscen import Study, StudyConfig
from oodscen.data._episode import Episode
from oodscen.judging._selection import chosen

ORDINARY = Path(__file__).with_name("ordinary.txt")
QUICK = StudyConfig.quick(simulator="flat", encoder="hash", baseline=str(ORDINARY), seed=3)


def asked_about(study: Study) -> list[Episode]:
    """Return the episodes that answerers are asked about: every scene with one of its ordinary drives."""
    return chosen(study.episodes, count=study.config.ordinary, seed=study.config.seed)
