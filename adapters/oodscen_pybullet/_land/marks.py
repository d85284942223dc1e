"""The paint on roads: lane marks, the bays of parking strips, crosswalks and stop lines."""

import itertools
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from oodscen.driving._roads.corridor import LaneStrip, PaintedArea
from oodscen_pybullet._land.course import RoadCourse, piece_length
from oodscen_pybullet._land.ground import Ground
from oodscen_pybullet._land.polygons import (
    is_convex,
    rectangle_around,
    without_straight_corners,
)
from oodscen_pybullet._land.ribbons import PAINT_M, Ribbons, spanned_pieces, whole_pieces
from oodscen_pybullet._land.theme import Theme
from oodscen_pybullet._land.ways import Way, strip_edges
from oodscen_pybullet._types import Array, Mask, Strings

_HALF_WIDTH_M, _HALF_WIDTH_DOUBLE_M = 0.075, 0.06
"""Half the width of a single line, and of each line of a double one, m."""
_DOUBLE_M = 0.14
"""Distance of each line of a double one from their middle, m."""
_LANE_M = 0.3
"""Width above which a lane has marks, m."""
_JUMP_M = 1.0
"""Sideways step of an edge from which it has no mark, m: a lane ends there at once."""
_MOUTH_M = 9.0
"""Marks end at a crosswalk that is at most this far from its junction, m."""
_TOUCH_M = 0.05
"""Overlap with a crosswalk from which a piece counts as below it, m."""
_BAY_M = 6.0
"""Length of a parking bay, m."""
_BAY_WIDTH_M = 1.5
"""Width above which a parking strip has bays, m."""
_BAY_LINE_M = 0.05
"""Half the width of the line between two bays, m."""
_STRIPE_M = 1.0
"""Distance between the stripes of a zebra, m, each half as wide."""
_ABOVE_M = 0.002
"""Height of crosswalks and stop lines above other paint, m."""


def mark_lanes(
    way: Way, ribbons: Ribbons, layer: float, outlines: Sequence[PaintedArea], theme: Theme
) -> None:
    """Paint the marks on lane edges, in junctions only on motorways, and the bays of parking.

    Args:
        way: The road.
        ribbons: Where to add the paint.
        layer: Height of the road's asphalt, m.
        outlines: Crosswalks and stop lines, which interrupt the marks.
        theme: The kind of land.
    """
    is_marked = (_junction_share(way) < 0.5) | (theme == "highway")
    free = whole_pieces(is_marked) & ~_interrupted(way, outlines)
    dark = spanned_pieces(way, "tunnel")
    height = layer + PAINT_M
    for mark in _edge_marks(way):
        double, single = free & mark.double, free & mark.single
        for side in (-_DOUBLE_M, _DOUBLE_M):
            _line(ribbons, mark.t + side, _HALF_WIDTH_DOUBLE_M, height, double, dark)
        _line(ribbons, mark.t, _HALF_WIDTH_M, height, single, dark)
    for strip in way.corridor.strips:
        if strip.kind == "parking":
            _bays(way, ribbons, strip, height, is_marked)


class _EdgeMark(NamedTuple):
    """The marks along one edge of a strip."""

    t: Array
    """[n] the edge's lateral offset, m."""
    single: Mask
    """[n - 1] the pieces that carry a single line."""
    double: Mask
    """[n - 1] the pieces that carry a double line."""


def _edge_marks(way: Way) -> Iterator[_EdgeMark]:
    """Yield the marks of a road from right to left: the rightmost edge, then the left one of each strip."""
    course, strips = way.course, way.corridor.strips
    right, left = strip_edges(way.corridor, course, strips[0])
    dashes = _dashes(course, piece_length(way.corridor))
    marks = _marks_along(course, strips[0], is_left=False)
    painted = _painted(marks, dashes, right, left - right)
    yield _EdgeMark(right, painted, np.zeros_like(painted))
    for strip, neighbour in itertools.zip_longest(strips, strips[1:]):
        right, left = strip_edges(way.corridor, course, strip)
        marks = _marks_along(course, strip, is_left=True)
        painted = _painted(marks, dashes, left, left - right)
        is_double = (marks == "solid") & _parts_directions(strip, neighbour)
        yield _EdgeMark(left, painted & ~is_double, painted & is_double)


def _marks_along(course: RoadCourse, strip: LaneStrip, *, is_left: bool) -> Strings:
    """Return the mark on one edge of a strip along every piece, [n - 1]."""
    changes = strip.mark_changes or ((0.0, strip.mark, strip.right_mark),)
    index = np.searchsorted([s for s, _, _ in changes], course.middles, side="right") - 1
    marks = np.array([left if is_left else right for _, left, right in changes])
    return marks[np.maximum(index, 0)]


def _painted(marks: Strings, dashes: Mask, edge: Array, width: Array) -> Mask:
    """Return the pieces along which the edge of a strip of some width, [n], carries paint."""
    where = whole_pieces(width > _LANE_M) & (np.abs(np.diff(edge)) < _JUMP_M)
    is_painted: Mask = (marks == "solid") | ((marks == "broken") & dashes)
    return where & is_painted


