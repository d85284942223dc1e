"""The area covered by triangles seen from above, and the distance of points from it."""

from collections.abc import Iterator, Sequence

import numpy as np

from oodscen_pybullet._types import Array, Ints

REACH_M = 2.5
"""Upper limit of measured distances, m."""
_CELL_M = 2.5
"""Side of a grid cell, m; any length will do, and it need not be `REACH_M`."""
_BATCH = 150_000
"""Largest number of point-triangle pairs per batch."""
_LEAST_SQUARE = 1e-12
"""Least square of a side by which it is divided, m^2."""
_LEAST_AREA = 1e-6
"""Twice the area up to which a triangle is degenerate, m^2."""


class Cover:
    """The union of many triangles, indexed by a grid."""

    def __init__(self, triangles: Array) -> None:
        """Sort triangles into a grid.

        Args:
            triangles: [n, 3, 2] corners in either orientation, m; degenerate triangles are ignored.
        """
        self._corners = _oriented(triangles)
        self._sides = np.roll(self._corners, -1, axis=1) - self._corners
        square = (self._sides**2).sum(axis=2)
        self._inverse_square = 1.0 / np.maximum(square, _LEAST_SQUARE)
        low = np.floor((self._corners.min(axis=1) - REACH_M) / _CELL_M).astype(np.int64)
        high = np.floor((self._corners.max(axis=1) + REACH_M) / _CELL_M).astype(np.int64)
        self._low = low.min(axis=0) if len(low) else np.zeros(2, np.int64)
        self._rows = int(high[:, 1].max() - self._low[1] + 1) if len(low) else 1
        self._bucket(low, high)

    def _bucket(self, low: Ints, high: Ints) -> None:
        """List the triangles of every cell within reach of one.

        `_cells` are the numbers of those cells, ascending. The triangles of the k-th of them are `_counts[k]`
        entries of `_members`, from `_starts[k]` on.

        Args:
            low: [n, 2] column and row of the first cell within reach of each triangle.
            high: [n, 2] the same of the last one.
        """
        columns, rows = (high - low + 1).T
        owner, rank = _expanded(columns * rows)
        column = low[owner, 0] + rank % columns[owner] - self._low[0]
        row = low[owner, 1] + rank // columns[owner] - self._low[1]
        cell = column * self._rows + row
        order = np.argsort(cell, kind="stable")
        self._members = owner[order]
        self._cells, self._starts = np.unique(cell[order], return_index=True)
        self._counts = np.diff(np.append(self._starts, len(order)))

    def distance(self, x: Array, y: Array) -> Array:
        """Return the distance of points from the covered area: negative inside, at most `REACH_M`, m.

        It is exact outside, up to `REACH_M`. Inside, only the sign is meaningful, and it is 0 on edges between
        triangles.

        Args:
            x: [n], m
            y: [n], m
        """
        distances = np.full(len(x), REACH_M)
        first, count = self._candidates(x, y)
        for rows in _batches(count):
            distances[rows] = self._signed_distances(x[rows], y[rows], first[rows], count[rows])
        return distances

    def _candidates(self, x: Array, y: Array) -> tuple[Ints, Ints]:
        """Return where in `_members` the triangles within reach of each point start, and how many there are."""
        if not len(self._cells):
            return np.zeros(len(x), np.int64), np.zeros(len(x), np.int64)
        column = np.floor(x / _CELL_M).astype(np.int64) - self._low[0]
        row = np.floor(y / _CELL_M).astype(np.int64) - self._low[1]
        cell = column * self._rows + row
        index = np.minimum(np.searchsorted(self._cells, cell), len(self._cells) - 1)
        is_listed = (row >= 0) & (row < self._rows) & (self._cells[index] == cell)
        return self._starts[index], np.where(is_listed, self._counts[index], 0)

    def _signed_distances(self, x: Array, y: Array, first: Ints, count: Ints) -> Array:
        """Return the least signed distance per point, over its candidate triangles, m."""
        point, rank = _expanded(count)
        member = self._members[first[point] + rank]
        corner, side = self._corners[member], self._sides[member]
        dx, dy = x[point, None] - corner[:, :, 0], y[point, None] - corner[:, :, 1]
        ex, ey = side[:, :, 0], side[:, :, 1]
        inverse_square = self._inverse_square[member]
        cross = ex * dy - ey * dx
        along = np.clip((dx * ex + dy * ey) * inverse_square, 0.0, 1.0)
        px, py = dx - along * ex, dy - along * ey
        distance = np.sqrt((px * px + py * py).min(axis=1))
        distance = np.where((cross >= 0.0).all(axis=1), -distance, distance)
        starts = np.concatenate([[0], np.cumsum(count)[:-1]])
        return np.minimum(np.minimum.reduceat(distance, starts), REACH_M)


def band_triangles(edges: Sequence[tuple[Array, Array]]) -> Array:
    """Return bands between pairs of lines as triangles, [n, 3, 2].

    Args:
        edges: The right and left edges of each band, both [k, 2].
    """
    parts = []
    for right, left in edges:
        parts.append(np.stack([right[:-1], right[1:], left[1:]], axis=1))
        parts.append(np.stack([right[:-1], left[1:], left[:-1]], axis=1))
    return np.concatenate(parts) if parts else np.zeros((0, 3, 2))


def _oriented(triangles: Array) -> Array:
    """Return triangles counter-clockwise, without degenerate ones."""
    origin = triangles[:, 0]
    edge_ab, edge_ac = triangles[:, 1] - origin, triangles[:, 2] - origin
    area = edge_ab[:, 0] * edge_ac[:, 1] - edge_ab[:, 1] * edge_ac[:, 0]
    turned = np.where((area < 0.0)[:, None, None], triangles[:, [0, 2, 1]], triangles)
    oriented: Array = turned[np.abs(area) > _LEAST_AREA]
    return oriented


def _batches(count: Ints) -> Iterator[Ints]:
    """Yield the rows that have candidates, in batches of limited numbers of pairs."""
    rows = np.flatnonzero(count)
    if not len(rows):
        return
    ends = np.cumsum(count[rows])
    splits = np.searchsorted(ends, np.arange(_BATCH, int(ends[-1]), _BATCH))
    yield from (batch for batch in np.split(rows, np.unique(splits)) if len(batch))


def _expanded(count: Ints) -> tuple[Ints, Ints]:
    """Repeat each owner by its count, and return it with a running index 0, 1, 2, ... per owner."""
    owner = np.repeat(np.arange(len(count)), count)
    return owner, np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
