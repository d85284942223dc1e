r"""Detectors: alternatives to OOD-ness that score how far a text lies from a baseline, behind one signature.

All are fitted to ordinary text alone; higher is more OOD. Let e be the embedding of a text, b those of
the baseline, mu and Sigma their mean and covariance.

    kth           -(k-th largest cos(b, e)), k = 10. In [-1, 1]. Sun et al., *Out-of-distribution
                  detection with deep nearest neighbors*, 2022. Sensitive to style, like OOD-ness; a single
                  odd baseline text no longer hides an OOD one.
    mahalanobis   sqrt((e - mu)^T S^-1 (e - mu)), S = Sigma shrunk to a multiple of the identity by Ledoit
                  and Wolf's formula (2004). At least 0. Lee et al., 2018. Misled by long and mixed texts, whose
                  vectors lie near mu.
    density       mean distance 1 - cos to the 10 nearest baseline texts, divided by their own mean distance to
                  their 10 nearest; texts tied for the last places count in equal parts. At least 0; about 1 for ordinary text. After Breunig et al., *LOF*, 2000.
                  Misled by near-duplicates in the baseline, next to which everything is sparse.
    whitened      -max cos(W(b - mu), W(e - mu)), W = Sigma^-1/4: features that vary much among ordinary texts
                  (place, wording) weigh less. In [-1, 1]. Misled by rare words in ordinary texts.
    events        judgement + novelty + leaning / 2, each in standard deviations of the baseline about its mean.
                  *Judgement* is the mean of the projections of the text, and of its clauses (averaged), on
                  S^-1 a, where a points from ordinary to not ordinary (`oodscen.metrics._detection.anchors`)
                  and S is Sigma shrunk by 0.3. *Novelty* is the largest distance of a clause to the nearest
                  clause of another baseline text. *Leaning* is the cosine to the nearest anchor for a kind of
                  event minus that to the nearest anchor for its absence, for the text and its clauses
                  (averaged). About 0 for ordinary text, unbounded. Specific to this library, not from the
                  paper. Misled by ordinary text that mentions danger ("a fire engine returns to its station"),
                  by OOD text in mild words, and by kinds of events that no anchor covers.

`docs/metrics.md` reports which is best, with error rates.
"""

import re
from collections.abc import Callable, Sequence
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from oodscen.encoders._similarity import Vectors, largest, nearest, unit
from oodscen.errors import UnknownComponent
from oodscen.metrics._detection.anchors import anchors
from oodscen.metrics._oodness import Measure

DetectorName = Literal["kth", "mahalanobis", "density", "whitened", "events"]
DETECTORS: tuple[DetectorName, ...] = get_args(DetectorName)

Encode = Callable[[Sequence[str]], Vectors]
"""Encodes texts to vectors of unit length or zero."""
Scores = NDArray[np.float64]

_Fitted = Callable[[Sequence[str], Vectors], Scores]

DECIMALS = 12
"""Decimals of a score; beyond them, products of matrices depend on the number of threads."""
_K = 10
_TIES, _TIED = 4, 2e-6
"""Neighbours that are looked at for ties, as a multiple of k, and the difference of cosines that is rounding."""
_SHRUNK = 0.3
_QUARTER = 0.25
_STEP = 2048
_LEAST_APART = 1e-6
"""Least distance of neighbours from theirs by which a text's distance is divided."""
_LEAST_LENGTH = 1e-12
"""Least length or variance by which a vector is divided."""
_NO_SPREAD = 1e-9
"""Standard deviation up to which values are only centred."""


_CUT = re.compile(
    r"[.;:,?!]\s+|\s[-\u2013\u2014]\s"
    r"|\s(?=(?:and|but|while|as|where|which|who|because|so|when|before|after|until|behind|towards"
    r"|with|without)\s)"
)
_MOST_CLAUSES = 64


