"""Tests of a difference: paired answers on the same items, and two sets of scores.

Everything here that takes `clusters` treats the path, not the scene, as the unit that is exchanged. A p-value
from random draws is (1 + count) / (1 + draws), never 0. The order of the items changes no p-value: clusters are
sorted by their sums.
"""

import math
from collections.abc import Sequence
from itertools import compress

import numpy as np
from numpy.typing import NDArray

from oodscen._seeding import stream
from oodscen.data._base import Data
from oodscen.statistics._intervals import Floats
from oodscen.statistics._resampling import REPLICATES, blocks, cluster_numbers

PERMUTATIONS = 10_000
"""Number of random assignments in a permutation test of two sets."""

_EXACT_UP_TO = 12
"""The most clusters whose sign patterns (4,096) are all enumerated."""
_EQUAL = 1e-12
"""Difference of means or sums up to which it is none."""
_AS_EXTREME = 1e-9
"""Amount by which a sum of flipped differences may fall short of the one seen and count as equal."""


class PairedTest(Data):
    """The comparison of two answerers on the same items."""

    n: int
    """Items that both answered."""
    first_only: int
    """Items that only the first got right."""
    second_only: int
    difference: float
    """The first's share of right answers minus the second's, on the common items; of two classes the mean share."""
    p_mcnemar: float
    """Mid-p of McNemar's test; takes items as independent, and all alike."""
    p_exact: float
    """p of McNemar's exact test; never smaller than mid-p."""
    p_clustered: float
    """p of the permutation test that flips whole paths; the one to quote if paths have several scenes."""


def mcnemar(first_only: int, second_only: int) -> tuple[float, float]:
    """Return the exact two-sided p of McNemar's test, and its mid-p, by the items that only one got right.

    Sources: Q. McNemar, Psychometrika 12 (1947); mid-p: M. W. Fagerland, S. Lydersen, P. Laake,
    BMC Med. Res. Methodol. 13:91 (2013), who recommend it.
    """
    n, k = first_only + second_only, min(first_only, second_only)
    if n == 0:
        return 1.0, 1.0
    half = n * math.log(2.0)

    def mass(i: int) -> float:
        log = math.lgamma(n + 1) - math.lgamma(i + 1) - math.lgamma(n - i + 1) - half
        return math.exp(log)

    tail = math.fsum(mass(i) for i in range(k + 1))
    exact = min(1.0, 2.0 * tail)
    mid = min(1.0, 2.0 * tail - mass(k))
    return exact, 1.0 if first_only == second_only else mid


def paired_test(
    first: Floats,
    second: Floats,
    clusters: Sequence[str] | None = None,
    *,
    classes: NDArray[np.bool_] | None = None,
    seed: int = 0,
) -> PairedTest:
    """Return the comparison of two answerers on the items that both answered.

    Args:
        first: [n] 1 if right, 0 if wrong, NaN if there is no answer.
        second: [n], in the same order.
        clusters: [n] labels; without them every item is a cluster of its own.
        classes: [n] the items of one of two classes that weigh alike in the difference and in `p_clustered`, however
            many items each has, as in balanced accuracy.
        seed: Seed of the permutations.
    """
    has_both = np.isfinite(first) & np.isfinite(second)
    gaps = first[has_both] - second[has_both]
    if classes is not None:
        gaps = gaps * _balancing_weights(classes[has_both])
    labels = None if clusters is None else list(compress(clusters, has_both))
    first_only, second_only = int((gaps > 0).sum()), int((gaps < 0).sum())
    exact, mid = mcnemar(first_only, second_only)
    return PairedTest(
        n=len(gaps),
        first_only=first_only,
        second_only=second_only,
        difference=float(np.sort(gaps).mean()) if len(gaps) else 0.0,
        p_mcnemar=mid,
        p_exact=exact,
        p_clustered=sign_flip(gaps, labels, seed=seed),
    )


