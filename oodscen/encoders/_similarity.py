"""Cosines between sets of vectors, computed in blocks so that memory stays bounded.

The search is exact: it compares every pair, in float32, and values agree with float64 to 1e-5. A
block of cosines is at most 16 MB. References may lie on disk and are read once, in order.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

_ROWS = 4096
"""Queries of a block of cosines."""
_COLUMNS = 1024
"""References of a block with as many queries; one with fewer queries has more, up to `_MOST_COLUMNS`."""
_MOST_COLUMNS = 16_384
_GROUP = 64
"""Rows whose largest cosine is found before the row of it is."""
TIE = np.float32(5e-7)
"""Cosines that differ by less are equally near: their last bits depend on what else is multiplied with them."""

Vectors = NDArray[np.float32]
"""[n, d] float32."""


class Rows(Protocol):
    """Vectors that can be read a slice at a time: an array, a memory map, or a file's reader."""

    def __len__(self) -> int:
        """Return the number of rows."""
        ...

    def __getitem__(self, rows: slice, /) -> Vectors:
        """Return a slice of the rows, each of unit length or zero."""
        ...


@dataclass(frozen=True, eq=False)
class Nearest:
    """The nearest reference of each query."""

    cosine: NDArray[np.float64]
    """[n], in [-1, 1]."""
    index: NDArray[np.int64]
    """[n], row of the nearest reference; the first of several equally near."""


def unit(vectors: Vectors) -> Vectors:
    """Return rows scaled to unit length; a zero row stays zero, so its cosine to anything is 0."""
    lengths = np.sqrt(np.square(vectors, dtype=np.float64).sum(axis=1, keepdims=True))
    scaled = vectors / np.where(lengths > 0.0, lengths, 1.0)
    return np.ascontiguousarray(scaled, dtype=np.float32)


def nearest(queries: Vectors, references: Rows) -> Nearest:
    """Return the nearest reference of each query; both are [., d] rows of unit length or zero."""
    best = _Best(len(queries))
    for rows, first, cosines in _blocks(queries, references):
        best.offer(rows.start, first, cosines)
    return best.nearest()


def nearest_other(vectors: Vectors) -> Nearest:
    """Return, for each row, the nearest other row of the same set; needs at least two rows.

    The cosine of a pair is computed once and used for both rows, which halves the work of `nearest`.
    """
    best = _Best(len(vectors))
    buffer = np.empty(_ROWS * _COLUMNS, np.float32)
    for first in range(0, len(vectors), _COLUMNS):
        block = vectors[first : first + _COLUMNS]
        last = first + len(block)
        for row in range(0, last, _ROWS):
            panel = vectors[row : min(row + _ROWS, last)]
            cosines = _cosines(panel, block, buffer)
            shared = np.arange(max(row, first), row + len(panel))
            cosines[shared - row, shared - first] = -np.inf
            best.offer_columns(first, row, cosines)
            best.offer(row, first, cosines[: max(first - row, 0)])
    return best.nearest()


def smallest(queries: Vectors, references: Rows) -> NDArray[np.float64]:
    """Return the cosine of each query to its farthest reference: [n], in [-1, 1]."""
    least = np.full(len(queries), np.inf, np.float32)
    for rows, _, cosines in _blocks(queries, references):
        np.minimum(least[rows], cosines.min(axis=1), out=least[rows])
    return np.clip(least.astype(np.float64), -1.0, 1.0)