class Detectors:
    """The detectors of one baseline of [N, d] vectors, each fitted on first use."""

    def __init__(self, texts: Sequence[str], vectors: Vectors, encode: Encode) -> None:
        self._texts = texts
        self._vectors = vectors
        self._encode = encode
        self._mean = vectors.mean(axis=0, dtype=np.float64)
        self._fitted: dict[str, _Fitted] = {}

    def score(self, name: DetectorName, texts: Sequence[str], vectors: Vectors) -> Scores:
        """Return one score per text, of which there is at least one; higher is more OOD.

        Raises:
            UnknownComponent: If there is no such detector.
        """
        if name not in DETECTORS:
            raise UnknownComponent("definition", str(name), get_args(Measure))
        if name not in self._fitted:
            fit = {
                "kth": self._kth,
                "mahalanobis": self._mahalanobis,
                "density": self._density,
                "whitened": self._whitened,
                "events": self._events,
            }[name]
            self._fitted[name] = fit()
        return np.round(self._fitted[name](texts, vectors), DECIMALS)

    def _kth(self) -> _Fitted:
        k = min(_K, len(self._vectors))
        return lambda _, vectors: 0.0 - largest(vectors, self._vectors, k)[0][:, -1]

    def _density(self) -> _Fitted:
        n = len(self._vectors)
        k = min(_K, max(n - 1, 1))
        skip = np.arange(n) if n > 1 else None
        own = 1.0 - largest(self._vectors, self._vectors, k, skip)[0].mean(axis=1)

        def score(_: Sequence[str], vectors: Vectors) -> Scores:
            cosines, places = largest(vectors, self._vectors, min(_TIES * k, n))
            last = cosines[:, k - 1 : k]
            is_nearer, is_tied = cosines > last + _TIED, np.abs(cosines - last) <= _TIED
            share = (k - is_nearer.sum(axis=1)) / is_tied.sum(axis=1)
            weights = np.where(is_nearer, 1.0, is_tied * share[:, None])
            around = (weights * own[places]).sum(axis=1) / k
            return np.asarray(
                (1.0 - cosines[:, :k].mean(axis=1)) / np.maximum(around, _LEAST_APART), np.float64
            )

        return score

    def _mahalanobis(self) -> _Fitted:
        covariance = self._covariance()
        inverse = np.linalg.pinv(shrunk(covariance, ledoit_wolf(self._vectors - self._mean)))

        def score(_: Sequence[str], vectors: Vectors) -> Scores:
            apart = vectors - self._mean
            squared = np.einsum("ij,jk,ik->i", apart, inverse, apart, optimize=True)
            return np.asarray(np.sqrt(np.maximum(squared, 0.0)), np.float64)

        return score

    def _whitened(self) -> _Fitted:
        values, axes = np.linalg.eigh(self._covariance())
        floor = max(float(values.mean()) * 0.04, _LEAST_LENGTH)
        scale = axes / (np.maximum(values, 0.0) + floor) ** _QUARTER
        known = self._turned(self._vectors, scale)
        return lambda _, vectors: 0.0 - nearest(self._turned(vectors, scale), known).cosine

    def _turned(self, vectors: Vectors, scale: NDArray[np.float64]) -> Vectors:
        return unit(((vectors - self._mean) @ scale).astype(np.float32))

    def _events(self) -> _Fitted:
        direction = np.linalg.pinv(shrunk(self._covariance(), _SHRUNK)) @ self._axis()
        calm, odd = (self._encode(side) for side in zip(*anchors()[-1], strict=True))

        def leaning(rows: Vectors) -> Scores:
            return np.asarray((rows @ odd.T).max(axis=1) - (rows @ calm.T).max(axis=1), np.float64)

        def measured(
            vectors: Vectors, parts: Vectors, novelty: Scores, owner: NDArray[np.int64]
        ) -> tuple[Scores, ...]:
            return (
                vectors @ direction,
                _by_text(parts @ direction, owner, "mean"),
                _by_text(novelty, owner, "max"),
                leaning(vectors),
                _by_text(leaning(parts), owner, "mean"),
            )

        parts, owner = _cut(self._texts)
        known = self._encode(parts)
        samples = measured(self._vectors, known, _novelty_within(known, owner), owner)
        standards = [_Standard(values) for values in samples]
        weights = np.array([0.5, 0.5, 1.0, 0.25, 0.25])

        def score(texts: Sequence[str], vectors: Vectors) -> Scores:
            parts, owner = _cut(texts)
            found = self._encode(parts)
            values = measured(vectors, found, 1.0 - nearest(found, known).cosine, owner)
            placed = [standard(one) for standard, one in zip(standards, values, strict=True)]
            return np.asarray(weights @ np.array(placed), np.float64)

        return score

    def _axis(self) -> NDArray[np.float64]:
        total = np.zeros(self._vectors.shape[1])
        for pairs in anchors():
            calm, odd = (self._encode(side).astype(np.float64) for side in zip(*pairs, strict=True))
            step = (odd - calm).mean(axis=0)
            total += step / max(float(np.linalg.norm(step)), _LEAST_LENGTH)
        return total

    def _covariance(self) -> NDArray[np.float64]:
        apart = self._vectors.astype(np.float64) - self._mean
        return np.asarray(apart.T @ apart / len(apart), np.float64)


