"""Comparisons of two sets of texts at equal size, by repeated subsampling."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from oodscen._numbers import whole_number
from oodscen._seeding import stream
from oodscen.data._base import Data
from oodscen.encoders._similarity import Vectors
from oodscen.errors import UsageError
from oodscen.metrics._diversity import mean_nearest, mean_pairwise
from oodscen.metrics._oodness import Measure
from oodscen.metrics._vectors.distances import frechet, mmd
from oodscen.statistics._significance import PERMUTATIONS, permutation_test, sign_flip

if TYPE_CHECKING:
    from oodscen.metrics._vectors.space import BaselineSpace

Paths = Sequence[str] | None
"""The path of each text of a set, by which texts are permuted; `None` permutes single texts."""


class Contrast(Data):
    """One figure of two sets at equal size."""

    a: float
    b: float
    difference: float
    """a - b."""
    low: float
    """2.5th percentile of the differences over the draws."""
    high: float
    """97.5th percentile. Both show the effect of the draw and are no confidence interval."""
    p_value: float | None = None
    """For OOD-ness only: two-sided, by permutation, or by sign flips if the sets are matched pairs."""


class Comparison(Data):
    """The figures of two sets of texts, means over draws of equal size."""

    size: int
    """Texts drawn from each set in each repeat."""
    repeats: int
    n_a: int
    n_b: int
    is_paired: bool = False
    """True if the i-th texts of both belong together; the test is of their differences."""
    oodness: Contrast
    nearest: Contrast
    """Diversity by the nearest text."""
    pairwise: Contrast
    """Diversity by the mean over pairs."""
    encoder: str
    baseline: str
    seed: int
    N: int = 0
    """Number of baseline texts."""
    definition: Measure = "tabulated"
    """Definition of OOD-ness."""

    def __str__(self) -> str:
        lines = [
            f"{self.n_a} and {self.n_b} texts, {self.repeats} draws of {self.size} from each, "
            f"against {self.N} baseline texts ({self.baseline}), embedded by {self.encoder}"
        ]
        for label, contrast in (
            ("OOD-ness", self.oodness),
            ("diversity, nearest", self.nearest),
            ("diversity, pairwise", self.pairwise),
        ):
            test = "" if contrast.p_value is None else f"  p = {contrast.p_value:.4f}"
            lines.append(
                f"{label:20} {contrast.a:+.3f}  {contrast.b:+.3f}  difference {contrast.difference:+.3f}{test}"
            )
        return "\n".join(lines)


class SetDistance(Data):
    """The distance between two sets as a whole; means over draws of equal size."""

    mmd: float
    """Squared maximum mean discrepancy, unbiased: about 0 for two draws of one source."""
    mmd_spread: float
    """Standard deviation over the draws."""
    frechet: float
    """Fréchet distance; comparable at the same `size` only."""
    frechet_spread: float
    size: int
    repeats: int
    n_a: int
    n_b: int
    encoder: str
    seed: int


def compare(
    space: "BaselineSpace",
    sets: tuple[Sequence[str], Sequence[str]],
    paths: tuple[Paths, Paths],
    *,
    size: int | None,
    repeats: int,
    paired: bool,
    definition: Measure,
) -> Comparison:
    """Return the comparison that `Metrics.compare` documents; `paths` are the labels of each set."""
    a, b = sets
    if paired and len(a) != len(b):
        raise UsageError(f"{len(a)} and {len(b)} texts are not matched pairs")
    whole_number("repeats", repeats, 1)
    drawn = _drawn_size(len(a), len(b), size)
    scores = [space.scores(texts, definition) for texts in sets]
    streams = ("pairs", "pairs") if paired else ("a", "b")
    figures = [
        _subsamples(space, name, texts, set_scores, drawn, repeats)
        for name, texts, set_scores in zip(streams, sets, scores, strict=True)
    ]
    if paired:
        gaps = scores[0] - scores[1]
        p_value = sign_flip(gaps, paths[0] or paths[1], seed=space.seed, replicates=PERMUTATIONS)
    else:
        p_value = permutation_test(scores[0], scores[1], paths, seed=space.seed)
    oodness, nearest, pairwise = (_contrast(*pair) for pair in zip(*figures, strict=True))
    return Comparison(
        size=drawn,
        repeats=repeats,
        n_a=len(a),
        n_b=len(b),
        is_paired=paired,
        oodness=oodness.model_copy(update={"p_value": p_value}),
        nearest=nearest,
        pairwise=pairwise,
        encoder=space.encoder.name,
        baseline=space.baseline.name,
        seed=space.seed,
        N=len(space.baseline),
        definition=definition,
    )


def distance(
    space: "BaselineSpace", first: Vectors, second: Vectors, *, size: int | None, repeats: int
) -> SetDistance:
    """Return the distance that `Metrics.distance` documents, of two sets of vectors."""
    whole_number("repeats", repeats, 1)
    drawn = _drawn_size(len(first), len(second), size)
    draws = stream(space.seed, "distance")
    figures = []
    for _ in range(repeats):
        a, b = _draw(draws, first, drawn), _draw(draws, second, drawn)
        figures.append((mmd(a, b), frechet(a, b)))
    mmds, frechets = np.array(figures).T
    return SetDistance(
        mmd=float(mmds.mean()),
        mmd_spread=float(mmds.std()),
        frechet=float(frechets.mean()),
        frechet_spread=float(frechets.std()),
        size=drawn,
        repeats=repeats,
        n_a=len(first),
        n_b=len(second),
        encoder=space.encoder.name,
        seed=space.seed,
    )


def _draw(draws: np.random.Generator, rows: Vectors, size: int) -> Vectors:
    """Return random rows; all of them keep their order, on which the last bits of a distance depend."""
    order = draws.permutation(len(rows))
    return rows if size == len(rows) else rows[order[:size]]


def _drawn_size(n: int, m: int, size: int | None) -> int:
    """Return the number of texts to draw from sets of n and m: `size`, or all of the smaller set.

    Raises:
        UsageError: If a set has fewer, or it is below 2.
    """
    smaller = min(n, m)
    if smaller < 2:
        raise UsageError(f"each set needs at least 2 texts to be compared; they have {n} and {m}")
    drawn = smaller if size is None else whole_number("size", size, 2)
    if drawn > smaller:
        raise UsageError(f"size is {drawn}, but the smaller set has {smaller} texts")
    return drawn


def _subsamples(
    space: "BaselineSpace",
    name: str,
    texts: Sequence[str],
    scores: NDArray[np.float64],
    size: int,
    repeats: int,
) -> NDArray[np.float64]:
    """Return OOD-ness and both diversities of the draws from one set: [3, repeats]."""
    vectors = space.vectors(texts)
    if size == len(texts):
        return np.repeat([_figures(vectors, scores)], repeats, axis=0).T
    draws = stream(space.seed, "compare", name)
    samples = (draws.permutation(len(texts))[:size] for _ in range(repeats))
    return np.array([_figures(vectors[rows], scores[rows]) for rows in samples]).T


def _figures(vectors: Vectors, oodness: NDArray[np.float64]) -> tuple[float, float, float]:
    """Return mean OOD-ness and both diversities of a set."""
    return float(oodness.mean()), -mean_nearest(vectors), -mean_pairwise(vectors)


def _contrast(a: NDArray[np.float64], b: NDArray[np.float64]) -> Contrast:
    low, high = np.quantile(a - b, [0.025, 0.975])
    return Contrast(
        a=float(a.mean()),
        b=float(b.mean()),
        difference=float((a - b).mean()),
        low=float(low),
        high=float(high),
    )
