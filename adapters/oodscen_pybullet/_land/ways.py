"""The roads of a map as they are drawn: their courses with their widths."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from oodscen.driving._roads.corridor import DRIVABLE, Corridor
from oodscen_pybullet._land.course import RoadCourse, is_fast
from oodscen_pybullet._types import Array

_ONWARD_M = 90.0
"""Length drawn beyond the end of a road that ends in the open, m."""
_OVERLAP = 0.6
"""Overlap of a road with its successors, m, which hides the seam."""
_MEETING = 8.0
"""Greatest distance between the end of a road and a road that it meets, m."""
_NARROW = 0.05
"""A strip no wider than this is not there, m."""
_ABSENT = 3.0
"""Distance from the edges of a road where it has none, m."""


@dataclass(frozen=True, eq=False)
class Way:
    """A road as drawn: its course and its width along it."""

    corridor: Corridor
    course: RoadCourse
    asphalt: tuple[Array, Array]
    """[n] t of the outermost edges of what is driven on, rails included, right and left."""
    paved: tuple[Array, Array]
    """[n] t of the outermost edges including pavements, right and left."""
    is_ego: bool
    is_connecting: bool
    """True if the road is only a path through a junction."""
    has_kerb: bool
    name: str

    @classmethod
    def of(
        cls, corridor: Corridor, course: RoadCourse, *, is_ego: bool, is_connecting: bool, name: str
    ) -> "Way":
        """Measure a road along its course."""
        firm = DRIVABLE | {"rail"}
        asphalt = _outline(corridor, course, firm)
        paved = _outline(corridor, course, firm | {"sidewalk"})
        kinds = {strip.kind for strip in corridor.strips}
        marks = {strip.mark for strip in corridor.strips} | {corridor.strips[0].right_mark}
        return cls(
            corridor=corridor,
            course=course,
            asphalt=asphalt,
            paved=(np.minimum(paved[0], asphalt[0]), np.maximum(paved[1], asphalt[1])),
            is_ego=is_ego,
            is_connecting=is_connecting,
            has_kerb="sidewalk" in kinds or "curb" in marks,
            name=name,
        )

    @property
    def is_track(self) -> bool:
        """Return whether it is a railway, on which nothing is for road users."""
        return all(strip.kind == "rail" for strip in self.corridor.strips)

    def asphalt_band(self) -> tuple[Array, Array]:
        """Return the right and left edge of the asphalt, [n, 2] each, extended slightly at both ends, m."""
        line = self.course
        reach = np.zeros((len(line.s), 1))
        reach[0], reach[-1] = -_OVERLAP, _OVERLAP
        along = reach * np.stack([line.cos, line.sin], axis=1)
        right, left = (line.points(edge)[:, :2] + along for edge in self.asphalt)
        return right, left

    def bounds(self, margin: float) -> tuple[float, float, float, float]:
        """Return the lowest and highest x and y of the area within a margin of the road, m."""
        reach = margin + max(float(np.abs(edge).max()) for edge in self.paved)
        x, y = self.course.x, self.course.y
        return (
            float(x.min()) - reach, float(x.max()) + reach,
            float(y.min()) - reach, float(y.max()) + reach,
        )  # fmt: skip

    def distances(self, s: Array, t: Array) -> tuple[Array, Array]:
        """Return the distances of points from the asphalt and from asphalt and pavements, m; negative inside."""
        line = self.course
        past = np.maximum(np.maximum(line.s[0] - s, s - line.s[-1]) - _OVERLAP, 0.0)
        is_past = bool(past.any())
        out = []
        for right, left in (self.asphalt, self.paved):
            a, b = np.interp(s, line.s, right), np.interp(s, line.s, left)
            away = np.where(b - a > _NARROW, np.maximum(a - t, t - b), _ABSENT)
            if is_past:
                side = np.maximum(away, 0.0)
                away = np.where(past > 0.0, np.sqrt(past * past + side * side), away)
            out.append(away)
        return out[0], out[1]


def ways_of(corridor: Corridor) -> tuple[Way, ...]:
    """Return all roads around the ego's corridor as drawn, the ego's first."""
    course = RoadCourse.of(corridor)
    ways = [Way.of(corridor, course, is_ego=True, is_connecting=False, name="ego")]
    for other in corridor.others:
        first, last = 0.0, other.corridor.length
        if not other.is_connecting:
            rest = [corridor, *(c.corridor for c in corridor.others if c is not other)]
            x, y = other.corridor.x, other.corridor.y
            first -= 0.0 if _meets(float(x[0]), float(y[0]), rest) else _ONWARD_M
            last += 0.0 if _meets(float(x[-1]), float(y[-1]), rest) else _ONWARD_M
        elif is_fast(corridor):
            # A motorway's lane ends within half a metre, where its exit takes it over.
            first, last = first - _OVERLAP, last + _OVERLAP
        ways.append(
            Way.of(
                other.corridor,
                RoadCourse.between(other.corridor, first, last),
                is_ego=False,
                is_connecting=other.is_connecting,
                name=other.road_id,
            )
        )
    return tuple(ways)


def _outline(corridor: Corridor, course: RoadCourse, kinds: frozenset[str]) -> tuple[Array, Array]:
    """Return t of the outermost edges of strips of some kinds; without such strips the edges coincide."""
    right, left = np.full(len(course.s), np.inf), np.full(len(course.s), -np.inf)
    for strip in corridor.strips:
        if strip.kind in kinds:
            a = np.interp(course.s, corridor.s, strip.right)
            b = np.interp(course.s, corridor.s, strip.left)
            is_there = b - a > _NARROW
            right = np.where(is_there, np.minimum(right, a), right)
            left = np.where(is_there, np.maximum(left, b), left)
    is_there = left > right
    return np.where(is_there, right, 0.0), np.where(is_there, left, 0.0)


def _meets(x: float, y: float, roads: Iterable[Corridor]) -> bool:
    """Return whether the end of a road touches one of the others."""
    return any(bool(((r.x - x) ** 2 + (r.y - y) ** 2).min() < _MEETING * _MEETING) for r in roads)
