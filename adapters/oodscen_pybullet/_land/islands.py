"""Land enclosed by roads: the centre of a roundabout, refuges between lanes."""

from collections import deque
from dataclasses import dataclass

import numpy as np

from oodscen_pybullet._land.ground import Ground
from oodscen_pybullet._types import Array, Ints, Mask

_CELL = 1.0
_MARGIN = 24.0
_LARGEST_M = 60.0


@dataclass(frozen=True, eq=False)
class Islands:
    """Islands on a grid of squares."""

    corner: tuple[float, float]
    """x and y of the grid's corner, m."""
    cells: Mask
    """[columns, rows] True where a square lies on an island."""
    middles: tuple[tuple[float, float, float], ...]
    """x, y and radius of the largest circle on each island bigger than a refuge, m."""

    @classmethod
    def of(cls, ground: Ground, meeting: Array) -> "Islands":
        """Find the land that cannot be reached without crossing asphalt.

        Args:
            ground: The roads.
            meeting: [n, 2] points around which to look for islands, m.
        """
        if not len(meeting):
            return cls((0.0, 0.0), np.zeros((0, 0), bool), ())
        low, high = meeting.min(axis=0) - _MARGIN, meeting.max(axis=0) + _MARGIN
        columns, rows = (int(n) for n in np.ceil((high - low) / _CELL))
        if columns * rows > 400 * 400:
            return cls((0.0, 0.0), np.zeros((0, 0), bool), ())
        x = low[0] + (np.arange(columns) + 0.5) * _CELL
        y = low[1] + (np.arange(rows) + 0.5) * _CELL
        grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
        away = ground.near(grid[:, 0], grid[:, 1]).asphalt.reshape(columns, rows)
        land = away > 0.0
        names = np.zeros((columns, rows), np.int64)
        outer: set[int] = set()
        count = 0
        for i, j in np.argwhere(land).tolist():
            if names[i, j] == 0:
                count += 1
                if _fill(land, names, i, j, count):
                    outer.add(count)
        cells = land & ~np.isin(names, list(outer))
        middles = []
        for name in range(1, count + 1):
            inside = np.where((names == name) & cells, away, -1.0)
            best = float(inside.max())
            if name not in outer and 3.5 < best < _LARGEST_M:
                i, j = divmod(int(inside.argmax()), rows)
                middles.append((float(x[i]), float(y[j]), best))
        return cls((float(low[0]), float(low[1])), cells, tuple(middles))

    def covers(self, points: Array) -> Mask:
        """Return which points, [n, 2], lie on an island."""
        if not self.cells.size:
            return np.zeros(len(points), bool)
        place = np.floor((points - np.array(self.corner)) / _CELL).astype(np.int64)
        limit = np.array(self.cells.shape)
        inside = ((place >= 0) & (place < limit)).all(axis=1)
        place = np.clip(place, 0, limit - 1)
        return np.asarray(inside & self.cells[place[:, 0], place[:, 1]])


def _fill(land: Mask, names: Ints, i: int, j: int, name: int) -> bool:
    """Label a connected piece of land and return whether it reaches the edge of the grid."""
    columns, rows = land.shape
    names[i, j] = name
    queue = deque([(i, j)])
    is_outer = False
    while queue:
        a, b = queue.popleft()
        is_outer |= a in (0, columns - 1) or b in (0, rows - 1)
        for p, q in ((a + 1, b), (a - 1, b), (a, b + 1), (a, b - 1)):
            if 0 <= p < columns and 0 <= q < rows and land[p, q] and not names[p, q]:
                names[p, q] = name
                queue.append((p, q))
    return is_outer
