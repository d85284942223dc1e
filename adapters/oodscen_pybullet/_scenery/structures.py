"""Tunnels and bridges of the ego's road."""

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
_LAMP_GAP = 10.0
_WALL = 0.35


def build_structures(ground: Ground) -> tuple[list[Mesh], list[Point]]:
    """Return the meshes of all tunnels and bridges, and the positions of tunnel lamps."""
    meshes: list[Mesh] = []
    lamps: list[Point] = []
    for structure in ground.corridor.structures:
        reach = 0.45 if structure.kind == "tunnel" else 0.0
        line = RoadCourse.between(ground.corridor, structure.start - reach, structure.end + reach)
        # A tunnel keeps the width of its ends up to the faces of its portals.
        within = np.clip(line.s, structure.start, structure.end)
        edges = [np.interp(within, ground.ego.course.s, edge) for edge in ground.ego.paved]
        if structure.kind == "tunnel":
            meshes.append(_tunnel(ground, structure, line, edges[0], edges[1], lamps))
        else:
            meshes += _bridge(ground, line, edges[0], edges[1])
    return meshes, lamps


def _tunnel(
    ground: Ground, one: Structure, line: RoadCourse, right: Array, left: Array, lamps: list[Point]
) -> Mesh:
    """Return walls, ceiling, lamps and the portals at both ends."""
    ribbons = Ribbons(line)
    low, high, top = -0.1, CEILING_M - 1.3, CEILING_M
    near, far = right - _WALL, left + _WALL
    for base, knee, colour in ((low, 1.1, "tunnel_light"), (1.1, high, "tunnel")):
        ribbons.band(far, far + 1e-4, colour, heights=(base, knee))
        ribbons.band(near - 1e-4, near, colour, heights=(knee, base))
    inner_left, inner_right = far - 1.2, near + 1.2
    ribbons.band(far, inner_left, "tunnel", heights=(high, top))
    ribbons.band(inner_left, inner_right, "tunnel_dark", heights=(top, top))
    ribbons.band(inner_right, near, "tunnel", heights=(top, high))
    ribbons.band(near, right, "tunnel_light", heights=(KERB_HEIGHT_M, KERB_HEIGHT_M))
    ribbons.band(left, far, "tunnel_light", heights=(KERB_HEIGHT_M, KERB_HEIGHT_M))
    mesh = MeshBuilder()
    for s in np.arange(one.start + 3.0, one.end, _LAMP_GAP).tolist():
        t0 = float(np.interp(s, line.s, inner_right))
        t1 = float(np.interp(s, line.s, inner_left))
        for share in (0.2, 0.8):
            x, y, z, _ = ground.corridor.point(s, t0 + share * (t1 - t0))
            c, n = float(np.interp(s, line.s, line.cos)), float(np.interp(s, line.s, line.sin))
            panel = [
                (x + a * c - b * n, y + a * n + b * c, z + top - 0.03)
                for a, b in ((-0.9, -0.22), (-0.9, 0.22), (0.9, 0.22), (0.9, -0.22))
            ]
            mesh.polygon(panel, "lamp_on")
            lamps.append((x, y, z + top - 0.1))
    for s, forward in ((one.start, True), (one.end, False)):
        _portal(mesh, ground, s, forward=forward)
    return tagged(Mesh.joined([ribbons.mesh(), mesh.build()]), Tag.WALLS)


def _portal(mesh: MeshBuilder, ground: Ground, s: float, *, forward: bool) -> None:
    """Add the portal of a tunnel, seen by drivers who enter it."""
    road, ego = ground.corridor, ground.ego
    x, y, z, _ = road.point(s, 0.0)
    c = float(np.interp(s, road.s, road.cos))
    n = float(np.interp(s, road.s, road.sin))
    right = float(np.interp(s, ego.course.s, ego.paved.right)) - _WALL
    left = float(np.interp(s, ego.course.s, ego.paved.left)) + _WALL
    wide, step = BANK_M + 5.0, -0.25 if forward else 0.25

    def at(t: float, h: float, out: float = 0.0) -> Point:
        return (x + out * c - t * n, y + out * n + t * c, z + h)

    def panel(outline: list[tuple[float, float]], colour: str, out: float = step) -> None:
        points = [at(t, h, out) for t, h in outline]
        mesh.polygon(points if not forward else points[::-1], colour)

    def panels(outline: list[tuple[float, float]], colour: str, out: float = step) -> None:
        """Add a panel outwards of the right wall, and its mirror image at the left one."""
        panel([(right - beyond, h) for beyond, h in outline], colour, out)
        mirrored = [(left + beyond, h) for beyond, h in outline]
        order = (1, 0, 3, 2) if len(outline) == 4 else (2, 1, 0)
        panel([mirrored[k] for k in order], colour, out)

    high, top, roof, rim, out = CEILING_M - 1.3, CEILING_M, PORTAL_M + 0.7, 0.6, step * 1.6
    panels([(wide, -2.0), (0.0, -2.0), (0.0, roof), (wide, roof)], "concrete_dark")
    panel([(right, top), (left, top), (left, roof), (right, roof)], "concrete_dark")
    panels([(0.0, high), (-1.2, top), (0.0, top)], "concrete_dark")
    panels([(rim, 0.0), (0.0, 0.0), (0.0, high), (rim, high + 0.3)], "concrete", out)
    panels([(rim, high + 0.3), (0.0, high), (-1.2, top), (-0.9, top + rim)], "concrete", out)
    panel(
        [(right + 0.9, top + rim), (right + 1.2, top), (left - 1.2, top), (left - 0.9, top + rim)],
        "concrete",
        out,
    )
    ends = ((right - wide, step), (left + wide, step), (left + wide, -4 * step))
    cap = [at(t, roof, out) for t, out in (*ends, (right - wide, -4 * step))]
    mesh.polygon(cap[::-1] if forward else cap, "concrete")
    for t in (right, left):
        side = [at(t, h, out) for h, out in ((-0.1, step), (-0.1, 0.0), (high, 0.0), (high, step))]
        mesh.polygon(side, "concrete").polygon(side[::-1], "concrete")


