"""The roads of a map: their courses, their heights, and the distance of points from asphalt."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from oodscen.driving._roads.corridor import DRIVABLE, Corridor
from oodscen_pybullet._land.cover import REACH, Cover, strips
from oodscen_pybullet._types import Array, Ints

STEP, FAST_STEP = 3.0, 6.0
"""Length of a piece of road and of a fast road, m; also the length of a dash of a broken mark."""
FAST = 19.0
"""Speed limit above which a road counts as fast, m/s."""
BEHIND = 60.0
"""Length of road drawn behind the ego's start, m."""
SEEN_M, DRIVEN_S = 400.0, 30.0
"""Sight distance, m, and driving time at the speed limit, s: the road is drawn this far ahead."""
TIGHT = 1 / 90
"""Curvature above which pieces are shorter, 1/m."""
ONWARD_M = 90.0
"""Length drawn beyond the end of a road that ends in the open, m."""
_OVERLAP = 0.6
"""Overlap of a road with its successors, m, which hides the seam."""
_BULGE = 0.03
"""Lane edges that bend by more than this within a piece make the pieces shorter, m."""
_JUMP = 0.5
"""Edges of the carriageway that change by more than this at once begin or end a lane, m."""
_NEAR = 60.0
"""Distances from asphalt beyond this are approximate, m."""
_ROUGH = 3.0
"""Largest overestimate of a distance measured across a road, m."""
_BLOCK = 400_000
"""Number of distances computed per batch."""


@dataclass(frozen=True, eq=False)
class RoadCourse:
    """A corridor's line, resampled for drawing and extended straight beyond its ends."""

    s: Array
    """[n], m; evenly spaced, with two extra samples per interval in tight bends and where widths change."""
    x: Array
    y: Array
    z: Array
    cos: Array
    sin: Array

    @classmethod
    def of(cls, corridor: Corridor) -> "RoadCourse":
        """Resample the ego's road from behind its start to the limit of sight."""
        first = max(0.0, corridor.start - BEHIND)
        return cls.between(
            corridor, first, corridor.start + DRIVEN_S * corridor.speed_limit + SEEN_M
        )

    @classmethod
    def between(cls, corridor: Corridor, first: float, last: float) -> "RoadCourse":
        """Resample a corridor from one s to another, extending it straight beyond its ends."""
        piece = FAST_STEP if corridor.speed_limit > FAST else STEP
        count = max(1, int((last - first) / piece + 0.5))
        step = piece if last - first >= piece else last - first
        s: Array = first + step * np.arange(count + 1, dtype=np.float64)
        s[-1] = max(last, float(s[-2]) + 0.25 * step)
        middle, long = 0.5 * (s[1:] + s[:-1]), np.diff(s)
        split = np.interp(middle, corridor.s, np.abs(corridor.curvature)) > TIGHT
        for strip in corridor.strips:
            for edge in (strip.right, strip.left):
                ends = np.interp(s, corridor.s, edge)
                bulge = np.interp(middle, corridor.s, edge) - 0.5 * (ends[1:] + ends[:-1])
                split |= np.abs(bulge) > _BULGE
        parts = [s[:-1], *((s[:-1] + k * long / 3)[split] for k in (1, 2)), s[-1:]]
        spans = [end for one in corridor.structures for end in (one.start, one.end)]
        if piece == FAST_STEP:
            # Where a lane leaves the road, a long piece would taper it and leave a hole beside it.
            spans += _jumps(corridor)
        parts.append(np.array([end for end in spans if first < end < last], np.float64))
        s = np.unique(np.concatenate(parts))
        inside = np.clip(s, 0.0, corridor.length)
        cos = np.interp(inside, corridor.s, corridor.cos)
        sin = np.interp(inside, corridor.s, corridor.sin)
        norm = np.sqrt(cos * cos + sin * sin)
        cos, sin = cos / norm, sin / norm
        beyond = s - inside
        return cls(
            s=s,
            x=np.interp(inside, corridor.s, corridor.x) + beyond * cos,
            y=np.interp(inside, corridor.s, corridor.y) + beyond * sin,
            z=np.interp(inside, corridor.s, corridor.z),
            cos=cos,
            sin=sin,
        )

    @property
    def middles(self) -> Array:
        """[n - 1], s of the middles of the pieces, m."""
        return np.asarray(0.5 * (self.s[1:] + self.s[:-1]))

    def points(self, t: Array | float, height: Array | float = 0.0) -> Array:
        """Return the points at lateral offset `t`, [n, 3]."""
        return np.stack([self.x - t * self.sin, self.y + t * self.cos, self.z + height], axis=1)


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

    @property
    def is_track(self) -> bool:
        """Return whether it is a railway, on which nothing is for road users."""
        return all(strip.kind == "rail" for strip in self.corridor.strips)

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


