"""The mesh of the ground beside the roads: kerbs, pavements, lawns and fields, out to the hills.

The land is a grid of squares, small at the roads and large far away. It is cut along lines of equal distance
from the asphalt, so any road network gets kerbs that follow its corners, and no holes.
"""

from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np

from oodscen.driving._roads.corridor import Structure
from oodscen_pybullet._land.adaptive_grid import Squares, crossing
from oodscen_pybullet._land.ground import Ground, Near
from oodscen_pybullet._land.islands import Islands
from oodscen_pybullet._land.relief import KERB_HEIGHT_M, Relief
from oodscen_pybullet._land.theme import Theme
from oodscen_pybullet._meshes.atlas import REGIONS, region_uv, swatch_uv
from oodscen_pybullet._meshes.mesh import Mesh
from oodscen_pybullet._rendering.clipping import cut
from oodscen_pybullet._types import Array, Ints

KERB_FOOT_M = -0.03
"""Height of the foot of a kerb's side above the road, m: below it, so that no gap shows."""
WIDE_M = 215.0
"""Distance from the ego's road to the edge of the ground, m."""

_X, _Y, _Z, _ASPHALT, _PAVED, _U, _V, _S = range(8)
"""Columns of a corner: its place, its distances from asphalt and pavements, its place in its square, and its s along
the ego's road."""
_KERB_TOP_M = 0.18
"""Width of the top of a kerb, m."""
_ISLAND_RIM_M = 1.6
"""Width of the paved edge of an island, m."""
_CORNER_M, _CORNER_PAVED_M = 9.0, 2.4
"""Distance from tight bends and junctions within which the ground is paved, and how far from the asphalt, m."""
_DECK_END_M = 10.0
"""Length at each end of a bridge below which the ground is cut at the road's edge, m."""
_DECK_EDGE_M = 0.46
"""Distance from pavements of that cut, m."""
_ROOFED_M = 20.0
"""Least distance from asphalt that the ground above tunnels and below bridges counts with, m."""
_FIELD_M = (72.0, 48.0)
"""Extent of a field, m."""
_FIELDS = 64
"""Rows and columns after which fields repeat."""
_CROPS = ("field", "grass", "grass_dark", "field", "earth", "grass")
_SHORTEST_M = 1e-4
"""Length of an edge up to which a face is left out, m."""
_NO_AREA_M2 = 1e-4
"""Twice the area up to which a triangle is left out, m^2."""
_FARTHEST_M = 1e9
"""Distance that no ground exceeds, m."""


class _GroundBand(NamedTuple):
    """The material of the ground up to a distance from pavements."""

    reach: float
    """The distance, m."""
    surface: str | None
    """A colour or region of the atlas; `None` for fields, each with its crop."""


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
        _GroundBand(90.0, None),
        _GroundBand(_FARTHEST_M, "hill"),
    ),
    "rural": (_GroundBand(9.0, "turf"), _GroundBand(110.0, None), _GroundBand(_FARTHEST_M, "hill")),
}


class _Piece(NamedTuple):
    """Triangles of one material."""

    vertices: Array
    """[3 n, 3]"""
    uvs: Array
    """[3 n, 2] coordinates in the atlas."""


