"""Cutting of triangles along a contour of a quantity stored at their corners."""

from collections.abc import Callable

import numpy as np

from oodscen_pybullet._types import Array

Place = Callable[[Array, Array], Array]
"""Returns the position of a cut between two corners, [n, k] each: [n] fractions of the way."""


def cut(
    corners: Array, column: int, level: float, place: Place | None = None
) -> tuple[Array, Array, Array]:
    """Cut triangles where one of their columns takes a value.

    Args:
        corners: [n, 3, k] columns of every corner.
        column: The column to cut by.
        level: The value at the cut.
        place: Returns the position of a cut between two corners; linear interpolation by default.

    Returns:
        The triangles below and those above, both with all columns and their orientation kept, and the
        cut itself, [m, 2, k]. Seen from above, the part below is on the left of the cut if triangles
        are counter-clockwise.
    """
    value = corners[:, :, column] - level
    is_above = value > 0.0
    count = is_above.sum(axis=1)
    below, above = [corners[count == 0]], [corners[count == 3]]
    cuts = []
    for lone_above in (True, False):
        rows = np.flatnonzero(count == (1 if lone_above else 2))
        is_lone = is_above[rows] if lone_above else ~is_above[rows]
        order = (is_lone.argmax(axis=1)[:, None] + np.arange(3)) % 3
        values = np.take_along_axis(value[rows], order, axis=1)
        a, b, c = np.take_along_axis(corners[rows], order[:, :, None], axis=1).swapaxes(0, 1)
        if place is None:
            ab = a + (values[:, 0] / (values[:, 0] - values[:, 1]))[:, None] * (b - a)
            ac = a + (values[:, 0] / (values[:, 0] - values[:, 2]))[:, None] * (c - a)
        else:
            shares = place(np.concatenate([a, a]), np.concatenate([b, c]))[:, None]
            ab, ac = a + shares[: len(a)] * (b - a), a + shares[len(a) :] * (c - a)
            ab[:, column] = ac[:, column] = level
        tip = np.stack([a, ab, ac], axis=1)
        rest = [np.stack([ab, b, c], axis=1), np.stack([ab, c, ac], axis=1)]
        if lone_above:
            above.append(tip)
            below += rest
            cuts.append(np.stack([ac, ab], axis=1))
        else:
            below.append(tip)
            above += rest
            cuts.append(np.stack([ab, ac], axis=1))
    return np.concatenate(below), np.concatenate(above), np.concatenate(cuts)
