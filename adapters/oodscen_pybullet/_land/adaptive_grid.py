"""A grid of squares over the land, refined along the edges of the roads."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from oodscen_pybullet._land.ground import Ground
from oodscen_pybullet._types import Array, Ints, Mask

Distance = Callable[[Array, Array], Array]

TOLERANCE = 0.04
"""Largest distance between the true edge of the roads and its triangulation, m."""
_UNIT = 0.75
_ROOT = 128
_COARSE = 8
"""Size of the squares at the roads before refinement, in units."""
_PRINT = 8
"""Size of the smallest square that shows a whole texture, in units."""
_SEARCH = 8
_INSIDE = 0.01
"""Distance by which steps towards an edge overshoot it, m."""
_LATTICE = np.array(
    [(a, b, 4 - a - b) for a in range(5) for b in range(5 - a) if max(a, b, 4 - a - b) < 4],
    np.float64,
) / 4.0  # fmt: skip
_QUARTERS = np.array([0.25, 0.5, 0.75])
_LEAST_M = 1e-9
"""Least length of an edge by which a distance is divided, m."""
_LEAST_SHARE = 1e-6
"""Least share of an edge by which a coordinate is divided."""


@dataclass(frozen=True, eq=False)
class Squares:
    """Adjacent squares of several sizes."""

    left: Ints
    """[n] west edges, in units."""
    low: Ints
    """[n] south edges, in units."""
    sizes: Ints
    """[n] sizes in units, powers of two."""

    @classmethod
    def around(cls, ground: Ground, road_corners: Array, wide: float) -> "Squares":
        """Cover the land around the ego's road, except the interior of asphalt.

        Args:
            ground: The roads.
            road_corners: [n, 2] points along tight bends and paths through junctions, m.
            wide: Distance from the ego's road to the edge of the land, m.
        """
        x = np.concatenate([way.course.x for way in ground.ways])
        y = np.concatenate([way.course.y for way in ground.ways])
        root = _ROOT * _UNIT
        i = np.arange(np.floor((x.min() - wide) / root), np.ceil((x.max() + wide) / root))
        j = np.arange(np.floor((y.min() - wide) / root), np.ceil((y.max() + wide) / root))
        grid = np.stack(np.meshgrid(i, j, indexing="ij"), axis=-1).reshape(-1, 2)
        cells, size = (grid * _ROOT).astype(np.int64), _ROOT
        found: list[tuple[Ints, int]] = []
        while len(cells):
            middle = (cells.astype(np.float64) + size / 2.0) * _UNIT
            radius = size * _UNIT * 0.7072
            near = ground.near(middle[:, 0], middle[:, 1])
            away = np.maximum(np.abs(near.asphalt) - radius, 0.0)
            keep = (near.asphalt > -radius - 1.0) & (near.ego_asphalt < wide + radius)
            keep |= _is_spanned(ground, near.s, radius) & (near.ego_asphalt < wide + radius)
            steps = np.searchsorted(np.array([0.5, 14.0, 50.0, 120.0]), away)
            wanted = np.array([8.0, 16.0, 32.0, 64.0, 128.0])[steps]
            wanted = np.minimum(wanted, _finest(road_corners, middle, radius))
            is_long = _is_spanned(ground, near.s, radius + 40.0) & (
                near.ego_asphalt - radius < 60.0
            )
            wanted = np.where(is_long, np.minimum(wanted, float(_COARSE)), wanted)
            split = keep & (wanted < size)
            if size <= _COARSE:
                unsure = np.flatnonzero(keep & ~split & (np.abs(near.asphalt) < radius + 0.3))
                if size > 1:
                    split[unsure] |= _misses(ground, cells[unsure], size, near.asphalt[unsure])
            found.append((cells[keep & ~split], size))
            size //= 2
            quarters = np.array([[0, 0], [size, 0], [0, size], [size, size]])
            cells = (cells[split][:, None, :] + quarters).reshape(-1, 2)
        corners = np.concatenate([some for some, _ in found])
        sizes = np.concatenate([np.full(len(some), size) for some, size in found])
        return cls(corners[:, 0], corners[:, 1], sizes)

    def triangles(self) -> tuple[Array, Ints, Ints]:
        """Return the points, [k, 2] m, the triangles as rows of points, [n, 3], and each one's square, [n].

        Squares include the corners of smaller neighbours, so the mesh has no cracks.
        """
        leaves = list(zip(self.left.tolist(), self.low.tolist(), self.sizes.tolist(), strict=True))
        names: dict[tuple[int, int], int] = {}
        for i, j, size in leaves:
            for place in ((i, j), (i + size, j), (i, j + size), (i + size, j + size)):
                names.setdefault(place, len(names))
        places: list[tuple[float, float]] = [(float(i), float(j)) for i, j in names]
        rows: list[tuple[int, int, int]] = []
        owners: list[int] = []
        for owner, (i, j, size) in enumerate(leaves):
            ring: list[int] = []
            _follow(ring, names, i, j, size, 0)
            _follow(ring, names, i + size, j, 0, size)
            _follow(ring, names, i + size, j + size, -size, 0)
            _follow(ring, names, i, j + size, 0, -size)
            if len(ring) == 4:
                rows += [(ring[0], ring[1], ring[2]), (ring[0], ring[2], ring[3])]
                owners += [owner, owner]
                continue
            places.append((i + size / 2, j + size / 2))
            hub = len(places) - 1
            rows += [(hub, a, b) for a, b in zip(ring, ring[1:] + ring[:1], strict=True)]
            owners += [owner] * len(ring)
        return np.array(places) * _UNIT, np.array(rows, np.int64), np.array(owners, np.int64)

    def local(self, points: Array, owners: Ints) -> Array:
        """Return the texture coordinates of points, [n, 3, 2], in a texture that repeats with the squares."""
        tile = np.maximum(self.sizes[owners], _PRINT).astype(np.float64)
        corner = np.stack(
            [np.floor(self.left[owners] / tile), np.floor(self.low[owners] / tile)], axis=1
        )
        shift = (corner * tile[:, None])[:, None, :]
        return np.asarray((points / _UNIT - shift) / tile[:, None, None], np.float64)


def crossing(distance: Distance, one: Array, two: Array, first: Array, second: Array) -> Array:
    """Return the points where lines cross an edge.

    Args:
        distance: Returns the distance of points from the edge, m; its sign is exact.
        one: [n, 2] first ends of the lines.
        two: [n, 2] second ends.
        first: [n] distances at the first ends.
        second: [n] distances at the second ends, of opposite sign.

    Returns:
        [n] fractions along each line, 0 to 1.

    From outside, each step is as long as the distance there, so it overshoots the edge by at most
    `_INSIDE`; where a line runs along the edge, bisection is faster.
    """
    is_above = first > 0.0
    on, off = is_above.astype(np.float64), (~is_above).astype(np.float64)
    away = np.where(is_above, first, second)
    side = two - one
    length = np.sqrt((side * side).sum(axis=1))
    for step in range(_SEARCH):
        share = (
            0.5
            if step % 2
            else np.minimum((away + _INSIDE) / np.maximum(np.abs(on - off) * length, _LEAST_M), 1.0)
        )
        at = off + share * (on - off)
        value = distance(one[:, 0] + at * side[:, 0], one[:, 1] + at * side[:, 1])
        is_off = value > 0.0
        off, away = np.where(is_off, at, off), np.where(is_off, value, away)
        on = np.where(is_off, on, at)
    share = np.minimum(away / np.maximum(np.abs(on - off) * length, _LEAST_M), 1.0)
    return np.asarray(off + share * (on - off), np.float64)


def _finest(road_corners: Array, middle: Array, radius: float) -> Array:
    """Return the largest size of squares allowed near tight bends and junctions, in units."""
    if not len(road_corners):
        return np.full(len(middle), float(_ROOT))
    square = (middle[:, :1] - road_corners[None, :, 0]) ** 2
    square += (middle[:, 1:] - road_corners[None, :, 1]) ** 2
    gap = np.sqrt(square.min(axis=1)) - radius
    return np.where(gap < 7.0, 4.0, np.where(gap < 13.0, 8.0, float(_ROOT)))


def _is_spanned(ground: Ground, s: Array, margin: float) -> Mask:
    spanned = np.zeros(len(s), bool)
    for structure in ground.corridor.structures:
        spanned |= (s > structure.start - margin) & (s < structure.end + margin)
    return spanned


def _follow(
    ring: list[int], names: dict[tuple[int, int], int], i: int, j: int, di: int, dj: int
) -> None:
    """Add the first corner of a side and the corners of smaller neighbours along it."""
    half_i, half_j = di // 2, dj // 2
    if (di | dj) % 2 == 0 and (i + half_i, j + half_j) in names:
        _follow(ring, names, i, j, half_i, half_j)
        _follow(ring, names, i + half_i, j + half_j, half_i, half_j)
    else:
        ring.append(names[i, j])


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
    around = np.array([[0, 0], [size, 0], [size, size], [0, size]])
    corners = (cells[:, None, :] + around).astype(np.float64) * _UNIT
    value = ground.near(*corners.reshape(-1, 2).T).asphalt.reshape(-1, 4)
    bend = np.abs(value[:, [0, 1]] + value[:, [2, 3]] - 2.0 * asphalt[:, None]).max(axis=1)
    rows = np.flatnonzero(bend > TOLERANCE)
    three = np.concatenate([corners[rows][:, [0, 1, 2]], corners[rows][:, [0, 2, 3]]])
    values = np.concatenate([value[rows][:, [0, 1, 2]], value[rows][:, [0, 2, 3]]])
    bad = _is_off(ground.asphalt, three, values)
    missed = np.zeros(len(cells), bool)
    missed[rows] = bad[: len(rows)] | bad[len(rows) :]
    return missed


def _is_off(distance: Distance, corners: Array, values: Array) -> Mask:
    """Return the triangles in which a straight cut misses the edge.

    Args:
        distance: Returns the distance from the edge.
        corners: [n, 3, 2]
        values: [n, 3] distances at the corners.
    """
    if not len(corners):
        return np.zeros(0, bool)
    is_above = values > 0.0
    count = is_above.sum(axis=1)
    lone = np.where((count == 1)[:, None], is_above, ~is_above)
    turned = (lone.argmax(axis=1)[:, None] + np.arange(3)) % 3
    three = np.take_along_axis(corners, turned[:, :, None], axis=1)
    value = np.take_along_axis(values, turned, axis=1)
    tip = value[:, 0] > 0.0
    places = (_LATTICE[None, :, :, None] * three[:, None]).sum(axis=2)
    found = distance(*places.reshape(-1, 2).T).reshape(len(three), -1)
    is_cut = (count == 1) | (count == 2)
    rows = np.flatnonzero(is_cut)
    a, b, c = (three[rows, k] for k in range(3))
    shares = crossing(
        distance,
        np.concatenate([a, a]),
        np.concatenate([b, c]),
        np.tile(value[rows, 0], 2),
        np.concatenate([value[rows, 1], value[rows, 2]]),
    )
    p, q = shares[: len(rows)], shares[len(rows) :]
    beyond = np.zeros(found.shape, bool)
    u = _LATTICE[:, 1] / np.maximum(p, _LEAST_SHARE)[:, None]
    v = _LATTICE[:, 2] / np.maximum(q, _LEAST_SHARE)[:, None]
    beyond[rows] = u + v > 1.0
    expected = tip[:, None] ^ beyond
    bad = (((found > 0.0) != expected) & (np.abs(found) > TOLERANCE)).any(axis=1)
    one, two = a + p[:, None] * (b - a), a + q[:, None] * (c - a)
    along = one[:, None] + _QUARTERS[:, None] * (two - one)[:, None]
    off = distance(*along.reshape(-1, 2).T).reshape(-1, len(_QUARTERS))
    bad[rows] |= (np.abs(off) > TOLERANCE).any(axis=1)
    return np.asarray(bad)