def _junction_share(way: Way) -> Array:
    """Return how much of each sample lies in a junction: [n], 0 to 1."""
    road = way.corridor
    return np.interp(way.course.s, road.s, road.in_junction.astype(np.float64))


def _interrupted(way: Way, outlines: Sequence[PaintedArea]) -> Mask:
    """Return which pieces lie below a crosswalk or stop line, or between it and the junction.

    They have no marks over the whole width of the road.
    """
    course, road = way.course, way.corridor
    is_interrupted = np.zeros(len(course.s) - 1, bool)
    mouths = [0.0, road.length, *course.s[_junction_share(way) > 0.5].tolist()]
    for outline in outlines:
        corners = outline.points[:-1]
        middle = corners.mean(axis=0)
        s, t = road.locate(float(middle[0]), float(middle[1]))
        right = float(np.interp(s, course.s, way.carriageway.right))
        left = float(np.interp(s, course.s, way.carriageway.left))
        if not (0.0 <= s <= road.length and right < t < left):
            continue
        ends = [road.locate(x, y)[0] for x, y in corners.tolist()]
        ends += [mouth for mouth in mouths if abs(mouth - s) < _MOUTH_M]
        first, last = min(ends) + _TOUCH_M, max(ends) - _TOUCH_M
        is_interrupted |= (course.s[1:] > first) & (course.s[:-1] < last)
    return is_interrupted


def _dashes(course: RoadCourse, length: float) -> Mask:
    """Return the pieces that a broken mark paints: one in three of those of a length, m, with all parts of it."""
    first = float(course.s[0])
    numbers = np.floor(first / length + 0.5) + np.floor((course.middles - first) / length)
    return np.asarray(numbers % 3 == 0)


def _line(
    ribbons: Ribbons, t: Array, half_width: float, height: float, where: Mask, dark: Mask
) -> None:
    """Paint a line in the open, and in another colour in tunnels."""
    heights = (height, height)
    ribbons.band(t - half_width, t + half_width, "mark", heights=heights, where=where & ~dark)
    ribbons.band(t - half_width, t + half_width, "mark_tunnel", heights=heights, where=where & dark)


def _parts_directions(strip: LaneStrip, neighbour: LaneStrip | None) -> bool:
    """Return whether a strip and the one on its left are lanes of opposite directions."""
    if neighbour is None:
        return False
    are_lanes = strip.kind == neighbour.kind == "driving"
    return are_lanes and strip.direction != neighbour.direction


def _bays(way: Way, ribbons: Ribbons, strip: LaneStrip, height: float, is_marked: Mask) -> None:
    """Paint the lines between the bays of a parking strip."""
    course, half = way.course, _BAY_LINE_M
    right, left = strip_edges(way.corridor, course, strip)
    has_bays = (is_marked & (left - right > _BAY_WIDTH_M)).astype(np.float64)
    columns = (has_bays, course.x, course.y, course.z, course.cos, course.sin, right, left)
    count = int((course.s[-1] - course.s[0]) / _BAY_M) + 1
    for s in (course.s[0] + _BAY_M * np.arange(count)).tolist():
        is_bay, x, y, z, cos, sin, first, last = (
            float(np.interp(s, course.s, column)) for column in columns
        )
        if is_bay < 1.0:
            continue
        points = [
            (x + along * cos - t * sin, y + along * sin + t * cos, z + height)
            for along, t in ((-half, first), (half, first), (half, last), (-half, last))
        ]
        ribbons.patch(points, "mark_worn")


def paint_crossings(ground: Ground, ribbons: Ribbons) -> None:
    """Paint crosswalks as zebras, and stop lines."""
    for outline in ground.corridor.crosswalks:
        outer = without_straight_corners(outline.points[:-1])
        if len(outer) < 3:
            continue
        is_line = outline.kind == "stop_line"
        if not is_convex(outer) or (len(outer) != 4 and not is_line):
            outer = rectangle_around(outer)
        x, y = outer[:, 0], outer[:, 1]
        corners = np.stack([x, y, ground.near(x, y).z + PAINT_M + _ABOVE_M], axis=1)
        if is_line:
            ribbons.patch(corners, "mark")
        else:
            _paint_zebra(corners, ribbons)


def _paint_zebra(corners: Array, ribbons: Ribbons) -> None:
    """Paint stripes across the longer sides of a quadrilateral, [4, 3]."""
    sides = corners - np.roll(corners, 1, axis=0)
    if (sides[1] ** 2).sum() < (sides[2] ** 2).sum():
        corners = np.roll(corners, -1, axis=0)
    a, b, c, d = corners
    length = float(np.sqrt(((b - a) ** 2).sum()))
    count = max(1, int(length / _STRIPE_M))
    for index in range(count):
        low, high = (index + 0.25) / count, (index + 0.75) / count
        stripe = [a + low * (b - a), a + high * (b - a), d + high * (c - d), d + low * (c - d)]
        ribbons.patch(np.array(stripe), "mark")
