"""The hand-written part of the bundled baseline.

A grammar repeats itself; these sentences do not. `handwritten.txt` covers ordinary but easily
overlooked situations (level crossings, car parks, ferries, learner drivers, signed road works, light
fog, an ambulance that is let past). `counterparts.txt` describes each kind of OOD event as it looks
when all is as it should be, and `sights.txt` describes things seen from a car and their ordinary
behaviour. These three use the registers in which driving is written about: captions and key words,
questions and answers, a driver's own words, a log, the steps of a test. Their authors had read the
*tune* half of the controls, so texts with a cosine of about 0.7 or more to an ordinary control of that
half were removed. The authors of `people.txt`, `manoeuvres.txt` and `conditions.txt` had seen no
control of either half, and nothing was removed for similarity. `figures.txt` is in the register of
specifications and problem texts, for the guard against off-topic texts.
"""

from collections.abc import Mapping
from functools import cache
from types import MappingProxyType

from oodscen._io.files import bundled
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
    """Return the hand-written texts alone; `ordinary_driving()` appends them to those that it draws."""
    return Baseline(
        texts=tuple(text for texts in by_subject().values() for text in texts),
        name="handwritten-driving",
        source=f"oodscen.baselines: {', '.join(_FILES)}",
        licence="Apache-2.0",
    )


@cache
def by_subject() -> Mapping[str, tuple[str, ...]]:
    """Return the hand-written texts by subject, which a line `# subject` begins; in the order of the files."""
    texts: dict[str, list[str]] = {}
    for name in _FILES:
        subject = ""
        for line in bundled(name, "oodscen.baselines").splitlines():
            if line.startswith("# "):
                subject = line[2:]
            elif line:
                texts.setdefault(subject, []).append(line)
    return MappingProxyType({subject: tuple(lines) for subject, lines in texts.items()})