def shrunk(covariance: NDArray[np.float64], share: float) -> NDArray[np.float64]:
    """Return a covariance moved by `share` towards the multiple of the identity with its trace."""
    size = len(covariance)
    level = float(np.trace(covariance)) / size
    return (1.0 - share) * covariance + share * level * np.eye(size)


def ledoit_wolf(apart: NDArray[np.floating]) -> float:
    """Return the shrinkage intensity for the covariance of [n, d] rows about their mean.

    Source: Ledoit and Wolf, *A well-conditioned estimator for large-dimensional covariance matrices*,
    2004. In [0, 1]; 1 if all rows are equal.
    """
    rows = np.asarray(apart, np.float64)
    n, size = rows.shape
    covariance = rows.T @ rows / n
    level = float(np.trace(covariance)) / size
    spread = float(np.square(covariance).sum()) / size - level**2
    if spread <= 0.0:
        return 1.0
    squared = np.square(rows).sum(axis=1)
    error = float(np.square(squared).sum()) / n - float(np.square(covariance).sum())
    return float(np.clip(error / (n * size) / spread, 0.0, 1.0))


class _Standard:
    """Expresses values in standard deviations of a sample about its mean."""

    def __init__(self, sample: NDArray[np.floating]) -> None:
        self._mean = float(np.mean(sample))
        spread = float(np.std(sample))
        self._spread = spread if spread > _NO_SPREAD else 1.0

    def __call__(self, values: NDArray[np.floating]) -> Scores:
        return np.asarray((values - self._mean) / self._spread, np.float64)


def clauses(text: str) -> tuple[str, ...]:
    """Split a text at punctuation and before conjunctions, so that an event is scored apart from its setting.

    Returns:
        1 to 64 parts of at least two words; the text itself if it cannot be split.
    """
    parts = [part.strip(" .,;:?!\t\n") for part in _CUT.split(text)]
    found = tuple(part for part in parts if len(part.split()) > 1)
    return found[:_MOST_CLAUSES] or (text,)


def _cut(texts: Sequence[str]) -> tuple[list[str], NDArray[np.int64]]:
    """Return all clauses, and for each the index of its text."""
    found = [clauses(text) for text in texts]
    owner = np.repeat(np.arange(len(texts)), [len(parts) for parts in found])
    return [part for parts in found for part in parts], owner


def _by_text(
    values: NDArray[np.floating], owner: NDArray[np.int64], how: Literal["mean", "max"]
) -> Scores:
    """Return the mean or maximum of clause values by text; clauses of a text must be adjacent."""
    starts = np.flatnonzero(np.r_[True, owner[1:] != owner[:-1]])
    wide = np.asarray(values, np.float64)
    if how == "max":
        return np.asarray(np.maximum.reduceat(wide, starts), np.float64)
    return np.asarray(np.add.reduceat(wide, starts) / np.bincount(owner), np.float64)


def _novelty_within(parts: Vectors, owner: NDArray[np.int64]) -> Scores:
    """Return the distance of each clause to the nearest clause of another text."""
    if owner[0] == owner[-1]:
        return np.zeros(len(parts))
    found = np.empty(len(parts))
    for first in range(0, len(parts), _STEP):
        rows = slice(first, first + _STEP)
        cosines = parts[rows] @ parts.T
        cosines[owner[rows, None] == owner] = -1.0
        found[rows] = 1.0 - cosines.max(axis=1)
    return found