def _balancing_weights(classes: NDArray[np.bool_]) -> Floats:
    """Return [n] weights of mean 1 that give both classes the same sum; all are 1 if one class is empty."""
    n, size = len(classes), int(classes.sum())
    if size in (0, n):
        return np.ones(n)
    return np.where(classes, n / (2 * size), n / (2 * (n - size)))


def sign_flip(
    gaps: Floats,
    clusters: Sequence[str] | None = None,
    *,
    seed: int = 0,
    replicates: int = REPLICATES,
) -> float:
    """Return the two-sided p of the paired permutation test of [n] differences that flips whole clusters.

    If two answerers are equally good, swapping their names within a path changes nothing. With up to 12
    clusters that have a difference, all patterns are enumerated; with more, `replicates` random ones are drawn.
    """
    sums: Floats = np.zeros(0)
    if len(gaps):
        order, numbers = np.argsort(gaps), cluster_numbers(len(gaps), clusters)
        sums = np.bincount(numbers[order], weights=gaps[order]).astype(np.float64)
    sums = np.sort(sums[np.abs(sums) > _EQUAL])
    if not len(sums):
        return 1.0
    threshold = abs(float(sums.sum())) - _AS_EXTREME
    if len(sums) <= _EXACT_UP_TO:
        patterns = (np.arange(2 ** len(sums))[:, None] >> np.arange(len(sums))) & 1
        return float((np.abs((2.0 * patterns - 1.0) @ sums) >= threshold).mean())
    draws = stream(seed, "permutation", "signs")
    extreme = 0
    for size in blocks(replicates, len(sums)):
        flips = draws.integers(0, 2, size=(size, len(sums)))
        extreme += int((np.abs((2.0 * flips - 1.0) @ sums) >= threshold).sum())
    return (extreme + 1) / (replicates + 1)


def permutation_test(
    a: Floats,
    b: Floats,
    clusters: tuple[Sequence[str] | None, Sequence[str] | None] = (None, None),
    *,
    seed: int = 0,
    replicates: int = PERMUTATIONS,
) -> float:
    """Return the two-sided p-value of a difference this large between the means of two sets of scores.

    Whole clusters change sides; `clusters` holds the labels of either set.
    """
    sums_a, sizes_a = _cluster_sums(a, clusters[0])
    sums_b, sizes_b = _cluster_sums(b, clusters[1])
    sums, sizes = np.concatenate([sums_a, sums_b]), np.concatenate([sizes_a, sizes_b])
    threshold = abs(float(a.mean() - b.mean())) - _EQUAL
    generator = stream(seed, "permutation")
    extreme = 0
    for _ in range(replicates):
        order = generator.permutation(len(sums))
        first, second = order[: len(sums_a)], order[len(sums_a) :]
        gap = sums[first].sum() / sizes[first].sum() - sums[second].sum() / sizes[second].sum()
        extreme += abs(float(gap)) >= threshold
    return (1 + extreme) / (1 + replicates)


def _cluster_sums(values: Floats, clusters: Sequence[str] | None) -> tuple[Floats, Floats]:
    """Return the sums and the sizes of clusters of [n] values, in ascending order."""
    numbers = cluster_numbers(len(values), clusters)
    sums = np.bincount(numbers, weights=values).astype(np.float64)
    sizes = np.bincount(numbers).astype(np.float64)
    order = np.lexsort((sizes, sums))
    return sums[order], sizes[order]


def holm(values: Sequence[float]) -> list[float]:
    """Return p-values after Holm's correction for multiple comparisons, in the given order.

    Source: S. Holm, A simple sequentially rejective multiple test procedure, Scand. J. Stat. 6
    (1979).
    """
    order = sorted(range(len(values)), key=lambda index: values[index])
    corrected = [1.0] * len(values)
    largest = 0.0
    for rank, index in enumerate(order):
        largest = max(largest, min(1.0, (len(values) - rank) * values[index]))
        corrected[index] = largest
    return corrected