def _arches(mesh: MeshBuilder, ground: Ground, line: RoadCourse, right: Array, left: Array) -> None:
    """Add a steel arch above each edge of a bridge, with hangers, and braces between the arches."""
    first, last = float(line.s[0]) + 8.0, float(line.s[-1]) - 8.0
    count = max(8, 2 * int((last - first) / 18.0))
    rise = min(16.0, 0.11 * (last - first))
    if last - first < 40.0:
        return

    def at(index: int, edge: Array, out: float, height: float) -> Point:
        s = first + (last - first) * index / count
        x, y, z, _ = ground.corridor.point(s, float(np.interp(s, line.s, edge)) + out)
        return (x, y, z + height)

    heights = [4.0 * rise * k * (count - k) / (count * count) - 0.6 for k in range(count + 1)]
    for edge, out in ((right, -0.75), (left, 0.75)):
        for index in range(count):
            start = at(index, edge, out, heights[index])
            mesh.beam(start, at(index + 1, edge, out, heights[index + 1]), 0.55, "steel")
            if index and heights[index] > 2.0:
                mesh.beam(at(index, edge, out, 0.0), start, 0.12, "steel")
        mesh.box(at(0, edge, out, -2.0), (1.6, 1.6, 4.0), "concrete", caps="t")
        mesh.box(at(count, edge, out, -2.0), (1.6, 1.6, 4.0), "concrete", caps="t")
    for index in range(1, count):
        if heights[index] > 6.5:
            one = at(index, right, -0.75, heights[index])
            mesh.beam(one, at(index, left, 0.75, heights[index]), 0.3, "steel")


def _bridge(ground: Ground, line: RoadCourse, right: Array, left: Array) -> list[Mesh]:
    """Return deck edges, railings, piers and the water below."""
    ribbons = Ribbons(line)
    deck = 0.45
    high = KERB_HEIGHT_M if ground.ego.has_kerb else 0.02
    ribbons.band(right - deck, right, "concrete", heights=(high, high))
    ribbons.band(left, left + deck, "concrete", heights=(high, high))
    ribbons.band(right - deck - 1e-4, right - deck, "concrete_dark", heights=(-1.3, high))
    ribbons.band(left + deck, left + deck + 1e-4, "concrete_dark", heights=(high, -1.3))
    ribbons.band(left + deck, right - deck, "concrete_dark", heights=(-1.3, -1.3))
    for t in (right - 0.25, left + 0.25):
        for base, top in ((0.42, 0.48), (0.72, 0.78), (1.0, 1.1)):
            ribbons.band(t, t + 1e-4, "post", heights=(base, top))
            ribbons.band(t - 1e-4, t, "post", heights=(top, base))
        ribbons.band(t - 0.05, t + 0.05, "rail", heights=(1.1, 1.1))
    mesh = MeshBuilder()
    for s in np.arange(float(line.s[0]) + 0.5, float(line.s[-1]), 2.5).tolist():
        for edge, shift in ((right, -0.25), (left, 0.25)):
            x, y, z, _ = ground.corridor.point(s, float(np.interp(s, line.s, edge)) + shift)
            mesh.box((x, y, z + 0.55), (0.1, 0.1, 1.1), "post", caps="")
    for s in np.arange(float(line.s[0]) + 26.0, float(line.s[-1]) - 20.0, 28.0).tolist():
        for across in (float(right.mean()) * 0.6, float(left.mean()) * 0.6):
            x, y, z, _ = ground.corridor.point(s, across)
            mesh.box((x, y, z - 1.3 - VALLEY_M / 2), (1.2, 1.2, VALLEY_M), "concrete", caps="")
    _arches(mesh, ground, line, right, left)
    water = Ribbons(line)
    depth = -_WATER_M - (line.z - line.z.min())
    for side in (-1.0, 1.0):
        for a, b in ((0.0, 40.0), (40.0, 110.0), (110.0, WIDE_M + 30.0)):
            near, far = side * a, side * b
            surface = "water" if a < 100 else "water_light"
            water.band(min(near, far), max(near, far), surface, heights=(depth, depth))
    span = tagged(Mesh.joined([ribbons.mesh(), mesh.build()]), Tag.BRIDGE)
    return [Mesh.joined([span, tagged(water.mesh(), Tag.WATER)])]
