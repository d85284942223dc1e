"""Reflections in wet ground and standing water."""

import numpy as np

from oodscen.numerics._kernels import Kernel, inlined
from oodscen_pybullet._rendering.optics import mixed
from oodscen_pybullet._rendering.triangles import GROUND, MIRROR, SHELTERED, SOFT
from oodscen_pybullet._types import F32, I32, U8

_FARTHEST_M = np.float32(300.0)
"""Depth from which wet ground reflects nothing, m."""
_GRAZING, _LOWEST_EYE_M = 13.0 / 1.4, 0.1
"""Depth, in heights of the eye, at which the gain at grazing angles is half of that at the horizon; least height, m."""
_SMEAR, _RIPPLE = np.float32(0.93), np.float32(0.4)
"""Share of the reflection in the row above that is kept: by rough asphalt, by water."""
_WATER, _WATER_GRAZING = np.float32(0.26), np.float32(0.6)
"""Reflectivity of water seen from above, and what it gains at grazing angles."""
_SKY_M = np.float32(400.0)
"""Depth beyond which a pixel is sky, m."""
_PALE, _PALE_GREY = np.float32(0.7), np.float32(0.93)
"""Share of grey in mirrored sky, which is pale near the horizon, and the brightness of that grey."""
_LAMP = np.float32(205.0)
"""Value above which a pixel counts as a lamp."""


def grazing_depth(eye_height: float) -> np.float32:
    """Return the depth at which the gain at grazing angles is half, m, for an eye above the ground, m."""
    return np.float32(_GRAZING * max(eye_height, _LOWEST_EYE_M))


@inlined
def _mirrored_row(row: int, column: int, distance: np.float32, depth: F32, standing: I32) -> int:
    """Return the lowest row, from one upwards, that ground at a distance mirrors; -1 if there is none."""
    source: int = standing[row, column]
    while source >= 0 and depth[source, column] < distance:
        source = standing[source - 1, column] if source > 0 else -1
    return source


@Kernel
def add_reflections(
    image: U8,
    depth: F32,
    kinds: U8,
    half_m: np.float32,
    wet: np.float32,
    gain: np.float32,
    seed: np.uint32,
) -> None:
    """Reflect objects and the sky in wet ground.

    Every column is mirrored at one of its rows. Water is mirrored at its bank: the nearest row above that is neither
    water nor open ground. Wet asphalt is mirrored at the foot of what stands behind it, or at the horizon, and never
    shows other ground. What is nearer than the asphalt casts no reflection on it; the next thing above takes its
    place. Asphalt smears its reflections into streaks, and water keeps them sharp. Columns with nothing to mirror
    stay as they are.

    Args:
        image: [height, width, 3], changed in place.
        depth: [height, width], m.
        kinds: [height, width] surface flags: `triangles.MIRROR` and so on.
        half_m: Depth at which the gain at grazing angles is half of that at the horizon, m; see `grazing_depth`.
        wet: Reflectivity of wet ground at grazing angles, 0 to 1; 0 is dry.
        gain: Brightness of lamps relative to their pixels: 0 by day, when the sky outshines them.
        seed: Seed of the surface roughness.
    """
    height, width = depth.shape
    one, zero = np.float32(1.0), np.float32(0.0)
    # The lowest row so far that water, and that wet ground, is mirrored at; and the latter for every pixel.
    bank, foot = np.full(width, -1, np.int32), np.full(width, -1, np.int32)
    standing = np.empty((height, width), np.int32)
    is_blank = np.ones(width, np.bool_)  # The column has no reflection yet.
    reflection = np.zeros((width, 3), np.float32)
    for y in range(height):
        for x in range(width):
            distance, kind = depth[y, x], kinds[y, x]
            is_water = kind & MIRROR != 0
            is_open = kind & (GROUND | SHELTERED | SOFT) == GROUND and distance < _FARTHEST_M
            if kind & (GROUND | MIRROR) == 0:
                foot[x] = y
            standing[y, x] = foot[x]
            if not (is_water or is_open):
                bank[x], is_blank[x] = y, True
                continue
            mirror_row = bank[x] if is_water else foot[x]
            if mirror_row < 0 or (not is_water and wet <= zero):
                continue
            grazing = distance / (distance + half_m)
            if is_water:
                column, share, keep = x, _WATER + _WATER_GRAZING * grazing, _RIPPLE
            else:
                shift = int(mixed(np.uint32(y * width + x) ^ seed) % np.uint64(3)) - 1
                column = min(max(x + shift, 0), width - 1)
                share, keep = wet * grazing * grazing, _SMEAR
            source = max(2 * mirror_row + 1 - y, 0)
            if not is_water:
                source = _mirrored_row(source, column, distance, depth, standing)
                if source < 0:
                    continue
            if is_blank[x]:
                is_blank[x], keep = False, zero
            grey = np.float32(image[source, column, 0]) + np.float32(image[source, column, 1])
            grey = (grey + np.float32(image[source, column, 2])) * np.float32(1.0 / 3.0)
            # The sky near the horizon is paler than the sky above, and water is murky.
            pale = _PALE if depth[source, column] > _SKY_M else zero
            for channel in range(3):
                mirrored = np.float32(image[source, column, channel])
                mirrored += (grey * _PALE_GREY - mirrored) * pale
                # A lamp is far brighter than the largest value that a picture can hold.
                mirrored += gain * max(mirrored - _LAMP, zero)
                reflection[x, channel] = reflection[x, channel] * keep + mirrored * (one - keep)
                before = np.float32(image[y, x, channel])
                after = before + (reflection[x, channel] - before) * share
                image[y, x, channel] = np.uint8(min(after + np.float32(0.5), np.float32(255.0)))
