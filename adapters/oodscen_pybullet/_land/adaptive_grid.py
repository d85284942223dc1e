"""A grid of squares over the land, refined along the edges of the roads."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from oodscen_pybullet._land.ground import Ground, Near
from oodscen_pybullet._types import Array, Ints, Mask

Distance = Callable[[Array, Array], Array]

_TOLERANCE_M = 0.04
"""Distance from the true edge of the roads above which a triangulation is refined, m; the smallest squares are not."""
_UNIT_M = 0.75
"""Side of the smallest squares, m: the unit of all sizes of squares."""
_ROOT = 128
"""Size of the largest squares, from which refinement starts."""
_COARSE = 8
"""Size of the squares at the roads before refinement."""
_WHOLE_TEXTURE = 8
"""Size of the smallest square that shows a whole texture."""
_SIZES = np.array([8.0, 16.0, 32.0, 64.0, 128.0])
_SIZES_END_M = np.array([0.5, 14.0, 50.0, 120.0])
"""Largest size of squares by their distance from the edge of the asphalt: each of the first ends at one of these, m."""
_CORNER_SIZE, _CORNER_M = 4.0, 7.0
_NEAR_CORNER_SIZE, _NEAR_CORNER_M = 8.0, 13.0
"""Largest sizes of squares at tight bends and junctions, and the distances from them at which these end, m."""
_SPAN_MARGIN_M, _SPAN_ASIDE_M = 40.0, 60.0
"""Distances along and beside the road of tunnels and bridges within which squares are at most `_COARSE`, m."""
_HALF_DIAGONAL = 0.7072
"""Half the diagonal of a square relative to its side, rounded up."""
_DEEP_M = 1.0
"""Depth below the edge of asphalt from which a square has no land, m."""
_UNSURE_M = 0.3
"""Distance from the asphalt's edge, beyond a square's corners, within which the square is checked, m."""
_SEARCH_STEPS = 8
_INSIDE_M = 0.01
"""Distance by which steps towards an edge overshoot it, m."""
_LATTICE = np.array(
    [(a, b, 4 - a - b) for a in range(5) for b in range(5 - a) if max(a, b, 4 - a - b) < 4],
    np.float64,
) / 4.0  # fmt: skip
"""Barycentric coordinates of the points of a triangle, without its corners, at which it is checked."""
_QUARTERS = np.array([0.25, 0.5, 0.75])
_LEAST_M = 1e-9
"""Least length of an edge by which a distance is divided, m."""
_LEAST_SHARE = 1e-6
"""Least share of an edge by which a coordinate is divided."""


@dataclass(frozen=True, eq=False)
class Squares:
    """Adjacent squares of several sizes."""

    left: Ints
    """[n] west edges, in units of `_UNIT_M`."""
    low: Ints
    """[n] south edges, in units."""
    sizes: Ints
    """[n] sizes in units, powers of two."""

    @classmethod
    def around(cls, ground: Ground, road_corners: Array, reach_m: float) -> "Squares":
        """Cover the land around the ego's road, except the interior of asphalt.

        Args:
            ground: The roads.
            road_corners: [n, 2] points along tight bends and paths through junctions, m.
            reach_m: Distance from the ego's road to the edge of the land, m.
        """
        cells, size = _root_cells(ground, reach_m), _ROOT
        corners, sizes = [], []
        while len(cells):
            is_land, is_split = _sorted_out(ground, road_corners, cells, size, reach_m)
            leaves = cells[is_land & ~is_split]
            corners.append(leaves)
            sizes.append(np.full(len(leaves), size))
            size //= 2
            quarters = np.array([[0, 0], [size, 0], [0, size], [size, size]])
            cells = (cells[is_split][:, None, :] + quarters).reshape(-1, 2)
        left, low = np.concatenate(corners).T
        return cls(left, low, np.concatenate(sizes))

    def triangles(self) -> tuple[Array, Ints, Ints]:
        """Return the points, [k, 2] m, the triangles as rows of points, [n, 3], and each one's square, [n].

        Squares include the corners of smaller neighbours, so the mesh has no cracks.
        """
        leaves = list(zip(self.left.tolist(), self.low.tolist(), self.sizes.tolist(), strict=True))
        rows_by_corner: dict[tuple[int, int], int] = {}
        for i, j, size in leaves:
            for corner in ((i, j), (i + size, j), (i, j + size), (i + size, j + size)):
                rows_by_corner.setdefault(corner, len(rows_by_corner))
        points: list[tuple[float, float]] = [(float(i), float(j)) for i, j in rows_by_corner]
        triangles: list[tuple[int, int, int]] = []
        owners: list[int] = []
        for owner, (i, j, size) in enumerate(leaves):
            ring: list[int] = []
            _follow(ring, rows_by_corner, i, j, size, 0)
            _follow(ring, rows_by_corner, i + size, j, 0, size)
            _follow(ring, rows_by_corner, i + size, j + size, -size, 0)
            _follow(ring, rows_by_corner, i, j + size, 0, -size)
            if len(ring) == 4:
                triangles += [(ring[0], ring[1], ring[2]), (ring[0], ring[2], ring[3])]
                owners += [owner, owner]
                continue
            hub = len(points)
            points.append((i + size / 2, j + size / 2))
            triangles += [(hub, a, b) for a, b in zip(ring, ring[1:] + ring[:1], strict=True)]
            owners += [owner] * len(ring)
        return np.array(points) * _UNIT_M, np.array(triangles, np.int64), np.array(owners, np.int64)

    def texture_coordinates(self, points: Array, owners: Ints) -> Array:
        """Return the place of triangles' corners, [n, 3, 2] m, in a texture that repeats with their squares, [n]."""
        tile = np.maximum(self.sizes[owners], _WHOLE_TEXTURE).astype(np.float64)
        corner = np.stack(
            [np.floor(self.left[owners] / tile), np.floor(self.low[owners] / tile)], axis=1
        )
        shift = (corner * tile[:, None])[:, None, :]
        return np.asarray((points / _UNIT_M - shift) / tile[:, None, None], np.float64)


