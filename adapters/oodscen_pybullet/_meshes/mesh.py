"""Meshes and their lamps and smoke."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from oodscen_pybullet._meshes.shapes import ORIGIN, placed, rotated
from oodscen_pybullet._types import U8, Array, Heading, Ints, Point

BY_DAY = 0.22
"""Share of a lamp's glow that is visible by day; light-emitting diodes have more."""


@dataclass(frozen=True)
class Lamp:
    """A light on a mesh that glows in the dark."""

    position: Point
    """In the mesh's frame, m."""
    colour: Point
    """Red, green, blue, 0 to 1."""
    facing: Point
    """Direction of the beam in the mesh's frame, of length 1; (0, 0, 0) shines in all directions."""
    power: float = 1.0
    """Relative power: 1 is a tail lamp; a headlamp on low beam is about 4."""
    by_day: float = BY_DAY
    """Share of its glow that is visible by day."""
    is_street: bool = False
    """True if it lights the road below it, as a street lamp does."""

    def placed(self, at: Point, heading: Heading) -> Self:
        """Return the lamp of a mesh that stands at a point and faces along a heading."""
        position, facing = placed(self.position, at, heading), placed(self.facing, ORIGIN, heading)
        return replace(self, position=position, facing=facing)


@dataclass(frozen=True)
class Puff:
    """A soft ball of smoke, fire or dust."""

    position: Point
    """Centre in the mesh's frame, m."""
    radius: float
    """Radius, m."""
    colour: Point
    """Red, green, blue, 0 to 1."""
    density: float
    """Opacity at the centre, 0 to 1."""
    is_bright: bool = False
    """True if it emits light, as fire does."""

    def placed(self, at: Point, heading: Heading) -> Self:
        """Return the puff of a mesh that stands at a point and faces along a heading."""
        return replace(self, position=placed(self.position, at, heading))


@dataclass(frozen=True, eq=False)
class Mesh:
    """A flat-shaded triangle mesh that takes its colours from the atlas."""

    vertices: Array
    """[n, 3] m; x forward, y left, z up; the footprint's centre is the origin."""
    normals: Array
    """[n, 3], unit length."""
    uvs: Array
    """[n, 2] atlas coordinates."""
    triangles: Ints
    """[m, 3] rows of `vertices`, counter-clockwise seen from outside."""
    lamps: tuple[Lamp, ...] = ()
    """The mesh's lamps."""
    puffs: tuple[Puff, ...] = ()
    """Smoke, fire and dust, which the bounds ignore."""
    is_ground: bool = False
    """True for road and land: upward faces get wet and receive the full light of the beams."""
    tags: U8 | None = None
    """[m] semantic class of each triangle: `oodscen_pybullet._meshes.tags.Tag`; 0 and `None` leave it
    to the colour."""

    @classmethod
    def loose(cls, vertices: Array, normals: Array, uvs: Array, tags: U8 | None = None) -> Self:
        """Return a mesh of triangles that share no vertices: three rows are one triangle."""
        triangles = np.arange(len(vertices)).reshape(-1, 3)
        return cls(vertices, normals, uvs, triangles, tags=tags)

    @classmethod
    def joined(cls, meshes: Sequence["Mesh"]) -> Self:
        """Merge the surfaces of several meshes, without their lamps and puffs."""
        corners = [mesh.triangles.reshape(-1) for mesh in meshes]
        parts = list(zip(meshes, corners, strict=True))
        return cls.loose(
            np.concatenate([mesh.vertices[rows] for mesh, rows in parts]),
            np.concatenate([mesh.normals[rows] for mesh, rows in parts]),
            np.concatenate([mesh.uvs[rows] for mesh, rows in parts]),
            np.concatenate([mesh.classes for mesh in meshes]),
        )

    def moved(
        self, turn: Array, *, about: Point = ORIGIN, to: Point = ORIGIN, scale: float = 1.0
    ) -> Self:
        """Return the mesh scaled and turned about a point that then lies elsewhere.

        Args:
            turn: [3, 3] rows of the rotation.
            about: The point.
            to: Its new place.
            scale: The factor.
        """

        def point(before: Point) -> Point:
            x, y, z = (rotated((np.array([before]) - about) * scale, turn)[0] + to).tolist()
            return x, y, z

        def direction(way: Point) -> Point:
            x, y, z = rotated(np.array([way]), turn)[0].tolist()
            return x, y, z

        return replace(
            self,
            vertices=rotated((self.vertices - about) * scale, turn) + to,
            normals=rotated(self.normals, turn),
            lamps=tuple(
                replace(lamp, position=point(lamp.position), facing=direction(lamp.facing))
                for lamp in self.lamps
            ),
            puffs=tuple(
                replace(puff, position=point(puff.position), radius=puff.radius * scale)
                for puff in self.puffs
            ),
        )

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Lowest and highest corner, m."""
        return self.vertices.min(axis=0), self.vertices.max(axis=0)

    @property
    def size(self) -> Point:
        """Length, width and height, m."""
        low, high = self.bounds
        length, width, height = (high - low).tolist()
        return length, width, height

    @property
    def classes(self) -> U8:
        """Semantic class of each triangle, [m]; 0 leaves it to the colour."""
        return np.zeros(len(self.triangles), np.uint8) if self.tags is None else self.tags
