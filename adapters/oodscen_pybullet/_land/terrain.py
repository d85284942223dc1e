"""The ground beside the roads: kerbs, pavements, lawns and fields, out to the hills.

The terrain is a grid of squares, small at the roads and large far away. It is cut along lines of
equal distance from the asphalt, so any road network gets kerbs that follow its corners, and no holes.
"""

from typing import Literal, NamedTuple, cast, get_args

import numpy as np

from oodscen.data._catalogue import RoadMap
from oodscen.driving._roads.corridor import Corridor, Structure
from oodscen_pybullet._land.adaptive_grid import Squares, crossing
from oodscen_pybullet._land.ground import TIGHT, Ground
from oodscen_pybullet._land.islands import Islands
from oodscen_pybullet._meshes.atlas import REGIONS, region_uv, swatch_uv
from oodscen_pybullet._meshes.mesh import Mesh
from oodscen_pybullet._rendering.clipping import cut
from oodscen_pybullet._types import Array, Mask

Theme = Literal["residential", "urban", "highway", "rural"]

KERB = 0.10
"""Height of pavements above the road, m."""
KERB_FOOT = -0.03
"""Height of the foot of a kerb's side above the road, m: below it, so that no gap shows."""
WIDE_M = 215.0
"""Distance from the ego's road to the edge of the ground, m."""
PORTAL_M = 7.4
"""Height of a tunnel's portal above the road, m."""
BANK_M = 13.0
"""Distance from the asphalt at which the ground beside a portal reaches the portal's height, m."""
VALLEY_M = 11.0
"""Depth of the ground below a bridge, m."""
WATER_M = 5.5
"""Depth of the water surface below a bridge, m."""
ISLAND_RIM = 1.6
"""Width of the paved edge of an island, m."""
_GAP = 2.0
"""Smallest distance between two points where roads meet, m."""
_X, _Y, _Z, _ASPHALT, _PAVED, _U, _V, _S, _IN = range(9)
"""Columns of a corner: its place, its distances from asphalt and pavements, its place in its square, its s along
the ego's road, and its height above tunnels."""

_UNKERBED_LIFT = -0.02
"""Height of the ground above the adjacent asphalt where there are no kerbs, m."""
_KERB_TOP_M = 0.18
"""Width of the top of a kerb, m."""
_CORNER_M, _CORNER_PAVED_M = 9.0, 2.4
"""Distance from where roads meet within which the ground is paved, and how far from the asphalt, m."""
_UNDULATING_M, _HILLY_M = (18.0, 90.0), (100.0, 190.0)
"""Distances from asphalt between which undulations, and the hills on the horizon, rise to their height, m."""
_UNDULATION_M, _HILL_M = 75.0, 60.0
"""Wavelengths of undulations and of hills, m."""
_HILL_SWING = 0.45
"""Largest change of the height of hills, as a share of it."""
_HILL_SHIFT_M = 500.0
"""Distance in the noise between undulations and hills, which must not coincide, m."""
_DITCH_M, _DITCH_NEAR_M, _DITCH_FAR_M = 0.25, (0.5, 2.5), (3.0, 6.0)
"""Depth of a ditch beside a road without kerbs, and distances from asphalt along its two banks, m."""
_BANK_NEAR_M = 3.0
"""Distance from the asphalt at which the bank beside a portal begins, m."""
_BANK_FADE_M = (4.0, 60.0)
"""Distances before a tunnel between which the bank falls to the ground, m."""
_COVER_SLOPE, _COVER_M = 0.45, 18.0
"""Slope of the hill above a tunnel, and its height above the portals, m."""
_VALLEY_SIDE_M, _VALLEY_FAR_M = 24.0, (120.0, 190.0)
"""Length of a valley's side below a bridge, and distances from asphalt between which the valley ends, m."""
_ABUTMENT_M = 0.5
"""Length over which the ground below a bridge starts to fall, m; it reaches so far beyond the bridge's ends."""
_DECK_END_M = 10.0
"""Length at each end of a bridge below which the ground is cut at the road's edge, m."""
_DECK_EDGE_M = 0.46
"""Distance from pavements of that cut, m."""
_ROOFED_M = 20.0
"""Least distance from asphalt that the ground above tunnels and below bridges counts with, m."""
_FIELD_M = (72.0, 48.0)
"""Extent of a field, m."""
_GRID = 64
"""Rows and columns after which waves and fields repeat."""
_GRID_OFFSET = 1000.0
"""Place of the map's origin in the grid of waves."""
_SHORTEST_M = 1e-4
"""Length of an edge up to which a face is left out, m."""
_FLAT = 1e-4
"""Length of a normal up to which a triangle is left out, m^2."""
_FARTHEST_M = 1e9