def crossing(distance: Distance, one: Array, two: Array, first: Array, second: Array) -> Array:
    """Return how far along lines they cross an edge.

    From outside, each step is as long as the distance there, so it overshoots the edge by at most
    `_INSIDE_M`; where a line runs along the edge, bisection is faster.

    Args:
        distance: Returns the distance of points from the edge, m; its sign is exact.
        one: [n, 2] first ends of the lines.
        two: [n, 2] second ends.
        first: [n] distances at the first ends.
        second: [n] distances at the second ends, of opposite sign.

    Returns:
        [n] shares of each line, 0 to 1.
    """
    is_above = first > 0.0
    on, off = is_above.astype(np.float64), (~is_above).astype(np.float64)
    away = np.where(is_above, first, second)
    side = two - one
    length = np.sqrt((side * side).sum(axis=1))
    for step in range(_SEARCH_STEPS):
        if step % 2:
            at = off + 0.5 * (on - off)
        else:
            span_m = np.maximum(np.abs(on - off) * length, _LEAST_M)
            at = off + np.minimum((away + _INSIDE_M) / span_m, 1.0) * (on - off)
        value = distance(one[:, 0] + at * side[:, 0], one[:, 1] + at * side[:, 1])
        is_off = value > 0.0
        off, away = np.where(is_off, at, off), np.where(is_off, value, away)
        on = np.where(is_off, on, at)
    share = np.minimum(away / np.maximum(np.abs(on - off) * length, _LEAST_M), 1.0)
    return np.asarray(off + share * (on - off), np.float64)


