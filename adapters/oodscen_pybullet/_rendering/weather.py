"""Air and precipitation: fog, sky, rain and snow.

Fog follows Koschmieder's law: contrast falls to 5 % at the visual range.
"""

import math
from collections.abc import Mapping
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from oodscen._seeding import stream
from oodscen.data._scene import Precipitation, Weather
from oodscen.numerics import _exact as exact
from oodscen.numerics._kernels import Kernel
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._lighting.shelter import Portal
from oodscen_pybullet._rendering.optics import beam, fade
from oodscen_pybullet._rendering.stage import RawPicture
from oodscen_pybullet._rendering.triangles import SHELTERED
from oodscen_pybullet._rendering.view import CameraView
from oodscen_pybullet._types import F32, U8, Array

Colour = tuple[float, float, float]

SKY_M = 6_000.0
"""Distance at which fog hides the sky as it hides things, m."""
SHEET = (256, 1024)
"""Rows by height and columns by heading of the cloud sheet."""
_EYE_M = 1.3
"""Height of a camera above the road for the cut-off of the beams, m."""
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


class _Layer(NamedTuple):
    """Raindrops at one range of distances; lengths and widths in pixels of a picture of 480 rows."""

    share: float
    """Number of drops, relative to the first layer."""
    length: float
    thick: float
    bright: float
    near_m: float
    far_m: float


_RAIN = (
    _Layer(share=1.0, length=18.0, thick=0.7, bright=76.0, near_m=5.0, far_m=22.0),
    _Layer(share=0.35, length=42.0, thick=1.0, bright=92.0, near_m=2.2, far_m=6.0),
    _Layer(share=0.05, length=84.0, thick=1.8, bright=70.0, near_m=1.3, far_m=2.5),
)
_DOWNPOUR_MM_H = 50.0
"""Precipitation at which rain has its full density of drops, mm/h."""
_SNOWSTORM_MM_H = 12.0
"""Precipitation, as water, at which snow has its full density of flakes, mm/h."""
_SNOW: Colour = (248.0, 250.0, 254.0)


def air_colour(weather: Weather, light: Light) -> Colour:
    """Return the colour of the air, into which everything fades, 0 to 255."""
    grey = _GREY[weather.precipitation]
    bright = 0.045 + 0.955 * light.daylight
    return (
        grey[0] * bright * light.tint[0],
        grey[1] * bright * light.tint[1],
        grey[2] * bright * light.tint[2],
    )


def heaven(view: CameraView, weather: Weather, light: Light) -> F32:
    """Return the sky by rows of pixels: [height, 5] float32.

    The columns are red, green and blue of the clear sky, 0 to 255; row of the cloud sheet; weight of the
    next row. Below the horizon it is the haze over distant ground.
    """
    _, upwards = view.slopes()
    rise = upwards * np.float32(view.up[2]) + np.float32(view.forward[2])
    high = np.clip(rise * np.float32(_RISE), 0.0, 1.0).astype(np.float32)
    sun, day = weather.sun_elevation_deg, light.daylight
    low = 1.0 - min(1.0, max(0.0, sun) / _GLOW_BELOW_DEG)
    glow = _GLOW_SHARE * low * max(0.0, min(1.0, (sun - _GLOW_ENDS_DEG) / -_GLOW_ENDS_DEG))
    rows = np.empty((view.height, 5), np.float32)
    for e in range(3):
        bottom = _NIGHT.horizon[e] + (_DAY.horizon[e] - _NIGHT.horizon[e]) * day
        bottom += (_GLOW[e] * max(day, 0.5) - bottom) * glow
        top = _NIGHT.zenith[e] + (_DAY.zenith[e] - _NIGHT.zenith[e]) * day
        rows[:, e] = np.float32(bottom) + np.float32(top - bottom) * high
    place = np.clip(rise * np.float32(_CLOUD_ROWS), 0.0, np.float32(SHEET[0] - 1.001))
    rows[:, 3] = np.floor(place)
    rows[:, 4] = place - rows[:, 3]
    return rows


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


