"""The line of a road, resampled for drawing."""

from dataclasses import dataclass

import numpy as np

from oodscen.driving._roads.corridor import DRIVABLE, Corridor
from oodscen_pybullet._types import Array, Ints

TIGHT = 1 / 90
"""Curvature above which pieces are shorter, 1/m."""
_STEP_M, _FAST_STEP_M = 3.0, 6.0
"""Length of a piece of road and of a fast road, m."""
_FAST_MPS = 19.0
"""Speed limit above which a road counts as fast, m/s."""
_BEHIND_M = 60.0
"""Length of road drawn behind the ego's start, m."""
_SEEN_M, _DRIVEN_S = 400.0, 30.0
"""Sight distance, m, and driving time at the speed limit, s: the road is drawn this far ahead."""
_BULGE_M = 0.03
"""Bulge of a lane's edge within a piece above which the piece is divided, m."""
_JUMP_M = 0.5
"""Sideways step of an edge above which a lane begins or ends there, m."""
_BATCH = 400_000
"""Largest number of distances per batch."""


@dataclass(frozen=True, eq=False)
class RoadCourse:
    """A corridor's line, resampled for drawing and extended straight beyond its ends."""

    s: Array
    """[n], m; evenly spaced but for the last piece, with more where the road bends or its widths change.

    Tight bends and changing widths have two more samples per piece; the ends of structures, and on a fast road
    the places where lanes begin or end, have one each.
    """
    x: Array
    y: Array
    z: Array
    cos: Array
    sin: Array

    @classmethod
    def of(cls, corridor: Corridor) -> "RoadCourse":
        """Resample the ego's road from behind its start to the limit of sight."""
        ahead = _DRIVEN_S * corridor.speed_limit + _SEEN_M
        first = max(0.0, corridor.start - _BEHIND_M)
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
        nearest = np.zeros(len(x), np.int64)
        size = max(1, _BATCH // len(self.x))
        for start in range(0, len(x), size):
            batch = slice(start, start + size)
            squares = (x[batch, None] - self.x[None, :]) ** 2
            squares += (y[batch, None] - self.y[None, :]) ** 2
            nearest[batch] = squares.argmin(axis=1)
        return nearest


def is_fast(corridor: Corridor) -> bool:
    """Return whether traffic on a road is fast, as on a motorway."""
    return corridor.speed_limit > _FAST_MPS


def piece_length(corridor: Corridor) -> float:
    """Return the length of a piece of a road where it is not divided, m; a broken mark's dashes are as long."""
    return _FAST_STEP_M if is_fast(corridor) else _STEP_M


def _positions(corridor: Corridor, first: float, last: float) -> Array:
    """Return the s at which a corridor is sampled, m: more of them where it bends or its lanes change."""
    piece_m = piece_length(corridor)
    count = max(1, int((last - first) / piece_m + 0.5))
    step = min(piece_m, last - first)
    s: Array = first + step * np.arange(count + 1, dtype=np.float64)
    s[-1] = last
    middle, length = 0.5 * (s[1:] + s[:-1]), np.diff(s)
    is_split = np.interp(middle, corridor.s, np.abs(corridor.curvature)) > TIGHT
    for strip in corridor.strips:
        for edge in (strip.right, strip.left):
            ends = np.interp(s, corridor.s, edge)
            bulge = np.interp(middle, corridor.s, edge) - 0.5 * (ends[1:] + ends[:-1])
            is_split |= np.abs(bulge) > _BULGE_M
    parts = [s[:-1], *((s[:-1] + k * length / 3)[is_split] for k in (1, 2)), s[-1:]]
    breaks = [end for structure in corridor.structures for end in (structure.start, structure.end)]
    if is_fast(corridor):
        # Where a lane leaves the road, a long piece would taper it and leave a hole beside it.
        breaks += _lane_changes(corridor)
    parts.append(np.array([place for place in breaks if first < place < last], np.float64))
    return np.unique(np.concatenate(parts))


def _lane_changes(corridor: Corridor) -> list[float]:
    """Return s on both sides of the places where lanes begin or end at their full width."""
    changes: set[float] = set()
    for strip in corridor.strips:
        if strip.kind in DRIVABLE:
            for edge in (strip.right, strip.left):
                before = np.flatnonzero(np.abs(np.diff(edge)) > _JUMP_M)
                changes.update(corridor.s[before].tolist(), corridor.s[before + 1].tolist())
    return sorted(changes)
