"""Tunnels and bridges of the ego's road."""

from typing import NamedTuple, Self

import numpy as np

from oodscen.driving._roads.corridor import Structure
from oodscen_pybullet._land.course import RoadCourse
from oodscen_pybullet._land.ground import Ground
from oodscen_pybullet._land.land import WIDE_M
from oodscen_pybullet._land.relief import BANK_M, KERB_HEIGHT_M, PORTAL_M, VALLEY_M
from oodscen_pybullet._land.ribbons import Ribbons
from oodscen_pybullet._meshes.builder import MeshBuilder
from oodscen_pybullet._meshes.mesh import Mesh
from oodscen_pybullet._meshes.tags import Tag, tagged
from oodscen_pybullet._types import Array, Point

CEILING_M = 5.4
"""Height of a tunnel's ceiling above the road, m."""
_WATER_M = 5.5
"""Depth of the water surface below a bridge, m."""
_LAMPS_M = 10.0
"""Distance between the lamps of a tunnel, m."""
_LAMP_SHARES = (0.2, 0.8)
"""Places of its two rows of lamps, as shares of the ceiling's width."""
_WALL_M = 0.35
"""Distance of a tunnel's walls from the road's edge, m."""
_BEVEL_M = (1.2, 1.3)
"""Width and height of the slope between a tunnel's walls and its ceiling, m."""
_FACE_M = 0.45
"""Distance of a portal's face before the tunnel, m."""
_DECK_M, _DECK_DEPTH_M = 0.45, 1.3
"""Width of a bridge's deck beside the road, and its depth, m."""
_THIN_M = 1e-4
"""Width of an upright face seen from above, m."""
_ARCH_END_M, _SHORTEST_ARCH_M = 8.0, 40.0
"""Distance of an arch from the bridge's ends, and its least length, m."""


def build_structures(ground: Ground) -> tuple[list[Mesh], list[Point]]:
    """Return the meshes of all tunnels and bridges, and the positions of tunnel lamps."""
    meshes: list[Mesh] = []
    lamps: list[Point] = []
    for structure in ground.corridor.structures:
        if structure.kind == "tunnel":
            span = _Span.of(ground, structure, _FACE_M)
            mesh, tunnel_lamps = _tunnel(ground, structure, span)
            meshes.append(mesh)
            lamps += tunnel_lamps
        else:
            meshes.append(_bridge(ground, _Span.of(ground, structure, 0.0)))
    return meshes, lamps


class _Span(NamedTuple):
    """The road along a tunnel or a bridge."""

    course: RoadCourse
    right: Array
    """[n] t of the road's right edge, pavements included, m."""
    left: Array

    @classmethod
    def of(cls, ground: Ground, structure: Structure, beyond: float) -> Self:
        """Return the road from before a structure to behind it; it is as wide there as at the structure's ends."""
        start, end = structure.start, structure.end
        course = RoadCourse.between(ground.corridor, start - beyond, end + beyond)
        s = np.clip(course.s, start, end)
        right, left = (np.interp(s, ground.ego.course.s, edge) for edge in ground.ego.paved)
        return cls(course, right, left)


def _tunnel(ground: Ground, tunnel: Structure, span: _Span) -> tuple[Mesh, list[Point]]:
    """Return walls, ceiling and the portals at both ends, and the positions of the lamps."""
    ribbons = Ribbons(span.course)
    width, height = _BEVEL_M
    high, top = CEILING_M - height, CEILING_M
    right, left = span.right - _WALL_M, span.left + _WALL_M
    for foot, knee, colour in ((-0.1, 1.1, "tunnel_light"), (1.1, high, "tunnel")):
        ribbons.band(left, left + _THIN_M, colour, heights=(foot, knee))
        ribbons.band(right - _THIN_M, right, colour, heights=(knee, foot))
    ceiling_left, ceiling_right = left - width, right + width
    ribbons.band(left, ceiling_left, "tunnel", heights=(high, top))
    ribbons.band(ceiling_left, ceiling_right, "tunnel_dark", heights=(top, top))
    ribbons.band(ceiling_right, right, "tunnel", heights=(top, high))
    walk = (KERB_HEIGHT_M, KERB_HEIGHT_M)
    ribbons.band(right, span.right, "tunnel_light", heights=walk)
    ribbons.band(span.left, left, "tunnel_light", heights=walk)
    mesh = MeshBuilder()
    lamps = _add_tunnel_lamps(mesh, ground, tunnel, span)
    _Portal.of(ground, tunnel.start, is_entrance=True).build(mesh)
    _Portal.of(ground, tunnel.end, is_entrance=False).build(mesh)
    return tagged(Mesh.joined([ribbons.mesh(), mesh.build()]), Tag.WALLS), lamps