def add_rain(image: U8, picture: RawPicture, kinds: U8) -> None:
    """Add streaks of falling drops, in place, where nothing occludes them.

    Args:
        image: [height, width, 3]
        picture: The camera, the weather, the light, the seed and the time.
        kinds: [height, width] surface flags: surfaces in a tunnel stay dry.
    """
    view, weather = picture.view, picture.weather
    rng = stream(picture.seed, "rain", round(picture.time, 3))
    area = view.width * view.height / (640 * 480)
    intensity = math.sqrt(weather.precipitation_mm_h / _DOWNPOUR_MM_H)
    scale = view.height / 480 * (0.75 + 0.5 * intensity)
    shine = 0.3 + 0.45 * picture.light.daylight
    layers = []
    for layer in _RAIN:
        count = int(area * layer.share * (160 + 760 * intensity))
        x = rng.uniform(-20, view.width + 20, count)
        size = rng.uniform(0.6, 1.3, count) * layer.length * scale
        y = rng.uniform(-40, view.height, count)
        shade = rng.uniform(0.4, 1.0, count) * layer.bright * shine
        ahead = rng.uniform(layer.near_m, layer.far_m, count)
        width = np.full(count, max(layer.thick * scale, 0.6))
        layers.append(np.stack([x, y, size, shade, width, ahead, np.zeros(count)], axis=1))
    streaks = np.concatenate(layers).astype(np.float32)
    across = (streaks[:, 0] - np.float32(view.width / 2)) * np.float32(1.0 / view.focal)
    high = (np.float32(view.height / 2) - streaks[:, 1]) * np.float32(1.0 / view.focal)
    streaks = _outside(streaks, streaks[:, 5], across, high, picture.portal)
    draw_streaks(image, picture.shot.reach, kinds, streaks)


def _outside(drops: F32, ahead: F32, across: F32, upwards: F32, portal: Portal | None) -> F32:
    """Return the drops or flakes that are not certainly in a tunnel.

    The last number of each becomes 1 if it may be in one: behind the portal ahead.
    """
    if portal is None:
        return drops
    is_behind = ahead > portal.depths(across, upwards)
    if portal.is_inside:
        return drops[is_behind]
    drops[:, -1] = is_behind
    return drops


@Kernel
def draw_streaks(image: U8, depth: F32, kinds: U8, streaks: F32) -> None:
    """Draw slightly slanted lines of light.

    Args:
        image: [height, width, 3], changed in place.
        depth: [height, width] m
        kinds: [height, width] surface flags.
        streaks: [n, 7] column and row of the upper end, length, brightness, width, pixels; distance,
            m; 1 if surfaces in a tunnel hide it.
    """
    height, width = image.shape[0], image.shape[1]
    one, most = np.float32(1.0), np.float32(255.0)
    for n in range(streaks.shape[0]):
        length, thick = streaks[n, 2], streaks[n, 4]
        first, last = int(np.floor(streaks[n, 1])), int(np.floor(streaks[n, 1] + length))
        for y in range(max(first, 0), min(last + 1, height)):
            along = (np.float32(y) - streaks[n, 1]) / length
            # Faint at both ends.
            part = np.float32(4.0) * along * (one - along)
            if part <= np.float32(0.0):
                continue
            middle = streaks[n, 0] - np.float32(0.10) * (np.float32(y) - streaks[n, 1])
            left = int(np.floor(middle - thick))
            for x in range(max(left, 0), min(int(np.floor(middle + thick)) + 2, width)):
                away = abs(np.float32(x) - middle)
                cover = min(
                    max(thick * np.float32(0.5) + np.float32(0.5) - away, np.float32(0.0)), one
                )
                if depth[y, x] < streaks[n, 5]:
                    continue
                if streaks[n, 6] > np.float32(0.0) and kinds[y, x] & SHELTERED:
                    continue
                bright = streaks[n, 3] * part * cover
                for e in range(3):
                    image[y, x, e] = np.uint8(min(np.float32(image[y, x, e]) + bright, most))


