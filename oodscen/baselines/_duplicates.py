"""Search for near-duplicates in a baseline.

They do not change the OOD-ness of other texts, but they make a baseline look larger than it is, and they
make a batch of it look ordinary when it is scored against the rest. `near_duplicates(texts)` compares the
wording, `near_duplicates(embeddings)` the meaning; both compare all pairs, in blocks.
"""

from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from oodscen._numbers import finite_number
from oodscen._text import folded_words
from oodscen.baselines._texts import check_texts
from oodscen.data._base import Data
from oodscen.encoders._similarity import TIE, unit
from oodscen.errors import DataError, Issue, UsageError

_BLOCK = 512
"""Number of rows that are compared with as many others at once."""

Product = Callable[[slice, slice], NDArray[np.float32]]
"""Returns the similarities of one block of rows to another."""
_ROUNDING = 1e-6
"""Amount by which rounding may leave the cosine of two equal rows below 1."""

_NUMBERS = "iuf"
"""Kinds of the dtypes of embeddings; any other array holds texts."""


class Duplicate(Data):
    """An item that resembles an earlier one."""

    index: int
    """Index of the item."""
    of: int
    """Index of the earlier item that it resembles most; the first of several equal ones."""
    similarity: float


class NearDuplicates(Data):
    """The items of a baseline that nearly repeat an earlier one."""

    found: tuple[Duplicate, ...]
    """In the order of the baseline."""
    n: int = Field(ge=1)
    """Number of items compared."""
    threshold: float
    measure: Literal["cosine", "trigrams"]

    @property
    def kept(self) -> tuple[int, ...]:
        """The indices of items that resemble no earlier one: the baseline without near-duplicates."""
        repeated = {item.index for item in self.found}
        return tuple(index for index in range(self.n) if index not in repeated)


def near_duplicates(
    items: Sequence[str] | NDArray[np.float32], threshold: float = 0.9
) -> NearDuplicates:
    """Return the items that resemble an earlier one.

    Args:
        items: Texts, compared by their sets of three-letter sequences (Jaccard index, ignoring case and
            punctuation, in [0, 1]); or embeddings, [n, d], compared by cosine.
        threshold: Smallest similarity that counts, in (0, 1]. Two sentences that differ only in a colour
            reach about 0.8 by their letters, and 0.8 to 0.95 by all-MiniLM-L6-v2.

    Returns:
        At most one entry per item, so that even a baseline of many copies gives a report no longer than itself.
        Time grows with the square of n, memory with n.

    Raises:
        DataError: If there is nothing to compare, a text is blank, or a value is not finite.
        UsageError: If the threshold is not in (0, 1].
    """
    threshold = finite_number("threshold", threshold)
    if not 0.0 < threshold <= 1.0:
        raise UsageError(f"the threshold {threshold} is not in (0, 1]")
    if isinstance(items, np.ndarray) and items.dtype.kind not in _NUMBERS:
        items = items.tolist()
    if isinstance(items, np.ndarray):
        return _report(len(items), _cosines(items), threshold, "cosine")
    texts = check_texts(items, "baseline")
    return _report(len(texts), _jaccard(texts), threshold, "trigrams")


def _report(
    size: int, product: Product, threshold: float, measure: Literal["cosine", "trigrams"]
) -> NearDuplicates:
    """Compare every row with all earlier ones, block by block."""
    best, nearest = np.full(size, -np.inf, np.float32), np.zeros(size, np.int64)
    for first in range(0, size, _BLOCK):
        rows = slice(first, min(first + _BLOCK, size))
        for start in range(0, first + 1, _BLOCK):
            columns = slice(start, min(start + _BLOCK, size))
            values = product(rows, columns)
            if start == first:
                values = np.where(np.tri(len(values), k=-1, dtype=bool), values, -np.inf)
            largest = values.max(axis=1, keepdims=True)
            column = (values >= largest - TIE).argmax(axis=1)
            value = np.take_along_axis(values, column[:, None], axis=1)[:, 0]
            is_better = value > best[rows] + TIE
            nearest[rows] = np.where(is_better, column + start, nearest[rows])
            best[rows] = np.where(is_better, value, best[rows])
    repeated = np.flatnonzero((best >= threshold - _ROUNDING) & (best > 0.0))
    return NearDuplicates(
        found=tuple(
            Duplicate(index=index, of=int(nearest[index]), similarity=float(best[index]))
            for index in repeated.tolist()
        ),
        n=size,
        threshold=threshold,
        measure=measure,
    )


def _cosines(vectors: NDArray[np.float32]) -> Product:
    fault = ""
    if vectors.ndim != 2 or not len(vectors):
        fault = f"has the shape {vectors.shape}, not one row for each text"
    elif not np.isfinite(vectors).all():
        fault = "holds values that are not finite"
    if fault:
        raise DataError("embeddings", [Issue("", fault)])
    scaled = unit(vectors)

    def product(rows: slice, columns: slice) -> NDArray[np.float32]:
        return np.asarray(np.clip(scaled[rows] @ scaled[columns].T, -1.0, 1.0), np.float32)

    return product


def _jaccard(texts: Sequence[str]) -> Product:
    vocabulary: dict[str, int] = {}
    grams = [
        np.array(sorted({vocabulary.setdefault(gram, len(vocabulary)) for gram in _grams(text)}))
        for text in texts
    ]
    sizes = np.array([len(text_grams) for text_grams in grams], np.float32)

    def incidence(rows: slice) -> NDArray[np.float32]:
        matrix = np.zeros((rows.stop - rows.start, len(vocabulary)), np.float32)
        for row, text_grams in enumerate(grams[rows]):
            matrix[row, text_grams] = 1.0
        return matrix

    def product(rows: slice, columns: slice) -> NDArray[np.float32]:
        shared = incidence(rows) @ incidence(columns).T
        return np.asarray(shared / (sizes[rows, None] + sizes[columns] - shared), np.float32)

    return product


def _grams(text: str) -> set[str]:
    letters = f" {folded_words(text) or text.strip()} "
    return {letters[start : start + 3] for start in range(len(letters) - 2)}