def largest(
    queries: Vectors, references: Rows, k: int, skip: NDArray[np.int64] | None = None
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return the cosines and the rows of the k nearest references, nearest first: [n, k] each.

    Of references as near as the last one that is returned, within `TIE`, the first ones are: the last bits of a cosine
    depend on the other queries. `skip` [n] is the one reference that each query ignores, negative for none.
    """
    nearest_cosines = np.full((len(queries), k), -np.inf, np.float32)
    nearest_rows = np.full((len(queries), k), -1, np.int64)
    for rows, first, cosines in _blocks(queries, references):
        if skip is not None:
            column = skip[rows] - first
            query = np.flatnonzero((column >= 0) & (column < cosines.shape[1]))
            cosines[query, column[query]] = -np.inf
        columns = _first_largest(cosines, min(k, cosines.shape[1]))
        nearest_cosines[rows], nearest_rows[rows] = _nearest_first(
            np.hstack([nearest_cosines[rows], np.take_along_axis(cosines, columns, axis=1)]),
            np.hstack([nearest_rows[rows], columns + first]),
            k,
        )
    return np.clip(nearest_cosines.astype(np.float64), -1.0, 1.0), nearest_rows


def _nearest_first(
    cosines: Vectors, references: NDArray[np.int64], k: int
) -> tuple[Vectors, NDArray[np.int64]]:
    """Return the k nearest of the references of each row with their cosines, nearest first: [n, k] each."""
    by_reference = np.argsort(references, axis=1)
    cosines = np.take_along_axis(cosines, by_reference, axis=1)
    references = np.take_along_axis(references, by_reference, axis=1)
    columns = _first_largest(cosines, k)
    cosines = np.take_along_axis(cosines, columns, axis=1)
    references = np.take_along_axis(references, columns, axis=1)
    order = np.lexsort((references, -cosines), axis=1)
    return (
        np.take_along_axis(cosines, order, axis=1),
        np.take_along_axis(references, order, axis=1),
    )


def _first_largest(values: NDArray[np.float32], k: int) -> NDArray[np.int64]:
    """Return the columns of the k largest values of each row in order, of ties for the last one the first: [n, k]."""
    columns = np.argpartition(-values, k - 1, axis=1)[:, :k]
    least = np.take_along_axis(values, columns, axis=1).min(axis=1, keepdims=True)
    has_ties = np.flatnonzero((values >= least - TIE).sum(axis=1) > k)
    is_larger = values[has_ties] > least[has_ties] + TIE
    is_smaller = values[has_ties] < least[has_ties] - TIE
    rank = np.where(is_larger, 0, np.where(is_smaller, 2, 1))
    columns[has_ties] = np.argsort(rank, axis=1, kind="stable")[:, :k]
    return np.sort(columns, axis=1)


class _Best:
    """The largest cosine so far of each of n rows, and its column."""

    def __init__(self, n: int) -> None:
        self._cosine = np.full(n, -np.inf, np.float32)
        self._index = np.zeros(n, np.int64)

    def offer(self, row: int, first: int, cosines: Vectors) -> None:
        """Update with the cosines of rows `row` onwards to references `first` onwards."""
        if not cosines.size:
            return
        largest_cosines = cosines.max(axis=1)
        better = np.flatnonzero(largest_cosines > self._cosine[row : row + len(cosines)])
        # A late block improves few rows, so finding the column for these alone is cheap.
        for block_row in better.tolist():
            self._index[row + block_row] = first + int(cosines[block_row].argmax())
        self._cosine[row + better] = largest_cosines[better]

    def offer_columns(self, row: int, first: int, cosines: Vectors) -> None:
        """Update with the cosines of references `first` onwards to rows `row` onwards."""
        # Scanning a column of a large block is slow, so the search first narrows to a group of rows.
        whole_groups, columns = len(cosines) // _GROUP, cosines.shape[1]
        whole_rows = whole_groups * _GROUP
        groups = cosines[:whole_rows].reshape(whole_groups, _GROUP, columns).max(axis=1)
        if whole_rows < len(cosines):
            groups = np.vstack([groups, cosines[whole_rows:].max(axis=0)])
        largest_cosines = groups.max(axis=0)
        better = np.flatnonzero(largest_cosines > self._cosine[row : row + columns])
        start = groups[:, better].argmax(axis=0) * _GROUP
        inside = np.minimum(start + np.arange(_GROUP)[:, None], len(cosines) - 1)
        self._index[row + better] = first + start + cosines[inside, better].argmax(axis=0)
        self._cosine[row + better] = largest_cosines[better]

    def nearest(self) -> Nearest:
        return Nearest(np.clip(self._cosine.astype(np.float64), -1.0, 1.0), self._index)


def _blocks(queries: Vectors, references: Rows) -> Iterator[tuple[slice, int, Vectors]]:
    """Yield row slices of the queries, the first reference row, and their cosines, valid until the next step."""
    height = max(min(len(queries), _ROWS), 1)
    width = min(max(_COLUMNS, _ROWS * _COLUMNS // height), _MOST_COLUMNS)
    buffer = np.empty(height * min(width, max(len(references), 1)), np.float32)
    for first in range(0, len(references), width):
        block = references[first : first + width]
        for row in range(0, len(queries), height):
            panel = queries[row : row + height]
            yield slice(row, row + len(panel)), first, _cosines(panel, block, buffer)


def _cosines(a: Vectors, b: Vectors, buffer: NDArray[np.float32]) -> Vectors:
    """Return the cosine of every row of `a` to every row of `b`, [n, m], written into `buffer`."""
    cosines = buffer[: len(a) * len(b)].reshape(len(a), len(b))
    with np.errstate(invalid="ignore"):  # Some BLAS kernels raise the flag for finite factors.
        np.matmul(a, b.T, out=cosines)
    return cosines
