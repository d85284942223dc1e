"""Weather and light: the kinds that a scene can ask for, and their numbers."""

from typing import Literal, Self, TypeGuard, get_args

from pydantic import Field, model_validator

from oodscen.data._base import Data

Precipitation = Literal["none", "rain", "snow"]
"""Forms of precipitation."""
PRECIPITATIONS: tuple[Precipitation, ...] = get_args(Precipitation)
WeatherKind = Literal["night", "fog", "rain", "snow", "ice"]
"""Kinds of weather and light that a scene can ask for by its numbers."""
WEATHER_KINDS: tuple[WeatherKind, ...] = get_args(WeatherKind)
CLEAR_AIR_M = 10_000.0
"""Visual range from which the air is clear, m."""
FOG_M = 1_000.0
"""Visual range below which the air is fog, m (WMO)."""
DARK_DEG = -3.0
"""Sun elevation below which it is dark enough for lamps, degrees."""
DUSK_DEG = -6.0
"""Sun elevation at which civil twilight ends, degrees."""


def is_weather_kind(name: str) -> TypeGuard[WeatherKind]:
    """Return whether a word names a kind of weather that a scene can ask for."""
    return name in WEATHER_KINDS


class Weather(Data):
    """Weather and light, in OpenSCENARIO's terms."""

    sun_elevation_deg: float = Field(default=45.0, ge=-90, le=90)
    """Negative at night."""
    fog_visual_range_m: float = Field(default=CLEAR_AIR_M, gt=0)
    """Distance at which contrast falls to 5 %; 10 km and more is clear air."""
    precipitation: Precipitation = "none"
    precipitation_mm_h: float = Field(default=0.0, ge=0, le=100)
    cloud_cover: float = Field(default=0.1, ge=0, le=1)
    """Share of the sky: OpenSCENARIO's oktas divided by eight."""
    friction: float = Field(default=1.0, gt=0, le=1.5)
    """Scale of the road's friction; 1 is dry asphalt."""

    @model_validator(mode="after")
    def _agree(self) -> Self:
        if (self.precipitation == "none") != (self.precipitation_mm_h == 0):
            raise ValueError("precipitation and precipitation_mm_h must both be given or neither")
        return self
