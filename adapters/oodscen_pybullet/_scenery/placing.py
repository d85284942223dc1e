"""Placement of meshes beside roads: never on a road and never overlapping."""

import math
from collections.abc import Container
from dataclasses import dataclass, field

import numpy as np

from oodscen.data._map_state import MapState
from oodscen_pybullet._land.ground import Ground
from oodscen_pybullet._land.terrain import Terrain
from oodscen_pybullet._land.ways import Way
from oodscen_pybullet._meshes.mesh import Mesh
from oodscen_pybullet._types import U8, Array, Heading, Point

Rectangle = tuple[float, float, Heading, float, float]
"""Centre, direction of the first side, and half the lengths of both sides, m."""

FAR_M = 280.0
"""Distance ahead of the ego's start beyond which small objects are omitted, m."""
_BEHIND_M, _ASIDE_M = 40.0, 0.35 * FAR_M
"""The same distances behind that start and beside the road, m."""
SHORT_M = 110.0
"""Distance before the end of the ego's road at which scenery ends, m; it looks small from there."""
_CELL_M = 24.0
"""Size of the grid squares in which claimed rectangles are looked up, m."""
_STEPS = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])
"""Places along half the side of a rectangle that must be off the asphalt."""


@dataclass(frozen=True)
class RoadsidePlace:
    """A place beside a road."""

    x: float
    y: float
    heading: Heading
    """Direction along the road for objects on its left, against it for objects on its right."""
    s: float
    """Position along that road."""
    side: int
    """+1 left, -1 right."""

    def beside(self, along: float, out: float) -> tuple[float, float]:
        """Return x, y of a point at a distance along the heading and away from the road, m."""
        c, s = self.heading
        return self.x + along * c - out * s, self.y + along * s + out * c


