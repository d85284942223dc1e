"""The boxes of bodies that pitch and roll about a point of their middle axis."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from oodscen.driving._motion import columns as col
from oodscen.driving._motion.bodies import Situation
from oodscen.numerics._exact import sincos
from oodscen.numerics._kernels import part


class TiltedBox(NamedTuple):
    """The upright box around a tilted body, along its heading."""

    x: float
    """Centre ahead of the body's place, m."""
    y: float
    """Centre to the left of it, m."""
    half_length: float
    half_width: float
    low: float
    """Height of the underside above the road, m."""
    high: float
    """Height of the top above the road, m."""


@part
def tilted_box(w: Situation, i: int) -> TiltedBox:
    """Return the upright box around a body: first rolled, then pitched (ISO 8855)."""
    state, traits = w.state, w.traits
    sp, cp = sincos(state[i, col.PITCH])
    sr, cr = sincos(state[i, col.ROLL])
    length, width = 0.5 * traits[i, col.LENGTH], 0.5 * traits[i, col.WIDTH]
    height, pivot = 0.5 * traits[i, col.HEIGHT], traits[i, col.PIVOT]
    above = height - pivot
    half_height = length * abs(sp) + width * abs(cp * sr) + height * abs(cp * cr)
    middle = state[i, col.LIFT] + pivot + above * cr * cp
    return TiltedBox(
        above * cr * sp,
        -above * sr,
        length * abs(cp) + width * abs(sp * sr) + height * abs(sp * cr),
        width * abs(cr) + height * abs(sr),
        middle - half_height,
        middle + half_height,
    )


def tilts(
    state: NDArray[np.float64], traits: NDArray[np.float64]
) -> dict[int, tuple[float, float, float]]:
    """Return pitch and roll, rad, and the height about which it turns, m, of every tilted body by row."""
    angles = state[:, col.PITCH : col.ROLL + 1]
    return {
        row: (float(angles[row, 0]), float(angles[row, 1]), float(traits[row, col.PIVOT]))
        for row in np.flatnonzero(angles.any(axis=1)).tolist()
    }
