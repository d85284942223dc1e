"""Land enclosed by roads: the centre of a roundabout, refuges between lanes."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from oodscen_pybullet._land.ground import Ground
from oodscen_pybullet._types import Array, Ints, Mask

_CELL_M = 1.0
"""Side of a square of the grid, m."""
_MARGIN_M = 24.0
"""Land searched around the corners of roads, m."""
_MOST_CELLS = 400 * 400
"""Cells of the grid above which no islands are sought."""
_REFUGE_M = 3.5
"""Largest radius of a refuge: nothing is planted on it, m."""
_LARGEST_M = 60.0
"""Radius from which enclosed land is no island but countryside, m."""

Circle = tuple[float, float, float]
"""x, y and radius, m."""


@dataclass(frozen=True, eq=False)
class Islands:
    """Islands on a grid of squares."""

    corner: tuple[float, float]
    """x and y of the grid's corner, m."""
    cells: Mask
    """[columns, rows] True where a square lies on an island."""
    circles: tuple[Circle, ...]
    """The largest circle on each island bigger than a refuge."""

    @classmethod
    def of(cls, ground: Ground, road_corners: Array) -> Self:
        """Find the land, short of countryside, that cannot be reached without crossing asphalt.

        Args:
            ground: The roads.
            road_corners: [n, 2] points along tight bends and paths through junctions, around which to look, m.
        """
        if not len(road_corners):
            return cls._empty()
        low, high = road_corners.min(axis=0) - _MARGIN_M, road_corners.max(axis=0) + _MARGIN_M
        columns, rows = (int(n) for n in np.ceil((high - low) / _CELL_M))
        if columns * rows > _MOST_CELLS:
            return cls._empty()
        x = low[0] + (np.arange(columns) + 0.5) * _CELL_M
        y = low[1] + (np.arange(rows) + 0.5) * _CELL_M
        grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
        away = ground.near(grid[:, 0], grid[:, 1]).asphalt.reshape(columns, rows)
        labels, enclosed = _enclosed(away > 0.0)
        islands, circles = [], []
        for label in enclosed:
            radii = np.where(labels == label, away, -1.0)
            radius = float(radii.max())
            if radius >= _LARGEST_M:
                continue
            islands.append(label)
            if radius > _REFUGE_M:
                i, j = divmod(int(radii.argmax()), rows)
                circles.append((float(x[i]), float(y[j]), radius))
        return cls((float(low[0]), float(low[1])), np.isin(labels, islands), tuple(circles))

    @classmethod
    def _empty(cls) -> Self:
        return cls((0.0, 0.0), np.zeros((0, 0), bool), ())

    def covers(self, points: Array) -> Mask:
        """Return which points, [n, 2], lie on an island."""
        if not self.cells.size:
            return np.zeros(len(points), bool)
        cell = np.floor((points - np.array(self.corner)) / _CELL_M).astype(np.int64)
        counts = np.array(self.cells.shape)
        is_on_grid = ((cell >= 0) & (cell < counts)).all(axis=1)
        column, row = np.clip(cell, 0, counts - 1).T
        return np.asarray(is_on_grid & self.cells[column, row])


def _enclosed(land: Mask) -> tuple[Ints, list[int]]:
    """Return the label of every square's piece of land, and the labels of pieces that miss the grid's edge.

    Pieces are connected by whole sides and listed in the order of their first square; asphalt has the label 0.
    """
    import cv2

    _, labels = cv2.connectedComponents(land.astype(np.uint8), connectivity=4)
    pieces, first = np.unique(labels, return_index=True)
    rim = np.concatenate([labels[0], labels[-1], labels[:, 0], labels[:, -1]])
    outer = {0, *rim.tolist()}
    ordered = pieces[np.argsort(first)].tolist()
    return labels.astype(np.int64), [label for label in ordered if label not in outer]
