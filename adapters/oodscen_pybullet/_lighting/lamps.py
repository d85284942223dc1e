"""Lamps in the dark: the light that they cast, their halos and the glare of the sun."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from oodscen.numerics import _exact as exact
from oodscen.numerics._kernels import Kernel
from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._meshes.mesh import Lamp
from oodscen_pybullet._rendering.postprocess import GRID_AHEAD, GRID_ASIDE, GRID_CELL
from oodscen_pybullet._rendering.view import CameraView
from oodscen_pybullet._types import F32, U8, Point

HEADLAMP = 3.5
"""Least power with which a directional lamp casts a cone of light."""
_FAR = GRID_AHEAD * GRID_CELL


def ground_light(view: CameraView, lamps: Sequence[Lamp], light: Light) -> F32 | None:
    """Return the lamps' light on surfaces in front of the camera.

    Args:
        view: The camera.
        lamps: All lamps.
        light: The light of the scene; by day lamps illuminate nothing.

    Returns:
        [GRID_AHEAD, GRID_ASIDE, 3] by cells along the optical axis and to the right, with the axis in
        the middle; `None` if the lamps add nothing.
    """
    dark = 1.0 - light.daylight
    if dark < 0.3:
        return None
    grid = np.zeros((GRID_AHEAD, GRID_ASIDE, 3), np.float32)
    is_lit = False
    for lamp in lamps:
        aside, _, ahead = view.to_camera(lamp.position)
        if not (-40.0 < ahead < _FAR + 10.0 and abs(aside) < GRID_ASIDE * GRID_CELL / 2 + 30.0):
            continue
        facing = (
            sum(a * b for a, b in zip(lamp.facing, view.right, strict=True)),
            sum(a * b for a, b in zip(lamp.facing, view.forward, strict=True)),
        )
        has_cone = lamp.power >= HEADLAMP and facing != (0.0, 0.0) and not lamp.is_street
        reach = 26.0 if lamp.is_street else 45.0 if has_cone else 9.0 * math.sqrt(lamp.power)
        i0, i1 = _cells(ahead - reach, ahead + reach, 0.0, GRID_AHEAD)
        j0, j1 = _cells(aside - reach, aside + reach, GRID_ASIDE / 2, GRID_ASIDE)
        if i0 >= i1 or j0 >= j1:
            continue
        y = (np.arange(i0, i1, dtype=np.float32) * np.float32(GRID_CELL) - np.float32(ahead))[
            :, None
        ]
        x = np.arange(j0, j1, dtype=np.float32) - np.float32(GRID_ASIDE / 2)
        x = (x * np.float32(GRID_CELL) - np.float32(aside))[None, :]
        square = np.asarray(x * x + y * y, np.float32)
        rim = np.maximum(np.float32(1.0) - square * np.float32(1.0 / reach**2), np.float32(0.0))
        if lamp.is_street:
            fall = np.float32(1.0) + square * np.float32(1.0 / 55.0)
            pool: NDArray[np.floating] = np.float32(0.62) / (fall * fall)
        elif has_cone:
            along = x * np.float32(facing[0]) + y * np.float32(facing[1])
            across = square - along * along
            width = np.maximum(along, np.float32(0.05)) * np.float32(0.38)
            shape = np.float32(1.0) + across / (width * width)
            pool = np.float32(0.20 * lamp.power) / (shape * shape)
            pool /= np.float32(1.0) + along * along * np.float32(1.0 / 170.0)
            pool *= along > np.float32(0.0)
        else:
            pool = np.float32(0.16 * lamp.power) / (np.float32(1.0) + square * np.float32(0.4))
            if facing != (0.0, 0.0):
                along = x * np.float32(facing[0]) + y * np.float32(facing[1])
                pool *= along > np.float32(-0.3)
        pool *= rim * np.float32(dark)
        grid[i0:i1, j0:j1] += pool[..., None] * np.array(lamp.colour, np.float32)
        is_lit = True
    return grid if is_lit else None


def _cells(low: float, high: float, zero: float, count: int) -> tuple[int, int]:
    return (
        max(math.floor(low / GRID_CELL + zero), 0),
        min(math.ceil(high / GRID_CELL + zero) + 1, count),
    )


def add_glows(
    image: U8,
    view: CameraView,
    depth: F32,
    lamps: Sequence[Lamp],
    light: Light,
    extinction: float,
) -> None:
    """Add the halos of visible lamps, in place.

    Args:
        image: [height, width, 3]
        view: The camera.
        depth: m
        lamps: All lamps.
        light: The light of the scene; by day halos are faint.
        extinction: Extinction coefficient of the air, 1/m: it dims lamps and widens their halos.
    """
    dark = 1.0 - light.daylight
    for lamp in lamps:
        if lamp.is_street and light.daylight > 0.5:
            continue
        spot = view.pixel(lamp.position)
        if spot is None or spot[2] > 300.0:
            continue
        column, row, ahead = spot
        reach = view.width * 0.1
        if not (-reach < column < view.width + reach and -reach < row < view.height + reach):
            continue
        seen = _facing(view, lamp) * _visible(depth, column, row, ahead)
        if seen <= 0.0:
            continue
        through = exact.exp(-extinction * ahead)
        murk = min(1.0, extinction * 60.0)
        strength = seen * through * (lamp.by_day + (1.0 - lamp.by_day) * dark)
        strength *= math.sqrt(lamp.power)
        core = max(0.7, view.focal * 0.055 * math.sqrt(lamp.power) / ahead)
        wide = core * (2.6 + 2.5 * dark + 3.0 * murk * (0.3 + dark))
        _add(image, column, row, core * 1.5, 235.0 * strength, _core(lamp))
        _add(image, column, row, min(wide, view.width * 0.16), 95.0 * strength, lamp.colour)


def add_glare(image: U8, view: CameraView, light: Light, depth: F32) -> None:
    """Add the glare of a low sun ahead, in place."""
    far = tuple(view.eye[i] + 1000.0 * light.sun[i] for i in range(3))
    spot = view.pixel((far[0], far[1], far[2]))
    if not light.has_glare or spot is None:
        return
    column, row, _ = spot
    warm = (1.0, 0.90, 0.66)
    disc = _visible(depth, column, row, 399.0)
    shown = 0.55 + 0.45 * disc
    _add(image, column, row, view.width * 0.6, 52.0 * shown, (1.0, 0.94, 0.80))
    _add(image, column, row, view.width * 0.12, 150.0 * disc, warm)
    _add(image, column, row, view.width * 0.04, 255.0 * disc, (1.0, 0.98, 0.9))


def _facing(view: CameraView, lamp: Lamp) -> float:
    fx, fy, fz = lamp.facing
    if fx == fy == fz == 0.0:
        return 1.0
    dx, dy, dz = (view.eye[i] - lamp.position[i] for i in range(3))
    length = math.sqrt(dx * dx + dy * dy + dz * dz) or 1.0
    return max(0.0, min(1.0, 1.4 * (fx * dx + fy * dy + fz * dz) / length))


def _visible(depth: F32, column: float, row: float, ahead: float) -> float:
    """Return the fraction of a few pixels around a point that nothing in front occludes."""
    height, width = depth.shape
    c, r = round(column - 0.5), round(row - 0.5)
    patch = depth[
        max(r - 1, 0) : max(min(r + 2, height), 0), max(c - 1, 0) : max(min(c + 2, width), 0)
    ]
    if patch.size == 0:
        return 0.6
    return np.count_nonzero(patch > ahead - 0.35) / patch.size


def _core(lamp: Lamp) -> Point:
    """Return the colour of a lamp's core: nearly white, or by day the colour that a signal shows."""
    red, green, blue = lamp.colour
    if lamp.by_day > 0.5:
        return lamp.colour
    return (0.5 + 0.5 * red, 0.5 + 0.5 * green, 0.5 + 0.5 * blue)


