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


class Contrast(Data):
    """One figure of two sets at equal size."""

    a: float
    b: float
    difference: float
    """a - b."""
    low: float
    """2.5 % of the differences over the subsamples."""
    high: float
    """97.5 % of the differences. Shows the effect of the draw; not a confidence interval."""
    p_value: float | None = None
    """For OOD-ness only: two-sided, by permutation, or by sign flips if the sets are matched pairs."""


class Comparison(Data):
    """A comparison of two sets of texts at equal size, by repeated subsampling."""

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
            f"{self.n_a} and {self.n_b} texts, {self.repeats} draws of {self.size} from either, "
            f"against {self.N} of {self.baseline} by {self.encoder}"
        ]
        for label, found in (
            ("OOD-ness", self.oodness),
            ("diversity, nearest", self.nearest),
            ("diversity, pairwise", self.pairwise),
        ):
            test = "" if found.p_value is None else f"  p = {found.p_value:.4f}"
            lines.append(
                f"{label:20} {found.a:+.3f}  {found.b:+.3f}  difference {found.difference:+.3f}{test}"
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
    """Return the comparison that `Metrics.compare` documents; `paths` are labels of either set."""
    a, b = sets
    drawn = drawn_size(len(a), len(b), size, repeats)
    if paired and len(a) != len(b):
        raise UsageError(f"{len(a)} and {len(b)} texts are not matched pairs")
    values = [space.scores(texts, definition) for texts in sets]
    names = ("pairs", "pairs") if paired else ("a", "b")
    figures = [
        _subsamples(space, name, texts, own, drawn, repeats)
        for name, texts, own in zip(names, sets, values, strict=True)
    ]
    if paired:
        gaps = values[0] - values[1]
        p_value = sign_flip(gaps, paths[0], seed=space.seed, replicates=PERMUTATIONS)
    else:
        p_value = permutation_test(values[0], values[1], paths, seed=space.seed)
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
    drawn = drawn_size(len(first), len(second), size, repeats)
    draws = stream(space.seed, "distance")
    found = []
    for _ in range(repeats):
        one, other = (rows[draws.permutation(len(rows))[:drawn]] for rows in (first, second))
        found.append((mmd(one, other), frechet(one, other)))
    squared, moments = np.array(found).T
    return SetDistance(
        mmd=float(squared.mean()),
        mmd_spread=float(squared.std()),
        frechet=float(moments.mean()),
        frechet_spread=float(moments.std()),
        size=drawn,
        repeats=repeats,
        n_a=len(first),
        n_b=len(second),
        encoder=space.encoder.name,
        seed=space.seed,
    )


def drawn_size(n: int, m: int, size: int | None, repeats: int) -> int:
    """Return the number of texts to draw from sets of n and m: `size`, or all of the smaller set.

    Raises:
        UsageError: If a set has fewer, or it is below 2.
    """
    drawn = min(n, m) if size is None else whole_number("size", size, 2)
    whole_number("repeats", repeats, 1)
    if not 2 <= drawn <= min(n, m):
        raise UsageError(
            f"sets of {n} and {m} texts cannot be compared by {repeats} draws of {drawn}: at least "
            "2 texts and at most all of the smaller set"
        )
    return drawn


def _subsamples(
    space: "BaselineSpace",
    name: str,
    texts: Sequence[str],
    values: NDArray[np.float64],
    size: int,
    repeats: int,
) -> np.ndarray:
    """Return OOD-ness and both diversities of the draws from one set: [3, repeats]."""
    vectors = space.vectors(texts)
    draws = stream(space.seed, "compare", name)
    found = []
    for _ in range(repeats):
        chosen = draws.permutation(len(texts))[:size]
        part = vectors[chosen]
        found.append((values[chosen].mean(), -mean_nearest(part), -mean_pairwise(part)))
    return np.array(found).T


def _contrast(a: np.ndarray, b: np.ndarray) -> Contrast:
    low, high = np.quantile(a - b, [0.025, 0.975])
    return Contrast(
        a=float(a.mean()),
        b=float(b.mean()),
        difference=float((a - b).mean()),
        low=float(low),
        high=float(high),
    )
