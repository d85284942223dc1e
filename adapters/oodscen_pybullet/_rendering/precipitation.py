"""Falling rain and snow."""

import math
from typing import NamedTuple

import numpy as np

from oodscen._seeding import stream
from oodscen.numerics._kernels import Kernel
from oodscen_pybullet._lighting.shelter import Portal
from oodscen_pybullet._rendering.optics import beam, fade
from oodscen_pybullet._rendering.stage import RawPicture
from oodscen_pybullet._rendering.triangles import SHELTERED
from oodscen_pybullet._types import F32, U8, Array

_EYE_M = 1.3
"""Height of a camera above the road for the cut-off of the beams, m."""


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
_SNOW = (248.0, 250.0, 254.0)
"""Colour of the brightest flake, 0 to 255."""


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