@dataclass
class Site:
    """Collects the objects beside the roads."""

    ground: Ground
    terrain: Terrain
    rng: np.random.Generator
    state: MapState | None = None
    """Faults of the map's lamps, lights and signs."""
    lamps: list[Point] = field(default_factory=list)
    """Heads of the lit street lamps."""
    _vertices: list[Array] = field(default_factory=list)
    _normals: list[Array] = field(default_factory=list)
    _uvs: list[Array] = field(default_factory=list)
    _tags: list[U8] = field(default_factory=list)
    _taken: dict[tuple[int, int], list[Rectangle]] = field(default_factory=dict)

    def add(self, mesh: Mesh, at: Point, heading: Heading) -> None:
        """Add a mesh with its x axis along a heading, without checking for other objects."""
        c, s = heading
        order = mesh.triangles.reshape(-1)
        for source, target, move in (
            (mesh.vertices, self._vertices, np.array(at)),
            (mesh.normals, self._normals, np.zeros(3)),
        ):
            rows = source[order]
            turned = np.stack(
                [c * rows[:, 0] - s * rows[:, 1], s * rows[:, 0] + c * rows[:, 1], rows[:, 2]],
                axis=1,
            )
            target.append(turned + move)
        self._uvs.append(mesh.uvs[order])
        self._tags.append(mesh.classes)

    def stand(
        self,
        mesh: Mesh,
        spot: RoadsidePlace,
        along: float,
        out: float,
        heading: Heading | None = None,
    ) -> Point:
        """Add a small object on the ground beside a spot, and return its position."""
        x, y = spot.beside(along, out)
        at = (x, y, self.terrain.height(x, y))
        self.add(mesh, at, heading or spot.heading)
        return at

    def try_to_stand(
        self,
        mesh: Mesh,
        spot: RoadsidePlace,
        along: float,
        out: float,
        *,
        margin: float,
        radius: float,
    ) -> None:
        """Add a small object if it is clear of asphalt and of claimed areas.

        Args:
            mesh: The object.
            spot: The reference place.
            along: Distance along the spot's heading, m.
            out: Distance away from the road, m.
            margin: Distance of its centre from asphalt, m.
            radius: Radius of its footprint, m.
        """
        x, y = spot.beside(along, out)
        is_free = self.is_free(x, y, margin)
        if is_free and self.claim(x, y, spot.heading, radius, radius, margin=0.0):
            self.stand(mesh, spot, along, out)

    def is_free(self, x: float, y: float, margin: float) -> bool:
        """Return whether a point is off the asphalt by more than a margin, m."""
        return self.ground.is_free(np.array([x]), np.array([y]), margin)

    def claim(
        self, x: float, y: float, heading: Heading, half_x: float, half_y: float, *, margin: float
    ) -> bool:
        """Reserve a rectangle unless it is taken or too close to asphalt.

        Args:
            x: x of its centre, m.
            y: y of its centre, m.
            heading: Direction of its first side.
            half_x: Half the length of the first side, m.
            half_y: Half the length of the other side, m.
            margin: Minimum distance from asphalt, m.
        """
        rectangle, reach = (x, y, heading, half_x, half_y), half_x + half_y
        cells = [
            (i, j)
            for i in range(int((x - reach) // _CELL_M), int((x + reach) // _CELL_M) + 1)
            for j in range(int((y - reach) // _CELL_M), int((y + reach) // _CELL_M) + 1)
        ]
        for cell in cells:
            if any(_overlap(rectangle, other) for other in self._taken.get(cell, ())):
                return False
        if margin > 0.0:
            c, s = heading
            along, across = half_x * _STEPS[:, None], half_y * _STEPS
            points_x, points_y = x + along * c - across * s, y + along * s + across * c
            if not self.ground.is_free(points_x.ravel(), points_y.ravel(), margin):
                return False
        for cell in cells:
            self._taken.setdefault(cell, []).append(rectangle)
        return True

    def spots(
        self, way: Way, side: int, spacing: float, *, jitter: float = 0.0, first: float = 0.0
    ) -> list[RoadsidePlace]:
        """Return places on the edge of a road's pavement at roughly equal distances."""
        course = way.course
        start = float(course.s[0]) + first
        end = float(course.s[-1]) - (SHORT_M if way.is_ego else 0.0)
        count = max(0, int((end - start) / spacing))
        shifts = self.rng.uniform(-jitter, jitter, count) if jitter else np.zeros(count)
        return [
            self.spot(way, start + spacing * (i + 0.5) + float(shifts[i]), side)
            for i in range(count)
        ]

    def spot(self, way: Way, s: float, side: int) -> RoadsidePlace:
        """Return the place on the edge of a road's pavement at `s`."""
        course = way.course
        edge = way.paved.left if side > 0 else way.paved.right
        columns = (edge, course.x, course.y, course.cos, course.sin)
        t, x, y, cos, sin = (float(np.interp(s, course.s, column)) for column in columns)
        norm = math.sqrt(cos * cos + sin * sin)
        cos, sin = cos / norm, sin / norm
        heading = (cos, sin) if side > 0 else (-cos, -sin)
        return RoadsidePlace(x - t * sin, y + t * cos, heading, s, side)

    def is_spanned(
        self,
        spot: RoadsidePlace,
        margin: float = 6.0,
        kinds: Container[str] = ("bridge", "tunnel"),
    ) -> bool:
        """Return whether a spot is on a bridge or in a tunnel, or close to the end of one.

        Args:
            spot: The spot.
            margin: Distance from the end that counts as close, m.
            kinds: The kinds of structure that count.
        """
        spans = [one for one in self.ground.corridor.structures if one.kind in kinds]
        if not spans:
            return False
        s, _ = self.ground.locate(spot.x, spot.y)
        return any(one.start - margin < s < one.end + margin for one in spans)

    def is_far(self, spot: RoadsidePlace) -> bool:
        """Return whether a spot is too far away for small objects to be visible."""
        s, away = self.ground.locate(spot.x, spot.y)
        ahead = s - self.ground.corridor.start
        return ahead > FAR_M or ahead < -_BEHIND_M or away > _ASIDE_M

    def turn(self) -> Heading:
        """Return a random direction."""
        u = float(self.rng.uniform(-1.0, 1.0))
        norm = 1.0 + u * u
        flip = 1.0 if self.rng.uniform() < 0.5 else -1.0
        return flip * (1.0 - u * u) / norm, flip * 2.0 * u / norm

    def mesh(self) -> Mesh:
        """Return the mesh of everything added."""
        vertices, normals, uvs = map(np.concatenate, (self._vertices, self._normals, self._uvs))
        return Mesh.loose(vertices, normals, uvs, np.concatenate(self._tags))


def _overlap(first: Rectangle, second: Rectangle) -> bool:
    """Return whether two rectangles overlap: no side's direction separates them."""
    (x0, y0, _, a0, b0), (x1, y1, _, a1, b1) = first, second
    dx, dy = x1 - x0, y1 - y0
    reach = a0 + b0 + a1 + b1
    if dx * dx + dy * dy > reach * reach:
        return False
    return not (_is_separated(first, second) or _is_separated(second, first))


def _is_separated(first: Rectangle, second: Rectangle) -> bool:
    """Return whether one of the first rectangle's sides separates it from the second."""
    (x0, y0, (c, s), a0, b0), (x1, y1, (c1, s1), a1, b1) = first, second
    dot, cross = abs(c * c1 + s * s1), abs(c * s1 - s * c1)
    along, across = abs((x1 - x0) * c + (y1 - y0) * s), abs((y1 - y0) * c - (x1 - x0) * s)
    is_ahead = along > a0 + (a1 * dot + b1 * cross)
    return is_ahead or across > b0 + (a1 * cross + b1 * dot)
