"""Words for weather and darkness in a label."""

import re
from collections.abc import Mapping

from oodscen._text import stem
from oodscen.data._scene import WeatherKind

WEATHER_WORDS: Mapping[WeatherKind, tuple[str, ...]] = {
    "rain": ("rain", "rainfall", "downpour", "rainstorm", "cloudburst"),
    "snow": ("snow", "snowfall", "snowstorm", "blizzard"),
    "fog": ("fog", "mist", "foggy"),
    "ice": ("ice", "icy"),
}
_CIRCUMSTANCE = re.compile(
    r"\b(?:at|in|during|under|by|amid)\s+(?:(?!and\b|or\b)\w+\s+){0,2}?"
    r"(night(?:time)?|dark(?:ness)?|rain(?:fall)?|snow(?:fall)?|fog|mist)\b",
    re.IGNORECASE,
)


def weather_kinds(stems: set[str]) -> tuple[WeatherKind, ...]:
    """Return the kinds of weather that any of some stems names."""
    return tuple(kind for kind, words in WEATHER_WORDS.items() if stems & set(map(stem, words)))


def circumstances(text: str) -> tuple[str, ...]:
    """Return the weather or light in which something happens: `night` for `in the dark`."""
    return tuple(dict.fromkeys(map(_kind, _CIRCUMSTANCE.findall(text))))


def without_circumstances(text: str) -> str:
    """Return a text without the words that tell its circumstances."""
    return _CIRCUMSTANCE.sub("", text)


def _kind(word: str) -> str:
    """Return the name of a weather need: `night` for `darkness`."""
    found = (kind for kind, words in WEATHER_WORDS.items() if word.casefold() in words)
    return next(found, "night")
