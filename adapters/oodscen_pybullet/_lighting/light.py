"""The light of a scene from the sun, the sky and lamps."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from oodscen.data._weather import Weather
from oodscen.numerics import _exact as exact
from oodscen_pybullet._types import F32, Point

_DAYLIGHT = ((-18.0, 0.06), (-6.0, 0.14), (0.0, 0.42), (8.0, 0.92), (15.0, 1.0))
"""Sun elevation, degrees, and brightness of the day."""
_GLARE_DEG = 12.0
"""Elevation below which a sun ahead of the ego dazzles, degrees."""
_GLARE_HIDDEN = 0.6
"""Hidden share of the sun up to which it dazzles."""
_AHEAD_DEG, _LOWEST_AHEAD_DEG = 6.0, 4.0
"""Heading relative to the road, and lowest drawn elevation, of a sun that dazzles, degrees."""
_BEHIND_DEG, _LOWEST_BEHIND_DEG = 144.0, 12.0
"""Heading and lowest drawn elevation of any other sun, degrees."""
_FOGGY_M = 600.0
"""Visual range below which fog hides the sun, m."""
_CASTS_CLEAR = 0.25
"""Visible share of the sun above which it casts the shadows."""
_RED_DEG = 20.0
"""Elevation below which the sun is red, degrees."""
_LOW_DEG = 28.0
"""Elevation below which the sun hardly reaches the ground, degrees."""
_AMBIENT, _AMBIENT_LOW, _AMBIENT_HIDDEN, _AMBIENT_SNOW = 0.54, 0.26, 0.28, 0.06
"""Fraction of ambient light under a high sun, and what a low sun, a hidden sun and lying snow add to it."""
_DIRECT, _DIRECT_CLEAR = 0.10, 0.50
"""Fraction of direct light under a hidden sun, and what a clear one adds to it."""
_SHADOW, _SHADOW_CLEAR, _SHADOW_LOW = 0.34, 0.06, -0.2
"""Darkness of shadows under a hidden sun, and what a clear and a low one add to it."""
_BLUE, _BLUE_RED = 0.4, 0.6
"""Blueness of shade under a clear sky, and what a red sun adds to it."""
_RED_TINT, _NIGHT_TINT, _BLUE_TINT = (
    (0.08, -0.04, -0.20),
    (-0.22, -0.10, 0.10),
    (-0.07, -0.01, 0.08),
)
"""Change of the light's colour by a red sun, by night and by blue shade."""
_LEAST_LEVEL = 0.02
"""Lower bound of the sun's fraction of the light on level ground, by which shadows are deepened."""
_MOST_BOOST = 4.0
"""Greatest factor by which shadows are deepened."""
_OVERCAST = (0.12, 0.16, 0.98)
"""Direction towards the brightest part of an overcast sky."""


