"""Separation of two sets of scores: area under the ROC curve, and tests of a difference.

    auroc             share of pairs (x, y) with x < y, ties half. In [0, 1]; 0.5 is no separation, 1 is a perfect
                      order. The Mann-Whitney statistic over n m. Misled by sets that also differ in something
                      irrelevant: style, length.
    permutation test  two-sided p-value of a difference in means this large if labels are exchangeable.
    sign-flip test    the same for matched pairs: the sign of each difference is exchangeable.

p-values are (1 + count) / (1 + draws), never 0. Units that belong together (the texts of one path) are permuted
together.
"""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from oodscen._seeding import stream
from oodscen.data._base import Data
from oodscen.statistics._resampling import members

_DRAWS = 10_000
_CELLS = 4_000_000
Values = NDArray[np.float64]


class Auroc(Data):
    """Area under the ROC curve of two sets of scores, with a bootstrap interval."""

    noun: ClassVar[str] = "AUROC"

    value: float
    """In [0, 1]; 0.5 is no separation, 1 puts every text of the second set above all of the first."""
    low: float | None
    """2.5 % of the replicates; `None` if either set has fewer than two units."""
    high: float | None
    replicates: int
    n_ordinary: int
    n_ood: int
    is_paired: bool
    """True if matched texts were resampled together."""


def auroc(ordinary: Values, ood: Values) -> float:
    """Return the share of pairs in which the OOD score is the higher; ties count half."""
    order = np.sort(ordinary)
    below = np.searchsorted(order, ood, "left") + np.searchsorted(order, ood, "right")
    return float(below.sum() / (2.0 * len(ordinary) * len(ood)))


def auroc_interval(
    ordinary: Values,
    ood: Values,
    clusters: Sequence[str] | None = None,
    *,
    is_paired: bool = False,
    seed: int = 0,
    replicates: int = 1000,
) -> Auroc:
    """Return the AUROC with its interval.

    Args:
        ordinary: [m] scores.
        ood: [n] scores.
        clusters: [n] labels of the OOD texts; texts with the same label are resampled together.
        is_paired: Whether the i-th scores of both sets belong together and are resampled together.
        seed: Seed of the draws.
        replicates: Number of resampled sets.
    """
    member = members(len(ood), clusters)
    units = int(member.max()) + 1
    low = high = None
    if units > 1 and len(ordinary) > 1:
        grid = (ood[:, None] > ordinary) + 0.5 * (ood[:, None] == ordinary)
        draws = stream(seed, "bootstrap", "auroc")
        found = []
        for _ in range(replicates):
            counts = np.bincount(draws.integers(0, units, units), minlength=units)
            weights = counts[member].astype(np.float64)
            if is_paired:
                others = weights
            else:
                size = len(ordinary)
                others = np.bincount(draws.integers(0, size, size), minlength=size).astype(float)
            found.append(weights @ grid @ others / (weights.sum() * others.sum()))
        low, high = (float(value) for value in np.quantile(found, [0.025, 0.975]))
    return Auroc(
        value=auroc(ordinary, ood),
        low=low,
        high=high,
        replicates=replicates,
        n_ordinary=len(ordinary),
        n_ood=len(ood),
        is_paired=is_paired,
    )


def sign_flip_test(differences: Values, *, seed: int = 0, draws: int = _DRAWS) -> float:
    """Return the two-sided p-value of a mean of paired differences this far from 0.

    Args:
        differences: [n], one per pair (or per cluster of pairs).
        seed: Seed of the draws.
        draws: Number of random assignments of signs.
    """
    n = len(differences)
    seen = abs(float(differences.mean()))
    generator = stream(seed, "sign-flip")
    count = done = 0
    while done < draws:
        size = min(max(1, _CELLS // n), draws - done)
        signs = generator.integers(0, 2, (size, n)) * 2.0 - 1.0
        count += int((np.abs(signs @ differences) / n >= seen - 1e-12).sum())
        done += size
    return (1 + count) / (1 + draws)


def permutation_test(
    a: Values,
    b: Values,
    clusters: tuple[Sequence[str] | None, Sequence[str] | None] = (None, None),
    *,
    seed: int = 0,
    draws: int = _DRAWS,
) -> float:
    """Return the two-sided p-value of a difference this large between the means of two sets.

    Args:
        a: [n] scores.
        b: [m] scores.
        clusters: Labels of either set; whole clusters change sides.
        seed: Seed of the draws.
        draws: Number of random assignments.
    """
    parts = []
    for values, labels in ((a, clusters[0]), (b, clusters[1])):
        member = members(len(values), labels)
        parts.append((np.bincount(member, weights=values), np.bincount(member)))
    sums, sizes = (np.concatenate(column).astype(np.float64) for column in zip(*parts, strict=True))
    units, first = len(sums), len(parts[0][0])
    seen = abs(float(a.mean() - b.mean()))
    generator = stream(seed, "permutation")
    count = 0
    for _ in range(draws):
        side = generator.permutation(units)
        one, other = side[:first], side[first:]
        gap = sums[one].sum() / sizes[one].sum() - sums[other].sum() / sizes[other].sum()
        count += abs(float(gap)) >= seen - 1e-12
    return (1 + count) / (1 + draws)
