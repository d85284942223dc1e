"""Projection of many points onto a corridor at once."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from oodscen.driving._roads.corridor import Corridor
from oodscen.numerics._exact import Floats

_COARSE = 16
"""Samples of a road between those that the search for a segment begins with, and the most that it moves at once."""
_MOST_MOVES, _MOST_REFINEMENTS = 40, 4
"""Moves of the search for a segment, and steps of Newton's method within it."""


class _Segment(NamedTuple):
    """The segments of a corridor that points lie beside, and the points' way along them; all arrays are [n]."""

    begin: NDArray[np.intp]
    """Samples at which the segments begin."""
    before: Floats
    """Distance to the plane across the road at the segment's begin, m; negative in front of it."""
    after: Floats
    """The same at its end; positive beyond it."""


def places(corridor: Corridor, x: Floats, y: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Return s and t of points of any shape on a road, and cosine and sine of the road's heading there.

    The places are those of `Corridor.locate`, except for the last bits and for points to which several parts of
    a bent road are about equally near.
    """
    px, py = x.reshape(-1), y.reshape(-1)
    norm = np.sqrt(corridor.cos * corridor.cos + corridor.sin * corridor.sin)
    cos, sin = corridor.cos / norm, corridor.sin / norm
    segment = _nearest_segments(corridor, cos, sin, px, py)
    begin, end = segment.begin, segment.begin + 1
    x0, y0, cos0, sin0 = corridor.x[begin], corridor.y[begin], cos[begin], sin[begin]
    dx, dy = corridor.x[end] - x0, corridor.y[end] - y0
    dcos, dsin = cos[end] - cos0, sin[end] - sin0
    # The share of the segment at which the plane across the road, turned evenly along it, holds the point.
    span = segment.before - segment.after
    share = np.where(span > 0.0, segment.before / np.where(span > 0.0, span, 1.0), 0.0)
    for _ in range(_MOST_REFINEMENTS):
        ax, ay = px - x0 - share * dx, py - y0 - share * dy
        heading_cos, heading_sin = cos0 + share * dcos, sin0 + share * dsin
        along = ax * heading_cos + ay * heading_sin
        slope = ax * dcos + ay * dsin - dx * heading_cos - dy * heading_sin
        share = share - np.where(slope == 0.0, 0.0, along / np.where(slope == 0.0, 1.0, slope))
    is_in_front = (segment.before < 0.0) & (begin == 0)
    is_beyond = (segment.after > 0.0) & (begin == len(corridor.s) - 2)
    share = np.where(is_in_front, 0.0, np.where(is_beyond, 1.0, share))
    heading_cos, heading_sin = cos0 + share * dcos, sin0 + share * dsin
    length = np.sqrt(heading_cos * heading_cos + heading_sin * heading_sin)
    heading_cos, heading_sin = heading_cos / length, heading_sin / length
    ax, ay = px - x0 - share * dx, py - y0 - share * dy
    s = np.where(is_beyond, corridor.length + segment.after, (begin + share) * corridor.step)
    s = np.where(is_in_front, segment.before, s)
    t = ay * heading_cos - ax * heading_sin
    shape = x.shape
    return (
        s.reshape(shape),
        t.reshape(shape),
        heading_cos.reshape(shape),
        heading_sin.reshape(shape),
    )


def _nearest_segments(
    corridor: Corridor, cos: Floats, sin: Floats, x: Floats, y: Floats
) -> _Segment:
    """Return the segment beside each point, from the nearest of a few samples on.

    Args:
        corridor: The road.
        cos: [samples] cosine of its heading.
        sin: [samples] sine of it.
        x: [n] m
        y: [n] m
    """
    last = len(corridor.s) - 2
    coarse = np.arange(0, last + 2, _COARSE)
    squares = (x[:, None] - corridor.x[coarse]) ** 2 + (y[:, None] - corridor.y[coarse]) ** 2
    index = np.minimum(coarse[squares.argmin(axis=1)], last)
    # Beyond the centre of a bend, the distances alone would lead back and forth for ever.
    low, high = np.zeros_like(index), np.full_like(index, last)
    for _ in range(_MOST_MOVES):
        before = (x - corridor.x[index]) * cos[index] + (y - corridor.y[index]) * sin[index]
        after = (x - corridor.x[index + 1]) * cos[index + 1]
        after += (y - corridor.y[index + 1]) * sin[index + 1]
        back = -1 - _half_steps(-before, corridor.step)
        on = 1 + _half_steps(after, corridor.step)
        move = np.where(before < 0.0, back, np.where(after > 0.0, on, 0))
        high = np.where(before < 0.0, np.maximum(index - 1, low), high)
        low = np.where((before >= 0.0) & (after > 0.0), np.minimum(index + 1, high), low)
        moved = np.clip(index + move, low, high)
        if np.array_equal(moved, index):
            break
        index = moved
    return _Segment(index, before, after)


def _half_steps(distance: Floats, step: float) -> NDArray[np.intp]:
    """Return half of the samples in a distance, so that the search does not overshoot in a bend."""
    return np.minimum((distance / (2.0 * step)).astype(np.intp), _COARSE)


def lanes(corridor: Corridor, strip: int, s: Floats, t: Floats) -> Floats:
    """Return the number of lanes from a strip to every place, left positive; NaN off the lanes."""
    numbers = np.full(s.shape, np.nan)
    position = np.clip(s / corridor.step, 0.0, len(corridor.s) - 1.0)
    index = np.minimum(position.astype(np.intp), len(corridor.s) - 2)
    share = position - index
    origin = corridor.driving.index(strip)
    is_along = (s >= 0.0) & (s <= corridor.length)
    for number, driving in enumerate(corridor.driving):
        lane = corridor.strips[driving]
        right, left = (
            edge[index] + share * (edge[index + 1] - edge[index])
            for edge in (lane.right, lane.left)
        )
        numbers[is_along & (right <= t) & (t < left)] = number - origin
    return numbers