@dataclass(frozen=True)
class Light:
    """Direction, brightness and colour of the light."""

    sun: Point
    """Direction towards the sun, unit length."""
    ambient: float
    """Fraction of the light that is ambient."""
    diffuse: float
    """Fraction of the light that comes directly from the sun."""
    daylight: float
    """0 in the deepest night, 1 at noon."""
    shadow: float
    """Darkness of shadows, 0 to 1."""
    tint: Point
    """Colour of the light."""
    shadow_tint: Point
    """Colour of the light in shadow."""
    towards_caster: Point
    """Direction towards the light that casts shadows: the sun, or near the zenith under an overcast sky."""
    has_glare: bool
    """True if the sun dazzles ahead of the ego."""

    @classmethod
    def of(cls, weather: Weather, heading: float, *, reflects_snow: bool) -> "Light":
        """Derive the light from the weather.

        Args:
            weather: The weather of the scene.
            heading: Heading of the road at the ego's start, rad.
            reflects_snow: Whether lying snow reflects light.
        """
        elevation = weather.sun_elevation_deg
        daylight = _between(_DAYLIGHT, elevation)
        hidden = _hidden(weather)
        has_glare = 0.0 < elevation < _GLARE_DEG and hidden < _GLARE_HIDDEN
        sun = _sun(elevation, heading, has_glare=has_glare)
        clear = 1.0 - hidden if elevation > 0.0 else 0.0
        red = _nearness(elevation, _RED_DEG) * clear
        # Where the sun hardly reaches the ground, cameras expose for the shade.
        low = _nearness(elevation, _LOW_DEG) * clear
        ambient = _AMBIENT + _AMBIENT_LOW * low + _AMBIENT_HIDDEN * (1.0 - clear)
        return cls(
            sun=sun,
            ambient=ambient + (_AMBIENT_SNOW if reflects_snow else 0.0),
            diffuse=_DIRECT + _DIRECT_CLEAR * clear,
            daylight=daylight,
            shadow=_SHADOW + _SHADOW_CLEAR * clear + _SHADOW_LOW * low,
            tint=_tint(red, 1.0 - daylight),
            shadow_tint=_shadow_tint(clear * (_BLUE + _BLUE_RED * red)),
            towards_caster=sun if clear > _CASTS_CLEAR else _OVERCAST,
            has_glare=has_glare,
        )

    def darkness(self) -> F32:
        """Return the darkening of a shadow relative to the sunlit surface, 0 to 1, [256].

        The index is the sun's incidence on the surface, 0 (grazing) to 255 (perpendicular). The darkening
        is the sun's fraction of the light. Where that is below `shadow` on level ground, all fractions are
        scaled up to reach it, at most fourfold, and none beyond `shadow`.
        """
        slant = np.arange(256, dtype=np.float32) / np.float32(255.0)
        share = self.diffuse * slant / (self.ambient + self.diffuse * slant)
        level = self.diffuse * self.sun[2] / (self.ambient + self.diffuse * self.sun[2])
        boost = min(max(self.shadow / max(level, _LEAST_LEVEL), 1.0), _MOST_BOOST)
        most = np.maximum(share, np.float32(self.shadow))
        return np.minimum(share * np.float32(boost), most).astype(np.float32)


def _hidden(weather: Weather) -> float:
    """Return how much of the sun clouds, rain, snow or fog hide, 0 to 1."""
    is_veiled = weather.precipitation != "none" or weather.fog_visual_range_m < _FOGGY_M
    return max(weather.cloud_cover, 1.0 if is_veiled else 0.0)


def _sun(elevation: float, heading: float, *, has_glare: bool) -> Point:
    """Return the direction towards the sun: ahead of the ego where it dazzles, behind it otherwise."""
    turn = heading + math.radians(_AHEAD_DEG if has_glare else _BEHIND_DEG)
    height = math.radians(max(elevation, _LOWEST_AHEAD_DEG if has_glare else _LOWEST_BEHIND_DEG))
    level = exact.cos(height)
    return (level * exact.cos(turn), level * exact.sin(turn), exact.sin(height))


def _nearness(elevation: float, limit: float) -> float:
    """Return how near the sun is to the horizon: 1 on it and below, 0 from a limit on, both in degrees."""
    return max(0.0, 1.0 - max(elevation, 0.0) / limit)


def _tint(red: float, dark: float) -> Point:
    """Return the colour of the light: red from a low sun, blue at night."""
    x, y, z = (
        1.0 + by_sun * red + by_night * dark * (1 - red)
        for by_sun, by_night in zip(_RED_TINT, _NIGHT_TINT, strict=True)
    )
    return x, y, z


def _shadow_tint(blue: float) -> Point:
    """Return the colour of the light in shadow."""
    x, y, z = (1.0 + change * blue for change in _BLUE_TINT)
    return x, y, z


def _between(table: Sequence[tuple[float, float]], value: float) -> float:
    """Interpolate in a table with ascending first column."""
    if value <= table[0][0]:
        return table[0][1]
    for (x0, y0), (x1, y1) in itertools.pairwise(table):
        if value <= x1:
            return y0 + (y1 - y0) * (value - x0) / (x1 - x0)
    return table[-1][1]
