"""English wordings of claims, from `phrases.toml`: settings, predicates and their contexts."""

import re
import tomllib
from importlib import resources
from typing import Any, NamedTuple

from oodscen.author._reading.numbers import COUNT, NUMBER
from oodscen.data._claim import Kind

_TABLE: dict[str, Any] = tomllib.loads(
    resources.files("oodscen.author._reading").joinpath("phrases.toml").read_text(encoding="utf-8")
)
_ANY_EGO = (
    r"(?:(?:(?:the|an|your|its) )?(?:(?:user-controlled )?ego(?:[- ](?:vehicle|car|motorcycle|driver))?"
    r"|hero vehicle|autonomous vehicle|automated vehicle|self-driving car|own vehicle)|(?:me|us)(?![\w-]))"
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
    "{count}": COUNT,
    "{n}": r"(two|three|four|five|six|eight|one|a single|single|[1-8])",
}


_FROM_START = r"(?<![\w-])(?!(?<=\d[.,:/])\d)"
"""A word or a number starts here: not its second half."""


def _filled(regex: str) -> str:
    for name, filling in _FILLINGS.items():
        regex = regex.replace(name, filling)
    return regex


class Pattern(NamedTuple):
    """A pattern whose match makes a claim."""

    kind: Kind
    value: str
    """Empty if a group of the pattern gives the number."""
    regex: re.Pattern[str]


def _statements(about: str) -> tuple[Pattern, ...]:
    return tuple(
        Pattern(
            row["kind"],
            row.get("value", ""),
            re.compile(
                rf"{_FROM_START}(?:{_filled('|'.join(row['words']))})(?![\w-])", re.IGNORECASE
            ),
        )
        for row in _TABLE["statement"]
        if row["about"] == about
    )


def _context(name: str) -> re.Pattern[str]:
    row = _TABLE["context"][name]
    words = "|".join(row["words"])
    if "before" in row or "after" in row:
        words = f"{row.get('before', '')}(?:{words}){row.get('after', '')}"
    return re.compile(_filled(words), 0 if row.get("is_case_sensitive") else re.IGNORECASE)


def _things(name: str) -> frozenset[str]:
    return frozenset(_TABLE["things"][name])


SETTINGS = _statements("setting")
PREDICATES = _statements("predicate")
SIGNALS = _statements("signal")
LEADS = _statements("lead")

EGO = _context("ego")
FORBIDDEN = _context("forbidden")
NOT_THERE = _context("not_there")
RIDES = _context("rides")
UNSHOWN = _context("unshown")
PAST = _context("past")
TO_COME = _context("to_come")
ANOTHER_TIME = _context("another_time")
NOT_NOW = _context("not_now")
DENIED_TOO = _context("denied_too")
NOUN_BEFORE = _context("noun_before")
LISTED = _context("listed")
OR_MORE = _context("or_more")
WEATHER_DOES = _context("weather_does")
NEGATED = _context("negated")
PERFECT = _context("perfect")
NOT_ITSELF = _context("not_itself")
DENIED = _context("denied")
CARRIED = _context("carried")
QUANTITY = _context("quantity")
DETERMINER = _context("determiner")
BACKGROUND = _context("background")
OBLIQUE = _context("oblique")
BREAK = _context("break")
RELATIVE = _context("relative")
SENTENCE = _context("sentence")
BLOCKED_BY = _context("blocked_by")
LEFT = _context("left")
BLOCKED = _context("blocked")
PUT = _context("put")
BORNE = _context("borne")
AGENT = _context("agent")
ROADWAY = _context("roadway")
BARS = _context("bars")
BLOCKS = _context("blocks")
STIRS = _context("stirs")
STILL_BY_NAME = _context("still_by_name")
MOVED_PAST = _context("moved_past")
PART_OF = _context("part_of")
ON_FOOT = _context("on_foot")
ITS = _context("its")
STRIDES = _context("strides")
LIES = _context("lies")
OF_ITS_VEHICLE = _context("of_its_vehicle")
BEING = _context("being")
LEAVES = _context("leaves")
LACKED = _context("lacked")
ALL_OF_THEM = _context("all_of_them")
LIGHTS_UP = _context("lights_up")
AS_A = _context("as_a")
ENDS = _context("ends")
TURNS_OUT = _context("turns_out")
CAB_OF_ITS_OWN = _context("cab_of_its_own")
LEFT_ITS = _context("left_its")
LEFT_A = _context("left_a")
BEHIND = _context("behind")
PLACED = _context("placed")
FOR_A = _context("for_a")

LIGHT = _things("light")
PARTS = _things("parts")
INERT = _things("inert")
CYCLES = _things("cycles")
GENERIC = _things("generic")
GENERIC_WORDS = GENERIC | _things("generic_words")
BY_NATURE: dict[str, str] = _TABLE["by_nature"]
