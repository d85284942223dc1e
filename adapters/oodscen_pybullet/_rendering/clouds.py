"""The clouds of a picture."""

from functools import lru_cache

import numpy as np

from oodscen._seeding import stream
from oodscen.data._weather import Weather
from oodscen.numerics import _exact as exact
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._rendering.plate import Clouds
from oodscen_pybullet._rendering.view import CameraView
from oodscen_pybullet._types import F32

_SHEET = (256, 1024)
"""Rows by height and columns by heading of the cloud sheet."""
_ROWS = 420.0
"""Rows of the cloud sheet per unit of upward slope."""
_CLOUDY, _OVERCAST = 0.02, 0.75
"""Cover from which there are clouds, and from which they leave no clear sky."""
_REACH, _SOFTNESS = 0.9, 0.12
"""Fall of the density at which clouds begin from a clear sky to a covered one, and from there to their soft edges."""
_NO_CLOUDS = 9.0
"""Density at which clouds begin that none reaches."""
_SHADE, _GLOOM = 0.86, 0.12
"""Brightness of thin clouds, and its fall from a clear sky to a covered one."""
_WHITE, _NIGHT = 243.0, 0.06
"""Brightness of a white cloud by day, 0 to 255, and the share of it by night."""


def clouds(weather: Weather, light: Light, seed: int) -> Clouds:
    """Return the clouds of a weather, in the daylight that there is."""
    cover = _cover(weather)
    begins = 1.0 - _REACH * cover - _SOFTNESS
    return Clouds(
        edge=np.float32(begins if cover > _CLOUDY else _NO_CLOUDS),
        floor=np.float32(max(0.0, (cover - _OVERCAST) / (1.0 - _OVERCAST))),
        shade=np.float32(_SHADE - _GLOOM * cover),
        bright=np.float32(_WHITE * (_NIGHT + (1.0 - _NIGHT) * light.daylight)),
        sheet=cloud_sheet(seed),
    )


def _cover(weather: Weather) -> float:
    """Return the fraction of the sky that clouds hide."""
    return max(weather.cloud_cover, 1.0 if weather.precipitation != "none" else 0.0)


def cloud_rows(view: CameraView) -> F32:
    """Return the row of the cloud sheet for each row of pixels, and the weight of the next: [height, 2] float32."""
    place = np.clip(view.rises() * np.float32(_ROWS), 0.0, np.float32(_SHEET[0] - 1.001))
    low = np.floor(place)
    return np.stack([low, place - low], axis=1).astype(np.float32)


def cloud_columns(view: CameraView) -> F32:
    """Return the column of the cloud sheet for each column of pixels: [width] float32."""
    across, _ = view.slopes()
    turn = exact.atan2(view.forward[1], view.forward[0]) / exact.TAU
    columns = np.float32(turn * _SHEET[1]) - across * np.float32(_SHEET[1] / exact.TAU)
    columns -= np.floor(columns * np.float32(1 / _SHEET[1])) * np.float32(_SHEET[1])
    return np.asarray(np.clip(columns, 0.0, np.float32(_SHEET[1] - 0.001)), np.float32)


@lru_cache(maxsize=8)
def cloud_sheet(seed: int) -> F32:
    """Return the density of clouds by height and heading, one column more than a full turn."""
    rng = stream(seed, "clouds")
    height, width = _SHEET
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
