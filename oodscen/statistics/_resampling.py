"""The bootstrap: resamples texts, or the paths that texts or scenes share.

Scenes of one path resemble one another, so ten of them carry less information than ten scenes of ten
paths. Everything here that takes `clusters` draws whole paths.
"""

from collections.abc import Iterator, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from oodscen._seeding import stream
from oodscen.statistics._intervals import (
    FEWEST_CLUSTERS,
    Floats,
    Interval,
    percentile_interval,
)

REPLICATES = 2000
"""Number of resampled sets of a bootstrap interval, and of sign flips in a permutation test."""

_CELLS = 4_000_000
"""The most draws that are kept in memory at a time."""
_ZERO = 1e-12
"""Denominator up to which it counts as zero."""


def blocks(replicates: int, units: int) -> Iterator[int]:
    """Yield the numbers of replicates to draw at a time, so that memory stays bounded."""
    step = max(1, _CELLS // max(units, 1))
    for done in range(0, replicates, step):
        yield min(step, replicates - done)


def cluster_numbers(n: int, clusters: Sequence[str] | None) -> NDArray[np.int64]:
    """Return the cluster number of each of n values, in the order of the labels; without clusters, 0 to n - 1."""
    if clusters is None:
        return np.arange(n)
    numbers = {label: number for number, label in enumerate(sorted(set(clusters)))}
    return np.array([numbers[label] for label in clusters], np.int64)


class Resampler:
    """Draws whole clusters with replacement, with the same draws for every figure.

    Clusters are drawn in the order of their labels, so that the order of the items changes no interval.

    Args:
        clusters: [n] label of every item; or n, if every item is a cluster of its own. Items without labels
            have to come in an order that depends on their values only.
        seed: Seed of the draws; the same seed gives the same intervals.
        replicates: Number of resampled sets.
        purpose: Name of the stream of draws; resamplers of different purposes draw independently.
    """

    def __init__(
        self,
        clusters: Sequence[str] | int,
        *,
        seed: int = 0,
        replicates: int = REPLICATES,
        purpose: str = "clusters",
    ) -> None:
        n, labels = (clusters, None) if isinstance(clusters, int) else (len(clusters), clusters)
        self.is_clustered = labels is not None
        self.cluster = cluster_numbers(n, labels)
        """[n], the cluster's number of every item."""
        self.units = int(self.cluster.max(initial=-1)) + 1
        self._replicates = replicates
        self._seed = seed
        self._purpose = purpose

    @cached_property
    def weights(self) -> Floats:
        """The number of times each cluster was drawn: [replicates, units]."""
        return np.concatenate(list(self._draws(self.units)))

    def blocks(self, beside: "Resampler | None" = None) -> Iterator[Floats]:
        """Yield the rows of `weights`, in blocks if they are too many to keep; those of two resamplers keep step."""
        units = max(self.units, beside.units) if beside else self.units
        if units * self._replicates <= _CELLS:
            yield self.weights
        else:
            yield from self._draws(units)

    def ratios(self, above: Floats, below: Floats) -> Floats:
        """Return [replicates, m] resampled ratios of the sums of [n, m] values; NaN if a denominator is zero."""
        sums_above, sums_below = self.summed(above), self.summed(below)
        return np.concatenate(
            [quotients(weights @ sums_above, weights @ sums_below) for weights in self.blocks()]
        )

    def summed(self, values: Floats) -> Floats:
        """Return the sums of [n, m] values within clusters: [units, m].

        Values are added from the lowest, so that the order of the items does not change how the sums are rounded.
        """
        sums = np.zeros((self.units, values.shape[1]))
        ranks = np.argsort(values, axis=0)
        np.add.at(
            sums,
            (self.cluster[ranks], np.arange(values.shape[1])),
            np.take_along_axis(values, ranks, axis=0),
        )
        return sums

    def _draws(self, widest: int) -> Iterator[Floats]:
        generator = stream(self._seed, "bootstrap", self._purpose)
        equal = np.full(self.units, 1.0 / max(self.units, 1))
        for size in blocks(self._replicates, widest):
            if self.units:
                yield generator.multinomial(self.units, equal, size=size).astype(np.float64)
            else:
                yield np.zeros((size, 0))

    def count(self, mask: NDArray[np.bool_]) -> int:
        """Return the number of clusters with an item in a mask [n]."""
        return int((np.bincount(self.cluster, weights=mask) > 0).sum())


def bootstrap_mean(
    values: Floats,
    clusters: Sequence[str] | None = None,
    *,
    seed: int = 0,
    replicates: int = REPLICATES,
) -> Interval | None:
    """Return the interval of the mean of [n] finite values; `None` if there are too few units to draw from."""
    resampler = _resampler(len(values), clusters, seed, replicates, "mean")
    if resampler.units < FEWEST_CLUSTERS:
        return None
    column = np.asarray(values, np.float64)[:, None]
    if clusters is None:
        column = np.sort(column, axis=0)
    means = resampler.ratios(column, np.ones_like(column))[:, 0]
    return percentile_interval(means, resampler.units, is_clustered=resampler.is_clustered)


def bootstrap_median(
    values: Floats,
    clusters: Sequence[str] | None = None,
    *,
    seed: int = 0,
    replicates: int = REPLICATES,
) -> Interval | None:
    """Return the interval of the median of [n] finite values; `None` if there are too few units to draw from."""
    resampler = _resampler(len(values), clusters, seed, replicates, "median")
    if resampler.units < FEWEST_CLUSTERS:
        return None
    order = np.argsort(values, kind="stable")
    ranked = np.asarray(values, np.float64)[order]
    # Without clusters every rank is a unit of its own, so that the order of the items changes nothing.
    unit = resampler.cluster if clusters is None else resampler.cluster[order]
    rows = next(blocks(replicates, len(ranked)))
    medians = [
        _medians(ranked, weights[first : first + rows][:, unit])
        for weights in resampler.blocks()
        for first in range(0, len(weights), rows)
    ]
    return percentile_interval(
        np.concatenate(medians), resampler.units, is_clustered=resampler.is_clustered
    )


def _medians(ranked: Floats, counts: Floats) -> Floats:
    """Return the medians [r] of [n] values in order, each taken as often as the rows of [r, n] counts say."""
    reached = np.cumsum(counts, axis=1)
    half = 0.5 * reached[:, -1:]
    below, above = (reached < half).sum(axis=1), (reached <= half).sum(axis=1)
    medians: Floats = 0.5 * (ranked[below] + ranked[above])
    return medians


def bootstrap_pairwise(
    vectors: NDArray[np.float32],
    clusters: Sequence[str] | None = None,
    *,
    seed: int = 0,
    replicates: int = REPLICATES,
) -> Interval | None:
    """Return the interval of the mean cosine over the pairs of [n, d] rows of unit length or zero.

    A unit that is drawn twice is not paired with its own copy: such pairs do not exist in a set of
    distinct texts and would pull every replicate towards 1. A replicate that drew only one unit of a
    single text has no pairs and does not count.

    Returns:
        `None` if there are too few units to draw from, or no replicate has a pair.
    """
    resampler = _resampler(len(vectors), clusters, seed, replicates, "pairwise")
    if resampler.units < FEWEST_CLUSTERS:
        return None
    rows = vectors.astype(np.float64)
    if clusters is None:
        rows = rows[np.lexsort(rows.T[::-1])]
    sums = resampler.summed(rows)
    sizes = np.bincount(resampler.cluster, minlength=resampler.units).astype(np.float64)
    lengths = np.square(sums).sum(axis=1)
    inner = lengths - resampler.summed(np.square(rows)).sum(axis=1)
    means = []
    for weights in resampler.blocks():
        squared = np.square(weights)
        total = np.square(weights @ sums).sum(axis=1) - squared @ lengths + weights @ inner
        pairs = (
            np.square(weights @ sizes)
            - squared @ np.square(sizes)
            + weights @ (sizes * (sizes - 1))
        )
        means.append(quotients(total, pairs))
    return percentile_interval(
        np.concatenate(means), resampler.units, is_clustered=resampler.is_clustered
    )


def _resampler(
    n: int, clusters: Sequence[str] | None, seed: int, replicates: int, purpose: str
) -> Resampler:
    return Resampler(
        n if clusters is None else clusters, seed=seed, replicates=replicates, purpose=purpose
    )


def quotients(above: Floats, below: Floats) -> Floats:
    """Return quotients; NaN where the denominator, which is not negative, is zero."""
    return np.divide(above, below, out=np.full_like(above, np.nan), where=below > _ZERO)
