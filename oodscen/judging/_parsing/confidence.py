"""Parses how sure an answerer says that it is."""

import re


def probability(value: object) -> float | None:
    """Return a stated probability in [0, 1]; accepts 0.8, "80 %", 80, "8/10", "50/50" and the words of `_DEGREES`."""
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        return None
    text = _BESIDE.sub("", str(value)).strip().casefold()
    degree = _DEGREES.get(re.sub(r"[\s_-]+", " ", text))
    if degree is not None:
        return degree
    match = _NUMBER.fullmatch(text)
    if not match:
        return None
    number = float(match[1].replace(",", "."))
    whole = float(match[3] or 1)
    is_percent = match[2] or (not match[3] and 10.0 < number <= 100.0)
    if is_percent:
        whole = 100.0
    return number / whole if whole and number <= whole else None


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
_NUMBER = re.compile(
    r"(\d{1,9}(?:\.\d{1,30}|,\d{1,2})?|\.\d{1,30})\s*(?:(%|percent)|(?:/|out of)\s*(\d{1,3}))?"
)
_SHARE = r"\d{1,3}(?:\.\d{1,30})? ?(?:%|percent|/ ?10{1,2}\b|out of 10\b)"
CONFIDENT = re.compile(
    rf"(?:confidence|certainty)(?: (?:level|is|of|at|about))* ?[:=]? ?(?P<after>{_SHARE}|\d+(?:[.,]\d+)?(?!\w|[.,]\d))"
    rf"|\((?P<alone>0?\.\d+|1(?:\.0+)?|{_SHARE})\)|(?:(?:with|i am|i'm) )?(?P<before>{_SHARE}) (?:sure|certain|confident|confidence|certainty)",
    re.IGNORECASE,
)


def confidence_in(prose: str) -> float | None:
    """Return the probability that prose states; `None` if it states none, or two."""
    stated = {
        probability(match["after"] or match["alone"] or match["before"])
        for match in CONFIDENT.finditer(prose)
    }
    return stated.pop() if len(stated) == 1 else None
