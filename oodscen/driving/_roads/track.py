"""A corridor as arrays, with the look-ups used by kernels and by `Corridor`."""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from oodscen.driving._roads.coverage import Ranges
from oodscen.numerics._exact import atan2, sincos
from oodscen.numerics._kernels import Integers, Kernel, Numbers, is_compiled, part

Array = NDArray[np.float64]

_NOWHERE = (math.inf, -math.inf)
_ON_LINE_M = 1e-12
"""Distance along the line from a point's foot at which the foot is found, m."""


class Track(NamedTuple):
    """The arrays that look-ups on a corridor need."""

    samples: Numbers
    """[n, 6] x, y, z, cosine and sine of the heading, and curvature."""
    edges: Numbers
    """[n, 2 k] t of the right and left edges of every strip."""
    ranges: Numbers
    """[n, 2 r] low and high t of the drivable ranges; unused ranges contain nothing."""
    is_lane: Integers
    """[k] 1 for driving strips, otherwise 0."""
    driving: Integers
    """[d] indices of the driving strips at the start, from right to left."""
    step: float
    length: float
    is_even: bool
    """True if the cross-section is the same everywhere."""


def pack(
    samples: Array,
    edges: Array,
    drivable: Sequence[Ranges],
    *,
    lanes: Sequence[bool],
    driving: Sequence[int],
    step: float,
    length: float,
) -> Track:
    """Return a track of NumPy arrays; `lanes` is true for each driving strip."""
    most = max(1, max(map(len, drivable)))
    ranges = np.array(
        [[*at_sample, *[_NOWHERE] * (most - len(at_sample))] for at_sample in drivable],
        dtype=np.float64,
    )
    return Track(
        samples=samples,
        edges=edges,
        ranges=ranges.reshape(len(drivable), 2 * most),
        is_lane=np.array(lanes, dtype=np.int64),
        driving=np.array(driving, dtype=np.int64),
        step=step,
        length=length,
        is_even=bool((ranges == ranges[:1]).all()) and bool((edges == edges[:1]).all()),
    )


def for_kernels(track: Track) -> Track:
    """Return a track in the form that kernels take."""
    return track if is_compiled() else view_track(track)


def view_track(track: Track) -> Track:
    """Return a track that plain Python indexes quickly."""
    views: Any = {name: memoryview(getattr(track, name)) for name in Track._fields[:5]}
    return track._replace(**views)


@part
def nearest(track: Track, s: float) -> int:
    """Return the index of the sample nearest to `s`."""
    last = track.samples.shape[0] - 1
    position = s / track.step + 0.5
    if position <= 0.0:
        return 0
    return min(int(position), last)


@part
def point(track: Track, s: float, t: float) -> tuple[float, float, float, float, float]:
    """Return x, y, z and the road's direction (cosine, sine) at a place; straight beyond the ends."""
    rows = track.samples
    position = s / track.step
    index = min(int(position), rows.shape[0] - 2) if position > 0.0 else 0
    f = min(max(position - index, 0.0), 1.0)
    cos = rows[index, 3] + f * (rows[index + 1, 3] - rows[index, 3])
    sin = rows[index, 4] + f * (rows[index + 1, 4] - rows[index, 4])
    norm = math.sqrt(cos * cos + sin * sin)
    cos /= norm
    sin /= norm
    beyond = s if s < 0.0 else s - track.length if s > track.length else 0.0
    return (
        rows[index, 0] + f * (rows[index + 1, 0] - rows[index, 0]) + beyond * cos - t * sin,
        rows[index, 1] + f * (rows[index + 1, 1] - rows[index, 1]) + beyond * sin + t * cos,
        rows[index, 2] + f * (rows[index + 1, 2] - rows[index, 2]),
        cos,
        sin,
    )


