"""Intervals: bootstrap over texts, or over the paths that texts share, and Wilson's for shares."""

import math
from collections.abc import Iterator, Sequence
from statistics import NormalDist
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from oodscen._seeding import stream
from oodscen.data._base import Data

_CELLS = 4_000_000
_NORMAL = NormalDist()


class Interval(Data):
    """A percentile bootstrap interval.

    It shows how much the figure would vary with another draw of similar texts (or paths). It does not
    cover the choice of encoder, baseline or definition.
    """

    noun: ClassVar[str] = "interval"

    low: float
    high: float
    level: float = 0.95
    replicates: int = Field(ge=1)
    units: int = Field(ge=2)
    """Number of resampled texts, or clusters of texts."""
    is_clustered: bool = False
    """True if whole clusters (the texts of one path) were resampled, because their texts resemble one another."""


def wilson(hits: float, n: float, *, level: float = 0.95) -> tuple[float, float]:
    """Return the Wilson score interval of a share; (0, 1) if nothing was counted.

    Source: E. B. Wilson, Probable inference, the law of succession, and statistical inference,
    JASA 22 (1927).

    Args:
        hits: Number of hits; fractional after a correction for clustering.
        n: Number of trials.
        level: Confidence level.
    """
    if n <= 0:
        return 0.0, 1.0
    z = _NORMAL.inv_cdf(0.5 + level / 2)
    share, z2 = hits / n, z * z
    middle = (share + z2 / (2 * n)) / (1 + z2 / n)
    half = z / (1 + z2 / n) * math.sqrt(share * (1 - share) / n + z2 / (4 * n * n))
    low = 0.0 if hits <= 0 else max(middle - half, 0.0)
    return low, 1.0 if hits >= n else min(middle + half, 1.0)


def bootstrap_mean(
    values: NDArray[np.float64],
    clusters: Sequence[str] | None = None,
    *,
    seed: int = 0,
    replicates: int = 2000,
    level: float = 0.95,
) -> Interval | None:
    """Return the interval of a mean.

    Args:
        values: [n].
        clusters: [n] labels; texts with the same label are drawn together.
        seed: Seed of the draws; the same seed gives the same interval.
        replicates: Number of resampled sets.
        level: Share of the replicates that lie inside.

    Returns:
        `None` if fewer than two units can be drawn.
    """
    member = members(len(values), clusters)
    units = int(member.max(initial=-1)) + 1
    if units < 2:
        return None
    sums = np.bincount(member, weights=values, minlength=units)
    sizes = np.bincount(member, minlength=units).astype(np.float64)
    found = [
        (weights @ sums) / (weights @ sizes)
        for weights in _draws(units, replicates, stream(seed, "bootstrap", "mean"))
    ]
    return _interval(found, level, units, clusters is not None)


def bootstrap_pairwise(
    vectors: NDArray[np.float32],
    clusters: Sequence[str] | None = None,
    *,
    seed: int = 0,
    replicates: int = 2000,
    level: float = 0.95,
) -> Interval | None:
    """Return the interval of the mean cosine over the pairs of a set.

    A unit that is drawn twice is not paired with its own copy: such pairs do not exist in a set of
    distinct texts and would pull every replicate towards 1.

    Args:
        vectors: [n, d], rows of unit length or zero.
        clusters: [n] labels; texts with the same label are drawn together.
        seed: Seed of the draws.
        replicates: Number of resampled sets.
        level: Share of the replicates that lie inside.

    Returns:
        `None` if fewer than two units can be drawn.
    """
    member = members(len(vectors), clusters)
    units = int(member.max(initial=-1)) + 1
    if units < 2:
        return None
    wide = vectors.astype(np.float64)
    sums = np.zeros((units, wide.shape[1]))
    np.add.at(sums, member, wide)
    sizes = np.bincount(member, minlength=units).astype(np.float64)
    lengths = np.square(sums).sum(axis=1)
    inner = lengths - np.bincount(member, weights=np.square(wide).sum(axis=1), minlength=units)
    found = []
    for weights in _draws(units, replicates, stream(seed, "bootstrap", "pairwise")):
        squared = np.square(weights)
        total = np.square(weights @ sums).sum(axis=1) - squared @ lengths + weights @ inner
        pairs = (
            np.square(weights @ sizes)
            - squared @ np.square(sizes)
            + weights @ (sizes * (sizes - 1))
        )
        # A replicate that drew only one unit of a single text has no pairs.
        found.append(total[pairs > 0] / pairs[pairs > 0])
    return _interval(found, level, units, clusters is not None)


def members(n: int, clusters: Sequence[str] | None) -> NDArray[np.int64]:
    """Return the cluster number of each of n values, in order of appearance; without clusters, 0 to n - 1."""
    if clusters is None:
        return np.arange(n)
    order: dict[str, int] = {}
    return np.array([order.setdefault(label, len(order)) for label in clusters], np.int64)


def _draws(
    units: int, replicates: int, generator: np.random.Generator
) -> Iterator[NDArray[np.float64]]:
    """Yield blocks [b, units] with the number of times each unit was drawn in each replicate."""
    step = max(1, _CELLS // units)
    equal = np.full(units, 1.0 / units)
    for done in range(0, replicates, step):
        size = min(step, replicates - done)
        yield generator.multinomial(units, equal, size=size).astype(np.float64)


def _interval(
    found: Sequence[NDArray[np.float64]], level: float, units: int, is_clustered: bool
) -> Interval:
    values = np.concatenate(found)
    tail = (1.0 - level) / 2.0
    low, high = np.quantile(values, [tail, 1.0 - tail])
    return Interval(
        low=float(low),
        high=float(high),
        level=level,
        replicates=len(values),
        units=units,
        is_clustered=is_clustered,
    )
