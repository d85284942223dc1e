"""Projection of many points onto a corridor at once."""

import numpy as np

from oodscen.driving._roads.corridor import Corridor
from oodscen.numerics._exact import Floats


def places(corridor: Corridor, x: Floats, y: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Return s and t of points of any shape on a road, and cosine and sine of the road's heading there.

    The places are those of `Corridor.locate`, except for the last bits.
    """
    shape, px, py = x.shape, x.reshape(-1), y.reshape(-1)
    norm = np.sqrt(corridor.cos * corridor.cos + corridor.sin * corridor.sin)
    cos, sin, step = corridor.cos / norm, corridor.sin / norm, corridor.step
    last = len(corridor.s) - 2
    coarse = np.arange(0, last + 2, 16)
    square = (px[:, None] - corridor.x[coarse]) ** 2 + (py[:, None] - corridor.y[coarse]) ** 2
    index = np.minimum(coarse[square.argmin(axis=1)], last)
    for _ in range(40):
        before = (px - corridor.x[index]) * cos[index] + (py - corridor.y[index]) * sin[index]
        after = (px - corridor.x[index + 1]) * cos[index + 1]
        after += (py - corridor.y[index + 1]) * sin[index + 1]
        back = -1 - np.minimum((-before / (2.0 * step)).astype(np.intp), 16)
        on = 1 + np.minimum((after / (2.0 * step)).astype(np.intp), 16)
        shift = np.where(before < 0.0, back, np.where(after > 0.0, on, 0))
        moved = np.clip(index + shift, 0, last)
        if np.array_equal(moved, index):
            break
        index = moved
    x0, y0, c0, s0 = corridor.x[index], corridor.y[index], cos[index], sin[index]
    dx, dy = corridor.x[index + 1] - x0, corridor.y[index + 1] - y0
    dc, ds = cos[index + 1] - c0, sin[index + 1] - s0
    span = before - after
    f = np.where(span > 0.0, before / np.where(span > 0.0, span, 1.0), 0.0)
    for _ in range(4):
        ax, ay = px - x0 - f * dx, py - y0 - f * dy
        hc, hs = c0 + f * dc, s0 + f * ds
        along = ax * hc + ay * hs
        slope = ax * dc + ay * ds - dx * hc - dy * hs
        f = f - np.where(slope == 0.0, 0.0, along / np.where(slope == 0.0, 1.0, slope))
    is_before, is_after = before < 0.0, after > 0.0
    f = np.where(is_before, 0.0, np.where(is_after, 1.0, f))
    hc, hs = c0 + f * dc, s0 + f * ds
    length = np.sqrt(hc * hc + hs * hs)
    hc, hs = hc / length, hs / length
    ax, ay = px - x0 - f * dx, py - y0 - f * dy
    s = (index + f) * step
    s = np.where(is_before, before, np.where(is_after, corridor.length + after, s))
    t = ay * hc - ax * hs
    return s.reshape(shape), t.reshape(shape), hc.reshape(shape), hs.reshape(shape)


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
