"""The builder of every mesh of this adapter, from polygons and simple bodies."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache, lru_cache
from typing import Literal, NamedTuple, Self

import numpy as np

from oodscen.data._designs.shapes import Caps, Rectangle
from oodscen.numerics._exact import cos, sin
from oodscen_pybullet._meshes.atlas import region_uv, swatch_uv
from oodscen_pybullet._meshes.mesh import BY_DAY, Lamp, Mesh, Puff
from oodscen_pybullet._meshes.shapes import (
    facet_rows,
    flat_normal,
    moved,
    rings,
    sphere_grid,
    unit,
    unit_rows,
)
from oodscen_pybullet._types import Array, Ints, Point


class _Rect(NamedTuple):
    """A level rectangle, m."""

    x0: float
    x1: float
    y0: float
    y1: float
    z: float

    def corners(self) -> list[Point]:
        """Return the corners, counter-clockwise seen from above."""
        x0, x1, y0, y1, z = self
        return [(x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z)]


class MeshBuilder:
    """Collects polygons; every method that adds something returns the builder."""

    def __init__(self) -> None:
        self._points: list[Array] = []
        self._normals: list[Array] = []
        self._uvs: list[Array] = []
        self._lamps: list[Lamp] = []
        self._puffs: list[Puff] = []

    def polygon(self, points: Sequence[Sequence[float]] | Array, colour: str) -> Self:
        """Add a flat convex polygon, counter-clockwise seen from the side that shows."""
        corners = np.asarray(points, dtype=np.float64)
        normal = flat_normal(corners.tolist())
        return self if normal is None else self._fill(corners, colour, normal)

    def textured_quad(self, points: Sequence[Sequence[float]] | Array, region: str) -> Self:
        """Add a quad that shows a region of the atlas.

        Args:
            points: Bottom left, bottom right, top right and top left, as a viewer sees them.
            region: Name of the region.
        """
        return self._add(np.asarray(points, dtype=np.float64), region_uv(region))

    def textured_polygon(
        self,
        points: Sequence[Sequence[float]] | Array,
        uvs: Sequence[tuple[float, float]],
        region: str,
    ) -> Self:
        """Add a flat convex polygon that shows part of a region of the atlas.

        Args:
            points: Counter-clockwise seen from the side that shows.
            uvs: Position of each point in the region, from the bottom left, 0 to 1.
            region: Name of the region.
        """
        left, low = region_uv(region)[0]
        right, high = region_uv(region)[2]
        placed = np.array([(left + (right - left) * u, low + (high - low) * v) for u, v in uvs])
        return self._add(np.asarray(points, dtype=np.float64), placed)

    def _add(self, corners: Array, uvs: Array) -> Self:
        """Add a flat convex polygon with texture coordinates of its own at every corner."""
        normal = flat_normal(corners.tolist())
        if normal is not None:
            rows = _fan(len(corners))
            self._points.append(corners[rows])
            self._normals.append(np.full((len(rows), 3), normal))
            self._uvs.append(uvs[rows])
        return self

    def _fill(self, corners: Array, colour: str, normals: Array | Point) -> Self:
        """Add a convex polygon of one colour, with a normal per corner or one for all."""
        rows = _fan(len(corners))
        self._points.append(corners[rows])
        if isinstance(normals, tuple):
            self._normals.append(np.full((len(rows), 3), normals))
        else:
            self._normals.append(normals[rows])
        self._uvs.append(_swatches(colour, len(rows)))
        return self

    def hull(
        self,
        bottom: Rectangle,
        top: Rectangle,
        colour: str,
        *,
        caps: Caps = "bt",
        cap_colour: str = "",
        sides: Sequence[str] = (),
    ) -> Self:
        """Add a box whose top may be smaller than its bottom.

        Args:
            bottom: x0, x1, y0, y1, z of the lower rectangle.
            top: The same for the upper rectangle.
            colour: Name of the colour.
            caps: Which ends are closed: `b`, `t` or both.
            cap_colour: Colour of the ends, if different.
            sides: Colours of the sides right, front, left, back; empty strings leave a side open.
        """
        lower, upper = _Rect(*bottom).corners(), _Rect(*top).corners()
        for i in range(4):
            side = sides[i] if sides else colour
            if side:
                j = (i + 1) % 4
                self.polygon([lower[i], lower[j], upper[j], upper[i]], side)
        if "t" in caps:
            self.polygon(upper, cap_colour or colour)
        if "b" in caps:
            self.polygon(lower[::-1], cap_colour or colour)
        return self

    def box(self, centre: Point, size: Point, colour: str, *, caps: Caps = "bt") -> Self:
        """Add an upright box, given its centre and full size."""
        x, y, z = centre
        half_length, half_width, half_height = size[0] / 2, size[1] / 2, size[2] / 2
        sides = (x - half_length, x + half_length, y - half_width, y + half_width)
        return self.hull((*sides, z - half_height), (*sides, z + half_height), colour, caps=caps)

    def beam(
        self, start: Point, end: Point, width: float, colour: str, *, end_width: float | None = None
    ) -> Self:
        """Add a square bar from one point to another, optionally tapered."""
        radii = (width / 2, (end_width if end_width is not None else width) / 2)
        return self._tube(*rings(start, end, radii, 4), colour, colour, smooth=False)

    def cylinder(
        self,
        start: Point,
        end: Point,
        radius: float,
        colour: str,
        *,
        sides: int = 10,
        end_radius: float | None = None,
        cap_colour: str = "",
        phase: float = 0.0,
    ) -> Self:
        """Add a round bar, cone or disc from one point to another."""
        radii = (radius, radius if end_radius is None else end_radius)
        both = rings(start, end, radii, sides, phase)
        return self._tube(*both, colour, cap_colour or colour, smooth=True)

    def _tube(
        self, ring_a: Array, ring_b: Array, colour: str, cap_colour: str, *, smooth: bool
    ) -> Self:
        if smooth:
            outward = unit_rows(ring_a - ring_a.mean(axis=0), ring_b - ring_b.mean(axis=0))
            self._smooth_band(ring_a, ring_b, colour, (outward, outward))
        else:
            for quad in _quads(ring_a, ring_b):
                self.polygon(quad, colour)
        self.polygon(ring_a[::-1], cap_colour)
        return self.polygon(ring_b, cap_colour)

    def _smooth_band(
        self, ring_a: Array, ring_b: Array, colour: str, outward: tuple[Array, Array]
    ) -> None:
        """Join two rings by quads, given the normals at both rings."""
        rows = _fan(4)
        self._points.append(_quads(ring_a, ring_b)[:, rows].reshape(-1, 3))
        self._normals.append(_quads(*outward)[:, rows].reshape(-1, 3))
        self._uvs.append(_swatches(colour, len(ring_a) * len(rows)))

    def ball(
        self,
        centre: Point,
        radii: Point,
        colour: str,
        *,
        around: int = 8,
        down: int = 5,
        jitter: float = 0.0,
        key: int = 0,
        second_colour: str = "",
    ) -> Self:
        """Add an ellipsoid; `jitter` makes it a rock or a bush.

        Args:
            centre: The centre of the ellipsoid.
            radii: Radii along x, y and z.
            colour: Name of the colour.
            around: Segments around the vertical axis.
            down: Segments from pole to pole.
            jitter: Fraction of the radius by which corners move in or out.
            key: Seed of the shape.
            second_colour: Colour of the hollows, if given.
        """
        sphere = sphere_grid(around, down)
        grid, dents = sphere.copy(), np.zeros((down + 1, around))
        if jitter:
            rng = np.random.Generator(np.random.PCG64(key))
            dents = rng.uniform(-1, 1, (down + 1, around))
            grid *= 1 + jitter * dents[..., None]
            grid[0], grid[-1] = grid[0, 0], grid[-1, 0]
        surface = grid * np.array(radii) + np.array(centre)
        for facet in facet_rows(around, down):
            shade = colour
            if second_colour and sum(dents[facet].tolist()) < 0.0:
                shade = second_colour
            if jitter:
                self.polygon(surface[facet], shade)
            else:
                self._fill(surface[facet], shade, sphere[facet])
        return self

    def column(
        self,
        rings: Sequence[tuple[Point, float, float]],
        colours: str | Sequence[str],
        *,
        axis: Literal["x", "z"] = "z",
        sides: int = 8,
        caps: Caps = "bt",
    ) -> Self:
        """Add a smooth body that joins a sequence of elliptic rings.

        Args:
            rings: Centre and two radii of each ring: along x and y for a body that rises along z,
                along y and z for one that extends along x. Rings are ordered upwards, or forwards.
            colours: One colour, or one per section between two rings.
            axis: `z` or `x`.
            sides: Corners of a ring.
            caps: Which ends are closed: `b`, `t` or both.
        """
        circle = _circle(sides)
        ellipses = [
            _ellipse(centre, first, second, axis, circle) for centre, first, second in rings
        ]
        names = [colours] * (len(rings) - 1) if isinstance(colours, str) else list(colours)
        for (low, low_outward), (high, high_outward), name in zip(
            ellipses[:-1], ellipses[1:], names, strict=True
        ):
            self._smooth_band(low, high, name, (low_outward, high_outward))
        if "b" in caps:
            self.polygon(ellipses[0][0][::-1], names[0])
        if "t" in caps:
            self.polygon(ellipses[-1][0], names[-1])
        return self

    def loft(self, sections: Sequence[Sequence[Point]], colours: Sequence[str]) -> Self:
        """Join a sequence of open outlines by panels.

        Args:
            sections: Outlines of equal length.
            colours: One colour per edge of an outline; an empty string leaves the panel open.
        """
        for near, far in itertools.pairwise(sections):
            for k, colour in enumerate(colours):
                if colour:
                    self.polygon([near[k], far[k], far[k + 1], near[k + 1]], colour)
        return self

    def wheel(self, x: float, y: float, radius: float, width: float, *, hub: str = "hub") -> Self:
        """Add a wheel that stands on the ground, with its hub facing away from y = 0."""
        out = 1.0 if y > 0 else -1.0
        near, far = y - out * width / 2, y + out * width / 2
        self.cylinder((x, near, radius), (x, far, radius), radius, "tyre", sides=14)
        face = far + out * 0.004
        return self.cylinder((x, far, radius), (x, face, radius), radius * 0.6, hub, sides=10)

    def lamp(
        self,
        position: Point,
        colour: Point,
        facing: Point,
        power: float = 1.0,
        *,
        by_day: float = BY_DAY,
    ) -> Self:
        """Declare a light that glows in the dark, and faintly by day.

        The length of `facing` plays no part; (0, 0, 0) shines in all directions.
        """
        self._lamps.append(Lamp(position, colour, unit(facing), power, by_day))
        return self

    def puff(
        self,
        position: Point,
        radius: float,
        colour: Point,
        density: float,
        *,
        is_bright: bool = False,
    ) -> Self:
        """Declare a soft ball of smoke, fire or dust."""
        self._puffs.append(Puff(position, radius, colour, density, is_bright))
        return self

    def add_surface(
        self,
        other: Mesh,
        at: Point = (0.0, 0.0, 0.0),
        yaw: float = 0.0,
        *,
        roof_z: float | None = None,
        roll: float = 0.0,
    ) -> Self:
        """Add the triangles of a finished mesh, rotated and moved, without its lamps, puffs and tags.

        Args:
            other: The mesh.
            at: New position of its origin.
            yaw: Counter-clockwise rotation, rad.
            roof_z: Height of the point that ends up on z = 0 after half a turn about x; `None` leaves the mesh
                upright.
            roll: Rotation about x before the others, rad.
        """
        points, normals = other.vertices.copy(), other.normals.copy()
        if roll:
            for rows in (points, normals):
                _turn(rows, 1, 2, roll)
        if roof_z is not None:
            points[:, 1] *= -1
            points[:, 2] = roof_z - points[:, 2]
            normals[:, 1:] *= -1
        for rows in (points, normals):
            _turn(rows, 0, 1, yaw)
        order = other.triangles.reshape(-1)
        self._points.append(points[order] + np.array(at))
        self._normals.append(normals[order])
        self._uvs.append(other.uvs[order])
        return self

    def insert(self, other: Mesh) -> Self:
        """Add a finished mesh with its lamps and puffs."""
        if len(other.triangles):
            self.add_surface(other)
        self._lamps += other.lamps
        self._puffs += other.puffs
        return self

    def shift(self, offset: Point, *, scale: float = 1.0) -> Self:
        """Scale everything added so far about the origin, then move it."""
        if self._points:
            self._points = [np.concatenate(self._points) * scale + np.array(offset)]
        self._lamps = [
            replace(lamp, position=moved(lamp.position, scale, offset)) for lamp in self._lamps
        ]
        self._puffs = [
            replace(puff, position=moved(puff.position, scale, offset), radius=puff.radius * scale)
            for puff in self._puffs
        ]
        return self

    @property
    def is_empty(self) -> bool:
        """True if nothing has a surface; lamps and puffs have none."""
        return not self._points

    def flatten(self, ground: float) -> Self:
        """Flatten everything below a height onto that height."""
        for rows in self._points:
            rows[:, 2] = np.maximum(rows[:, 2], ground)
        return self

    def grounded(self) -> Self:
        """Move everything up or down so that the lowest z is 0."""
        low, _ = self.bounds
        return self.shift((0.0, 0.0, -float(low[2])))

    def centred(self) -> Self:
        """Move everything so that the footprint's centre is the origin and the lowest z is 0."""
        low, high = self.bounds
        return self.shift((-(low[0] + high[0]) / 2, -(low[1] + high[1]) / 2, -low[2]))

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Lowest and highest corner so far, m."""
        rows = np.concatenate(self._points)
        return rows.min(axis=0), rows.max(axis=0)

    def build(self) -> Mesh:
        """Return the mesh."""
        surface = Mesh.loose(
            np.concatenate([np.zeros((0, 3)), *self._points]),
            np.concatenate([np.zeros((0, 3)), *self._normals]),
            np.concatenate([np.zeros((0, 2)), *self._uvs]),
        )
        return replace(surface, lamps=tuple(self._lamps), puffs=tuple(self._puffs))


def _ellipse(
    centre: Point,
    first: float,
    second: float,
    axis: Literal["x", "z"],
    circle: Sequence[tuple[float, float]],
) -> tuple[Array, Array]:
    """Return the corners of a column's ring and their normals, given cosines and sines around it."""
    x, y, z = centre
    if axis == "z":
        corners = [(x + first * c, y + second * s, z) for c, s in circle]
        outward = [(c * second, s * first, 0.0) for c, s in circle]
    else:
        corners = [(x, y + first * c, z + second * s) for c, s in circle]
        outward = [(0.0, c * second, s * first) for c, s in circle]
    rows = np.array(outward)
    return np.array(corners), unit_rows(rows, rows + np.array([0.0, 0.0, 1.0]))


