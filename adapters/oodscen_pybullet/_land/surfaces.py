"""The surface of the roads: asphalt, medians and all paint."""

from collections.abc import Sequence

import numpy as np

from oodscen.driving._roads.corridor import DRIVABLE, Corridor, LaneStrip, PaintedArea
from oodscen_pybullet._land.ground import Ground, RoadCourse, Way
from oodscen_pybullet._land.terrain import KERB, Theme
from oodscen_pybullet._meshes.atlas import region_uv, swatch_uv
from oodscen_pybullet._meshes.mesh import Mesh
from oodscen_pybullet._meshes.shapes import upright
from oodscen_pybullet._types import Array, Mask

LAYER = 0.004
"""Height between stacked layers of the road, m."""
PAINT = 0.008
"""Height of marks above the asphalt, m."""
_MOUTH_M = 9.0
"""Marks end at a crosswalk that is at most this far from its junction, m."""
_GAUGE_M, _SLEEPERS_M = 1.5, 0.65
"""Distance between the middles of two rails, and between two sleepers, m."""
_WIDER = 0.25
"""Distance by which asphalt extends below kerbs, m."""


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
        surface: str,
        *,
        heights: tuple[Array | float, Array | float] = (0.0, 0.0),
        is_region: bool = False,
        where: Mask | None = None,
    ) -> None:
        """Add a band between two lateral offsets.

        Args:
            right: t of its right edge, m, along the course.
            left: t of its left edge.
            surface: A colour, or a region of the atlas that repeats on every piece.
            heights: Height of the right and the left edge above the road, m.
            is_region: Whether `surface` is a region.
            where: [pieces] mask of the pieces to add; all by default.
        """
        a, b = self.course.points(right, heights[0]), self.course.points(left, heights[1])
        quads = np.stack([a[:-1], a[1:], b[1:], b[:-1]], axis=1)
        if where is not None:
            quads = quads[where]
        uv = region_uv(surface) if is_region else np.tile(swatch_uv(surface), (4, 1))
        self.quads(quads, np.broadcast_to(uv, (len(quads), 4, 2)))

    def quads(self, quads: Array, uv: Array) -> None:
        """Add quads, [n, 4, 3], counter-clockwise, with their atlas coordinates, [n, 4, 2]."""
        across, along = quads[:, 3] - quads[:, 0], quads[:, 1] - quads[:, 0]
        across = np.where(
            np.abs(across).sum(axis=1, keepdims=True) > 1e-6, across, quads[:, 2] - quads[:, 1]
        )
        normal = np.cross(along, across)
        length = np.sqrt((normal * normal).sum(axis=1, keepdims=True))
        keep = length[:, 0] > 1e-9
        normal = normal / np.maximum(length, 1e-9)
        order = [0, 1, 2, 0, 2, 3]
        self._vertices.append(quads[keep][:, order].reshape(-1, 3))
        self._uvs.append(uv[keep][:, order].reshape(-1, 2))
        self._normals.append(np.repeat(normal[keep], 6, axis=0))

    def patch(self, points: Sequence[Sequence[float]] | Array, colour: str) -> None:
        """Add a flat convex polygon, counter-clockwise seen from above."""
        corners = np.asarray(points, np.float64)
        for index in range(1, len(corners) - 1):
            three = corners[[0, index, index + 1]]
            self._vertices.append(three)
            self._uvs.append(np.tile(swatch_uv(colour), (3, 1)))
            self._normals.append(np.tile(np.array([0.0, 0.0, 1.0]), (3, 1)))

    def mesh(self) -> Mesh:
        """Return the mesh of everything added."""
        return Mesh.loose(
            np.concatenate([np.zeros((0, 3)), *self._vertices]),
            np.concatenate([np.zeros((0, 3)), *self._normals]),
            np.concatenate([np.zeros((0, 2)), *self._uvs]),
        )


def strip_edges(corridor: Corridor, course: RoadCourse, strip: LaneStrip) -> tuple[Array, Array]:
    """Return t of the right and left edges of a strip along a course."""
    return (
        np.interp(course.s, corridor.s, strip.right),
        np.interp(course.s, corridor.s, strip.left),
    )