def _root_cells(ground: Ground, reach_m: float) -> Ints:
    """Return the lower left corners of the largest squares around all roads, [n, 2]."""
    x = np.concatenate([way.course.x for way in ground.ways])
    y = np.concatenate([way.course.y for way in ground.ways])
    side_m = _ROOT * _UNIT_M
    i = np.arange(np.floor((x.min() - reach_m) / side_m), np.ceil((x.max() + reach_m) / side_m))
    j = np.arange(np.floor((y.min() - reach_m) / side_m), np.ceil((y.max() + reach_m) / side_m))
    grid = np.stack(np.meshgrid(i, j, indexing="ij"), axis=-1).reshape(-1, 2)
    return (grid * _ROOT).astype(np.int64)


def _sorted_out(
    ground: Ground, road_corners: Array, cells: Ints, size: int, reach_m: float
) -> tuple[Mask, Mask]:
    """Return which squares of a size have land, and which of those are too large."""
    middle = (cells.astype(np.float64) + size / 2.0) * _UNIT_M
    radius = size * _UNIT_M * _HALF_DIAGONAL
    near = ground.near(middle[:, 0], middle[:, 1])
    is_off_asphalt = near.asphalt > -radius - _DEEP_M
    is_land = is_off_asphalt | _is_spanned(ground, near.s, radius)
    is_land &= near.ego_asphalt < reach_m + radius
    is_split = is_land & (_largest_sizes(ground, road_corners, near, middle, radius) < size)
    if 1 < size <= _COARSE:
        is_at_edge = np.abs(near.asphalt) < radius + _UNSURE_M
        unsure = np.flatnonzero(is_land & ~is_split & is_at_edge)
        is_split[unsure] |= _misses(ground, cells[unsure], size, near.asphalt[unsure])
    return is_land, is_split


def _largest_sizes(
    ground: Ground, road_corners: Array, near: Near, middle: Array, radius: float
) -> Array:
    """Return the largest sizes allowed for squares of some radius around middles, [n, 2]."""
    away = np.maximum(np.abs(near.asphalt) - radius, 0.0)
    sizes = _SIZES[np.searchsorted(_SIZES_END_M, away)]
    sizes = np.minimum(sizes, _largest_at_corners(road_corners, middle, radius))
    is_at_span = _is_spanned(ground, near.s, radius + _SPAN_MARGIN_M)
    is_at_span &= near.ego_asphalt - radius < _SPAN_ASIDE_M
    return np.asarray(np.where(is_at_span, np.minimum(sizes, float(_COARSE)), sizes))


def _largest_at_corners(road_corners: Array, middle: Array, radius: float) -> Array:
    """Return the largest sizes allowed by the distance from tight bends and junctions."""
    if not len(road_corners):
        return np.full(len(middle), float(_ROOT))
    square = (middle[:, :1] - road_corners[None, :, 0]) ** 2
    square += (middle[:, 1:] - road_corners[None, :, 1]) ** 2
    gap = np.sqrt(square.min(axis=1)) - radius
    farther = np.where(gap < _NEAR_CORNER_M, _NEAR_CORNER_SIZE, float(_ROOT))
    return np.where(gap < _CORNER_M, _CORNER_SIZE, farther)


def _is_spanned(ground: Ground, s: Array, margin: float) -> Mask:
    """Return which places along the ego's road are in a tunnel, on a bridge, or within a margin of one."""
    spanned = np.zeros(len(s), bool)
    for structure in ground.corridor.structures:
        spanned |= (s > structure.start - margin) & (s < structure.end + margin)
    return spanned


def _follow(
    ring: list[int],
    rows_by_corner: dict[tuple[int, int], int],
    i: int,
    j: int,
    di: int,
    dj: int,
) -> None:
    """Add the first corner of a side and the corners of smaller neighbours along it."""
    half_i, half_j = di // 2, dj // 2
    if (di | dj) % 2 == 0 and (i + half_i, j + half_j) in rows_by_corner:
        _follow(ring, rows_by_corner, i, j, half_i, half_j)
        _follow(ring, rows_by_corner, i + half_i, j + half_j, half_i, half_j)
    else:
        ring.append(rows_by_corner[i, j])


