"""How surely something is said: "0.8", "80 %", "8/10", "fairly sure"."""

from oodscen.judging.languages import SURENESS
from oodscen.judging.patterns import compiled


def stated_confidence(plain: str) -> float | None:
    """Return the probability, 0 to 1, that a normalised text states last, in whatever form."""
    numbers = list(STATED.finditer(plain))
    if not numbers:
        worded = _IN_WORDS.search(plain)
        return probability(worded[1]) if worded else None
    found = {key: said for key, said in numbers[-1].groupdict().items() if said}
    number, *unit = found.values()
    return probability(" ".join([number.replace(",", "."), *unit]))


STATED = compiled(
    # confidence: 0.8; probability of about 80 %; certainty 8/10
    rf"(?<![a-z]){SURENESS}\w*\W{{0,4}}"
    r"(?:(?:is|of|level|at|as|around|about|roughly|approximately|ist|est|es)\W{1,2})*[:=(]* *"
    r"(?P<after>\d+(?:[.,]\d+)?) *(?P<unit>%|percent|/ *\d+|out of \d+)?",
    # 80 % sure
    rf"(?P<before>\d+(?:[.,]\d+)?) *(?P<share>%|percent) *{SURENESS}",
    # (0.8), (about 80 %)
    r"\( *(?:around|about)? *(?P<alone>[01][.,]\d+|\d{1,3}(?= *%)) *(?P<percent>%)? *\)",
    # yes, 0.8
    r"\A\W*(?:yes|no|true|false)\W{1,4}(?P<listed>[01][.,]\d+|\d{1,3}(?= *%)) *(?P<of>%)?",
)
"""A probability that is stated as a number."""

_IN_WORDS = compiled(
    r"(?:\bconfidence *(?:level *)?(?:is|:|=|\u2014) *|\bi(?:'m| am) )"
    r"((?:(?:not|very|so|extremely|highly|fairly|quite|reasonably|pretty|rather|absolutely"
    r"|completely|fully) )*"
    r"(?:sure|certain|confident|unsure|uncertain|high|medium|moderate|low)\b)"
)
"""How sure somebody says to be in words."""


def probability(value: object) -> float | None:
    """Return a stated probability: 0.8, "80 %", 80, "8/10" and "high" are all understood."""
    if isinstance(value, bool) or value is None:
        return None
    if isinstance(value, str):
        word = value.strip().casefold()
        number = _NUMBER.search(word)
        if not number:
            return next((share for words, share in _WORDED if words.search(word)), None)
        value = float(number[1].replace(",", "."))
        if number[2] or number[3]:
            value /= float(number[3] or 100.0) or 1.0
            return value if 0.0 <= value <= 1.0 else None
    if not isinstance(value, (int, float)) or not 0.0 <= value <= 100.0:
        return None
    if 1.0 < value <= 10.0:
        return None
    return float(value) if value <= 1.0 else value / 100.0


_NUMBER = compiled(r"(-?\d+(?:[.,]\d+)?) *(?:(%|percent)|(?:/|out of ) *(\d+))?")
_SURE = r"(?:sure|certain|confident)"
_WORDED = (
    (
        compiled(
            rf"\bnot (?:(?:very|so|at all) )?{_SURE}\b", r"\b(?:unsure|uncertain|low|guess)\b"
        ),
        0.55,
    ),
    (compiled(rf"\b(?:absolutely|completely|100|fully) {_SURE}\b", r"^certain$"), 1.0),
    (compiled(rf"\b(?:very|extremely|highly) (?:high|likely|{_SURE})\b"), 0.95),
    (compiled(rf"\b(?:fairly|quite|reasonably|pretty|rather) (?:high|likely|{_SURE})\b"), 0.8),
    (compiled(r"\b(?:medium|moderate\w*|somewhat|probabl[ey])\b"), 0.7),
    (compiled(rf"\b(?:high|{_SURE})\b"), 0.9),
)
"""Words for how sure somebody is, and the probability that they are taken for; the first counts."""