def lay_roads(ground: Ground, theme: Theme, rng: np.random.Generator) -> Mesh:
    """Return the surface of all roads.

    Args:
        ground: The roads.
        theme: Determines the material of shoulders and medians.
        rng: Draws the positions of asphalt repairs.
    """
    parts = []
    for index, way in enumerate(ground.ways):
        ribbons = Ribbons(way.course)
        layer = 0.0 if way.is_ego else -LAYER * (1 + index % 5)
        _lay(way, ribbons, theme, layer, rng)
        if way.is_track:
            _lay_track(way, ribbons)
        elif theme == "highway" or not way.is_connecting:
            _mark_lanes(way, ribbons, layer, ground.corridor.crosswalks, theme)
        if way.is_ego:
            _wear(way, ribbons, rng)
        parts.append(ribbons)
    paint = Ribbons(ground.ego.course)
    _lay_floors(ground, paint)
    _paint_crossings(ground, paint)
    return Mesh.joined([part.mesh() for part in [*parts, paint]])


def _lay(way: Way, ribbons: Ribbons, theme: Theme, layer: float, rng: np.random.Generator) -> None:
    """Add the strips of one road."""
    course, strips = way.course, way.corridor.strips
    spanned, dark = _spanned(way, ("tunnel", "bridge")), _spanned(way, ("tunnel",))
    right_most, left_most = way.asphalt
    low = (layer, layer)
    medians: list[tuple[Array, Array, Mask]] = []
    if way.has_kerb:
        _lay_below(way, ribbons, layer)
    for strip in strips:
        right, left = strip_edges(way.corridor, course, strip)
        is_there = _pieces((left - right) > 0.02)
        if strip.kind in DRIVABLE:
            surface, is_region = _surface(strip, theme)
            widened = _WIDER if way.has_kerb else 0.03
            right = np.where(right <= right_most + 0.01, right - widened, right)
            left = np.where(left >= left_most - 0.01, left + widened, left)
            ribbons.band(right, left, "asphalt_tunnel", heights=low, where=is_there & dark)
            is_there = is_there & ~dark
            if surface == "asphalt" and not way.is_connecting:
                worn = is_there & (rng.uniform(size=len(is_there)) < 0.14)
                ribbons.band(right, left, "asphalt_worn", heights=low, is_region=True, where=worn)
                is_there = is_there & ~worn
            ribbons.band(right, left, surface, heights=low, is_region=is_region, where=is_there)
        elif strip.kind == "rail":
            ribbons.band(right, left, "gravel", heights=low, is_region=True, where=is_there)
        elif strip.kind == "sidewalk":
            _raise(ribbons, right, left, "tunnel_light", is_there & dark)
            _raise(ribbons, right, left, "paving", is_there & spanned & ~dark)
        else:
            is_inner = _pieces((right > right_most - 0.1) & (left < left_most + 0.1))
            surface = "gravel" if theme == "highway" else "grass"
            where = is_there & is_inner & ~dark
            if theme in ("residential", "urban"):
                ribbons.band(right, left, surface, heights=(KERB, KERB), where=where)
                medians.append((right, left, where))
            else:
                ribbons.band(right, left, surface, heights=low, where=where)
            outer = is_there & spanned & ~is_inner
            ribbons.band(right, left, "concrete_dark", heights=low, where=outer & ~dark)
            ribbons.band(right, left, "tunnel_light", heights=low, where=is_there & dark)
    _kerb_medians(ribbons, medians)


def _lay_track(way: Way, ribbons: Ribbons) -> None:
    """Add the sleepers and the two rails of a track along its reference line."""
    course = way.course
    sleepers = np.arange(float(course.s[0]), float(course.s[-1]), _SLEEPERS_M).tolist()
    for s in sleepers:
        box = (s - 0.13, s + 0.13, -1.25, 1.25)
        _slab(way.corridor, ribbons, box, -0.5 * LAYER, "wood")
    for t in (-0.5 * _GAUGE_M, 0.5 * _GAUGE_M):
        ribbons.band(t - 0.05, t + 0.05, "rail", heights=(2.0 * PAINT, 2.0 * PAINT))


