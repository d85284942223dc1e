"""Repairs and manhole covers in a road's lanes."""

from itertools import pairwise

import numpy as np

from oodscen.driving._roads.corridor import LaneStrip
from oodscen_pybullet._land.ribbons import LAYER_M, Ribbons
from oodscen_pybullet._land.ways import Way
from oodscen_pybullet._types import Point

_APART_M, _JITTER_M = 19.0, 7.0
"""Distance between places that may have something, and the most by which each is moved, m."""
_FIRST_M, _LAST_M = 8.0, 60.0
"""Distances of the first and the last place from the ends of the road, before they are moved, m."""
_BEFORE_M, _AFTER_M = 6.0, 1.0
"""Distances before and behind a tunnel or bridge within which nothing begins, m: a repair fits before it."""
_LEAST_WIDTH_M = 2.5
"""Width from which a lane has something, m."""
_MANHOLE_SHARE, _REPAIR_SHARE = 0.35, 0.30
"""Shares of the places that have a manhole cover and a repair; on roads without manholes both have a repair."""
_NO_MANHOLES_MPS = 20.0
"""Speed limit from which a road has no manholes, m/s."""
_ASIDE_M = 0.7
"""Largest distance of a manhole cover from the lane's middle, m."""
_RIM_M = 0.25
"""Distance of repairs from the lane's edges, m."""
_LENGTH_M, _INWARDS_M, _WIDTH_M = (1.2, 5.0), (0.0, 0.9), (0.7, 1.9)
"""Least and largest length of a repair, its distance from the rim at the right edge, and its width, m."""
_COVER = ((0.36, "asphalt_light", 0.003), (0.29, "asphalt_patch", 0.006))
"""Radius, colour and height of a manhole's frame and lid, m."""
_DIAGONAL = 0.7071
_OCTAGON = (
    (1.0, 0.0), (_DIAGONAL, _DIAGONAL), (0.0, 1.0), (-_DIAGONAL, _DIAGONAL),
    (-1.0, 0.0), (-_DIAGONAL, -_DIAGONAL), (0.0, -1.0), (_DIAGONAL, -_DIAGONAL),
)  # fmt: skip


def add_repairs_and_manholes(way: Way, ribbons: Ribbons, rng: np.random.Generator) -> None:
    """Add repairs and manhole covers to a road."""
    first, last = float(way.course.s[0]) + _FIRST_M, float(way.course.s[-1]) - _LAST_M
    for strip in way.corridor.strips:
        if strip.kind == "driving":
            for s in np.arange(first, last, _APART_M).tolist():
                place = s + float(rng.uniform(-_JITTER_M, _JITTER_M))
                _add_at(place, way, strip, ribbons, rng)


def _add_at(
    s: float, way: Way, strip: LaneStrip, ribbons: Ribbons, rng: np.random.Generator
) -> None:
    """Add a repair, a manhole cover or nothing at a place of a lane.

    A repair lies within the lane's edges all along it.
    """
    road = way.corridor
    draw = float(rng.uniform())
    if any(
        structure.start - _BEFORE_M < s < structure.end + _AFTER_M for structure in road.structures
    ):
        return
    right, left = _edges(way, strip, s, s)
    if left - right < _LEAST_WIDTH_M:
        return
    if draw < _MANHOLE_SHARE and road.speed_limit < _NO_MANHOLES_MPS:
        aside = float(rng.uniform(-_ASIDE_M, _ASIDE_M))
        _add_manhole(way, ribbons, s, 0.5 * (left + right) + aside)
    elif draw < _MANHOLE_SHARE + _REPAIR_SHARE:
        length = float(rng.uniform(*_LENGTH_M))
        inwards, width = float(rng.uniform(*_INWARDS_M)), float(rng.uniform(*_WIDTH_M))
        right, left = _edges(way, strip, s, s + length)
        if left - right < _LEAST_WIDTH_M:
            return
        low = right + _RIM_M + inwards
        high = min(left - _RIM_M, low + width)
        _add_repair(way, ribbons, (s, s + length), (low, high))


def _edges(way: Way, strip: LaneStrip, start: float, end: float) -> tuple[float, float]:
    """Return the innermost t of a lane's right and left edge between two s, m."""
    road = way.corridor
    s = [start, *road.s[(road.s > start) & (road.s < end)].tolist(), end]
    right, left = np.interp(s, road.s, strip.right), np.interp(s, road.s, strip.left)
    return float(right.max()), float(left.min())


def _add_repair(
    way: Way, ribbons: Ribbons, along: tuple[float, float], across: tuple[float, float]
) -> None:
    """Add a repair, bent where the asphalt is, between two s and two t, m."""
    start, end = along
    right, left = across
    bends = [s for s in way.course.s.tolist() if start < s < end]
    for first, last in pairwise([start, *bends, end]):
        corners = ((first, right), (last, right), (last, left), (first, left))
        ribbons.patch([_on_asphalt(way, s, t, LAYER_M) for s, t in corners], "asphalt_patch")


def _add_manhole(way: Way, ribbons: Ribbons, s: float, t: float) -> None:
    """Add the frame and the lid of a manhole, which slope as the asphalt does."""
    for radius, colour, height in _COVER:
        corners = [
            _on_asphalt(way, s + radius * along, t + radius * across, height)
            for along, across in _OCTAGON
        ]
        ribbons.patch(corners, colour)


def _on_asphalt(way: Way, s: float, t: float, height: float) -> Point:
    """Return a point at a height above the asphalt as it is drawn, m."""
    x, y, _, _ = way.corridor.point(s, t)
    return x, y, float(np.interp(s, way.course.s, way.course.z)) + height
