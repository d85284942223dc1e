"""English wordings of claims, from `phrases.toml`: settings, predicates and their contexts."""

import re
import tomllib
from collections.abc import Iterable
from functools import cache
from typing import Any, NamedTuple

from oodscen._io.files import bundled
from oodscen._words.text import AMERICAN
from oodscen.author._reading.numbers import COUNT, NUMBER
from oodscen.data._claim import Kind

_TABLE: dict[str, Any] = tomllib.loads(bundled("phrases.toml", "oodscen.author._reading"))
_ANY_EGO = (
    r"(?:(?:(?:the|an|your|its) )?(?:(?:user-controlled )?ego(?:[- ](?:vehicle|car|motorcycle|driver))?"
    r"|(?:hero|host|subject) vehicle|vehicle under test"
    r"|(?:autonomous|automated|self-driving|own) (?:vehicle|car))"
    r"|(?:me|us|(?:my|our|your)(?: own)? (?:vehicle|car))(?![\w-]))"
)
_EGO = (
    rf"{_ANY_EGO}(?!['’]s|[- ](?:vehicle|car|motorcycle|driver)['’]s"
    r"|(?: own| entry| driving)? (?:lane|path)\b)"
)
"""The ego itself, not something of it."""
_LANE = (
    rf"(?:{_ANY_EGO}['’]s(?: own| entry| driving| original| current| very| planned)? (?:lane|path|way|side)"
    rf"|(?:the )?ego(?: own| entry)? (?:lane|path)|(?:the |its )?(?:lane|path|way) of {_ANY_EGO}"
    rf"|the lane (?:in which|that|used by|where) {_ANY_EGO}|the same lane|(?:your|my|our)(?: own)? (?:lane|path|way)"
    r"|(?<=vehicle in )its(?: entry| own)? lane|(?<=vehicle inside )its lane)"
)
_FILLINGS = {
    "{lane}": _LANE,
    "{ego}": _EGO,
    "{any_ego}": _ANY_EGO,
    "{own}": rf"{_ANY_EGO}['’]s",
    "{me}": rf"(?:{_EGO}|(?:it|you|my|your|our)\b)",
    "{number}": NUMBER,
    "{free_of}": r"(?:free|devoid|empty|void|bare) (?:of|from)|(?:is|are|was|were|looks|stays) (?:\w+ly )?clear of",
    "{count}": COUNT,
    "{perhaps}": "(?:perhaps|maybe|possibly|probably|presumably|supposedly|allegedly|reportedly|apparently|seemingly|conceivably)",
    **{british: f"(?:{british}|{american})" for british, american in AMERICAN.items()},
    "{n}": r"(two|three|four|five|six|eight|one|a single|single|[1-8])",
}

_FROM_START = r"(?<![\w-])(?!(?<=\d[.,:/])\d)"
"""A word or a number starts here: not its second half."""
_TO_END = r"(?![\w-])"
"""A word ends here."""


class Pattern(NamedTuple):
    """A pattern whose match makes a claim."""

    kind: Kind
    value: str
    """Empty if a group of the pattern gives the number."""
    regex: re.Pattern[str]


@cache
def statements(about: str) -> tuple[Pattern, ...]:
    """Return the patterns of claims about a `setting`, or by a `predicate`, `signal` or `lead` of a thing."""
    return tuple(
        Pattern(row["kind"], row.get("value", ""), _statement(row["words"]))
        for row in _TABLE["statement"]
        if row["about"] == about
    )


def _statement(words: Iterable[str]) -> re.Pattern[str]:
    return re.compile(rf"{_FROM_START}(?:{_filled('|'.join(words))}){_TO_END}", re.IGNORECASE)


@cache
def context(name: str) -> re.Pattern[str]:
    """Return the pattern of a row of `context`, by which a claim is read or left out."""
    row = _TABLE["context"][name]
    words = "|".join(row["words"])
    if "before" in row or "after" in row:
        words = f"{row.get('before', '')}(?:{words}){row.get('after', '')}"
    return re.compile(_filled(words), re.IGNORECASE)


@cache
def things(name: str) -> frozenset[str]:
    """Return the names of a row of `things`."""
    return frozenset(_TABLE["things"][name])


BY_NATURE: dict[str, str] = _TABLE["by_nature"]
"""Motions that words imply by themselves: `sleeping` ..."""


def _filled(regex: str) -> str:
    for name, filling in _FILLINGS.items():
        regex = regex.replace(name, filling)
    return regex
