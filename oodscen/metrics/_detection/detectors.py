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
                  their 10 nearest; texts tied for the last places count in equal parts. At least 0; about 1 for
                  ordinary text. After Breunig et al., *LOF*, 2000. Misled by near-duplicates in the baseline, next
                  to which everything is sparse.
    whitened      -max cos(W(b - mu), W(e - mu)), W = (Sigma + c I)^-1/4, c = 4 % of the mean variance: features that vary much among ordinary texts
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
from oodscen.metrics._detection.anchors import load_anchors
from oodscen.metrics._oodness import Measure

DetectorName = Literal["kth", "mahalanobis", "density", "whitened", "events"]
DETECTORS: tuple[DetectorName, ...] = get_args(DetectorName)

Encode = Callable[[Sequence[str]], Vectors]
"""Encodes texts to vectors of unit length or zero."""
Scores = NDArray[np.float64]

_Score = Callable[[Sequence[str], Vectors], Scores]
"""A fitted detector: scores texts with their vectors."""

DECIMALS = 12
"""Decimals of a score; beyond them, products of matrices depend on the number of threads."""
_K = 10
"""Neighbours of a text."""
_TIE_FACTOR = 4
"""Neighbours that are looked at for ties, as a multiple of k."""
_TIE = 2e-6
"""Difference of cosines up to which it is rounding."""
_SHRINKAGE = 0.3
"""Share by which the covariance of `events` is shrunk."""
_WHITENING_POWER = 0.25
_WHITENING_FLOOR = 0.04
"""Variance that is added to every axis before whitening, as a share of the mean."""
_EVENT_WEIGHTS = np.array([0.5, 0.5, 1.0, 0.25, 0.25])
"""Weights of the five parts of `events`: judgement of text and clauses, novelty, leaning of text and clauses."""
_STEP = 2048
"""Clauses of a block."""
_LEAST_APART = 1e-6
"""Least distance of neighbours from theirs by which a text's distance is divided."""
_LEAST_LENGTH = 1e-12
"""Least length or variance by which a vector is divided."""
_NO_SPREAD = 1e-9
"""Standard deviation up to which values are only centred."""
_CLAUSE_BREAK = re.compile(
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
        self._fitted: dict[str, _Score] = {}

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

    def _kth(self) -> _Score:
        k = min(_K, len(self._vectors))
        return lambda _, vectors: 0.0 - largest(vectors, self._vectors, k)[0][:, -1]

    def _density(self) -> _Score:
        n = len(self._vectors)
        k = min(_K, max(n - 1, 1))
        skip = np.arange(n) if n > 1 else None
        baseline_distances = 1.0 - largest(self._vectors, self._vectors, k, skip)[0].mean(axis=1)

        def score(_: Sequence[str], vectors: Vectors) -> Scores:
            cosines, neighbours = largest(vectors, self._vectors, min(_TIE_FACTOR * k, n))
            last = cosines[:, k - 1 : k]
            is_nearer, is_tied = cosines > last + _TIE, np.abs(cosines - last) <= _TIE
            share = (k - is_nearer.sum(axis=1)) / is_tied.sum(axis=1)
            weights = np.where(is_nearer, 1.0, is_tied * share[:, None])
            distances = 1.0 - cosines[:, :k].mean(axis=1)
            neighbour_distances = (weights * baseline_distances[neighbours]).sum(axis=1) / k
            return np.asarray(distances / np.maximum(neighbour_distances, _LEAST_APART), np.float64)

        return score

    def _mahalanobis(self) -> _Score:
        covariance = self._covariance()
        inverse = np.linalg.pinv(shrunk(covariance, ledoit_wolf(self._vectors - self._mean)))

        def score(_: Sequence[str], vectors: Vectors) -> Scores:
            centred = vectors - self._mean
            squared = np.einsum("ij,jk,ik->i", centred, inverse, centred, optimize=True)
            return np.asarray(np.sqrt(np.maximum(squared, 0.0)), np.float64)

        return score

    def _whitened(self) -> _Score:
        values, axes = np.linalg.eigh(self._covariance())
        floor = max(float(values.mean()) * _WHITENING_FLOOR, _LEAST_LENGTH)
        whitening = axes / (np.maximum(values, 0.0) + floor) ** _WHITENING_POWER

        def whitened(vectors: Vectors) -> Vectors:
            return unit(((vectors - self._mean) @ whitening).astype(np.float32))

        baseline = whitened(self._vectors)
        return lambda _, vectors: 0.0 - nearest(whitened(vectors), baseline).cosine

    def _events(self) -> _Score:
        direction = np.linalg.pinv(shrunk(self._covariance(), _SHRINKAGE)) @ self._axis()
        calm, odd = (self._encode(side) for side in zip(*load_anchors().kinds, strict=True))

        def leaning(rows: Vectors) -> Scores:
            return np.asarray((rows @ odd.T).max(axis=1) - (rows @ calm.T).max(axis=1), np.float64)

        def parts_of(
            vectors: Vectors, clause_vectors: Vectors, novelty: Scores, owner: NDArray[np.int64]
        ) -> tuple[Scores, ...]:
            return (
                vectors @ direction,
                _by_text(clause_vectors @ direction, owner, "mean"),
                _by_text(novelty, owner, "max"),
                leaning(vectors),
                _by_text(leaning(clause_vectors), owner, "mean"),
            )

        baseline_clauses, baseline_owner = _split(self._texts)
        baseline = self._encode(baseline_clauses)
        novelty_within = _novelty_within(baseline, baseline_owner)
        samples = parts_of(self._vectors, baseline, novelty_within, baseline_owner)
        standards = [_Standard(sample) for sample in samples]

        def score(texts: Sequence[str], vectors: Vectors) -> Scores:
            all_clauses, owner = _split(texts)
            clause_vectors = self._encode(all_clauses)
            novelty = 1.0 - nearest(clause_vectors, baseline).cosine
            parts = parts_of(vectors, clause_vectors, novelty, owner)
            standardised = [standard(part) for standard, part in zip(standards, parts, strict=True)]
            return np.asarray(_EVENT_WEIGHTS @ np.array(standardised), np.float64)

        return score

    def _axis(self) -> NDArray[np.float64]:
        """Return the direction from ordinary to not ordinary, in which every sort of anchors counts alike."""
        total = np.zeros(self._vectors.shape[1])
        for pairs in load_anchors():
            calm, odd = (self._encode(side).astype(np.float64) for side in zip(*pairs, strict=True))
            step = (odd - calm).mean(axis=0)
            total += step / max(float(np.linalg.norm(step)), _LEAST_LENGTH)
        return total

    def _covariance(self) -> NDArray[np.float64]:
        centred = self._vectors.astype(np.float64) - self._mean
        return np.asarray(centred.T @ centred / len(centred), np.float64)


def shrunk(covariance: NDArray[np.float64], share: float) -> NDArray[np.float64]:
    """Return a covariance moved by `share` towards the multiple of the identity with its trace."""
    size = len(covariance)
    level = float(np.trace(covariance)) / size
    return (1.0 - share) * covariance + share * level * np.eye(size)


def ledoit_wolf(centred: NDArray[np.floating]) -> float:
    """Return the shrinkage intensity for the covariance of [n, d] rows, less their mean.

    Source: Ledoit and Wolf, *A well-conditioned estimator for large-dimensional covariance matrices*,
    2004. In [0, 1]; 1 if all rows are equal.
    """
    rows = np.asarray(centred, np.float64)
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
    parts = [part.strip(" .,;:?!\t\n") for part in _CLAUSE_BREAK.split(text)]
    longer = tuple(part for part in parts if len(part.split()) > 1)
    return longer[:_MOST_CLAUSES] or (text,)


def _split(texts: Sequence[str]) -> tuple[list[str], NDArray[np.int64]]:
    """Return all clauses, and for each the index of its text."""
    by_text = [clauses(text) for text in texts]
    owner = np.repeat(np.arange(len(texts)), [len(parts) for parts in by_text])
    return [part for parts in by_text for part in parts], owner


def _by_text(
    values: NDArray[np.floating], owner: NDArray[np.int64], statistic: Literal["mean", "max"]
) -> Scores:
    """Return the mean or maximum of clause values by text; clauses of a text must be adjacent."""
    starts = np.flatnonzero(np.r_[True, owner[1:] != owner[:-1]])
    wide = np.asarray(values, np.float64)
    if statistic == "max":
        return np.asarray(np.maximum.reduceat(wide, starts), np.float64)
    return np.asarray(np.add.reduceat(wide, starts) / np.bincount(owner), np.float64)


def _novelty_within(clause_vectors: Vectors, owner: NDArray[np.int64]) -> Scores:
    """Return the distance of each clause to the nearest clause of another text; 0 if there is no other text."""
    novelty = np.zeros(len(clause_vectors))
    if owner[0] == owner[-1]:
        return novelty
    for first in range(0, len(clause_vectors), _STEP):
        rows = slice(first, first + _STEP)
        cosines = clause_vectors[rows] @ clause_vectors.T
        cosines[owner[rows, None] == owner] = -1.0
        novelty[rows] = 1.0 - cosines.max(axis=1)
    return novelty
