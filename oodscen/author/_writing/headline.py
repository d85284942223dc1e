"""Headlines: clauses worded as in a test catalogue, without articles and auxiliaries."""

import re

_ARTICLE = re.compile(
    r"\b(?:an?|the) (?!(?:few|lot|little|bit|couple|other way|other side|dozen|moment)\b)",
    re.IGNORECASE,
)
_APART = r"(?<!\bthat )(?<!\bwhich )(?<!\bwho )(?<!\bit )(?<!\bthey )(?<!\bthere )"
"""Lookbehinds that let a subordinate clause keep its verb."""
_EGO = re.compile(r"\b[Tt]he ego(?: vehicle)?\b")
_HAS = re.compile(
    _APART + r"\b(?:has|have) (?:just |suddenly |already )?"
    r"(?:been |(?=(?:\w{2,}ed|slid|lost|left|burst|spun|swung|set|put|built|dug|caught|shed)\b))"
)
_IS = re.compile(_APART + r"\b(?:is|are) (?=\w{2,}(?:ing|ed)\b)")
_GOES_ON = re.compile(r"\band (?:\w+ly )?\w+(?<!s)s\b")
"""A second verb, which would make the rest of the first one look like a different verb."""
_PATH = re.compile(
    r"\b(in|across|into|over|onto|from) the path of (?:the )?(ego(?: vehicle| car)?)\b"
)


def headline(clause: str) -> str:
    """Return a clause without the words that a headline omits; its meaning stays the same."""
    clause = _PATH.sub(r"\1 \2's path", _EGO.sub("ego", clause))
    if _GOES_ON.search(clause) is None:
        clause = _IS.sub("", _HAS.sub("", clause))
    return _ARTICLE.sub("", clause)