class _GroundBand(NamedTuple):
    """The material of the ground up to a distance from pavements."""

    reach: float
    """The distance, m."""
    surface: str
    """A colour or region of the atlas; empty for fields."""


_BANDS: dict[Theme, tuple[_GroundBand, ...]] = {
    "residential": (
        _GroundBand(13.0, "turf"),
        _GroundBand(60.0, "grass"),
        _GroundBand(_FARTHEST_M, "hill"),
    ),
    "urban": (
        _GroundBand(3.5, "paving"),
        _GroundBand(70.0, "concrete_dark"),
        _GroundBand(_FARTHEST_M, "hill"),
    ),
    "highway": (
        _GroundBand(12.0, "turf"),
        _GroundBand(90.0, ""),
        _GroundBand(_FARTHEST_M, "hill"),
    ),
    "rural": (_GroundBand(9.0, "turf"), _GroundBand(110.0, ""), _GroundBand(_FARTHEST_M, "hill")),
}
_CROPS = ("field", "grass", "grass_dark", "field", "earth", "grass")
_RELIEF: dict[Theme, tuple[float, float]] = {
    "residential": (0.0, 11.0),
    "urban": (0.0, 2.0),
    "highway": (5.0, 16.0),
    "rural": (7.0, 20.0),
}
"""Height of the land's undulations and of the hills on the horizon, m."""


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
        self._waves = rng.uniform(-1.0, 1.0, (_GRID, _GRID))
        self._crops = rng.integers(0, len(_CROPS), (_GRID, _GRID))
        self._meeting = _meeting_points(ground)
        self.islands = Islands.of(ground, self._meeting)
        """The land enclosed by roads."""
        self._known: dict[tuple[float, float], float] = {}

    @property
    def lift(self) -> float:
        """Height of the ground above the adjacent asphalt, m."""
        return KERB if self.ground.kerbed else _UNKERBED_LIFT

    def height(self, x: float, y: float) -> float:
        """Return the height of the ground at a point, m."""
        if (x, y) not in self._known:
            outside, inside, within = self._heights(np.array([x]), np.array([y]))
            self._known[x, y] = float((inside if within[0] else outside)[0]) + self.lift
        return self._known[x, y]

    def surface(self, x: float, y: float) -> float:
        """Return the height of the surface at a point, road or ground, m."""
        near = self.ground.near(np.array([x]), np.array([y]))
        return float(near.z[0]) if near.asphalt[0] <= 0.0 else self.height(x, y)

    def lifts(self, x: Array, y: Array) -> Array:
        """Return the height of the ground above the surrounding roads at points, m; 0 on asphalt."""
        if len(x) == 0:
            return np.zeros(0)
        near = self.ground.near(x, y)
        outside, inside, within = self._heights(x, y)
        high = np.where(within, inside, outside) + self.lift - near.z
        return np.where(near.asphalt > 0.0, high, 0.0)

    def is_corner(self, x: float, y: float, reach: float) -> bool:
        """Return whether a point lies within `reach`, m, of a junction or tight bend."""
        if not len(self._meeting):
            return False
        square = (self._meeting[:, 0] - x) ** 2 + (self._meeting[:, 1] - y) ** 2
        return bool(square.min() < reach * reach)

    def mesh(self) -> Mesh:
        """Return the ground with its kerbs."""
        pieces: list[tuple[Array, Array]] = []
        open_, over = self._spanned(self._corners())
        _, land, border = cut(open_, _ASPHALT, 0.0, self._edge)
        is_edge = land[:, :, _ASPHALT] <= 0.0
        x, y = land[is_edge][:, _X], land[is_edge][:, _Y]
        land[is_edge, _PAVED] = np.minimum(self.ground.near(x, y).paved, 0.0) if len(x) else 0.0
        if self.ground.kerbed:
            pieces.append(_walls(border))
            kerbed, land = self._kerbed(land)
            pieces += kerbed
        land = np.concatenate([land, over])
        for band in _BANDS[self.theme]:
            some, land, _ = cut(land, _PAVED, band.reach)
            pieces += [self._surface(some, band.surface)] if band.surface else self._fields(some)
        vertices = np.concatenate([vertices for vertices, _ in pieces])
        uvs = np.concatenate([uvs for _, uvs in pieces])
        return _mesh(vertices, uvs)

    def _kerbed(self, land: Array) -> tuple[list[tuple[Array, Array]], Array]:
        """Split off kerbs, islands and pavements; return them and the rest of the land."""
        kerb, land, _ = cut(land, _ASPHALT, _KERB_TOP_M)
        is_island = self.islands.covers(land[:, :, : _Y + 1].mean(axis=1))
        island, land = land[is_island], land[~is_island]
        rim, lawn, _ = cut(island, _ASPHALT, ISLAND_RIM)
        paved, land, _ = cut(land, _PAVED, 0.0)
        surfaces = ((kerb, "kerb"), (rim, "paving"), (lawn, "turf"), (paved, "paving"))
        return [self._surface(corners, surface) for corners, surface in surfaces], land

    def _edge(self, one: Array, two: Array) -> Array:
        return crossing(
            self.ground.asphalt,
            one[:, : _Y + 1],
            two[:, : _Y + 1],
            one[:, _ASPHALT],
            two[:, _ASPHALT],
        )

    def _spanned(self, corners: Array) -> tuple[Array, Array]:
        """Split the ground at tunnels and bridges: the part in the open, and the part above or below.

        Heights are recomputed along the cuts because they cannot be interpolated there from the corners of
        the squares.
        """
        open_, over = corners, corners[:0]
        for one in self.ground.corridor.structures:
            ends: tuple[float, ...] = (one.start, one.end)
            if one.kind == "bridge":
                ends = (one.start, one.start + _DECK_END_M, one.end - _DECK_END_M, one.end)
            before, rest, _ = cut(open_, _S, ends[0])
            for index, end in enumerate(ends[1:]):
                middle, rest, _ = cut(rest, _S, end)
                if one.kind == "bridge" and index != 1:
                    _, middle, _ = cut(middle, _PAVED, _DECK_EDGE_M)
                over = np.concatenate([over, middle])
            open_ = np.concatenate([before, rest])
        if len(over):
            for part, column in ((open_, 0), (over, 1)):
                flat = part.reshape(-1, part.shape[2])
                heights = self._heights(flat[:, _X], flat[:, _Y])
                flat[:, _Z] = heights[column]
            over[:, :, _ASPHALT] = np.maximum(over[:, :, _ASPHALT], _ROOFED_M)
            over[:, :, _PAVED] = over[:, :, _ASPHALT]
        return open_, over

    # ------------------------------------------------------------------ shape

    def _structures(self, kind: str) -> list[Structure]:
        return [one for one in self.ground.corridor.structures if one.kind == kind]

    def _heights(self, x: Array, y: Array) -> tuple[Array, Array, Mask]:
        """Return the ground's height in the open and above tunnels, and a mask of where the latter applies."""
        near = self.ground.near(x, y)
        away = np.maximum(near.asphalt, 0.0)
        low = np.zeros(len(x)) if self.ground.kerbed else _ditch(away)
        outside = near.z + self._relief(x, y, away) + low
        inside, within = outside, np.zeros(len(x), bool)
        for tunnel in self._structures("tunnel"):
            gap = np.maximum(tunnel.start - near.s, near.s - tunnel.end)
            deep = np.maximum(-gap, 0.0)
            side = _rise(away, _BANK_NEAR_M, BANK_M)
            outside = outside + PORTAL_M * side * _fall(np.maximum(gap, 0.0), *_BANK_FADE_M)
            inside = inside + PORTAL_M + np.minimum(_COVER_SLOPE * deep, _COVER_M)
            within |= gap <= 0.0
        for bridge in self._structures("bridge"):
            deep = np.minimum(near.s - bridge.start, bridge.end - near.s)
            share = _rise(deep, 0.0, _VALLEY_SIDE_M)
            dry = 1.0 - share * _fall(away, *_VALLEY_FAR_M)
            outside = near.z + low + (outside - near.z - low) * dry
            outside = outside - np.minimum(np.maximum(deep, 0.0), _ABUTMENT_M) - VALLEY_M * share
            inside = np.where(deep > -_ABUTMENT_M, outside, inside)
        return outside, inside, within

    def _relief(self, x: Array, y: Array, away: Array) -> Array:
        """Return the height of undulations and hills at points at some distances from asphalt, m."""
        undulations, hills = _RELIEF[self.theme]
        undulating = undulations * _rise(away, *_UNDULATING_M) * self._wave(x, y, _UNDULATION_M)
        swing = _HILL_SWING * self._wave(x + _HILL_SHIFT_M, y, _HILL_M)
        return np.asarray(undulating + hills * _rise(away, *_HILLY_M) * (1.0 + swing))

    def _wave(self, x: Array, y: Array, size: float) -> Array:
        """Return smooth noise, -1 to 1, with a wavelength of about `size`."""
        u, v = x / size + _GRID_OFFSET, y / size + _GRID_OFFSET
        i, j = np.floor(u).astype(np.int64), np.floor(v).astype(np.int64)
        a, b = _rise(u - i, 0.0, 1.0), _rise(v - j, 0.0, 1.0)
        i0, i1, j0, j1 = i % _GRID, (i + 1) % _GRID, j % _GRID, (j + 1) % _GRID
        low = self._waves[i0, j0] * (1 - a) + self._waves[i1, j0] * a
        high = self._waves[i0, j1] * (1 - a) + self._waves[i1, j1] * a
        return np.asarray(low * (1 - b) + high * b, np.float64)

    # ------------------------------------------------------------------ squares

    def _corners(self) -> Array:
        """Return the squares as triangles with all columns that cutting needs."""
        net = Squares.around(self.ground, self._meeting, WIDE_M)
        points, order, held = net.triangles()
        near = self.ground.near(points[:, 0], points[:, 1])
        outside, inside, _ = self._heights(points[:, 0], points[:, 1])
        paved = near.paved
        if self.ground.kerbed and len(self._meeting):
            paved = np.minimum(
                paved, np.where(self._is_corner(points), near.asphalt - _CORNER_PAVED_M, paved)
            )
        columns = np.stack(
            [
                points[:, 0], points[:, 1], outside, near.asphalt, paved,
                np.zeros(len(points)), np.zeros(len(points)), near.s, inside,
            ],
            axis=1,
        )  # fmt: skip
        corners = columns[order]
        corners[:, :, _U : _V + 1] = net.local(points[order], held)
        return corners

    def _is_corner(self, points: Array) -> Mask:
        """Return which points are close enough to a junction to be paved all over."""
        square = (points[:, :1] - self._meeting[None, :, 0]) ** 2
        square += (points[:, 1:] - self._meeting[None, :, 1]) ** 2
        return np.asarray(square.min(axis=1) < _CORNER_M * _CORNER_M)

    # ------------------------------------------------------------------ surfaces

    def _surface(self, corners: Array, surface: str) -> tuple[Array, Array]:
        """Return the vertices and atlas coordinates of triangles of a colour or region."""
        points = corners[:, :, : _Z + 1].copy()
        points[:, :, _Z] += self.lift
        if surface in REGIONS:
            uv = region_uv(surface)
            low, high = uv[0], uv[2]
            uvs = low + np.clip(corners[:, :, _U : _V + 1], 0.0, 1.0) * (high - low)
        else:
            uvs = np.broadcast_to(swatch_uv(surface), (len(corners), 3, 2))
        return points.reshape(-1, 3), uvs.reshape(-1, 2)

    def _fields(self, corners: Array) -> list[tuple[Array, Array]]:
        middle = corners[:, :, : _Y + 1].mean(axis=1)
        i, j = (np.floor(middle / _FIELD_M).astype(np.int64) % _GRID).T
        crop = self._crops[i, j]
        return [self._surface(corners[crop == index], name) for index, name in enumerate(_CROPS)]


