"""Search for near-duplicates in a baseline.

They do not change the OOD-ness of other texts, but they make a baseline look larger than it is, and they
make a batch of it look ordinary when it is scored against the rest. All pairs are compared, in blocks, so that time
grows with the square of their number.
"""

from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from oodscen._numbers import finite_number
from oodscen._words.text import folded_words
from oodscen.data._base import Data
from oodscen.encoders._similarity import TIE, unit
from oodscen.errors import UsageError

_BLOCK = 256
"""Number of rows that are compared with all earlier ones at once."""
Similarities = Callable[[slice], NDArray[np.float32]]
"""Returns the similarities of a block of rows to all rows up to its last."""
_ROUNDING = 1e-6
"""Amount by which rounding may leave the cosine of two equal rows below 1."""


class Duplicate(Data):
    """An item that resembles an earlier one that is kept."""

    index: int
    """Index of the item."""
    of: int
    """Index of the kept item that it resembles most; the first of several equal ones."""
    similarity: float


class NearDuplicates(Data):
    """The items of a baseline that nearly repeat an earlier one, taken in order: the others are kept.

    An item that only resembles items which are not kept is no repetition, so that chains do not collapse.
    """

    found: tuple[Duplicate, ...]
    """In the order of the baseline."""
    n: int = Field(ge=1)
    """Number of items compared."""
    threshold: float
    measure: Literal["cosine", "trigrams"]

    @property
    def kept(self) -> tuple[int, ...]:
        """The indices of the other items: the baseline without near-duplicates."""
        repeated = {item.index for item in self.found}
        return tuple(index for index in range(self.n) if index not in repeated)


def similar_wording(texts: Sequence[str], threshold: float = 0.9) -> NearDuplicates:
    """Return the texts whose three-letter sequences are nearly those of an earlier one.

    Similarity is the Jaccard index of the two sets, which ignores case and punctuation. Two sentences that differ
    only in a colour reach about 0.8. Memory grows with the number of texts.

    Args:
        texts: At least one, each visible.
        threshold: Smallest similarity that counts, in (0, 1].

    Raises:
        UsageError: If the threshold is not in (0, 1].
    """
    grams = [_grams(text) for text in texts]
    sizes = np.array([len(text_grams) for text_grams in grams], np.float32)
    holders: dict[str, list[int]] = {}
    for index, text_grams in enumerate(grams):
        for gram in text_grams:
            holders.setdefault(gram, []).append(index)
    texts_with = {gram: np.array(indices) for gram, indices in holders.items()}

    def jaccard(rows: slice) -> NDArray[np.float32]:
        shared = np.zeros((rows.stop - rows.start, rows.stop), np.float32)
        for row, text_grams in zip(shared, grams[rows], strict=True):
            sharing = np.concatenate([texts_with[gram] for gram in text_grams])
            row[:] = np.bincount(sharing, minlength=len(texts))[: rows.stop]
        shared /= sizes[rows, None] + sizes[: rows.stop] - shared
        return shared

    return _compare(len(texts), jaccard, threshold, "trigrams")


def similar_meaning(vectors: NDArray[np.float32], threshold: float = 0.9) -> NearDuplicates:
    """Return the rows that nearly point where an earlier one does, by cosine.

    Two sentences that differ only in a colour reach 0.8 to 0.95 with all-MiniLM-L6-v2.

    Args:
        vectors: Embeddings, [n, d], finite; n is at least 1.
        threshold: Smallest similarity that counts, in (0, 1].

    Raises:
        UsageError: If the threshold is not in (0, 1].
    """
    scaled = unit(vectors)

    def cosines(rows: slice) -> NDArray[np.float32]:
        return np.asarray(np.clip(scaled[rows] @ scaled[: rows.stop].T, -1.0, 1.0), np.float32)

    return _compare(len(vectors), cosines, threshold, "cosine")


def _compare(
    size: int, similarities: Similarities, threshold: float, measure: Literal["cosine", "trigrams"]
) -> NearDuplicates:
    """Compare every row with all earlier ones that are kept."""
    threshold = finite_number("threshold", threshold)
    if not 0.0 < threshold <= 1.0:
        raise UsageError(f"the threshold {threshold} is not in (0, 1]")
    is_kept = np.ones(size, np.bool_)
    found = []
    for start in range(0, size, _BLOCK):
        rows = slice(start, min(start + _BLOCK, size))
        for index, values in enumerate(similarities(rows), start):
            earlier = np.where(is_kept[:index], values[:index], -np.inf)
            best = earlier.max(initial=0.0)
            if best < threshold - _ROUNDING or best == 0.0:
                continue
            is_kept[index] = False
            of = int((earlier >= best - TIE).argmax())
            found.append(Duplicate(index=index, of=of, similarity=float(earlier[of])))
    return NearDuplicates(found=tuple(found), n=size, threshold=threshold, measure=measure)


def _grams(text: str) -> set[str]:
    letters = f" {folded_words(text) or text.strip()} "
    return {letters[start : start + 3] for start in range(len(letters) - 2)}
