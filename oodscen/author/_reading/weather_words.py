"""Words for weather and darkness in a label."""

import re
from collections.abc import Collection, Mapping
from functools import cache

from oodscen._words.text import stem
from oodscen.author._reading.alternatives import DETERMINERS, NOUNS_LIKE_PARTICIPLES, PLACING
from oodscen.data._weather import WeatherKind

WEATHER_WORDS: Mapping[WeatherKind, tuple[str, ...]] = {
    "rain": ("rain", "rainfall", "downpour", "rainstorm", "cloudburst", "rainy"),
    "snow": ("snow", "snowfall", "snowstorm", "blizzard", "snowy"),
    "fog": ("fog", "mist", "foggy", "misty"),
    "ice": ("ice", "icy"),
}
_DARKNESS = tuple("night,nighttime,night-time,nightfall,midnight,darkness,the dark,dark".split(","))
_NAMES: Mapping[WeatherKind, tuple[str, ...]] = {**WEATHER_WORDS, "night": _DARKNESS}
_ADJECTIVES = {"rainy", "snowy", "foggy", "misty", "icy", "dark"}
_SUBSTANCES = {"ice"}
"""Nouns for what a thing lies in rather than the weather around it."""

_WORDS = {word for words in _NAMES.values() for word in words} - _SUBSTANCES
_ANY = "|".join(sorted(_WORDS))
_NOUN = "|".join(sorted(_WORDS - _ADJECTIVES))
_BREAK = PLACING | set("and or but as if is are was were has have for".split())
_NEXT = _BREAK | DETERMINERS | set("of ego it he she we you they".split())
"""Words that follow a noun phrase; those of `_BREAK` occur in none."""
_HEAD = (
    r"\s+(?:weather|conditions?|hours?|time|sky|air"
    r"|storms?|showers?|flurr(?:y|ies)|banks?|drifts?|patch(?:es)?)\b"
)
"""A noun that a word of weather describes: `foggy weather`, `snow storm`."""
_END = rf"\s*$|\s+[^\w\s]|[^\w\s'\u2019-]|\s+(?:{'|'.join(sorted(_NEXT))})\b"
"""The end of a noun phrase."""
_ACT = rf"[\s-](?!(?:{'|'.join(sorted(NOUNS_LIKE_PARTICIPLES))})\b)\w{{3,}}(?:ing|ed)\b"
"""A participle after a noun: `fog crossing the road` is not a kind of fog, as `fog lamp` is not fog."""
_WORD = rf"(?!(?:{'|'.join(sorted(_BREAK))})\s)[\w-]+\s+"
"""A word of a noun phrase, and the space behind it."""
_CIRCUMSTANCE = re.compile(
    rf"\b(?:at|in|during|under|by|amid|on(?=\s+(?:{_WORD}){{1,3}}night\b))\s+(?:{_WORD}){{0,3}}?"
    rf"(?P<names>(?:(?:{_ANY})\s+(?:of\s+)?)*"
    rf"(?:(?:{_ANY})(?={_HEAD}|{_END})|(?:{_NOUN})(?={_ACT})|(?<=at )night\b))"
    rf"(?:{_HEAD})?",
    re.IGNORECASE,
)
"""A preposition and a noun phrase about weather: not `in a dark coat` or `by a snow plough`; after `on`, of a night."""
_NAME = re.compile(
    "|".join(rf"\b(?P<{kind}>{'|'.join(words)})\b" for kind, words in _NAMES.items()), re.IGNORECASE
)


@cache
def weather_stems(kind: WeatherKind) -> frozenset[str]:
    """Return the stems of the words for a kind of weather."""
    return frozenset(map(stem, WEATHER_WORDS[kind]))


def weather_kinds(stems: Collection[str]) -> tuple[WeatherKind, ...]:
    """Return the kinds of weather that the stems name."""
    return tuple(kind for kind in WEATHER_WORDS if not weather_stems(kind).isdisjoint(stems))


def circumstances(text: str) -> tuple[str, ...]:
    """Return the weather and light in which something happens: `night` and `rain` for `in night rain`."""
    names = " ".join(match["names"] for match in _CIRCUMSTANCE.finditer(text))
    return tuple(dict.fromkeys(str(name.lastgroup) for name in _NAME.finditer(names)))


def without_circumstances(text: str) -> str:
    """Return a text without the words that tell its circumstances."""
    return " ".join(_CIRCUMSTANCE.sub(" ", text).split())