def _rise(value: Array, start: float, end: float) -> Array:
    """Return 0 below `start`, 1 above `end`, and a smooth ramp in between."""
    share = np.clip((value - start) / (end - start), 0.0, 1.0)
    return np.asarray(share * share * (3.0 - 2.0 * share), np.float64)


def _fall(value: Array, start: float, end: float) -> Array:
    """Return 1 below `start`, 0 above `end`, and a smooth ramp in between."""
    return 1.0 - _rise(value, start, end)


def _ditch(away: Array) -> Array:
    """Return the height of the ground beside a road without kerbs, by the distance from asphalt, m."""
    return -_DITCH_M * _rise(away, *_DITCH_NEAR_M) * _fall(away, *_DITCH_FAR_M)


def _meeting_points(ground: Ground) -> Array:
    """Return points along tight bends and paths through junctions, [n, 2]."""
    found = []
    for way in ground.ways:
        line, road = way.course, way.corridor
        bend = np.interp(line.s, road.s, np.abs(road.curvature))
        is_tight = bend > TIGHT
        if way.is_connecting:
            is_tight[:] = True
        is_tight |= np.interp(line.s, road.s, road.in_junction.astype(np.float64)) > 0.0
        for edge in (way.asphalt[0], way.asphalt[1]):
            points = line.points(edge)[is_tight]
            found.append(points[:, :2])
    every = np.concatenate(found)
    return np.asarray(np.unique(np.floor(every / _GAP + 0.5), axis=0) * _GAP)