def _misses(ground: Ground, cells: Ints, size: int, asphalt: Array) -> Mask:
    """Return which squares are too large for the road edges inside them.

    Args:
        ground: Measures the distance from the asphalt at any place.
        cells: [n, 2] lower left corners of the squares.
        size: Side of the squares, in the unit of `cells`.
        asphalt: [n] distance of their middles from the edge of the asphalt, m.
    """
    if not len(cells):
        return np.zeros(0, bool)
    square = np.array([[0, 0], [size, 0], [size, size], [0, size]])
    corners = (cells[:, None, :] + square).astype(np.float64) * _UNIT_M
    distances = ground.near(*corners.reshape(-1, 2).T).asphalt.reshape(-1, 4)
    diagonals = distances[:, [0, 1]] + distances[:, [2, 3]]
    bend = np.abs(diagonals - 2.0 * asphalt[:, None]).max(axis=1)
    rows = np.flatnonzero(bend > _TOLERANCE_M)
    halves = ([0, 1, 2], [0, 2, 3])
    is_off = _is_off(
        ground.asphalt,
        np.concatenate([corners[rows][:, half] for half in halves]),
        np.concatenate([distances[rows][:, half] for half in halves]),
    )
    is_missed = np.zeros(len(cells), bool)
    is_missed[rows] = is_off[: len(rows)] | is_off[len(rows) :]
    return is_missed


def _is_off(distance: Distance, corners: Array, distances: Array) -> Mask:
    """Return the triangles in which a straight cut misses the edge.

    Args:
        distance: Returns the distance from the edge.
        corners: [n, 3, 2]
        distances: [n, 3] distances at the corners.
    """
    if not len(corners):
        return np.zeros(0, bool)
    corners, distances, is_cut = _lone_corner_first(corners, distances)
    a, b, c = (corners[is_cut, k] for k in range(3))
    shares = crossing(
        distance,
        np.concatenate([a, a]),
        np.concatenate([b, c]),
        np.tile(distances[is_cut, 0], 2),
        np.concatenate([distances[is_cut, 1], distances[is_cut, 2]]),
    )
    ab, ac = np.split(shares, 2)
    points = (_LATTICE[None, :, :, None] * corners[:, None]).sum(axis=2)
    at_points = distance(*points.reshape(-1, 2).T).reshape(len(corners), -1)
    is_beyond = np.zeros(at_points.shape, bool)
    towards_b = _LATTICE[:, 1] / np.maximum(ab, _LEAST_SHARE)[:, None]
    towards_c = _LATTICE[:, 2] / np.maximum(ac, _LEAST_SHARE)[:, None]
    is_beyond[is_cut] = towards_b + towards_c > 1.0
    is_positive = (distances[:, :1] > 0.0) ^ is_beyond
    is_off = (((at_points > 0.0) != is_positive) & (np.abs(at_points) > _TOLERANCE_M)).any(axis=1)
    start, end = a + ab[:, None] * (b - a), a + ac[:, None] * (c - a)
    along_cut = start[:, None] + _QUARTERS[:, None] * (end - start)[:, None]
    on_cut = distance(*along_cut.reshape(-1, 2).T).reshape(-1, len(_QUARTERS))
    is_off[is_cut] |= (np.abs(on_cut) > _TOLERANCE_M).any(axis=1)
    return np.asarray(is_off)


def _lone_corner_first(corners: Array, distances: Array) -> tuple[Array, Array, Mask]:
    """Turn triangles so that the corner that is alone on its side of the edge comes first.

    Returns:
        The corners, their distances, and which triangles the edge cuts.
    """
    is_above = distances > 0.0
    count = is_above.sum(axis=1)
    is_lone = np.where((count == 1)[:, None], is_above, ~is_above)
    order = (is_lone.argmax(axis=1)[:, None] + np.arange(3)) % 3
    turned = np.take_along_axis(corners, order[:, :, None], axis=1)
    return turned, np.take_along_axis(distances, order, axis=1), (count == 1) | (count == 2)
