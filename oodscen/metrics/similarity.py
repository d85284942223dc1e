"""Cosines between sets of vectors, in blocks: memory stays bounded whatever the sizes."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_ROWS = 1024
_COLUMNS = 4096

Vectors = NDArray[np.float32]
"""[n, d] float32."""


@dataclass(frozen=True, eq=False)
class Extremes:
    """For each query the cosines to its nearest and farthest reference."""

    largest: NDArray[np.float64]
    """[n], in [-1, 1]."""
    smallest: NDArray[np.float64]
    """[n], in [-1, 1]."""
    nearest: NDArray[np.int64]
    """[n], row of the nearest reference; the first of equals."""


def unit(vectors: Vectors) -> Vectors:
    """Scale rows to unit length; a zero row stays zero, so its cosine to anything is 0."""
    lengths = np.sqrt(np.square(vectors, dtype=np.float64).sum(axis=1, keepdims=True))
    scaled = vectors / np.where(lengths > 0.0, lengths, 1.0)
    return np.ascontiguousarray(scaled, dtype=np.float32)


def extremes(
    queries: Vectors, references: Vectors, skip: NDArray[np.int64] | None = None
) -> Extremes:
    """Find the nearest and the farthest reference of each query.

    Args:
        queries: [n, d], rows of unit length or zero.
        references: [m, d], likewise.
        skip: [n], for each query the one reference that does not count (itself).
    """
    n = len(queries)
    largest, smallest = np.full(n, -np.inf), np.full(n, np.inf)
    nearest = np.zeros(n, np.int64)
    for rows, first, cosines in _blocks(queries, references):
        low = cosines
        if skip is not None:
            own = skip[rows] - first
            here = np.flatnonzero((own >= 0) & (own < cosines.shape[1]))
            low = cosines.copy()
            low[here, own[here]] = np.inf
            cosines[here, own[here]] = -np.inf
        best = cosines.argmax(axis=1)
        value = np.take_along_axis(cosines, best[:, None], axis=1)[:, 0]
        better = value > largest[rows]
        nearest[rows] = np.where(better, best + first, nearest[rows])
        largest[rows] = np.where(better, value, largest[rows])
        smallest[rows] = np.minimum(smallest[rows], low.min(axis=1))
    return Extremes(largest, smallest, nearest)


def _blocks(
    queries: Vectors, references: Vectors
) -> Iterator[tuple[slice, int, NDArray[np.float32]]]:
    for row in range(0, len(queries), _ROWS):
        rows = slice(row, min(row + _ROWS, len(queries)))
        for first in range(0, len(references), _COLUMNS):
            cosines = queries[rows] @ references[first : first + _COLUMNS].T
            yield rows, first, np.clip(cosines, -1.0, 1.0)