def _add_tunnel_lamps(
    mesh: MeshBuilder, ground: Ground, tunnel: Structure, span: _Span
) -> list[Point]:
    """Add two rows of lamps below a tunnel's ceiling, and return their positions."""
    course = span.course
    lamps = []
    for s in np.arange(tunnel.start + 3.0, tunnel.end, _LAMPS_M).tolist():
        right = float(np.interp(s, course.s, span.right - _WALL_M + _BEVEL_M[0]))
        left = float(np.interp(s, course.s, span.left + _WALL_M - _BEVEL_M[0]))
        for share in _LAMP_SHARES:
            x, y, z, _ = ground.corridor.point(s, right + share * (left - right))
            cos = float(np.interp(s, course.s, course.cos))
            sin = float(np.interp(s, course.s, course.sin))
            panel = [
                (x + a * cos - b * sin, y + a * sin + b * cos, z + CEILING_M - 0.03)
                for a, b in ((-0.9, -0.22), (-0.9, 0.22), (0.9, 0.22), (0.9, -0.22))
            ]
            mesh.polygon(panel, "lamp_on")
            lamps.append((x, y, z + CEILING_M - 0.1))
    return lamps


_Outline = list[tuple[float, float]]
"""Corners across a road: t, or the distance outwards of a wall, and the height above the road, m."""


class _Portal(NamedTuple):
    """The face of a tunnel across the road."""

    x: float
    y: float
    z: float
    cos: float
    sin: float
    """Its place on the reference line, and the road's direction there."""
    right: float
    left: float
    """t of the tunnel's walls, m."""
    is_entrance: bool
    """True if traffic in the road's direction enters here."""

    @classmethod
    def of(cls, ground: Ground, s: float, *, is_entrance: bool) -> Self:
        """Return the portal at s."""
        road, ego = ground.corridor, ground.ego
        x, y, z, _ = road.point(s, 0.0)
        cos, sin = (float(np.interp(s, road.s, column)) for column in (road.cos, road.sin))
        right, left = (float(np.interp(s, ego.course.s, edge)) for edge in ego.paved)
        return cls(x, y, z, cos, sin, right - _WALL_M, left + _WALL_M, is_entrance)

    def build(self, mesh: MeshBuilder) -> None:
        """Add the face around the opening, a rim, and a cap above."""
        width, height = _BEVEL_M
        high, top, roof = CEILING_M - height, CEILING_M, PORTAL_M + 0.7
        wide, rim, face = BANK_M + 5.0, 0.6, self._outwards(0.25)
        front = face * 1.6
        right, left = self.right, self.left
        concrete, dark = "concrete", "concrete_dark"
        self._add_pair(mesh, [(wide, -2.0), (0.0, -2.0), (0.0, roof), (wide, roof)], dark, face)
        self._add(mesh, [(right, top), (left, top), (left, roof), (right, roof)], dark, face)
        self._add_pair(mesh, [(0.0, high), (-width, top), (0.0, top)], dark, face)
        jamb = [(rim, 0.0), (0.0, 0.0), (0.0, high), (rim, high + 0.3)]
        self._add_pair(mesh, jamb, concrete, front)
        haunch = [(rim, high + 0.3), (0.0, high), (-width, top), (-0.9, top + rim)]
        self._add_pair(mesh, haunch, concrete, front)
        lintel = [
            (right + 0.9, top + rim), (right + width, top),
            (left - width, top), (left - 0.9, top + rim),
        ]  # fmt: skip
        self._add(mesh, lintel, concrete, front)
        cap = [
            self._point(t, roof, out)
            for t, out in (
                (right - wide, face), (left + wide, face),
                (left + wide, -4 * face), (right - wide, -4 * face),
            )
        ]  # fmt: skip
        mesh.polygon(cap[::-1] if self.is_entrance else cap, concrete)
        for t in (right, left):
            side = [
                self._point(t, h, out)
                for h, out in ((-0.1, face), (-0.1, 0.0), (high, 0.0), (high, face))
            ]
            mesh.polygon(side, concrete).polygon(side[::-1], concrete)

    def _outwards(self, distance: float) -> float:
        """Return the shift along the road of what stands before the tunnel, m."""
        return -distance if self.is_entrance else distance

    def _point(self, t: float, height: float, along: float) -> Point:
        """Return a point at t, at a height above the road and a distance along it from the portal, m."""
        return (
            self.x + along * self.cos - t * self.sin,
            self.y + along * self.sin + t * self.cos,
            self.z + height,
        )

    def _add(self, mesh: MeshBuilder, outline: _Outline, colour: str, along: float) -> None:
        """Add a panel that faces away from the tunnel; corners are (t, height)."""
        points = [self._point(t, height, along) for t, height in outline]
        mesh.polygon(points[::-1] if self.is_entrance else points, colour)

    def _add_pair(self, mesh: MeshBuilder, outline: _Outline, colour: str, along: float) -> None:
        """Add a panel at the right wall, and its mirror image at the left one; corners are (outwards, height)."""
        self._add(mesh, [(self.right - out, height) for out, height in outline], colour, along)
        mirrored = [(self.left + out, height) for out, height in outline]
        order = (1, 0, 3, 2) if len(outline) == 4 else (2, 1, 0)
        self._add(mesh, [mirrored[k] for k in order], colour, along)