def _walls(border: Array) -> tuple[Array, Array]:
    """Return the vertical faces of kerbs along a cut, facing the road."""
    p, q = border[:, 0, : _Z + 1], border[:, 1, : _Z + 1]
    length = np.sqrt(((p - q) ** 2).sum(axis=1))
    p, q = p[length > _SHORTEST_M], q[length > _SHORTEST_M]
    rise, sink = np.array([0.0, 0.0, KERB]), np.array([0.0, 0.0, KERB_FOOT])
    quads = np.stack([q + sink, p + sink, p + rise, q + rise], axis=1)
    points = quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    return points, np.broadcast_to(swatch_uv("kerb_side"), (len(points), 2)).copy()


def _mesh(vertices: Array, uvs: Array) -> Mesh:
    """Return triangles with flat shading as a mesh, without degenerate ones."""
    three = vertices.reshape(-1, 3, 3)
    normal = np.cross(three[:, 1] - three[:, 0], three[:, 2] - three[:, 0])
    length = np.sqrt((normal * normal).sum(axis=1))
    keep = length > _FLAT
    normal = normal[keep] / length[keep, None]
    return Mesh.loose(
        three[keep].reshape(-1, 3),
        np.repeat(normal, 3, axis=0),
        uvs.reshape(-1, 3, 2)[keep].reshape(-1, 2),
    )


def theme_of(road: RoadMap, corridor: Corridor) -> Theme:
    """Return the kind of land that a map's traits ask for."""
    for theme in get_args(Theme):
        if theme in road.traits:
            return cast("Theme", theme)
    return "urban" if any(strip.kind == "sidewalk" for strip in corridor.strips) else "rural"
