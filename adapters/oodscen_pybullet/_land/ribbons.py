"""Bands and flat patches along a road, of which its surface, its marks and its barriers consist."""

from collections.abc import Sequence

import numpy as np

from oodscen.driving._roads.corridor import Corridor
from oodscen_pybullet._land.course import RoadCourse
from oodscen_pybullet._land.ways import Way
from oodscen_pybullet._meshes.atlas import region_uv, swatch_uv
from oodscen_pybullet._meshes.mesh import Mesh
from oodscen_pybullet._types import Array, Mask

EdgeHeights = tuple[Array | float, Array | float]
"""Heights of the right and the left edge of a band above the road, m."""
LAYER_M = 0.004
"""Height between stacked layers of the road, m."""
PAINT_M = 0.008
"""Height of marks above the asphalt, m."""
_NO_LENGTH_M = 1e-6
"""Length of a quad's side up to which the opposite side gives its direction, m."""
_NO_AREA = 1e-9
"""Length of a normal up to which a quad has no area and is left out, m^2."""


class Ribbons:
    """Collects bands along a course and flat patches."""

    def __init__(self, course: RoadCourse) -> None:
        self.course = course
        self._vertices: list[Array] = []
        self._normals: list[Array] = []
        self._uvs: list[Array] = []

    def band(
        self,
        right: Array | float,
        left: Array | float,
        colour: str,
        *,
        heights: EdgeHeights = (0.0, 0.0),
        where: Mask | None = None,
    ) -> None:
        """Add a band of one colour between two lateral offsets.

        Args:
            right: t of its right edge, m, along the course.
            left: t of its left edge.
            colour: A colour of the atlas.
            heights: Height of the right and the left edge above the road, m.
            where: [pieces] mask of the pieces to add; all by default.
        """
        self._add_band(right, left, np.tile(swatch_uv(colour), (4, 1)), heights, where)

    def tiled_band(
        self,
        right: Array | float,
        left: Array | float,
        region: str,
        *,
        heights: EdgeHeights = (0.0, 0.0),
        where: Mask | None = None,
    ) -> None:
        """Add a band that repeats a region of the atlas on every piece; as `band` otherwise."""
        self._add_band(right, left, region_uv(region), heights, where)

    def _add_band(
        self,
        right: Array | float,
        left: Array | float,
        uv: Array,
        heights: EdgeHeights,
        where: Mask | None,
    ) -> None:
        a, b = self.course.points(right, heights[0]), self.course.points(left, heights[1])
        quads = np.stack([a[:-1], a[1:], b[1:], b[:-1]], axis=1)
        if where is not None:
            quads = quads[where]
        self.add_quads(quads, np.broadcast_to(uv, (len(quads), 4, 2)))

    def add_quads(self, quads: Array, uv: Array) -> None:
        """Add quads, [n, 4, 3], counter-clockwise, with their atlas coordinates, [n, 4, 2].

        Each is lit as if it were flat, by the normal at its first corner.
        """
        a, b, c, d = quads.swapaxes(0, 1)
        normal = np.cross(_either_side(b - a, c - d), _either_side(d - a, c - b))
        length = np.sqrt((normal * normal).sum(axis=1, keepdims=True))
        has_area = length[:, 0] > _NO_AREA
        normal = normal / np.maximum(length, _NO_AREA)
        order = [0, 1, 2, 0, 2, 3]
        self._vertices.append(quads[has_area][:, order].reshape(-1, 3))
        self._uvs.append(uv[has_area][:, order].reshape(-1, 2))
        self._normals.append(np.repeat(normal[has_area], 6, axis=0))

    def patch(self, points: Sequence[Sequence[float]] | Array, colour: str) -> None:
        """Add a convex polygon, counter-clockwise seen from above, and shade it as if it were level."""
        corners = np.asarray(points, np.float64)
        for index in range(1, len(corners) - 1):
            self._vertices.append(corners[[0, index, index + 1]])
            self._uvs.append(np.tile(swatch_uv(colour), (3, 1)))
            self._normals.append(np.tile(np.array([0.0, 0.0, 1.0]), (3, 1)))

    def mesh(self) -> Mesh:
        """Return the mesh of everything added."""
        return Mesh.loose(
            np.concatenate([np.zeros((0, 3)), *self._vertices]),
            np.concatenate([np.zeros((0, 3)), *self._normals]),
            np.concatenate([np.zeros((0, 2)), *self._uvs]),
        )


def _either_side(sides: Array, opposite: Array) -> Array:
    """Return sides of quads, [n, 3], and the opposite one of each that has no length."""
    has_length = np.abs(sides).sum(axis=1, keepdims=True) > _NO_LENGTH_M
    return np.where(has_length, sides, opposite)


def whole_pieces(samples: Mask) -> Mask:
    """Return which pieces satisfy a condition at both ends."""
    return np.asarray(samples[1:] & samples[:-1])


def spanned_pieces(way: Way, *kinds: str) -> Mask:
    """Return which pieces of a course have their middles within structures of the given kinds."""
    middles = way.course.middles
    is_spanned = np.zeros(len(middles), bool)
    for structure in way.corridor.structures:
        if structure.kind in kinds:
            is_spanned |= (middles > structure.start) & (middles < structure.end)
    return is_spanned


def add_slab(
    road: Corridor,
    ribbons: Ribbons,
    box: tuple[float, float, float, float],
    height: float,
    colour: str,
) -> None:
    """Add a rectangle on a road.

    Args:
        road: The road.
        ribbons: Where to add it.
        box: Its first and last s, then its first and last t, m.
        height: Height above the road, m.
        colour: A colour of the atlas.
    """
    s0, s1, t0, t1 = box
    corners = []
    for s, t in ((s0, t0), (s1, t0), (s1, t1), (s0, t1)):
        x, y, z, _ = road.point(s, t)
        corners.append((x, y, z + height))
    ribbons.patch(corners, colour)