@dataclass(frozen=True, eq=False)
class Near:
    """The relation of points to the ground, one row per point."""

    asphalt: Array
    """Distance from the nearest asphalt, m; negative inside; approximate where far away or negative."""
    paved: Array
    """The same for asphalt and pavements."""
    z: Array
    """Height of the surrounding roads, m."""
    s: Array
    """Position along the ego's road, m."""
    t: Array
    """Offset to the left of the ego's reference line, m."""
    ego: Array
    """Distance from the asphalt of the ego's road, m."""


class Ground:
    """All roads of a map."""

    def __init__(self, corridor: Corridor) -> None:
        """Resample every road.

        Args:
            corridor: The ego's corridor with the others.
        """
        self.corridor = corridor
        course = RoadCourse.of(corridor)
        ego = Way.of(corridor, course, is_ego=True, is_connecting=False, name="ego")
        ends = [(other.corridor, _ends(other.corridor)) for other in corridor.others]
        ways = [ego]
        for other in corridor.others:
            first, last = 0.0, other.corridor.length
            if not other.is_connecting:
                head, tail = _ends(other.corridor)
                rest = [c for c, _ in ends if c is not other.corridor]
                first -= 0.0 if _meets(head, corridor, rest) else ONWARD_M
                last += 0.0 if _meets(tail, corridor, rest) else ONWARD_M
            elif corridor.speed_limit > FAST:
                # A motorway's lane ends within half a metre, where its exit takes it over.
                first, last = first - _OVERLAP, last + _OVERLAP
            course = RoadCourse.between(other.corridor, first, last)
            ways.append(
                Way.of(
                    other.corridor,
                    course,
                    is_ego=False,
                    is_connecting=other.is_connecting,
                    name=other.road_id,
                )
            )
        self.ways: tuple[Way, ...] = tuple(ways)
        self.kerbed = any(way.has_kerb for way in ways)
        self._bounds = [_bounds(way) for way in ways]
        self._along: dict[tuple[float, float], tuple[float, float]] = {}
        self._free: dict[tuple[tuple[float, ...], tuple[float, ...], float], bool] = {}
        self._asphalt = Cover(strips([_band(way, way.asphalt) for way in ways]))

    @property
    def ego(self) -> Way:
        """The ego's road."""
        return self.ways[0]

    def near(self, x: Array, y: Array) -> Near:
        """Return distances and heights of points.

        Args:
            x: [n], m
            y: [n], m
        """
        count = len(x)
        asphalt, paved = np.full(count, 1e4), np.full(count, 1e4)
        weight, height = np.zeros(count), np.zeros(count)
        s, t, ego = np.zeros(count), np.zeros(count), np.zeros(count)
        x0, x1, y0, y1 = float(x.min()), float(x.max()), float(y.min()), float(y.max())
        for way, bounds in zip(self.ways, self._bounds, strict=True):
            line = way.course
            if way.is_ego:
                rows = np.arange(count)
            else:
                low_x, high_x, low_y, high_y = bounds
                if x1 < low_x or x0 > high_x or y1 < low_y or y0 > high_y:
                    continue
                inside = (x > low_x) & (x < high_x) & (y > low_y) & (y < high_y)
                rows = np.flatnonzero(inside)
            if len(rows) == 0:
                continue
            here, across, out = _places(way, x[rows], y[rows])
            z = np.interp(here, line.s, line.z)
            share = 1.0 / np.maximum(out[0], 0.05) ** 2
            asphalt[rows] = np.minimum(asphalt[rows], out[0])
            paved[rows] = np.minimum(paved[rows], out[1])
            weight[rows] += share
            height[rows] += share * z
            if way.is_ego:
                s, t, ego = here, across, out[0]
        close = np.flatnonzero(asphalt < REACH + _ROUGH)
        if len(close):
            asphalt[close] = _corrected(asphalt[close], self.asphalt(x[close], y[close]))
        return Near(asphalt, np.minimum(paved, asphalt), height / weight, s, t, ego)

    def along(self, x: float, y: float) -> tuple[float, float]:
        """Return a point's position along the ego's road and its distance from that road, m."""
        if (x, y) not in self._along:
            here, _, away = _places(self.ego, np.array([x]), np.array([y]))
            self._along[x, y] = float(here[0]), float(away[0][0])
        return self._along[x, y]

    def asphalt(self, x: Array, y: Array) -> Array:
        """Return the distance of points from the asphalt as drawn.

        Args:
            x: [n], m
            y: [n], m

        Returns:
            [n], m; negative on asphalt, at most `oodscen_pybullet._land.cover.REACH`.
        """
        return self._asphalt.distance(x, y)

    def is_free(self, x: Iterable[float], y: Iterable[float], margin: float) -> bool:
        """Return whether all points are off the asphalt by at least a margin, m."""
        key = (tuple(x), tuple(y), margin)
        if key not in self._free:
            self._free[key] = self._is_free(np.array(key[0]), np.array(key[1]), margin)
        return self._free[key]

    def _is_free(self, x: Array, y: Array, margin: float) -> bool:
        exact = self.asphalt(x, y)
        if margin < REACH or bool((exact <= 0.0).any()):
            return bool((exact > margin).all())
        return bool((self.near(x, y).asphalt > margin).all())