@dataclass(frozen=True, eq=False)
class Land:
    """The ground beside roads, as it is cut and surfaced; corners are [triangles, 3, columns]."""

    relief: Relief
    road_corners: Array
    """[n, 2] points along tight bends and paths through junctions."""
    islands: Islands
    crops: Ints
    """[_FIELDS, _FIELDS] the crop of each field, an index."""

    @classmethod
    def drawn(
        cls, relief: Relief, road_corners: Array, islands: Islands, rng: np.random.Generator
    ) -> Self:
        """Draw the fields."""
        return cls(relief, road_corners, islands, rng.integers(0, len(_CROPS), (_FIELDS, _FIELDS)))

    @property
    def _ground(self) -> Ground:
        return self.relief.ground

    def mesh(self) -> Mesh:
        """Return the ground with its kerbs."""
        in_open, spanned = self._split_at_structures(self._corners())
        land, border = self._beside_asphalt(in_open)
        pieces = []
        if self._ground.has_kerb:
            pieces.append(_kerb_sides(border))
            kerbed, land = self._kerbed(land)
            pieces += kerbed
        pieces += self._banded(np.concatenate([land, spanned]))
        vertices = np.concatenate([piece.vertices for piece in pieces])
        return _flat_shaded(vertices, np.concatenate([piece.uvs for piece in pieces]))

    def _corners(self) -> Array:
        """Return the squares as triangles with all columns that cutting needs."""
        squares = Squares.around(self._ground, self.road_corners, WIDE_M)
        points, triangles, owners = squares.triangles()
        x, y = points[:, 0], points[:, 1]
        near = self._ground.near(x, y)
        z, zero = self.relief.heights(x, y).beside, np.zeros(len(points))
        columns = [x, y, z, near.asphalt, self._paved(points, near), zero, zero, near.s]
        corners = np.stack(columns, axis=1)[triangles]
        corners[:, :, _U : _V + 1] = squares.texture_coordinates(points[triangles], owners)
        return corners

    def _paved(self, points: Array, near: Near) -> Array:
        """Return the distance of points, [n, 2], from what is paved, m: also all that is close to a kerbed corner."""
        if not (self._ground.has_kerb and len(self.road_corners)):
            return near.paved
        squares = (points[:, :1] - self.road_corners[None, :, 0]) ** 2
        squares += (points[:, 1:] - self.road_corners[None, :, 1]) ** 2
        is_corner = squares.min(axis=1) < _CORNER_M * _CORNER_M
        at_corner = np.minimum(near.paved, near.asphalt - _CORNER_PAVED_M)
        return np.asarray(np.where(is_corner, at_corner, near.paved))

    def _split_at_structures(self, corners: Array) -> tuple[Array, Array]:
        """Split the ground at tunnels and bridges: the part in the open, and the one that a structure spans.

        Heights are recomputed along the cuts because they cannot be interpolated there from the corners of
        the squares.
        """
        in_open, spanned_parts = corners, [corners[:0]]
        for structure in self._ground.corridor.structures:
            split = _below_bridge if structure.kind == "bridge" else _above_tunnel
            in_open, within = split(in_open, structure)
            spanned_parts += within
        spanned = np.concatenate(spanned_parts)
        if len(spanned):
            in_open[:, :, _Z] = self.relief.heights(*_flat_places(in_open)).beside.reshape(-1, 3)
            spanned[:, :, _Z] = self.relief.heights(*_flat_places(spanned)).across.reshape(-1, 3)
            spanned[:, :, _ASPHALT] = np.maximum(spanned[:, :, _ASPHALT], _ROOFED_M)
            spanned[:, :, _PAVED] = spanned[:, :, _ASPHALT]
        return in_open, spanned

    def _beside_asphalt(self, in_open: Array) -> tuple[Array, Array]:
        """Cut off what lies below asphalt; return the land, and the edges along the cut."""
        _, land, border = cut(in_open, _ASPHALT, 0.0, self._edge_of_asphalt)
        is_edge = land[:, :, _ASPHALT] <= 0.0
        points = land[is_edge][:, : _Y + 1]
        near = self._ground.near(points[:, 0], points[:, 1])
        land[is_edge, _PAVED] = np.minimum(self._paved(points, near), 0.0)
        return land, border

    def _edge_of_asphalt(self, starts: Array, ends: Array) -> Array:
        """Return how far along the lines between two rows of corners the edge of the asphalt is."""
        return crossing(
            self._ground.asphalt,
            starts[:, : _Y + 1],
            ends[:, : _Y + 1],
            starts[:, _ASPHALT],
            ends[:, _ASPHALT],
        )

    def _kerbed(self, land: Array) -> tuple[list[_Piece], Array]:
        """Split off kerbs, islands and pavements; return them and the rest of the land."""
        kerb, land, _ = cut(land, _ASPHALT, _KERB_TOP_M)
        is_island = self.islands.covers(land[:, :, : _Y + 1].mean(axis=1))
        island, land = land[is_island], land[~is_island]
        rim, lawn, _ = cut(island, _ASPHALT, _ISLAND_RIM_M)
        paved, land, _ = cut(land, _PAVED, 0.0)
        surfaces = ((kerb, "kerb"), (rim, "paving"), (lawn, "turf"), (paved, "paving"))
        return [self._surfaced(corners, surface) for corners, surface in surfaces], land

    def _banded(self, land: Array) -> list[_Piece]:
        """Surface the land by its distance from pavements."""
        pieces = []
        for band in _BANDS[self.relief.theme]:
            within, land, _ = cut(land, _PAVED, band.reach)
            if band.surface is None:
                pieces += self._fields(within)
            else:
                pieces.append(self._surfaced(within, band.surface))
        return pieces

    def _fields(self, corners: Array) -> list[_Piece]:
        """Surface land with fields."""
        middle = corners[:, :, : _Y + 1].mean(axis=1)
        i, j = (np.floor(middle / _FIELD_M).astype(np.int64) % _FIELDS).T
        crop = self.crops[i, j]
        return [self._surfaced(corners[crop == index], name) for index, name in enumerate(_CROPS)]

    def _surfaced(self, corners: Array, surface: str) -> _Piece:
        """Return triangles with a colour or a region, at their height above the asphalt."""
        points = corners[:, :, : _Z + 1].copy()
        points[:, :, _Z] += self.relief.lift
        if surface in REGIONS:
            uv = region_uv(surface)
            low, high = uv[0], uv[2]
            uvs = low + np.clip(corners[:, :, _U : _V + 1], 0.0, 1.0) * (high - low)
        else:
            uvs = np.broadcast_to(swatch_uv(surface), (len(corners), 3, 2))
        return _Piece(points.reshape(-1, 3), uvs.reshape(-1, 2))


