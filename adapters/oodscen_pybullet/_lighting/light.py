"""The light of a scene from the sun, the sky and lamps."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from oodscen.data._scene import Weather
from oodscen.numerics import _exact as exact
from oodscen_pybullet._types import F32, Point

_DEGREE = math.radians(1.0)

_DAYLIGHT = ((-18.0, 0.06), (-6.0, 0.14), (0.0, 0.42), (8.0, 0.92), (15.0, 1.0))
"""Sun elevation, degrees, and brightness of the day."""
_AHEAD_DEG, _BEHIND_DEG = 6.0, 144.0
"""Heading of a sun that dazzles, and of any other, relative to the road, degrees."""
_LOWEST_AHEAD_DEG, _LOWEST_DEG = 4.0, 12.0
"""Lowest elevation at which either is drawn, degrees."""
_FOGGY_M = 600.0
"""Visual range below which fog hides the sun, m."""
_OVERCAST = (0.12, 0.16, 0.98)
"""Direction towards the brightest part of an overcast sky."""
GLARE_DEG = 12.0
"""Elevation below which a sun ahead of the ego dazzles, degrees."""


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
    has_glare: bool
    shade: Point = (1.0, 1.0, 1.0)
    """Colour of the light in shadow."""
    shades: Point = (0.0, 0.0, 1.0)
    """Direction towards the light that casts shadows: the sun, or near the zenith under an overcast sky."""

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
        has_glare = 0.0 < elevation < GLARE_DEG and hidden < 0.6
        sun = _sun(elevation, heading, has_glare=has_glare)
        clear = (1.0 - hidden) * (1.0 if elevation > 0.0 else 0.0)
        warm = max(0.0, 1.0 - max(elevation, 0.0) / 20.0) * clear
        # Where the sun hardly reaches the ground, cameras expose for the shade.
        low = max(0.0, 1.0 - max(elevation, 0.0) / 28.0) * clear
        blue = clear * (0.4 + 0.6 * warm)
        return cls(
            sun=sun,
            ambient=0.54 + 0.26 * low + 0.28 * (1.0 - clear) + (0.06 if reflects_snow else 0.0),
            diffuse=0.10 + 0.50 * clear,
            daylight=daylight,
            shadow=0.34 + 0.06 * clear - 0.2 * low,
            tint=_tint(warm, 1.0 - daylight),
            has_glare=has_glare,
            shade=(1.0 - 0.07 * blue, 1.0 - 0.01 * blue, 1.0 + 0.08 * blue),
            shades=sun if clear > 0.25 else _OVERCAST,
        )

    def darkness(self) -> F32:
        """Return the darkening of a shadow relative to the sunlit surface, 0 to 1, [256].

        The index is the sun's incidence on the surface, 0 (grazing) to 255 (perpendicular). The darkening
        is the sun's fraction of the light; where an overcast sky makes that small, it is `shadow` near
        the base of objects.
        """
        slant = np.arange(256, dtype=np.float32) / np.float32(255.0)
        share = self.diffuse * slant / (self.ambient + self.diffuse * slant)
        level = self.diffuse * self.sun[2] / (self.ambient + self.diffuse * self.sun[2])
        boost = min(max(self.shadow / max(level, 0.02), 1.0), 4.0)
        most = np.maximum(share, np.float32(self.shadow))
        return np.minimum(share * np.float32(boost), most).astype(np.float32)


def _hidden(weather: Weather) -> float:
    """Return how much of the sun clouds, rain, snow or fog hide, 0 to 1."""
    is_veiled = weather.precipitation != "none" or weather.fog_visual_range_m < _FOGGY_M
    return max(weather.cloud_cover, 1.0 if is_veiled else 0.0)


def _sun(elevation: float, heading: float, *, has_glare: bool) -> Point:
    """Return the direction towards the sun: ahead of the ego where it dazzles, behind it otherwise."""
    turn = heading + _DEGREE * (_AHEAD_DEG if has_glare else _BEHIND_DEG)
    height = _DEGREE * max(elevation, _LOWEST_AHEAD_DEG if has_glare else _LOWEST_DEG)
    level = exact.cos(height)
    return (level * exact.cos(turn), level * exact.sin(turn), exact.sin(height))


def _tint(warm: float, dark: float) -> Point:
    """Return the colour of the light: red from a low sun, blue at night."""
    return (
        1.0 + 0.08 * warm - 0.22 * dark * (1 - warm),
        1.0 - 0.04 * warm - 0.10 * dark * (1 - warm),
        1.0 - 0.20 * warm + 0.10 * dark * (1 - warm),
    )


def _between(table: Sequence[tuple[float, float]], value: float) -> float:
    """Interpolate in a table with ascending first column."""
    if value <= table[0][0]:
        return table[0][1]
    for (x0, y0), (x1, y1) in itertools.pairwise(table):
        if value <= x1:
            return y0 + (y1 - y0) * (value - x0) / (x1 - x0)
    return table[-1][1]
