"""The hand-written part of the shipped baseline.

A grammar repeats itself; these sentences do not. They are data, in seven files. `handwritten.txt` tells of
what is ordinary but easily missed (level crossings, car parks, ferries, learner drivers, signed road works, light
fog, an ambulance that is let past), `counterparts.txt` of what each kind of OOD event looks like when all is as it
should be, `sights.txt` of what is seen from a car and what it ordinarily does: in the registers in
which driving is written about, captions and key words, questions and answers, a driver's own words, a log, the
steps of a test. Their authors had read the half *tune* of the controls, so texts with a cosine of about 0.7 or more to an
ordinary control of that half were taken out. `people.txt`, `manoeuvres.txt` and `conditions.txt` were written by
hands that had seen no control of either half, and nothing was taken out of them for likeness. `figures.txt` is in the
register of specifications and problem texts, for the guard against off-topic texts.
"""

from collections.abc import Mapping
from functools import cache
from importlib import resources
from types import MappingProxyType

from oodscen.baselines._baseline import Baseline

_FILES = (
    "handwritten.txt",
    "counterparts.txt",
    "sights.txt",
    "people.txt",
    "manoeuvres.txt",
    "conditions.txt",
    "figures.txt",
)


@cache
def handwritten_driving() -> Baseline:
    """Return the hand-written texts alone; `ordinary_driving()` holds them after those it draws."""
    return Baseline(
        texts=tuple(text for texts in by_subject().values() for text in texts),
        name="handwritten-driving",
        source=f"oodscen.baselines: {', '.join(_FILES)}",
        licence="Apache-2.0",
    )


@cache
def by_subject() -> Mapping[str, tuple[str, ...]]:
    """Return the hand-written texts by what they are about, in the order of the files."""
    found: dict[str, list[str]] = {}
    for name in _FILES:
        file = resources.files("oodscen.baselines") / name
        subject = ""
        for line in file.read_text(encoding="utf-8").splitlines():
            if line.startswith("# "):
                subject = line[2:]
            elif line:
                found.setdefault(subject, []).append(line)
    return MappingProxyType({subject: tuple(texts) for subject, texts in found.items()})
