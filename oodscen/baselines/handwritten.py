"""The hand-written part of the shipped baseline.

A grammar repeats itself; these sentences do not. They tell of what is ordinary but easily missed (level
crossings, car parks, ferries, learner drivers, signed road works, light fog, an ambulance that is let
past), in the registers in which driving is written about: captions and key words, questions and
answers, a driver's own words, a log, the steps of a test. They are data, `handwritten.txt`.
"""

from collections.abc import Mapping
from functools import cache
from importlib import resources
from types import MappingProxyType

from oodscen.baselines.baseline import Baseline


@cache
def handwritten_driving() -> Baseline:
    """Return the hand-written texts alone; `ordinary_driving()` holds them after those it draws."""
    return Baseline(
        texts=tuple(text for texts in by_subject().values() for text in texts),
        name="handwritten-driving",
        source="oodscen.baselines: handwritten.txt",
        licence="Apache-2.0",
    )


@cache
def by_subject() -> Mapping[str, tuple[str, ...]]:
    """Return the hand-written texts by what they are about, in the order of the file."""
    file = resources.files("oodscen.baselines") / "handwritten.txt"
    found: dict[str, list[str]] = {}
    subject = ""
    for line in file.read_text(encoding="utf-8").splitlines():
        if line.startswith("# "):
            subject = line[2:]
        elif line:
            found.setdefault(subject, []).append(line)
    return MappingProxyType({subject: tuple(texts) for subject, texts in found.items()})
