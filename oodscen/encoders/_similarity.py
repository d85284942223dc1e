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
_COLUMNS = 1024
_MOST_COLUMNS = 16_384
_GROUP = 64
_TIE = np.float32(5e-7)
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
    return best.found()


def nearest_other(vectors: Vectors) -> Nearest:
    """Return, for each row, the nearest other row of the same set; needs at least two rows.

    The cosine of a pair is computed once and used for both rows, which halves the work of `nearest`.
    """
    best = _Best(len(vectors))
    space = np.empty(_ROWS * _COLUMNS, np.float32)
    for first in range(0, len(vectors), _COLUMNS):
        block = vectors[first : first + _COLUMNS]
        last = first + len(block)
        for row in range(0, last, _ROWS):
            panel = vectors[row : min(row + _ROWS, last)]
            cosines = _product(panel, block, space)
            own = np.arange(max(row, first), row + len(panel))
            cosines[own - row, own - first] = -np.inf
            best.offer_columns(first, row, cosines)
            best.offer(row, first, cosines[: max(first - row, 0)])
    return best.found()


def smallest(queries: Vectors, references: Rows) -> NDArray[np.float64]:
    """Return the cosine of each query to its farthest reference: [n], in [-1, 1]."""
    found = np.full(len(queries), np.inf, np.float32)
    for rows, _, cosines in _blocks(queries, references):
        np.minimum(found[rows], cosines.min(axis=1), out=found[rows])
    return np.clip(found.astype(np.float64), -1.0, 1.0)


def largest(
    queries: Vectors, references: Rows, k: int, skip: NDArray[np.int64] | None = None
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return the cosines and the rows of the k nearest references, nearest first: [n, k] each.

    Of references as near as the last one that is returned, within `_TIE`, the first ones are: the last bits of a cosine
    depend on the other queries. `skip` [n] is the one reference that each query ignores, negative for none.
    """
    values = np.full((len(queries), k), -np.inf, np.float32)
    places = np.full((len(queries), k), -1, np.int64)
    for rows, first, cosines in _blocks(queries, references):
        if skip is not None:
            own = skip[rows] - first
            here = np.flatnonzero((own >= 0) & (own < cosines.shape[1]))
            cosines[here, own[here]] = -np.inf
        chosen = _first_largest(cosines, min(k, cosines.shape[1]))
        both = np.hstack([values[rows], np.take_along_axis(cosines, chosen, axis=1)])
        where = np.hstack([places[rows], chosen + first])
        by_row = np.argsort(where, axis=1)
        kept = np.take_along_axis(
            by_row, _first_largest(np.take_along_axis(both, by_row, axis=1), k), axis=1
        )
        both = np.take_along_axis(both, kept, axis=1)
        where = np.take_along_axis(where, kept, axis=1)
        order = np.lexsort((where, -both), axis=1)
        values[rows] = np.take_along_axis(both, order, axis=1)
        places[rows] = np.take_along_axis(where, order, axis=1)
    return np.clip(values.astype(np.float64), -1.0, 1.0), places


def _first_largest(values: NDArray[np.float32], k: int) -> NDArray[np.int64]:
    """Return the columns of the k largest values of each row in order, of ties for the last one the first: [n, k]."""
    chosen = np.argpartition(-values, k - 1, axis=1)[:, :k]
    least = np.take_along_axis(values, chosen, axis=1).min(axis=1, keepdims=True)
    tied = np.flatnonzero((values >= least - _TIE).sum(axis=1) > k)
    rank = (values[tied] <= least[tied] + _TIE) + 1 * (values[tied] < least[tied] - _TIE)
    chosen[tied] = np.argsort(rank, axis=1, kind="stable")[:, :k]
    return np.sort(chosen, axis=1)


class _Best:
    """The largest cosine so far of each of n rows, and its column."""

    def __init__(self, n: int) -> None:
        self._cosine = np.full(n, -np.inf, np.float32)
        self._index = np.zeros(n, np.int64)

    def offer(self, row: int, first: int, cosines: Vectors) -> None:
        """Update with the cosines of rows `row` onwards to references `first` onwards."""
        if not cosines.size:
            return
        values = cosines.max(axis=1)
        better = np.flatnonzero(values > self._cosine[row : row + len(values)])
        # A late block improves few rows, so finding the column for these alone is cheap.
        for place in better.tolist():
            self._index[row + place] = first + int(cosines[place].argmax())
        self._cosine[row + better] = values[better]

    def offer_columns(self, row: int, first: int, cosines: Vectors) -> None:
        """Update with the cosines of references `first` onwards to rows `row` onwards."""
        # Scanning a column of a large block is slow, so the search first narrows to a group of rows.
        whole, columns = len(cosines) // _GROUP, cosines.shape[1]
        groups = cosines[: whole * _GROUP].reshape(whole, _GROUP, columns).max(axis=1)
        if len(cosines) % _GROUP:
            groups = np.vstack([groups, cosines[whole * _GROUP :].max(axis=0)])
        values = groups.max(axis=0)
        better = np.flatnonzero(values > self._cosine[row : row + len(values)])
        start = groups[:, better].argmax(axis=0) * _GROUP
        inside = np.minimum(start + np.arange(_GROUP)[:, None], len(cosines) - 1)
        self._index[row + better] = first + start + cosines[inside, better].argmax(axis=0)
        self._cosine[row + better] = values[better]

    def found(self) -> Nearest:
        return Nearest(np.clip(self._cosine.astype(np.float64), -1.0, 1.0), self._index)


def _blocks(queries: Vectors, references: Rows) -> Iterator[tuple[slice, int, Vectors]]:
    """Yield row slices of the queries, the first reference row, and their cosines, valid until the next step."""
    tall = max(min(len(queries), _ROWS), 1)
    wide = min(max(_COLUMNS, _ROWS * _COLUMNS // tall), _MOST_COLUMNS)
    space = np.empty(tall * min(wide, max(len(references), 1)), np.float32)
    for first in range(0, len(references), wide):
        block = references[first : first + wide]
        for row in range(0, len(queries), tall):
            panel = queries[row : row + tall]
            yield slice(row, row + len(panel)), first, _product(panel, block, space)


def _product(a: Vectors, b: Vectors, space: NDArray[np.float32]) -> Vectors:
    out = space[: len(a) * len(b)].reshape(len(a), len(b))
    with np.errstate(invalid="ignore"):  # Some BLAS kernels raise the flag for finite factors.
        np.matmul(a, b.T, out=out)
    return out
