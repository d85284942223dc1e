"""Tests of a difference: paired answers on the same items, and two sets of scores.

Everything here that takes `clusters` treats the path, not the scene, as the unit that is exchanged. A p-value
from random draws is (1 + count) / (1 + draws), never 0. The order of the items changes no p-value: clusters are
sorted by their sums.
"""

import math
from collections.abc import Sequence

import numpy as np

from oodscen._seeding import stream
from oodscen.data._base import Data
from oodscen.statistics._intervals import Floats
from oodscen.statistics._resampling import REPLICATES, blocks, members

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
    """The first's share of right answers minus the second's, on the common items."""
    p_mcnemar: float
    """Mid-p of McNemar's test; takes items as independent."""
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


def paired(
    first: Floats, second: Floats, clusters: Sequence[str] | None = None, *, seed: int = 0
) -> PairedTest:
    """Return the comparison of two answerers on the items that both answered.

    Args:
        first: [n] 1 if right, 0 if wrong, NaN if there is no answer.
        second: [n], in the same order.
        clusters: [n] labels; without them every item is a cluster of its own.
        seed: Seed of the permutations.
    """
    both = np.isfinite(first) & np.isfinite(second)
    one, two = first[both], second[both]
    labels = (
        None if clusters is None else [c for c, keep in zip(clusters, both, strict=True) if keep]
    )
    gap = one - two
    first_only, second_only = int((gap > 0).sum()), int((gap < 0).sum())
    exact, mid = mcnemar(first_only, second_only)
    return PairedTest(
        n=len(gap),
        first_only=first_only,
        second_only=second_only,
        difference=float(gap.mean()) if len(gap) else 0.0,
        p_mcnemar=mid,
        p_exact=exact,
        p_clustered=sign_flip(gap, labels, seed=seed),
    )


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
        sums = np.bincount(members(len(gaps), clusters), weights=gaps).astype(np.float64)
    sums = np.sort(sums[np.abs(sums) > _EQUAL])
    if not len(sums):
        return 1.0
    seen = abs(float(sums.sum())) - _AS_EXTREME
    if len(sums) <= _EXACT_UP_TO:
        patterns = (np.arange(2 ** len(sums))[:, None] >> np.arange(len(sums))) & 1
        return float((np.abs((2.0 * patterns - 1.0) @ sums) >= seen).mean())
    draws = stream(seed, "permutation", "signs")
    extreme = 0
    for size in blocks(replicates, len(sums)):
        flips = draws.integers(0, 2, size=(size, len(sums)))
        extreme += int((np.abs((2.0 * flips - 1.0) @ sums) >= seen).sum())
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
    parts = []
    for values, labels in ((a, clusters[0]), (b, clusters[1])):
        member = members(len(values), labels)
        own, items = np.bincount(member, weights=values), np.bincount(member)
        order = np.lexsort((items, own))
        parts.append((own[order], items[order]))
    sums, sizes = (np.concatenate(column).astype(np.float64) for column in zip(*parts, strict=True))
    first = len(parts[0][0])
    seen = abs(float(a.mean() - b.mean()))
    generator = stream(seed, "permutation")
    count = 0
    for _ in range(replicates):
        side = generator.permutation(len(sums))
        one, other = side[:first], side[first:]
        gap = sums[one].sum() / sizes[one].sum() - sums[other].sum() / sizes[other].sum()
        count += abs(float(gap)) >= seen - _EQUAL
    return (1 + count) / (1 + replicates)


def holm(values: Sequence[float]) -> list[float]:
    """Return p-values after Holm's correction for multiple comparisons, in the given order.

    Source: S. Holm, A simple sequentially rejective multiple test procedure, Scand. J. Stat. 6
    (1979).
    """
    order = sorted(range(len(values)), key=lambda index: values[index])
    found = [1.0] * len(values)
    worst = 0.0
    for rank, index in enumerate(order):
        worst = max(worst, min(1.0, (len(values) - rank) * values[index]))
        found[index] = worst
    return found
