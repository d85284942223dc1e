"""The roads of a map as they are drawn: their courses with their widths."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from oodscen.driving._roads.corridor import DRIVABLE, Corridor, LaneStrip
from oodscen_pybullet._land.course import RoadCourse, is_fast
from oodscen_pybullet._types import Array, Mask

_ONWARD_M = 90.0
"""Length drawn beyond the end of a road that ends in the open, m."""
_OVERLAP_M = 0.6
"""Overlap of a road with its successors, m, which hides the seam."""
_MEETING_M = 8.0
"""Distance from a sample of another road's reference line within which the end of a road meets that road, m."""
_NARROW_M = 0.05
"""A strip no wider than this is not there, m."""
_ABSENT_M = 3.0
"""Distance reported where a road has no carriageway, m; a margin above it takes that for too near."""


class Outline(NamedTuple):
    """The outermost edges of strips along a course."""

    right: Array
    """[n] t, m"""
    left: Array


class Bounds(NamedTuple):
    """An area parallel to the axes, m."""

    x_min: float
    x_max: float
    y_min: float
    y_max: float

    def contains(self, x: Array, y: Array) -> Mask:
        """Return which points lie inside."""
        is_within: Mask = (x > self.x_min) & (x < self.x_max) & (y > self.y_min) & (y < self.y_max)
        return is_within


class Distances(NamedTuple):
    """Distances of points from a road, m; negative inside."""

    carriageway: Array
    paved: Array
    """From the carriageway or the pavements."""


@dataclass(frozen=True, eq=False)
class Way:
    """A road: its course and its edges along it."""

    corridor: Corridor
    course: RoadCourse
    carriageway: Outline
    """The edges of what is driven on, rails included."""
    paved: Outline
    """The edges including pavements."""
    is_ego: bool
    """True if it is the ego's road."""
    is_connecting: bool
    """True if the road is only a path through a junction."""
    has_kerb: bool

    @classmethod
    def of(
        cls, corridor: Corridor, course: RoadCourse, *, is_ego: bool, is_connecting: bool
    ) -> "Way":
        """Measure a road along its course."""
        firm = DRIVABLE | {"rail"}
        kinds = {strip.kind for strip in corridor.strips}
        marks = {strip.mark for strip in corridor.strips} | {corridor.strips[0].right_mark}
        return cls(
            corridor=corridor,
            course=course,
            carriageway=_outline(corridor, course, firm),
            paved=_outline(corridor, course, firm | {"sidewalk"}),
            is_ego=is_ego,
            is_connecting=is_connecting,
            has_kerb="sidewalk" in kinds or "curb" in marks,
        )

    @property
    def is_track(self) -> bool:
        """True if it is a railway, on which nothing is for road users."""
        return all(strip.kind == "rail" for strip in self.corridor.strips)

    def carriageway_band(self) -> tuple[Array, Array]:
        """Return the right and left edge of the carriageway, [n, 2] m each, lengthened by `_OVERLAP_M` at both ends."""
        course = self.course
        reach = np.zeros((len(course.s), 1))
        reach[0], reach[-1] = -_OVERLAP_M, _OVERLAP_M
        along = reach * np.stack([course.cos, course.sin], axis=1)
        right, left = (course.points(edge)[:, :2] + along for edge in self.carriageway)
        return right, left

    def bounds(self, margin: float) -> Bounds:
        """Return the bounds of the area within a margin of the road, m."""
        reach = margin + max(float(np.abs(edge).max()) for edge in self.paved)
        x, y = self.course.x, self.course.y
        return Bounds(
            x_min=float(x.min()) - reach,
            x_max=float(x.max()) + reach,
            y_min=float(y.min()) - reach,
            y_max=float(y.max()) + reach,
        )

    def distances(self, s: Array, t: Array) -> Distances:
        """Return the distances of points on the road's course."""
        course = self.course
        past = np.maximum(np.maximum(course.s[0] - s, s - course.s[-1]) - _OVERLAP_M, 0.0)
        return Distances(
            carriageway=_distance(course.s, self.carriageway, s, t, past),
            paved=_distance(course.s, self.paved, s, t, past),
        )


def ways_of(corridor: Corridor) -> tuple[Way, ...]:
    """Return all roads around the ego's corridor, the ego's first."""
    course = RoadCourse.of(corridor)
    ways = [Way.of(corridor, course, is_ego=True, is_connecting=False)]
    for other in corridor.others:
        first, last = 0.0, other.corridor.length
        if not other.is_connecting:
            neighbours = [corridor, *(o.corridor for o in corridor.others if o is not other)]
            x, y = other.corridor.x, other.corridor.y
            if not _meets(x[0], y[0], neighbours):
                first -= _ONWARD_M
            if not _meets(x[-1], y[-1], neighbours):
                last += _ONWARD_M
        elif is_fast(corridor):
            # A motorway's lane ends within half a metre, where its exit takes it over.
            first, last = first - _OVERLAP_M, last + _OVERLAP_M
        ways.append(
            Way.of(
                other.corridor,
                RoadCourse.between(other.corridor, first, last),
                is_ego=False,
                is_connecting=other.is_connecting,
            )
        )
    return tuple(ways)


def strip_edges(corridor: Corridor, course: RoadCourse, strip: LaneStrip) -> tuple[Array, Array]:
    """Return t of the right and left edges of a strip along a course."""
    return (
        np.interp(course.s, corridor.s, strip.right),
        np.interp(course.s, corridor.s, strip.left),
    )


def _outline(corridor: Corridor, course: RoadCourse, kinds: frozenset[str]) -> Outline:
    """Return the outermost edges of the strips of these kinds; without such strips they coincide."""
    right, left = np.full(len(course.s), np.inf), np.full(len(course.s), -np.inf)
    for strip in corridor.strips:
        if strip.kind in kinds:
            strip_right, strip_left = strip_edges(corridor, course, strip)
            is_wide = strip_left - strip_right > _NARROW_M
            right = np.where(is_wide, np.minimum(right, strip_right), right)
            left = np.where(is_wide, np.maximum(left, strip_left), left)
    is_there = left > right
    return Outline(np.where(is_there, right, 0.0), np.where(is_there, left, 0.0))


def _distance(along: Array, outline: Outline, s: Array, t: Array, past: Array) -> Array:
    """Return the distances of points from an outline, m; negative inside.

    Args:
        along: [n] s of the outline, m.
        outline: The edges.
        s: [m], m
        t: [m], m
        past: [m] distance beyond the ends of the road, m; 0 beside it.
    """
    right, left = np.interp(s, along, outline.right), np.interp(s, along, outline.left)
    away = np.where(left - right > _NARROW_M, np.maximum(right - t, t - left), _ABSENT_M)
    if not past.any():
        return away
    beside = np.maximum(away, 0.0)
    return np.where(past > 0.0, np.sqrt(past * past + beside * beside), away)


def _meets(x: float, y: float, roads: Iterable[Corridor]) -> bool:
    """Return whether the end of a road meets one of the others."""
    squares = (((road.x - x) ** 2 + (road.y - y) ** 2).min() for road in roads)
    return any(bool(square < _MEETING_M * _MEETING_M) for square in squares)