@part
def locate(track: Track, x: float, y: float, near: float) -> tuple[float, float]:
    """Return the place (s, t) of a point, searched around `near`."""
    rows, step = track.samples, track.step
    last = rows.shape[0] - 2
    index = min(max(int(near / step), 0), last)
    low, high = 0, last
    # Beyond the centre of a bend, the distances alone would lead back and forth for ever.
    while True:
        before = (x - rows[index, 0]) * rows[index, 3] + (y - rows[index, 1]) * rows[index, 4]
        if before < 0.0 and index > low:
            high = index - 1
            index = max(high - int(min(-before / (2.0 * step), float(last))), low)
            continue
        ahead = index + 1
        after = (x - rows[ahead, 0]) * rows[ahead, 3] + (y - rows[ahead, 1]) * rows[ahead, 4]
        if after > 0.0 and index < high:
            low = index + 1
            index = min(low + int(min(after / (2.0 * step), float(last))), high)
            continue
        break
    x0, y0, c0, s0 = rows[index, 0], rows[index, 1], rows[index, 3], rows[index, 4]
    if before < 0.0:
        return before, (y - y0) * c0 - (x - x0) * s0
    x1, y1 = rows[index + 1, 0], rows[index + 1, 1]
    c1, s1 = rows[index + 1, 3], rows[index + 1, 4]
    if after > 0.0:
        return track.length + after, (y - y1) * c1 - (x - x1) * s1
    f = before / (before - after) if before > after else 0.0
    cos, sin = c0, s0
    for _ in range(4):
        dx, dy = x - x0 - f * (x1 - x0), y - y0 - f * (y1 - y0)
        cos, sin = c0 + f * (c1 - c0), s0 + f * (s1 - s0)
        along = dx * cos + dy * sin
        slope = dx * (c1 - c0) + dy * (s1 - s0) - (x1 - x0) * cos - (y1 - y0) * sin
        if slope == 0.0 or abs(along) < _ON_LINE_M:
            break
        f -= along / slope
    norm = math.sqrt(cos * cos + sin * sin)
    dx, dy = x - x0 - f * (x1 - x0), y - y0 - f * (y1 - y0)
    return (index + f) * step, (dy * cos - dx * sin) / norm


@Kernel
def locate_each(
    track: Track, x: Numbers, y: Numbers, near: Numbers, s: Numbers, t: Numbers
) -> None:
    """Fill in the places (s, t) of points, each searched around its `near`."""
    for index in range(x.shape[0]):
        s[index], t[index] = locate(track, x[index], y[index], near[index])


@part
def heading(track: Track, s: float) -> float:
    """Return the road's heading at the sample nearest to `s`, rad."""
    index = nearest(track, s)
    return atan2(track.samples[index, 4], track.samples[index, 3])


@part
def alignment(track: Track, s: float, yaw: float) -> float:
    """Return the cosine of the angle between the road at `s` and a direction."""
    index = nearest(track, s)
    sine, cosine = sincos(yaw)
    return track.samples[index, 3] * cosine + track.samples[index, 4] * sine


@part
def bend(track: Track, s: float) -> float:
    """Return the reference line's curvature at `s`, 1/m; 0 beyond the ends."""
    if s < 0.0 or s > track.length:
        return 0.0
    return track.samples[nearest(track, s), 5]


@part
def stretch(track: Track, s: float, t: float) -> float:
    """Return the length of the line at a constant offset `t` per metre of the reference line, at least 0.2."""
    return max(0.2, 1.0 - bend(track, s) * t)


@part
def curvature(track: Track, s: float, t: float) -> float:
    """Return the curvature of the line at a constant offset `t`, 1/m."""
    return bend(track, s) / stretch(track, s, t)


@part
def edges(track: Track, strip: int, s: float) -> tuple[float, float]:
    """Return t of a strip's right and left edges at `s`."""
    rows = track.edges
    last = rows.shape[0] - 1
    position = min(max(s / track.step, 0.0), last - 0.0)
    index = min(int(position), last - 1)
    f = position - index
    right, left = rows[index, 2 * strip], rows[index, 2 * strip + 1]
    return (
        right + f * (rows[index + 1, 2 * strip] - right),
        left + f * (rows[index + 1, 2 * strip + 1] - left),
    )


@part
def centre(track: Track, strip: int, s: float) -> float:
    """Return t of a strip's centre at `s`."""
    right, left = edges(track, strip, s)
    return 0.5 * (right + left)


@part
def is_drivable(track: Track, s: float, low: float, high: float) -> bool:
    """Return whether the road is drivable everywhere between two offsets at `s`."""
    index = nearest(track, s)
    for column in range(0, track.ranges.shape[1], 2):
        if track.ranges[index, column] <= low and high <= track.ranges[index, column + 1]:
            return True
    return False


@part
def drivable_range(track: Track, s: float, t: float) -> tuple[bool, float, float]:
    """Return whether the road around `t` is drivable, and its right and left limits."""
    index = nearest(track, s)
    for column in range(0, track.ranges.shape[1], 2):
        low, high = track.ranges[index, column], track.ranges[index, column + 1]
        if low <= t <= high:
            return True, low, high
    return False, t, t


@part
def neighbour(track: Track, strip: int, s: float, side: int) -> int:
    """Return the driving strip adjacent to `strip` on one side, or -1."""
    right, left = edges(track, strip, s)
    edge = left if side > 0 else right
    other = strip + side
    while 0 <= other < track.is_lane.shape[0]:
        right, left = edges(track, other, s)
        if left - right > 0.5:
            touches = abs((right if side > 0 else left) - edge) < 0.3
            return other if touches and track.is_lane[other] == 1 else -1
        other += side
    return -1
