"""The parts of a corridor's cross-sections that strips of other roads cover."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
Ranges = tuple[tuple[float, float], ...]
"""Disjoint ranges of t, ascending, m."""

REACH_M = 170.0
"""Maximum distance of other roads to the side of a corridor, m."""
_TOUCH = 0.05
"""Distance between two ranges below which they are merged, m."""
_MAX_SPAN_M = 40.0
_ROUNDING = 1e-9
"""Part of a step, or of an edge, that is rounding; an edge shorter than that in s is level, m."""
_NARROW_M = 1e-6
"""Width up to which a range of t is empty, m."""


class OverlapStrip(NamedTuple):
    """A strip of another road, sample by sample, in the corridor's coordinates."""

    right: tuple[FloatArray, FloatArray]
    """s and t of the right edge, m."""
    left: tuple[FloatArray, FloatArray]


def covered_ranges(
    bands: Iterable[OverlapStrip], step: float, count: int
) -> dict[int, list[tuple[float, float]]]:
    """Return the ranges of t that strips of other roads cover, by sample of a corridor.

    The corridor has `count` samples, `step` m apart.
    """
    samples: list[NDArray[np.int64]] = []
    lows: list[FloatArray] = []
    highs: list[FloatArray] = []
    for band in bands:
        s, t = (
            np.stack([right[:-1], left[:-1], left[1:], right[1:]])
            for right, left in zip(band.right, band.left, strict=True)
        )
        low, high = s.min(axis=0), s.max(axis=0)
        usable = (high - low < _MAX_SPAN_M) & (np.abs(t).max(axis=0) < REACH_M)
        usable &= (high >= 0.0) & (low <= (count - 1) * step)
        s, t, low, high = s[:, usable], t[:, usable], low[usable], high[usable]
        if not len(low):
            continue
        first = np.ceil(low / step - _ROUNDING).astype(np.int64)
        last = np.floor(high / step + _ROUNDING).astype(np.int64)
        for number in range(int((last - first).max()) + 1):
            at = first + number
            chosen = (at <= last) & (at >= 0) & (at < count)
            if not chosen.any():
                continue
            ends = _crossing(s[:, chosen], t[:, chosen], at[chosen] * step)
            samples.append(at[chosen])
            lows.append(ends[0])
            highs.append(ends[1])
    if not samples:
        return {}
    every = np.concatenate(samples)
    low, high = np.concatenate(lows), np.concatenate(highs)
    real = high - low > _NARROW_M
    every, low, high = every[real], low[real], high[real]
    order = np.lexsort((low, every))
    ranges: dict[int, list[tuple[float, float]]] = {}
    for sample, a, b in zip(
        every[order].tolist(), low[order].tolist(), high[order].tolist(), strict=True
    ):
        extend(ranges.setdefault(sample, []), a, b)
    return ranges


def _crossing(s: FloatArray, t: FloatArray, at: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the lowest and highest t at which the lines s = `at` cross quadrilaterals."""
    low, high = np.full(at.shape, np.inf), np.full(at.shape, -np.inf)
    for index in range(4):
        s0, s1 = s[index], s[(index + 1) % 4]
        t0, t1 = t[index], t[(index + 1) % 4]
        across = s1 - s0
        level = np.abs(across) < _ROUNDING
        part = (at - s0) / np.where(level, 1.0, across)
        hits = ~level & (part >= -_ROUNDING) & (part <= 1.0 + _ROUNDING)
        value = t0 + np.clip(part, 0.0, 1.0) * (t1 - t0)
        low = np.where(hits, np.minimum(low, value), low)
        high = np.where(hits, np.maximum(high, value), high)
    return low, high


def union_of(own: Sequence[tuple[float, float]], others: Sequence[tuple[float, float]]) -> Ranges:
    """Return the union of two ascending lists of ranges; touching ranges are merged."""
    ranges: list[tuple[float, float]] = []
    for low, high in sorted([*own, *others]):
        extend(ranges, low, high)
    return tuple(ranges)


def extend(
    ranges: list[tuple[float, float]], low: float, high: float, touch: float = _TOUCH
) -> None:
    """Add a range that begins no lower than the last one; ranges that touch are merged."""
    if ranges and low - ranges[-1][1] < touch:
        ranges[-1] = (ranges[-1][0], max(high, ranges[-1][1]))
    else:
        ranges.append((low, high))