def _above_tunnel(land: Array, tunnel: Structure) -> tuple[Array, list[Array]]:
    """Split land at the ends of a tunnel: the part in the open, and the one above it."""
    before, rest, _ = cut(land, _S, tunnel.start)
    above, after, _ = cut(rest, _S, tunnel.end)
    return np.concatenate([before, after]), [above]


def _below_bridge(land: Array, bridge: Structure) -> tuple[Array, list[Array]]:
    """Split land at the ends of a bridge: the part in the open, and the one below it.

    Near its ends, where the deck is close to the ground, there is none below the deck.
    """
    before, rest, _ = cut(land, _S, bridge.start)
    first, rest, _ = cut(rest, _S, bridge.start + _DECK_END_M)
    middle, rest, _ = cut(rest, _S, bridge.end - _DECK_END_M)
    last, after, _ = cut(rest, _S, bridge.end)
    beside = [cut(end, _PAVED, _DECK_EDGE_M)[1] for end in (first, last)]
    return np.concatenate([before, after]), [beside[0], middle, beside[1]]


def _flat_places(corners: Array) -> tuple[Array, Array]:
    """Return x and y of all corners."""
    return corners[:, :, _X].reshape(-1), corners[:, :, _Y].reshape(-1)


def _kerb_sides(border: Array) -> _Piece:
    """Return the vertical faces of kerbs along a cut, facing the road."""
    p, q = border[:, 0, : _Z + 1], border[:, 1, : _Z + 1]
    length = np.sqrt(((p - q) ** 2).sum(axis=1))
    p, q = p[length > _SHORTEST_M], q[length > _SHORTEST_M]
    rise, sink = np.array([0.0, 0.0, KERB_HEIGHT_M]), np.array([0.0, 0.0, KERB_FOOT_M])
    quads = np.stack([q + sink, p + sink, p + rise, q + rise], axis=1)
    points = quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    return _Piece(points, np.broadcast_to(swatch_uv("kerb_side"), (len(points), 2)).copy())


def _flat_shaded(vertices: Array, uvs: Array) -> Mesh:
    """Return triangles with flat shading as a mesh, without degenerate ones."""
    corners = vertices.reshape(-1, 3, 3)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.sqrt((normal * normal).sum(axis=1))
    keep = length > _NO_AREA_M2
    normal = normal[keep] / length[keep, None]
    return Mesh.loose(
        corners[keep].reshape(-1, 3),
        np.repeat(normal, 3, axis=0),
        uvs.reshape(-1, 3, 2)[keep].reshape(-1, 2),
    )