def _turn(rows: Array, first: int, second: int, angle: float) -> None:
    """Turn vectors in place, from the first of two axes towards the second."""
    c, s = cos(angle), sin(angle)
    a, b = rows[:, first].copy(), rows[:, second].copy()
    rows[:, first], rows[:, second] = c * a - s * b, s * a + c * b


def _quads(ring_a: Array, ring_b: Array) -> Array:
    """Return the corners of the quads between two rings, [sides, 4, 3]."""
    after = [*range(1, len(ring_a)), 0]
    return np.stack([ring_a, ring_a[after], ring_b[after], ring_b], axis=1)


@cache
def _circle(sides: int) -> list[tuple[float, float]]:
    """Return cosines and sines around a circle, half a side on from the axis."""
    turns = [2 * math.pi * (i + 0.5) / sides for i in range(sides)]
    return [(cos(turn), sin(turn)) for turn in turns]


@lru_cache(maxsize=4096)
def _swatches(colour: str, count: int) -> Array:
    """Return the texture coordinates of corners of one colour, not to be changed."""
    return np.full((count, 2), swatch_uv(colour))


@cache
def _fan(corners: int) -> Ints:
    """Return the corners of the triangles that fill a convex polygon."""
    return np.array([i for k in range(1, corners - 1) for i in (0, k, k + 1)])
