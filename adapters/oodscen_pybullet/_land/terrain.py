"""The ground around the roads of a map, as what stands on it asks for it."""

import numpy as np

from oodscen_pybullet._land.course import TIGHT
from oodscen_pybullet._land.ground import Ground
from oodscen_pybullet._land.islands import Islands
from oodscen_pybullet._land.land import Land
from oodscen_pybullet._land.relief import Relief
from oodscen_pybullet._land.theme import Theme
from oodscen_pybullet._meshes.mesh import Mesh
from oodscen_pybullet._types import Array

_GAP_M = 2.0
"""Grid to which points at corners of roads are rounded, m; equal ones are merged."""


class Terrain:
    """The shape and surface of the ground around the roads of a map."""

    def __init__(self, ground: Ground, theme: Theme, rng: np.random.Generator) -> None:
        """Draw the hills and fields.

        Args:
            ground: The roads.
            theme: The kind of land.
            rng: Draws hills and fields.
        """
        self.ground = ground
        self.theme: Theme = theme
        self._relief = Relief.drawn(ground, theme, rng)
        self._corners = _road_corners(ground)
        self.islands = Islands.of(ground, self._corners)
        """The land enclosed by roads."""
        self._land = Land.drawn(self._relief, self._corners, self.islands, rng)
        self._heights: dict[tuple[float, float], float] = {}

    def height(self, x: float, y: float) -> float:
        """Return the height of the ground at a point, m."""
        if (x, y) not in self._heights:
            self._heights[x, y] = float(self._tops(np.array([x]), np.array([y]))[0])
        return self._heights[x, y]

    def surface(self, x: float, y: float) -> float:
        """Return the height of the surface at a point, road or ground, m."""
        near = self.ground.near(np.array([x]), np.array([y]))
        return float(near.z[0]) if near.asphalt[0] <= 0.0 else self.height(x, y)

    def lifts(self, x: Array, y: Array) -> Array:
        """Return the height of the ground above the surrounding roads at points, m; 0 on asphalt."""
        if len(x) == 0:
            return np.zeros(0)
        near = self.ground.near(x, y)
        return np.where(near.asphalt > 0.0, self._tops(x, y) - near.z, 0.0)

    def is_corner(self, x: float, y: float, reach: float) -> bool:
        """Return whether a point lies within `reach`, m, of a junction or tight bend."""
        if not len(self._corners):
            return False
        square = (self._corners[:, 0] - x) ** 2 + (self._corners[:, 1] - y) ** 2
        return bool(square.min() < reach * reach)

    def mesh(self) -> Mesh:
        """Return the ground with its kerbs."""
        return self._land.mesh()

    def _tops(self, x: Array, y: Array) -> Array:
        """Return the height of the ground seen from above at points, m."""
        heights = self._relief.heights(x, y)
        return np.where(heights.is_above, heights.across, heights.beside) + self._relief.lift


def _road_corners(ground: Ground) -> Array:
    """Return points along tight bends and paths through junctions, [n, 2]."""
    corners = []
    for way in ground.ways:
        course, road = way.course, way.corridor
        is_corner = np.interp(course.s, road.s, np.abs(road.curvature)) > TIGHT
        is_corner |= np.interp(course.s, road.s, road.in_junction.astype(np.float64)) > 0.0
        is_corner |= way.is_connecting
        corners += [course.points(edge)[is_corner, :2] for edge in way.carriageway]
    cells = np.floor(np.concatenate(corners) / _GAP_M + 0.5)
    return np.asarray(np.unique(cells, axis=0) * _GAP_M)
