"""The light that lamps cast on the ground in the dark."""

import math
from collections.abc import Sequence

import numpy as np

from oodscen_pybullet._lighting.light import Light
from oodscen_pybullet._meshes.mesh import Lamp
from oodscen_pybullet._rendering.plate import GRID_AHEAD, GRID_ASIDE, GRID_CELL_M
from oodscen_pybullet._rendering.view import CameraView
from oodscen_pybullet._types import F32

_DARK_ENOUGH = 0.3
"""Darkness from which lamps light the ground."""
_HEADLAMP_POWER = 3.5
"""Least power with which a directional lamp casts a cone of light."""
_STREET_M, _CONE_M, _ROUND_M = 26.0, 45.0, 9.0
"""Reach of a street lamp, of a cone, and of any other lamp of power 1, m."""
_STREET_LIGHT, _STREET_FALL = np.float32(0.62), np.float32(1.0 / 55.0)
"""Light below a street lamp, and its fall with the square of the distance, 1/m^2."""
_CONE_LIGHT, _CONE_FALL = 0.20, np.float32(1.0 / 170.0)
"""Light of a cone per power, and its fall, 1/m^2."""
_CONE_SLOPE, _CONE_START_M = np.float32(0.38), np.float32(0.05)
"""Half the width of a cone per metre along it, and the distance from which it widens, m."""
_ROUND_LIGHT, _ROUND_FALL = 0.16, np.float32(0.4)
"""Light of any other lamp per power, and its fall, 1/m^2."""
_BACKWARDS_M = np.float32(-0.3)
"""Reach of a directional lamp without a cone behind itself, m, negative."""
_STEEP = 0.1
"""Level part of a lamp's direction up to which it looks straight up or down, and shines all round."""
_ZERO, _ONE = np.float32(0.0), np.float32(1.0)

_Facing = tuple[float, float]
"""A lamp's direction seen from above, to the camera's right and forward, of length 1; (0, 0) shines all round."""


def ground_light(view: CameraView, lamps: Sequence[Lamp], light: Light) -> F32 | None:
    """Return the lamps' light on surfaces around the camera, most of them in front of it.

    Args:
        view: The camera.
        lamps: All lamps.
        light: The light of the scene; by day lamps illuminate nothing.

    Returns:
        [GRID_AHEAD, GRID_ASIDE, 3] by level cells ahead and to the right, with the camera over the row
        `camera_row` and the middle column; `None` if the lamps add nothing.
    """
    dark = 1.0 - light.daylight
    if dark < _DARK_ENOUGH:
        return None
    grid = np.zeros((GRID_AHEAD, GRID_ASIDE, 3), np.float32)
    for lamp in lamps:
        _add_pool(grid, view, lamp, np.float32(dark))
    return grid if grid.any() else None


def camera_row(view: CameraView) -> int:
    """Return the row of the grid that the camera is over: the first, or a later one the more it looks down."""
    return round(GRID_AHEAD / 2 * max(-view.forward[2], 0.0) ** 2)


def _add_pool(grid: F32, view: CameraView, lamp: Lamp, dark: np.float32) -> None:
    """Add a lamp's light to the grid.

    Args:
        grid: [GRID_AHEAD, GRID_ASIDE, 3], changed in place.
        view: The camera.
        lamp: The lamp.
        dark: Darkness of the scene, 0 to 1.
    """
    aside, ahead = view.to_level(lamp.position)
    first = camera_row(view)
    facing = _facing(view, lamp)
    reach = _reach(lamp, facing)
    rows = _cells(ahead, reach, first, GRID_AHEAD)
    columns = _cells(aside, reach, GRID_ASIDE / 2, GRID_ASIDE)
    if not (rows and columns):
        return
    cell = np.float32(GRID_CELL_M)
    y = ((np.array(rows, np.float32) - np.float32(first)) * cell - np.float32(ahead))[:, None]
    x = np.array(columns, np.float32) - np.float32(GRID_ASIDE / 2)
    x = (x * cell - np.float32(aside))[None, :]
    rim = np.maximum(_ONE - (x * x + y * y) * np.float32(1.0 / reach**2), _ZERO)
    pool = _pool(lamp, facing, x, y) * (rim * dark)
    part = grid[rows.start : rows.stop, columns.start : columns.stop]
    part += pool[..., None] * np.array(lamp.colour, np.float32)


def _facing(view: CameraView, lamp: Lamp) -> _Facing:
    """Return where a lamp shines; its tilt does not shorten the way."""
    x, y, _ = lamp.facing
    if x * x + y * y <= _STEEP * _STEEP:
        return (0.0, 0.0)
    right, forward = view.level(x, y)
    length = math.sqrt(right * right + forward * forward)
    return (right / length, forward / length)


def _has_cone(lamp: Lamp, facing: _Facing) -> bool:
    """Return whether a lamp casts a cone of light, as headlamps do."""
    return lamp.power >= _HEADLAMP_POWER and facing != (0.0, 0.0) and not lamp.is_street


def _reach(lamp: Lamp, facing: _Facing) -> float:
    """Return the distance at which a lamp's light ends, m; at least a cell of the grid."""
    if lamp.is_street:
        return _STREET_M
    if _has_cone(lamp, facing):
        return _CONE_M
    return max(_ROUND_M * math.sqrt(lamp.power), GRID_CELL_M)


def _cells(middle: float, reach: float, zero: float, count: int) -> range:
    """Return the cells of an axis of the grid within reach of a place on it, m."""
    first = max(math.floor((middle - reach) / GRID_CELL_M + zero), 0)
    return range(first, min(math.ceil((middle + reach) / GRID_CELL_M + zero) + 1, count))


def _pool(lamp: Lamp, facing: _Facing, x: F32, y: F32) -> F32:
    """Return a lamp's light at places to the right, [1, m], and ahead of it, [n, 1], m."""
    square = np.asarray(x * x + y * y, np.float32)
    if lamp.is_street:
        fall = _ONE + square * _STREET_FALL
        return np.asarray(_STREET_LIGHT / (fall * fall))
    along = np.asarray(x * np.float32(facing[0]) + y * np.float32(facing[1]))
    if _has_cone(lamp, facing):
        across = square - along * along
        width = np.maximum(along, _CONE_START_M) * _CONE_SLOPE
        shape = _ONE + across / (width * width)
        pool = np.float32(_CONE_LIGHT * lamp.power) / (shape * shape)
        pool /= _ONE + along * along * _CONE_FALL
        return np.asarray(pool * (along > _ZERO))
    pool = np.float32(_ROUND_LIGHT * lamp.power) / (_ONE + square * _ROUND_FALL)
    is_lit = along > _BACKWARDS_M if facing != (0.0, 0.0) else True
    return np.asarray(pool * is_lit)
