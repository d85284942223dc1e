"""The line on the weather in a digest: models read it, and the built-in author, which sees only the prompt, parses it."""

import re
from dataclasses import dataclass
from typing import Self

from oodscen._words.decimals import exact
from oodscen.data._additions import DENSE_FOG_M, ICE
from oodscen.data._catalogue import Catalogue
from oodscen.data._weather import CLEAR_AIR_M, DUSK_DEG, WeatherKind, is_weather_kind

_CLEAR_FROM_M = 5_000.0
"""Visual range from which the air counts as clear, m."""
_NADIR_DEG = -90.0
"""Elevation below which no sun goes, degrees."""


@dataclass(frozen=True)
class WeatherLimits:
    """The contents of a digest's line on the weather."""

    sun_deg: float
    """Lowest elevation of the sun, degrees."""
    fog_m: float
    """Least visual range, m."""
    rain: bool
    snow: bool
    intensity: float
    """Greatest precipitation intensity, mm/h."""
    friction: float
    """Least friction."""
    sun_is_drawn: bool = True
    """False if every sun looks alike."""
    others: tuple[str, ...] = ()
    """Kinds of weather that no scene can ask for."""

    @classmethod
    def of(cls, line: str) -> Self:
        """Parse a line such as `night; fog down to 30 m visual range; rain and snow up to 60 mm/h; ...`."""
        scaled, _, also = line.partition("; also ")
        others = also.removesuffix(", which no scene can ask for")

        def number(before: str, default: float) -> float:
            match = re.search(rf"{before} (-?[\d.]+(?:e[+-]\d+)?)", scaled)
            return float(match[1]) if match else default

        return cls(
            sun_deg=number("sun at", _NADIR_DEG if scaled.startswith("night") else 0.0),
            fog_m=number("fog down to", CLEAR_AIR_M),
            rain=re.search(r"\brain\b", scaled) is not None,
            snow=re.search(r"\bsnow\b", scaled) is not None,
            intensity=number("up to", 0.0),
            friction=number("friction down to", 1.0),
            sun_is_drawn="every sun looks alike" not in scaled,
            others=tuple(others.split(", ")) if others else (),
        )

    def offers(self, name: str) -> bool:
        """Return whether a kind of weather can be shown, whether or not it has a scale in a scene."""
        kinds: dict[WeatherKind, bool] = {
            "night": self.sun_deg < DUSK_DEG,
            "fog": self.fog_m <= DENSE_FOG_M,
            "rain": self.rain,
            "snow": self.snow,
            "ice": self.friction <= ICE,
        }
        return kinds[name] if is_weather_kind(name) else name in self.others


def weather_line(catalogue: Catalogue) -> str:
    """Return the line of a catalogue; `WeatherLimits.of` reads it back."""
    weather = catalogue.weather
    lowest = weather.min_sun_elevation_deg
    parts = ["night" if lowest < DUSK_DEG else "no night"]
    if lowest > _NADIR_DEG:
        parts[0] += f" (sun at {exact(lowest)} degrees or higher)"
    if not weather.sun_is_drawn:
        parts.append("every sun looks alike: neither dusk nor glare")
    fog = weather.min_fog_visual_range_m
    parts.append(f"fog down to {exact(fog)} m visual range" if fog < _CLEAR_FROM_M else "no fog")
    kinds = [kind for kind in weather.precipitation if kind != "none"]
    if kinds:
        parts.append(f"{' and '.join(kinds)} up to {exact(weather.max_precipitation_mm_h)} mm/h")
    else:
        parts.append("no precipitation")
    parts.append(f"road friction down to {exact(weather.min_friction)}")
    if weather.others:
        parts.append(f"also {', '.join(weather.others)}, which no scene can ask for")
    return "; ".join(parts)