def add_snow(image: U8, picture: RawPicture, kinds: U8) -> None:
    """Add falling flakes, in place, where nothing occludes them; see `add_rain`."""
    view, weather = picture.view, picture.weather
    rng = stream(picture.seed, "snow", round(picture.time, 3))
    intensity = min(1.0, weather.precipitation_mm_h / _SNOWSTORM_MM_H)
    count = int(700 + 5200 * intensity)
    share = rng.uniform(0.0, 1.0, count)
    ahead = 0.9 + 26.0 * share * np.sqrt(np.sqrt(share))
    across = rng.uniform(-1.0, 1.0, count) * ahead * view.width / view.focal * 0.55
    upwards = rng.uniform(-1.0, 1.0, count) * ahead * view.height / view.focal * 0.55
    column = view.width / 2 + view.focal * across / ahead
    row = view.height / 2 - view.focal * upwards / ahead
    radius = np.maximum(view.focal * 0.0055 / ahead, 0.5)
    bright = _flake_brightness(picture, ahead, across, upwards)
    columns = [column, row, radius, ahead, bright, np.zeros(count)]
    flakes = np.stack(columns, axis=1).astype(np.float32)
    slopes = (across / ahead).astype(np.float32), (upwards / ahead).astype(np.float32)
    flakes = _outside(flakes, flakes[:, 3], *slopes, picture.portal)
    draw_flakes(image, picture.shot.reach, kinds, flakes, np.array(_SNOW, np.float32))


def _flake_brightness(picture: RawPicture, ahead: Array, across: Array, upwards: Array) -> F32:
    """Return the brightness of flakes in daylight and headlamps, 0 to 1; places relative to the camera, m."""
    daylight = picture.light.daylight
    aside = np.asarray(across / ahead * np.float32(1.0 / 0.5), np.float32)
    spread = fade(np.minimum(aside * aside, np.float32(40.0)))
    strength = np.float32(2.6 * (1.0 - daylight) if picture.view.is_lit else 0.0)
    height = upwards.astype(np.float32) + np.float32(_EYE_M)
    shine = beam(ahead.astype(np.float32), height, spread, strength)
    bright = np.float32(0.34 + 0.66 * daylight) + shine
    return np.asarray(np.minimum(bright, np.float32(1.0)))


@Kernel
def draw_flakes(image: U8, depth: F32, kinds: U8, flakes: F32, colour: F32) -> None:
    """Draw soft round flakes where nothing occludes them; they never darken a pixel.

    Args:
        image: [height, width, 3], changed in place.
        depth: [height, width] m
        kinds: [height, width] surface flags.
        flakes: [n, 6] column, row and radius, pixels; distance, m; brightness, 0 to 1; 1 if surfaces
            in a tunnel hide it.
        colour: [3] colour of the brightest flake, 0 to 255.
    """
    height, width = depth.shape
    one, half, zero = np.float32(1.0), np.float32(0.5), np.float32(0.0)
    for n in range(flakes.shape[0]):
        column, row, radius = flakes[n, 0] - half, flakes[n, 1] - half, flakes[n, 2]
        edge = radius + one
        for y in range(max(int(row - edge), 0), min(int(row + edge) + 2, height)):
            for x in range(max(int(column - edge), 0), min(int(column + edge) + 2, width)):
                if depth[y, x] < flakes[n, 3]:
                    continue
                if flakes[n, 5] > zero and kinds[y, x] & SHELTERED:
                    continue
                away = (np.float32(x) - column) * (np.float32(x) - column)
                away += (np.float32(y) - row) * (np.float32(y) - row)
                cover = min(max((edge - np.sqrt(away)) / (one + half * radius), zero), one)
                cover *= np.float32(0.8)
                for e in range(3):
                    before = np.float32(image[y, x, e])
                    more = max(colour[e] * flakes[n, 4] - before, zero)
                    image[y, x, e] = np.uint8(before + more * cover + half)