def _corrected(rough: Array, exact: Array) -> Array:
    """Return the distances with the sign of the exact ones, and with their size where they are near."""
    on = np.where(rough < 0.0, rough, exact)
    return np.where(exact >= REACH, np.maximum(rough, REACH), np.where(exact > 0.0, exact, on))


def _band(way: Way, edges: tuple[Array, Array]) -> tuple[Array, Array]:
    """Return the right and left lines of a road, extended slightly at both ends."""
    line = way.course
    reach = np.zeros((len(line.s), 1))
    reach[0], reach[-1] = -_OVERLAP, _OVERLAP
    along = reach * np.stack([line.cos, line.sin], axis=1)
    right, left = (line.points(edge)[:, :2] + along for edge in edges)
    return right, left


def _places(way: Way, x: Array, y: Array) -> tuple[Array, Array, tuple[Array, Array]]:
    """Return s and t of points on a road, and their distances from its asphalt and pavements."""
    line = way.course
    index = _nearest(line, x, y)
    dx, dy = x - line.x[index], y - line.y[index]
    here = line.s[index] + dx * line.cos[index] + dy * line.sin[index]
    across = dy * line.cos[index] - dx * line.sin[index]
    past = np.maximum(np.maximum(line.s[0] - here, here - line.s[-1]) - _OVERLAP, 0.0)
    is_past = bool(past.any())
    out = []
    for right, left in (way.asphalt, way.paved):
        a, b = np.interp(here, line.s, right), np.interp(here, line.s, left)
        wide = np.where(b - a > 0.05, np.maximum(a - across, across - b), 3.0)
        if is_past:
            side = np.maximum(wide, 0.0)
            wide = np.where(past > 0.0, np.sqrt(past * past + side * side), wide)
        out.append(wide)
    return here, across, (out[0], out[1])


def _jumps(corridor: Corridor) -> list[float]:
    """Return s on both sides of the places where lanes begin or end at their full width."""
    found: set[float] = set()
    for strip in corridor.strips:
        if strip.kind in DRIVABLE:
            for edge in (strip.right, strip.left):
                before = np.flatnonzero(np.abs(np.diff(edge)) > _JUMP)
                found.update(corridor.s[before].tolist(), corridor.s[before + 1].tolist())
    return sorted(found)


def _bounds(way: Way) -> tuple[float, float, float, float]:
    """Return the lowest and highest x and y of the area that a road affects, m."""
    reach = _NEAR + max(float(np.abs(edge).max()) for edge in way.paved)
    x, y = way.course.x, way.course.y
    return (
        float(x.min()) - reach, float(x.max()) + reach,
        float(y.min()) - reach, float(y.max()) + reach,
    )  # fmt: skip


def _outline(corridor: Corridor, course: RoadCourse, kinds: frozenset[str]) -> tuple[Array, Array]:
    """Return t of the outermost edges of strips of some kinds; without such strips the edges coincide."""
    right, left = np.full(len(course.s), np.inf), np.full(len(course.s), -np.inf)
    for strip in corridor.strips:
        if strip.kind in kinds:
            a = np.interp(course.s, corridor.s, strip.right)
            b = np.interp(course.s, corridor.s, strip.left)
            is_there = b - a > 0.05
            right = np.where(is_there, np.minimum(right, a), right)
            left = np.where(is_there, np.maximum(left, b), left)
    is_there = left > right
    return np.where(is_there, right, 0.0), np.where(is_there, left, 0.0)


def _ends(corridor: Corridor) -> tuple[tuple[float, float], tuple[float, float]]:
    return (
        (float(corridor.x[0]), float(corridor.y[0])),
        (float(corridor.x[-1]), float(corridor.y[-1])),
    )


def _meets(end: tuple[float, float], ego: Corridor, others: Sequence[Corridor]) -> bool:
    """Return whether the end of a road touches another road."""
    x, y = end
    reach = 8.0
    lines = [(ego.x, ego.y), *((other.x, other.y) for other in others)]
    return any(bool(((a - x) ** 2 + (b - y) ** 2).min() < reach * reach) for a, b in lines)


def _nearest(line: RoadCourse, x: Array, y: Array) -> Ints:
    """Return the row of the course nearest to each point."""
    found = np.zeros(len(x), np.int64)
    block = max(1, _BLOCK // len(line.x))
    for start in range(0, len(x), block):
        dx = x[start : start + block, None] - line.x[None, :]
        dy = y[start : start + block, None] - line.y[None, :]
        dx *= dx
        dy *= dy
        dx += dy
        found[start : start + block] = dx.argmin(axis=1)
    return found