def _bridge(ground: Ground, span: _Span) -> Mesh:
    """Return deck edges, railings, piers, arches and the water below."""
    ribbons, mesh = Ribbons(span.course), MeshBuilder()
    _add_deck(ribbons, span, KERB_HEIGHT_M if ground.ego.has_kerb else 0.02)
    _add_railings(ribbons, span)
    _add_posts_and_piers(mesh, ground, span)
    _add_arches(mesh, ground, span)
    deck = tagged(Mesh.joined([ribbons.mesh(), mesh.build()]), Tag.BRIDGE)
    return Mesh.joined([deck, tagged(_water(span.course), Tag.WATER)])


def _add_deck(ribbons: Ribbons, span: _Span, top: float) -> None:
    """Add the edges of a bridge's deck, up to a height above the road, m, and its underside."""
    right, left = span.right - _DECK_M, span.left + _DECK_M
    bottom = -_DECK_DEPTH_M
    ribbons.band(right, span.right, "concrete", heights=(top, top))
    ribbons.band(span.left, left, "concrete", heights=(top, top))
    ribbons.band(right - _THIN_M, right, "concrete_dark", heights=(bottom, top))
    ribbons.band(left, left + _THIN_M, "concrete_dark", heights=(top, bottom))
    ribbons.band(left, right, "concrete_dark", heights=(bottom, bottom))


def _add_railings(ribbons: Ribbons, span: _Span) -> None:
    """Add the rails along both edges, visible from both sides."""
    for t in (span.right - 0.25, span.left + 0.25):
        for low, high in ((0.42, 0.48), (0.72, 0.78), (1.0, 1.1)):
            ribbons.band(t, t + _THIN_M, "post", heights=(low, high))
            ribbons.band(t - _THIN_M, t, "post", heights=(high, low))
        ribbons.band(t - 0.05, t + 0.05, "rail", heights=(1.1, 1.1))


def _add_posts_and_piers(mesh: MeshBuilder, ground: Ground, span: _Span) -> None:
    """Add the posts of the railings, and the piers."""
    course = span.course
    first, last = float(course.s[0]), float(course.s[-1])
    for s in np.arange(first + 0.5, last, 2.5).tolist():
        for edge, shift in ((span.right, -0.25), (span.left, 0.25)):
            x, y, z, _ = ground.corridor.point(s, float(np.interp(s, course.s, edge)) + shift)
            mesh.box((x, y, z + 0.55), (0.1, 0.1, 1.1), "post", caps="")
    for s in np.arange(first + 26.0, last - 20.0, 28.0).tolist():
        for t in (float(span.right.mean()) * 0.6, float(span.left.mean()) * 0.6):
            x, y, z, _ = ground.corridor.point(s, t)
            middle = (x, y, z - _DECK_DEPTH_M - VALLEY_M / 2)
            mesh.box(middle, (1.2, 1.2, VALLEY_M), "concrete", caps="")


def _add_arches(mesh: MeshBuilder, ground: Ground, span: _Span) -> None:
    """Add a steel arch above each edge of a long bridge, with hangers, and braces between the arches."""
    course = span.course
    first, last = float(course.s[0]) + _ARCH_END_M, float(course.s[-1]) - _ARCH_END_M
    length = last - first
    if length < _SHORTEST_ARCH_M:
        return
    count = max(8, 2 * int(length / 18.0))
    rise = min(16.0, 0.11 * length)
    heights = [4.0 * rise * k * (count - k) / (count * count) - 0.6 for k in range(count + 1)]

    def point(index: int, edge: Array, out: float, height: float) -> Point:
        s = first + length * index / count
        x, y, z, _ = ground.corridor.point(s, float(np.interp(s, course.s, edge)) + out)
        return (x, y, z + height)

    for edge, out in ((span.right, -0.75), (span.left, 0.75)):
        for index in range(count):
            start = point(index, edge, out, heights[index])
            mesh.beam(start, point(index + 1, edge, out, heights[index + 1]), 0.55, "steel")
            if index and heights[index] > 2.0:
                mesh.beam(point(index, edge, out, 0.0), start, 0.12, "steel")
        for index in (0, count):
            mesh.box(point(index, edge, out, -2.0), (1.6, 1.6, 4.0), "concrete", caps="t")
    for index in range(1, count):
        if heights[index] > 6.5:
            start = point(index, span.right, -0.75, heights[index])
            mesh.beam(start, point(index, span.left, 0.75, heights[index]), 0.3, "steel")


def _water(course: RoadCourse) -> Mesh:
    """Return the level surface of the water below a bridge."""
    ribbons = Ribbons(course)
    height = -_WATER_M - (course.z - course.z.min())
    for side in (-1.0, 1.0):
        for near, far, surface in (
            (0.0, 40.0, "water"),
            (40.0, 110.0, "water"),
            (110.0, WIDE_M + 30.0, "water_light"),
        ):
            right, left = sorted((side * near, side * far))
            ribbons.band(right, left, surface, heights=(height, height))
    return ribbons.mesh()
