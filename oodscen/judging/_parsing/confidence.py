"""Parses how sure an answerer says that it is."""

import re
from collections.abc import Iterable


def probability(value: object) -> float | None:
    """Return a stated probability in [0, 1]; accepts 0.8, "80 %", 80, "8/10", "50/50" and the words of `_DEGREES`.

    A number above 1 and up to 10 that names no scale is none.
    """
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        return None
    if not isinstance(value, str):
        return _share(value)
    text = _BESIDE.sub("", value).strip().casefold()
    degree = _DEGREES.get(re.sub(r"[\s_-]+", " ", text))
    if degree is not None:
        return degree
    match = _NUMBER.fullmatch(text)
    if not match:
        return None
    number, is_percent, whole = match.groups()
    return _share(float(number.replace(",", ".")), 100.0 if is_percent else float(whole or 1))


def is_confidence(value: object) -> bool:
    """Return whether a value may state a confidence, readable or not; `None` leaves it out."""
    return value is None or (isinstance(value, (int, float, str)) and not isinstance(value, bool))


def is_aside(value: object) -> bool:
    """Return whether a value is a text with words that state no probability."""
    if not isinstance(value, str) or _UNSTATED.fullmatch(value):
        return False
    return bool(re.search(r"[^\W\d_]", value)) and probability(value) is None


def one_probability(values: Iterable[object]) -> float | None:
    """Return the probability that several values state; `None` if they state none, or two."""
    stated = {probability(value) for value in values} - {None}
    return stated.pop() if len(stated) == 1 else None


def confidence_in(prose: str) -> float | None:
    """Return the probability that prose states; `None` if it states none, or two."""
    return one_probability(
        match["after"] or match["alone"] or match["before"] for match in CONFIDENT.finditer(prose)
    )


def without_confidence(prose: str, least: float = 0.0) -> str:
    """Return tidied prose without the sentences, lines, brackets and endings that state a confidence.

    A share below the least stays, as does a doubt such as "not 80 % sure" if there is a least.
    """

    def rest(clause: re.Match[str]) -> str:
        share = probability(clause["alone"] or clause["before"])
        is_hedge = least > 0.0 and not clause["after"] and (share is None or share < least)
        return clause[0] if is_hedge else ""

    return _CLAUSE.sub(rest, prose).strip()


def _share(number: float, whole: float = 1.0) -> float | None:
    if whole == 1.0 and 10.0 < number <= 100.0:
        whole = 100.0
    return number / whole if whole and 0.0 <= number <= whole else None


_DEGREES = {
    "50/50": 0.5, "50:50": 0.5, "50 50": 0.5, "fifty fifty": 0.5, "none": 0.5, "unsure": 0.5, "uncertain": 0.5, "not sure": 0.5,
    "very low": 0.55, "low": 0.6, "fairly low": 0.6, "medium": 0.75, "moderate": 0.75, "fair": 0.75,
    "fairly high": 0.85, "high": 0.9, "sure": 0.95, "very high": 0.97, "very sure": 0.97, "certain": 1.0,
}  # fmt: skip
"""Words for a confidence in a yes or no, as probabilities: only their order counts."""
_BESIDE = re.compile(
    r"^\s*(?:about|around|approximately|roughly|~)\s*|\s*\([^()]{1,60}\)\s*\.?$|\.\s*$",
    re.IGNORECASE,
)
"""Matches what may stand beside a number or a word."""
_UNSTATED = re.compile(
    r"\s*(?:n/?a|unknown|not (?:applicable|available|given|known|stated))\W*", re.IGNORECASE
)
_DIGITS = r"(?:\d{1,9}(?:\.\d{1,30}|,\d{1,2})?|\.\d{1,30})"
_SCALE = r"\s*(?:(%|percent)|(?:/|(?:out )?of)\s*(\d{1,3}))"
_NUMBER = re.compile(rf"({_DIGITS})(?:{_SCALE})?")
_SCALED = _DIGITS + re.sub(r"\((?!\?)", "(?:", _SCALE)
_UP_TO = rf"\s?(?:[\u2013\u2014-]|to)\s?{_DIGITS}(?:\s?%)?"
_WORDS = "|".join(sorted(map(re.escape, _DEGREES), reverse=True)).replace(r"\ ", "[ _-]")
_SURE = r"(?:sure|certain|confident|confidence|certainty)"
CONFIDENT = re.compile(
    r"(?:\bmy )?(?:confidence|certainty)(?: (?:level|is|of|at))* ?[:=]? ?(?:about |around |~ ?)?"
    rf"(?P<after>(?:{_SCALED}|{_DIGITS})(?:{_UP_TO})?|{_WORDS})(?![\w/]|[.,]\d| ?(?:out )?of\b)"
    rf"|\((?P<alone>0?\.\d+|1\.0+|{_SCALED})\)"
    rf"|(?:(?:with|i am|i'm) )?(?:(?:about|around|roughly) )?(?:(?:not|less than) {_SCALED}|(?<!n't )(?P<before>{_SCALED})) {_SURE}",
    re.IGNORECASE,
)
"""Matches a confidence in prose, also one that states no probability, such as "1-5 %" and "not 100 % sure"."""
_CLAUSE = re.compile(
    r"(?:\A|(?P<mark>\s{0,4}[.,;:!\n(\u2013\u2014-]\s{0,4}|\s{1,4}))"
    rf"(?:{CONFIDENT.pattern})\)?(?(mark)(?=\s{{0,4}}(?:[.,;:!\n]|\Z))|\s{{0,4}}(?:[.,;:!\n]\s{{0,4}}|\Z))",
    re.IGNORECASE,
)
"""Matches a confidence that is a clause of its own, with the mark before it, or behind it at the start."""
