"""The colours of the air and of the clear sky."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from oodscen.data._weather import Precipitation, Weather
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._rendering.view import CameraView
from oodscen_pybullet._types import F32

Colour = tuple[float, float, float]

SKY_M = 6_000.0
"""Distance at which fog hides the sky as it hides things, m."""
_GREY: Mapping[Precipitation, Colour] = {
    "none": (196.0, 201.0, 207.0),
    "rain": (158.0, 164.0, 171.0),
    "snow": (208.0, 212.0, 219.0),
}
"""Colours of the air by day, 0 to 255."""


class _Sky(NamedTuple):
    """Colours of a clear sky, 0 to 255."""

    horizon: Colour
    zenith: Colour


_DAY = _Sky(horizon=(204.0, 222.0, 240.0), zenith=(92.0, 148.0, 222.0))
_NIGHT = _Sky(horizon=(26.0, 30.0, 44.0), zenith=(7.0, 9.0, 20.0))
_GLOW: Colour = (248.0, 186.0, 128.0)
"""Colour of the horizon under a low sun."""
_GLOW_BELOW_DEG = 14.0
"""Elevation of the sun below which the horizon glows, degrees."""
_GLOW_ENDS_DEG = -8.0
"""Elevation of the sun at which the glow is gone, degrees."""
_GLOW_SHARE = 0.6
_RISE = 1.6
"""Share of the way from horizon to zenith colour per unit of upward slope."""


def air_colour(weather: Weather, light: Light) -> Colour:
    """Return the colour of the air, into which everything fades, 0 to 255."""
    grey = _GREY[weather.precipitation]
    bright = 0.045 + 0.955 * light.daylight
    return (
        grey[0] * bright * light.tint[0],
        grey[1] * bright * light.tint[1],
        grey[2] * bright * light.tint[2],
    )


def clear_sky(view: CameraView, weather: Weather, light: Light) -> F32:
    """Return the colour of the clear sky by rows of pixels, 0 to 255: [height, 3] float32.

    Below the horizon it is the haze over distant ground.
    """
    high = np.clip(view.rises() * np.float32(_RISE), 0.0, 1.0).astype(np.float32)
    sun, day = weather.sun_elevation_deg, light.daylight
    low = 1.0 - min(1.0, max(0.0, sun) / _GLOW_BELOW_DEG)
    glow = _GLOW_SHARE * low * max(0.0, min(1.0, (sun - _GLOW_ENDS_DEG) / -_GLOW_ENDS_DEG))
    rows = np.empty((view.height, 3), np.float32)
    for e in range(3):
        bottom = _NIGHT.horizon[e] + (_DAY.horizon[e] - _NIGHT.horizon[e]) * day
        bottom += (_GLOW[e] * max(day, 0.5) - bottom) * glow
        top = _NIGHT.zenith[e] + (_DAY.zenith[e] - _NIGHT.zenith[e]) * day
        rows[:, e] = np.float32(bottom) + np.float32(top - bottom) * high
    return rows