def _add(
    image: U8, column: float, row: float, radius: float, strength: float, colour: Point
) -> None:
    light = np.array([value * strength for value in colour], np.float32)
    splash(image, np.float32(column), np.float32(row), np.float32(radius), light)


@Kernel
def splash(image: U8, column: np.float32, row: np.float32, radius: np.float32, light: F32) -> None:
    """Add a round spot of light that fades to zero at twice its radius.

    Args:
        image: [height, width, 3], changed in place.
        column: Column of the centre, pixels.
        row: Row of the centre.
        radius: Pixels.
        light: [3] light to add at the centre, 0 to 255.
    """
    height, width = image.shape[0], image.shape[1]
    one, half = np.float32(1.0), np.float32(0.5)
    reach = np.float32(2.0) * radius + one
    left, right = max(int(column - reach), 0), min(int(column + reach) + 1, width)
    top, bottom = max(int(row - reach), 0), min(int(row + reach) + 1, height)
    if left >= right or top >= bottom:
        return
    scale = one / (np.float32(4.0) * radius * radius + np.float32(1e-6))
    aside = np.arange(left, right).astype(np.float32) + (half - column)
    aside = aside * aside
    for y in range(top, bottom):
        aloft = np.float32(y) + half - row
        fall = np.maximum(one - (aside + aloft * aloft) * scale, np.float32(0.0))
        fall = fall * fall * fall
        for e in range(3):
            bright = image[y, left:right, e] + (fall * light[e] + half)
            image[y, left:right, e] = np.minimum(bright, np.float32(255.0)).astype(np.uint8)
