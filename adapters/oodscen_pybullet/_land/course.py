"""The line of a road, resampled for drawing."""

from dataclasses import dataclass

import numpy as np

from oodscen.driving._roads.corridor import DRIVABLE, Corridor
from oodscen_pybullet._types import Array, Ints

TIGHT = 1 / 90
"""Curvature above which pieces are shorter, 1/m."""
_STEP, _FAST_STEP = 3.0, 6.0
"""Length of a piece of road and of a fast road, m; also the length of a dash of a broken mark."""
_FAST = 19.0
"""Speed limit above which a road counts as fast, m/s."""
_BEHIND = 60.0
"""Length of road drawn behind the ego's start, m."""
_SEEN_M, _DRIVEN_S = 400.0, 30.0
"""Sight distance, m, and driving time at the speed limit, s: the road is drawn this far ahead."""
_BULGE = 0.03
"""Lane edges that bend by more than this within a piece make the pieces shorter, m."""
_JUMP = 0.5
"""Edges of the carriageway that change by more than this at once begin or end a lane, m."""
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
        ahead = _DRIVEN_S * corridor.speed_limit + _SEEN_M
        first = max(0.0, corridor.start - _BEHIND)
        return cls.between(corridor, first, corridor.start + ahead)

    @classmethod
    def between(cls, corridor: Corridor, first: float, last: float) -> "RoadCourse":
        """Resample a corridor from one s to another, extending it straight beyond its ends."""
        s = _positions(corridor, first, last)
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

    def locate(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Return s and t of points, m, each relative to its nearest sample."""
        index = self._nearest(x, y)
        dx, dy = x - self.x[index], y - self.y[index]
        s = self.s[index] + dx * self.cos[index] + dy * self.sin[index]
        return s, dy * self.cos[index] - dx * self.sin[index]

    def _nearest(self, x: Array, y: Array) -> Ints:
        """Return the index of the sample nearest to each point."""
        found = np.zeros(len(x), np.int64)
        block = max(1, _BLOCK // len(self.x))
        for start in range(0, len(x), block):
            dx = x[start : start + block, None] - self.x[None, :]
            dy = y[start : start + block, None] - self.y[None, :]
            dx *= dx
            dy *= dy
            dx += dy
            found[start : start + block] = dx.argmin(axis=1)
        return found


def is_fast(corridor: Corridor) -> bool:
    """Return whether traffic on a road is fast, as on a motorway."""
    return corridor.speed_limit > _FAST


def _positions(corridor: Corridor, first: float, last: float) -> Array:
    """Return the s at which a corridor is sampled, m: more of them where it bends or its lanes change."""
    piece = _FAST_STEP if is_fast(corridor) else _STEP
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
    breaks = [end for structure in corridor.structures for end in (structure.start, structure.end)]
    if is_fast(corridor):
        # Where a lane leaves the road, a long piece would taper it and leave a hole beside it.
        breaks += _lane_changes(corridor)
    parts.append(np.array([s for s in breaks if first < s < last], np.float64))
    return np.unique(np.concatenate(parts))


def _lane_changes(corridor: Corridor) -> list[float]:
    """Return s on both sides of the places where lanes begin or end at their full width."""
    found: set[float] = set()
    for strip in corridor.strips:
        if strip.kind in DRIVABLE:
            for edge in (strip.right, strip.left):
                before = np.flatnonzero(np.abs(np.diff(edge)) > _JUMP)
                found.update(corridor.s[before].tolist(), corridor.s[before + 1].tolist())
    return sorted(found)
