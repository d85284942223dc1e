"""The colours of the air and of the sky, and its clouds."""

from collections.abc import Mapping
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from oodscen._seeding import stream
from oodscen.data._scene import Precipitation, Weather
from oodscen.numerics import _exact as exact
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._rendering.view import CameraView
from oodscen_pybullet._types import F32

Colour = tuple[float, float, float]

SKY_M = 6_000.0
"""Distance at which fog hides the sky as it hides things, m."""
SHEET = (256, 1024)
"""Rows by height and columns by heading of the cloud sheet."""
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
_CLOUD_ROWS = 420.0
"""Rows of the cloud sheet per unit of upward slope."""


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
    high = np.clip(_rises(view) * np.float32(_RISE), 0.0, 1.0).astype(np.float32)
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


def cloud_rows(view: CameraView) -> F32:
    """Return the row of the cloud sheet for each row of pixels, and the weight of the next: [height, 2] float32."""
    place = np.clip(_rises(view) * np.float32(_CLOUD_ROWS), 0.0, np.float32(SHEET[0] - 1.001))
    low = np.floor(place)
    return np.stack([low, place - low], axis=1).astype(np.float32)


def _rises(view: CameraView) -> F32:
    """Return the rise per metre ahead for each row of pixels."""
    _, upwards = view.slopes()
    return np.asarray(upwards * np.float32(view.up[2]) + np.float32(view.forward[2]), np.float32)


def cloud_columns(view: CameraView) -> F32:
    """Return the column of the cloud sheet for each column of pixels: [width] float32."""
    across, _ = view.slopes()
    turn = exact.atan2(view.forward[1], view.forward[0]) / exact.TAU
    columns = np.float32(turn * SHEET[1]) - across * np.float32(SHEET[1] / exact.TAU)
    columns -= np.floor(columns * np.float32(1 / SHEET[1])) * np.float32(SHEET[1])
    return np.asarray(np.clip(columns, 0.0, np.float32(SHEET[1] - 0.001)), np.float32)


def cloud_cover(weather: Weather) -> float:
    """Return the fraction of the sky that clouds hide."""
    return max(weather.cloud_cover, 1.0 if weather.precipitation != "none" else 0.0)


@lru_cache(maxsize=8)
def cloud_sheet(seed: int) -> F32:
    """Return the density of clouds by height and heading, one column more than a full turn."""
    rng = stream(seed, "clouds")
    height, width = SHEET
    sheet = np.zeros((height, width), np.float32)
    octaves = ((10, 48, 0.52), (22, 96, 0.26), (44, 256, 0.15), (88, 512, 0.07))
    for rows, columns, weight in octaves:
        noise = rng.integers(0, 4096, (rows + 1, columns)).astype(np.float32) * np.float32(1 / 4095)
        sheet += np.float32(weight) * _stretched(noise, height, width)
    sheet = np.clip((sheet - np.float32(0.5)) * np.float32(1.7) + np.float32(0.5), 0.0, 1.0)
    sheet = np.hstack([sheet, sheet[:, :1]]).astype(np.float32)
    sheet.flags.writeable = False
    return sheet


def _stretched(noise: F32, height: int, width: int) -> F32:
    """Return noise resampled smoothly to another size; the last column meets the first."""
    rows, columns = noise.shape
    y = np.arange(height, dtype=np.float32) * np.float32((rows - 1) / height)
    x = np.arange(width, dtype=np.float32) * np.float32(columns / width)
    i, j = y.astype(np.int64), x.astype(np.int64)
    v, u = y - i.astype(np.float32), x - j.astype(np.float32)
    v, u = v * v * (np.float32(3.0) - 2 * v), u * u * (np.float32(3.0) - 2 * u)
    lines = noise[i] + (noise[i + 1] - noise[i]) * v[:, None]
    other = lines[:, (j + 1) % columns]
    return np.asarray(lines[:, j] + (other - lines[:, j]) * u[None, :], np.float32)
