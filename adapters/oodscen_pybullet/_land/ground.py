"""The roads of a map on the ground, and the distance of points from asphalt."""

from dataclasses import dataclass

import numpy as np

from oodscen.driving._roads.corridor import Corridor
from oodscen_pybullet._land.cover import REACH_M, Cover, band_triangles
from oodscen_pybullet._land.ways import Way, ways_of
from oodscen_pybullet._types import Array

_NEAR_M = 60.0
"""Margin around a road other than the ego's beyond which it is ignored, m."""
_ROUGH_M = 3.0
"""Largest overestimate of a distance measured across a road, m."""
_FAR_M = 1e4
"""Distance of points from asphalt where no road is near, m."""
_CLOSE_M = 0.05
"""Lower bound of the distances by which heights are weighted, m."""


@dataclass(frozen=True, eq=False)
class Near:
    """The places of points relative to the roads, one row per point."""

    asphalt: Array
    """Distance from the nearest asphalt, m; negative inside; approximate where far away or negative."""
    paved: Array
    """The same for asphalt and pavements."""
    z: Array
    """Height of the surrounding roads, m."""
    s: Array
    """Position along the ego's road, m."""
    ego_asphalt: Array
    """Distance from the asphalt of the ego's road, m."""


class Ground:
    """All roads of a map.

    Args:
        corridor: The ego's corridor with the others.
    """

    def __init__(self, corridor: Corridor) -> None:
        self.corridor = corridor
        self.ways = ways_of(corridor)
        self.has_kerb = any(way.has_kerb for way in self.ways)
        self._bounds = [way.bounds(_NEAR_M) for way in self.ways]
        self._asphalt = Cover(band_triangles([way.carriageway_band() for way in self.ways]))

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
        asphalt, paved = np.full(count, _FAR_M), np.full(count, _FAR_M)
        weight, height = np.zeros(count), np.zeros(count)
        s, ego_asphalt = np.zeros(count), np.zeros(count)
        for way, bounds in zip(self.ways, self._bounds, strict=True):
            rows = np.arange(count) if way.is_ego else np.flatnonzero(bounds.contains(x, y))
            if len(rows) == 0:
                continue
            along, aside = way.course.locate(x[rows], y[rows])
            from_asphalt, from_paved = way.distances(along, aside)
            nearness = 1.0 / np.maximum(from_asphalt, _CLOSE_M) ** 2
            asphalt[rows] = np.minimum(asphalt[rows], from_asphalt)
            paved[rows] = np.minimum(paved[rows], from_paved)
            weight[rows] += nearness
            height[rows] += nearness * np.interp(along, way.course.s, way.course.z)
            if way.is_ego:
                s, ego_asphalt = along, from_asphalt
        close = np.flatnonzero(asphalt < REACH_M + _ROUGH_M)
        if len(close):
            asphalt[close] = _corrected(asphalt[close], self.asphalt(x[close], y[close]))
        return Near(asphalt, np.minimum(paved, asphalt), height / weight, s, ego_asphalt)

    def locate(self, x: float, y: float) -> tuple[float, float]:
        """Return a point's position along the ego's road and its distance from that road, m."""
        s, t = self.ego.course.locate(np.array([x]), np.array([y]))
        return float(s[0]), float(self.ego.distances(s, t).carriageway[0])

    def asphalt(self, x: Array, y: Array) -> Array:
        """Return the distance of points from the asphalt as drawn.

        Args:
            x: [n], m
            y: [n], m

        Returns:
            [n], m; negative on asphalt, at most `oodscen_pybullet._land.cover.REACH_M`.
        """
        return self._asphalt.distance(x, y)

    def is_free(self, x: Array, y: Array, margin: float) -> bool:
        """Return whether all points are off the asphalt by more than a margin, m."""
        distance = self.asphalt(x, y)
        if margin >= REACH_M and bool((distance > 0.0).all()):  # `asphalt` measures no farther
            distance = self.near(x, y).asphalt
        return bool((distance > margin).all())


def _corrected(rough: Array, exact: Array) -> Array:
    """Return the distances with the sign of the exact ones, and with their size where they are near."""
    is_far, is_off, is_deep = exact >= REACH_M, exact > 0.0, rough < 0.0
    return np.select([is_far, is_off, is_deep], [np.maximum(rough, REACH_M), exact, rough], exact)
