r"""The offline estimate of rarity: a small head over an encoder's vectors and stems of words.

    f(x) = b + x . beta + sum_j alpha_j exp(-gamma |x - l_j|^2),  x = (embedding, stems)

is the decimal logarithm of kilometres. It is kernel ridge regression on inducing points l_j (subset of regressors;
Quinonero-Candela and Rasmussen, 2005), fitted by `tools/rarity/train.py`, which also says to what. Stems alone serve
any encoder; the embedding of all-MiniLM-L6-v2 is added where that is the encoder.

A text is read without its sentences of courtesy. The ends of the interval are lines over the estimate: quantile
regressions of the ratings on estimates of texts whose writer had no part in the fit, where every writer counts alike and
the parts of the baseline as one. `docs/rarity.md` has what they cover.
"""

from collections.abc import Callable, Sequence
from functools import cache
from importlib import resources
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from oodscen.encoders._similarity import Vectors
from oodscen.metrics._rarity.words import Words, without_courtesy

Values = NDArray[np.float64]
MINILM = "all-MiniLM-L6-v2@"
"""Beginning of the names of encoders whose vectors the head was fitted to."""
_BLOCK = 512
"""Texts of a block, which bound the memory."""
_LEAST, _MOST = -1.0, 12.0
"""Range of estimates, log10 km."""


class Estimates(NamedTuple):
    """Decimal logarithms of kilometres, and the nearness of texts to what the head knows; [n] each."""

    low: Values
    best: Values
    high: Values
    nearness: Values
    """Largest kernel value of an inducing point, in (0, 1]."""
    known_share: Values
    """Share of the words whose stems are known."""


class Head:
    """A fitted head of a kind, `minilm` or `words`, from arrays that `tools/rarity/train.py` wrote."""

    def __init__(self, arrays: dict[str, NDArray[Any]], kind: str) -> None:
        self.uses_vectors = kind == "minilm"
        self.words = Words([str(stem) for stem in arrays["vocabulary"]], arrays["weights"])
        fit = {name.removeprefix(f"{kind}."): value for name, value in arrays.items()}
        self._beta = fit["beta"].astype(np.float32)
        # Large terms of either sign cancel: sums of float32 would depend on the texts of a block in the fourth decimal.
        self._alpha = fit["alpha"].astype(np.float64)
        self._constant, self._gamma = float(fit["constant"]), float(fit["gamma"])
        self.least_nearness = float(fit["nearest"])
        """Nearness below which the head gives no figure."""
        self._low, self._high = fit["low"], fit["high"]
        self._points = inducing_points(arrays, self.uses_vectors)
        self._lengths = squares(self._points)

    def estimate(self, texts: Sequence[str], vectors: Vectors | None = None) -> Estimates:
        """Return the estimates of texts; a head that uses vectors takes theirs, [n, d] of unit length."""
        best, nearness = np.empty(len(texts)), np.empty(len(texts))
        for first in range(0, len(texts), _BLOCK):
            block = slice(first, first + _BLOCK)
            rows = self.words.rows(texts[block])
            if self.uses_vectors:
                assert vectors is not None
                rows = np.hstack([np.asarray(vectors[block], np.float32), rows])
            values = kernel(rows, self._points, self._gamma, self._lengths)
            best[block] = self._constant + rows @ self._beta + values @ self._alpha
            nearness[block] = values.max(axis=1)
        best = np.clip(best, _LEAST, _MOST)
        low, high = interval_ends(best, self._low, self._high)
        known_share = np.array([self.words.known_share(text) for text in texts])
        return Estimates(low, best, high, nearness, known_share)


def interval_ends(best: Values, low: Values, high: Values) -> tuple[Values, Values]:
    """Return the ends of the intervals of estimates, by lines [2] of constant and slope."""
    return np.minimum(low[0] + low[1] * best, best), np.maximum(high[0] + high[1] * best, best)


def squares(rows: NDArray[Any]) -> NDArray[Any]:
    """Return the squared length of every row, [n]."""
    return np.asarray(np.square(rows).sum(axis=1))


def kernel(
    rows: NDArray[Any], points: NDArray[Any], gamma: float, lengths: NDArray[Any] | None = None
) -> NDArray[Any]:
    """Return exp(-gamma |x - l|^2) for every row and point, [n, m]; `lengths` are the points' `squares`."""
    point_squares = squares(points) if lengths is None else lengths
    distances = (squares(rows)[:, None] + point_squares) - 2.0 * rows @ points.T
    return np.asarray(np.exp(-gamma * np.maximum(distances, 0.0)))


def inducing_points(arrays: dict[str, NDArray[Any]], uses_vectors: bool) -> NDArray[np.float32]:
    """Return the inducing points [m, d + V] or [m, V]; their stems are stored as columns, row by row."""
    starts, columns = arrays["starts"], arrays["places"]
    rows = np.zeros((len(starts) - 1, len(arrays["weights"])), np.float32)
    for row, (first, last) in zip(rows, pairwise(starts), strict=True):
        row[columns[first:last]] = arrays["weights"][columns[first:last]]
    lengths = np.linalg.norm(rows, axis=1, keepdims=True)
    rows /= np.where(lengths > 0.0, lengths, 1.0)
    if not uses_vectors:
        return rows
    return np.hstack([arrays["vectors"].astype(np.float32) * arrays["scale"][:, None], rows])


@cache
def load_head(kind: str) -> Head:
    """Return the shipped head, `minilm` or `words`."""
    shipped = resources.files("oodscen.metrics._rarity").joinpath("head.npz")
    with shipped.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
        return Head(dict(arrays), kind)


def estimate(
    encoder: str, texts: Sequence[str], encode: Callable[[list[str]], Vectors]
) -> tuple[Head, Estimates, Vectors | None]:
    """Return the head for the encoder of this name, its estimates, and the vectors if the head uses them."""
    plain = [without_courtesy(text) for text in texts]
    head = load_head("minilm" if encoder.startswith(MINILM) else "words")
    vectors = encode(plain) if head.uses_vectors else None
    return head, head.estimate(plain, vectors), vectors