def _kerb_medians(ribbons: Ribbons, medians: Sequence[tuple[Array, Array, Mask]]) -> None:
    """Add kerbs along both edges of raised medians, except between two that touch."""
    if not medians:
        return
    some = np.array([where for _, _, where in medians])
    is_there = np.zeros((len(medians), some.shape[1] + 1), bool)
    is_there[:, :-1] |= some
    is_there[:, 1:] |= some
    right = np.where(is_there, np.array([r for r, _, _ in medians]), np.inf).min(axis=0)
    left = np.where(is_there, np.array([e for _, e, _ in medians]), -np.inf).max(axis=0)
    where: Mask = np.logical_or.reduce(some, axis=0)
    right, left = (
        np.where(is_there.any(axis=0), right, 0.0),
        np.where(is_there.any(axis=0), left, 0),
    )
    _kerbs(ribbons, right, left, "kerb", "kerb_side", where)
    rows = np.flatnonzero(np.diff(np.concatenate([[False], where, [False]]).astype(int)))
    low, high = ribbons.course.points(right, -0.03), ribbons.course.points(left, KERB)
    for row, is_first in zip(rows.tolist(), [True, False] * (len(rows) // 2), strict=True):
        (ax, ay, az), (bx, by, bz) = low[row].tolist(), high[row].tolist()
        front = np.array([upright((bx, by), (ax, ay), az, bz)])
        uv = np.broadcast_to(swatch_uv("kerb_side"), (1, 4, 2))
        ribbons.quads(front if is_first else front[:, [1, 0, 3, 2]], uv)


def _raise(ribbons: Ribbons, right: Array, left: Array, surface: str, where: Mask) -> None:
    """Add a band at the height of a pavement, with kerbs."""
    ribbons.band(
        right, left, surface, heights=(KERB, KERB), is_region=surface == "paving", where=where
    )
    side = "tunnel" if surface == "tunnel_light" else "kerb_side"
    top = "tunnel_light" if surface == "tunnel_light" else "kerb"
    _kerbs(ribbons, right, left, top, side, where)


def _kerbs(ribbons: Ribbons, right: Array, left: Array, top: str, side: str, where: Mask) -> None:
    """Add kerbs along both edges of a raised band."""
    high = (KERB + 0.004, KERB + 0.004)
    half = np.minimum(0.16, 0.5 * np.maximum(left - right, 0.0))
    ribbons.band(right, right + half, top, heights=high, where=where)
    ribbons.band(left - half, left, top, heights=high, where=where)
    ribbons.band(right - 1e-5, right, side, heights=(-0.03, KERB), where=where)
    ribbons.band(left, left + 1e-5, side, heights=(KERB, -0.03), where=where)


def _lay_below(way: Way, ribbons: Ribbons, layer: float) -> None:
    """Add asphalt below kerbs where the width changes or the road ends, to close gaps."""
    right, left = way.asphalt
    changes = (np.abs(np.diff(right)) > 0.05) | (np.abs(np.diff(left)) > 0.05)
    changes[:1] = changes[-1:] = True
    changes |= np.roll(changes, 1) | np.roll(changes, -1)
    if way.is_connecting:
        changes[:] = True
    wide = 2.6
    height = layer - 0.03
    ribbons.band(right - wide, left + wide, "asphalt", heights=(height, height), where=changes)


def _spanned(way: Way, kinds: Sequence[str]) -> Mask:
    """Return which pieces of a course lie on bridges or in tunnels."""
    middle = 0.5 * (way.course.s[1:] + way.course.s[:-1])
    found = np.zeros(len(middle), bool)
    for one in way.corridor.structures:
        if one.kind in kinds:
            found |= (middle > one.start) & (middle < one.end)
    return found


def _pieces(samples: Mask) -> Mask:
    """Return the pieces that satisfy a condition at both ends."""
    return np.asarray(samples[1:] & samples[:-1])


def _surface(strip: LaneStrip, theme: Theme) -> tuple[str, bool]:
    """Return the colour or region of a drivable strip, and whether it is a region."""
    if strip.kind == "parking":
        return "asphalt_light", False
    if strip.kind == "shoulder" and theme == "rural":
        return "gravel", True
    return "asphalt", True


# ------------------------------------------------------------------ marks


def _mark_lanes(
    way: Way, ribbons: Ribbons, layer: float, outlines: Sequence[PaintedArea], theme: Theme
) -> None:
    """Paint the marks on lane edges, in junctions only on motorways, and the bays of parking."""
    course, strips, road = way.course, way.corridor.strips, way.corridor
    inside = np.interp(course.s, road.s, road.in_junction.astype(np.float64)) >= 0.5
    outside = ~inside | (theme == "highway")
    free, dark = _pieces(outside) & ~_crossed(way, outlines), _spanned(way, ("tunnel",))
    height = layer + PAINT
    for index in range(len(strips) + 1):
        mark = strips[0].right_mark if index == 0 else strips[index - 1].mark
        if mark not in ("solid", "broken"):
            continue
        owner = strips[max(index - 1, 0)]
        right, left = strip_edges(road, course, owner)
        middle = right if index == 0 else left
        # An edge that jumps aside, where a lane ends at once, has no mark across the road.
        where = free & _pieces(left - right > 0.3) & (np.abs(np.diff(middle)) < 1.0)
        where &= ~_bare(course, owner, is_left=index > 0)
        if _is_double(strips, index):
            for side in (-0.14, 0.14):
                _line(ribbons, middle + side, 0.06, height, where, dark)
        else:
            drawn = where & _dashes(course) if mark == "broken" else where
            _line(ribbons, middle, 0.075, height, drawn, dark)
    for strip in strips:
        if strip.kind == "parking":
            _bays(way, ribbons, strip, height, outside)


def _bare(course: RoadCourse, strip: LaneStrip, *, is_left: bool) -> Mask:
    """Return the pieces along which a strip's edge has no mark, unlike at the ego's start."""
    middle = 0.5 * (course.s[1:] + course.s[:-1])
    found = np.zeros(len(middle), bool)
    for s, left, right in strip.mark_changes:
        found[middle >= s] = (left if is_left else right) == "none"
    return found


def _crossed(way: Way, outlines: Sequence[PaintedArea]) -> Mask:
    """Return which pieces lie below a crosswalk or stop line, or between it and the junction."""
    line, road = way.course, way.corridor
    found = np.zeros(len(line.s) - 1, bool)
    inside = np.interp(line.s, road.s, road.in_junction.astype(np.float64)) > 0.5
    mouths = [0.0, road.length, *line.s[inside].tolist()]
    for outline in outlines:
        middle = np.asarray(outline.points, np.float64)[:-1].mean(axis=0)
        s, t = road.locate(float(middle[0]), float(middle[1]))
        right = float(np.interp(s, line.s, way.asphalt[0]))
        left = float(np.interp(s, line.s, way.asphalt[1]))
        if not (0.0 <= s <= road.length and right < t < left):
            continue
        places = [road.locate(x, y)[0] for x, y in np.asarray(outline.points).tolist()]
        low, high = min(places), max(places)
        for mouth in mouths:
            if abs(mouth - s) < _MOUTH_M:
                low, high = min(low, mouth), max(high, mouth)
        found |= (line.s[1:] > low + 0.05) & (line.s[:-1] < high - 0.05)
    return found


def _dashes(course: RoadCourse) -> Mask:
    """Return the painted pieces of a broken mark: one in three."""
    period = 3.0 * float(np.diff(course.s).max())
    return np.asarray((0.5 * (course.s[1:] + course.s[:-1])) % period < period / 3)


def _line(ribbons: Ribbons, t: Array, half: float, height: float, where: Mask, dark: Mask) -> None:
    heights = (height, height)
    ribbons.band(t - half, t + half, "mark", heights=heights, where=where & ~dark)
    ribbons.band(t - half, t + half, "mark_tunnel", heights=heights, where=where & dark)


def _is_double(strips: tuple[LaneStrip, ...], index: int) -> bool:
    if not 0 < index < len(strips) or strips[index - 1].mark != "solid":
        return False
    one, two = strips[index - 1], strips[index]
    return one.kind == two.kind == "driving" and one.direction != two.direction


def _bays(way: Way, ribbons: Ribbons, strip: LaneStrip, height: float, free: Mask) -> None:
    """Paint the lines between the bays of a parking strip."""
    course = way.course
    right, left = strip_edges(way.corridor, course, strip)
    bay = np.floor(course.s / 6.0)
    is_new = np.append(True, bay[1:] > bay[:-1])
    rows = np.flatnonzero(free & (left - right > 1.5) & is_new)
    for row in rows.tolist():
        x, y, z = float(course.x[row]), float(course.y[row]), float(course.z[row]) + height
        c, s = float(course.cos[row]), float(course.sin[row])
        a, b = float(right[row]), float(left[row])
        points = [
            (x + u * c - t * s, y + u * s + t * c, z)
            for u, t in ((-0.05, a), (0.05, a), (0.05, b), (-0.05, b))
        ]
        ribbons.patch(points, "mark_worn")


def _wear(way: Way, ribbons: Ribbons, rng: np.random.Generator) -> None:
    """Add repairs and manhole covers to the ego's road."""
    road, course = way.corridor, way.course
    for strip in road.strips:
        if strip.kind != "driving":
            continue
        for s in np.arange(float(course.s[0]) + 8.0, float(course.s[-1]) - 60.0, 19.0).tolist():
            at = s + float(rng.uniform(-7.0, 7.0))
            kind = float(rng.uniform())
            if any(one.start - 6.0 < at < one.end + 1.0 for one in road.structures):
                continue
            right = float(np.interp(at, road.s, strip.right))
            left = float(np.interp(at, road.s, strip.left))
            if left - right < 2.5:
                continue
            if kind < 0.35 and road.speed_limit < 20.0:
                _disc(road, ribbons, at, 0.5 * (left + right) + float(rng.uniform(-0.7, 0.7)))
            elif kind < 0.65:
                long = float(rng.uniform(1.2, 5.0))
                low = right + 0.25 + float(rng.uniform(0.0, 0.9))
                high = min(left - 0.25, low + float(rng.uniform(0.7, 1.9)))
                _slab(road, ribbons, (at, at + long, low, high), LAYER, "asphalt_patch")


def _slab(
    road: Corridor,
    ribbons: Ribbons,
    box: tuple[float, float, float, float],
    height: float,
    colour: str,
) -> None:
    """Add a rectangle from s0 to s1 and t0 to t1."""
    s0, s1, t0, t1 = box
    corners = []
    for s, t in ((s0, t0), (s1, t0), (s1, t1), (s0, t1)):
        x, y, z, _ = road.point(s, t)
        corners.append((x, y, z + height))
    ribbons.patch(corners, colour)


_EIGHT = (
    (1.0, 0.0), (0.7071, 0.7071), (0.0, 1.0), (-0.7071, 0.7071),
    (-1.0, 0.0), (-0.7071, -0.7071), (0.0, -1.0), (0.7071, -0.7071),
)  # fmt: skip


def _disc(road: Corridor, ribbons: Ribbons, s: float, t: float) -> None:
    """Add a manhole cover."""
    x, y, z, _ = road.point(s, t)
    for radius, colour, height in ((0.36, "asphalt_light", 0.003), (0.29, "asphalt_patch", 0.006)):
        ribbons.patch([(x + radius * a, y + radius * b, z + height) for a, b in _EIGHT], colour)


# ------------------------------------------------------------------ junctions


def _lay_floors(ground: Ground, ribbons: Ribbons) -> None:
    """Lay asphalt below every junction so that no ground shows between its roads."""
    groups: dict[str, list[Array]] = {}
    for way, name in zip(
        ground.ways[1:], (o.junction for o in ground.corridor.others), strict=True
    ):
        if way.is_connecting:
            line = way.course
            edges = [line.points(way.asphalt[0]), line.points(way.asphalt[1])]
            groups.setdefault(name, []).append(np.concatenate(edges))
    for points in groups.values():
        cloud = np.concatenate(points)
        cloud[:, 2] -= 0.02 + 0.006 * 5
        hull = _convex(cloud)
        if len(hull) > 2:
            ribbons.patch(hull, "asphalt")


def _convex(points: Array) -> Array:
    """Return the convex hull of points seen from above, counter-clockwise."""
    rows = sorted({(round(x, 3), round(y, 3)): z for x, y, z in points.tolist()}.items())
    chain: list[tuple[float, float, float]] = []
    for sequence in (rows, rows[::-1]):
        part: list[tuple[float, float, float]] = []
        for (x, y), z in sequence:
            while len(part) > 1:
                (ax, ay, _), (bx, by, _) = part[-2], part[-1]
                if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0:
                    break
                part.pop()
            part.append((x, y, z))
        chain += part[:-1]
    return np.array(chain)


def _paint_crossings(ground: Ground, ribbons: Ribbons) -> None:
    """Paint crosswalks as zebras, and stop lines."""
    for outline in ground.corridor.crosswalks:
        points = np.asarray(outline.points, np.float64)
        if len(points) > 1 and bool((points[0] == points[-1]).all()):
            points = points[:-1]
        if len(points) < 3:
            continue
        x, y = points[:, 0], points[:, 1]
        z = ground.near(x, y).z + PAINT + 0.002
        if outline.kind == "stop_line" or len(points) != 4:
            ribbons.patch(np.stack([x, y, z], axis=1), "mark")
            continue
        corners = np.stack([x, y, z], axis=1)
        sides = corners - np.roll(corners, 1, axis=0)
        if (sides[1] ** 2).sum() < (sides[2] ** 2).sum():
            corners = np.roll(corners, -1, axis=0)
        a, b, c, d = corners
        length = float(np.sqrt(((b - a) ** 2).sum()))
        count = max(1, int(length / 1.0))
        for index in range(count):
            low, high = (index + 0.25) / count, (index + 0.75) / count
            stripe = [a + low * (b - a), a + high * (b - a), d + high * (c - d), d + low * (c - d)]
            ribbons.patch(np.array(stripe), "mark")
