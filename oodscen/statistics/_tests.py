"""Intervals and tests for right or wrong answers on clustered items.

Scenes of one path resemble one another, so ten of them carry less information than ten scenes of ten
paths. Every function here that takes `clusters` treats the path, not the scene, as the sampled unit.
Arrays are [n] or [n, m] float64; NaN marks a missing value.
"""

import math
from collections.abc import Sequence
from statistics import NormalDist
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from oodscen._seeding import stream
from oodscen.data._base import Data
from oodscen.statistics._resampling import members, wilson

Floats = NDArray[np.float64]

REPLICATES = 2000
"""Number of resampled sets of a bootstrap interval, and of sign flips in a permutation test."""
FEWEST_CLUSTERS = 5
"""The fewest clusters for a percentile bootstrap; with fewer, it is far too narrow and not computed."""

_NORMAL = NormalDist()
_EXACT_UP_TO = 12
"""The most clusters whose sign patterns (4,096) are all enumerated."""


class Bounds(Data):
    """A 95 % interval of a figure, with the method that produced it."""

    noun: ClassVar[str] = "interval"

    low: float
    high: float
    method: Literal["wilson", "cluster bootstrap"]
    units: int = Field(ge=1)
    """Number of units taken as independent: items (`wilson`) or paths."""


class PairedTest(Data):
    """The comparison of two answerers on the same items."""

    noun: ClassVar[str] = "paired test"

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
    """p of the permutation test that flips whole paths; the one to trust if paths have several scenes."""


class Resampler:
    """Draws whole clusters with replacement, with the same draws for every figure.

    Args:
        clusters: [n] label of every item.
        seed: Seed of the draws; the same seed gives the same intervals.
        replicates: Number of resampled sets.
    """

    def __init__(
        self, clusters: Sequence[str], *, seed: int = 0, replicates: int = REPLICATES
    ) -> None:
        self.member = members(len(clusters), clusters)
        self.units = int(self.member.max(initial=-1)) + 1
        self._of = np.zeros((self.units, len(clusters)))
        self._of[self.member, np.arange(len(clusters))] = 1.0
        equal = np.full(self.units, 1.0 / max(self.units, 1))
        generator = stream(seed, "bootstrap", "clusters")
        self.weights = (
            generator.multinomial(self.units, equal, size=replicates).astype(np.float64)
            if self.units
            else np.zeros((replicates, 0))
        )

    def ratios(self, above: Floats, below: Floats) -> Floats:
        """Return resampled ratios of sums.

        Args:
            above: [n, m]; the figure is the sum of `above` divided by that of `below`.
            below: [n, m].

        Returns:
            [replicates, m]; NaN if a replicate's denominator is zero.
        """
        over, under = self.weights @ self.summed(above), self.weights @ self.summed(below)
        return np.divide(over, under, out=np.full_like(over, np.nan), where=under > 1e-12)

    def summed(self, values: Floats) -> Floats:
        """Return the sums of [n, m] values within clusters: [units, m]."""
        return self._of @ values

    def count(self, is_there: NDArray[np.bool_]) -> int:
        """Return the number of clusters with an item in a mask [n]."""
        return int((np.bincount(self.member, weights=is_there, minlength=1) > 0).sum())


def percentiles(found: Floats, units: int, *, level: float = 0.95) -> Bounds | None:
    """Return the interval of replicates [r]; `None` with too few clusters or without spread."""
    known = found[np.isfinite(found)]
    if units < FEWEST_CLUSTERS or not len(known) or np.ptp(known) < 1e-12:
        return None
    tail = (1 - level) / 2
    low, high = np.quantile(known, [tail, 1 - tail])
    return Bounds(
        low=round(float(low), 6),
        high=round(float(high), 6),
        method="cluster bootstrap",
        units=units,
    )


def share_bounds(hits: float, n: int, units: int, found: Floats | None = None) -> Bounds | None:
    """Return the interval of a share.

    The clustered bootstrap if possible. With fewer than `FEWEST_CLUSTERS` paths it is Wilson's interval
    over items instead. If all items agree, it is Wilson's with every path counted as one item, because
    agreement within a path adds no evidence.

    Args:
        hits: Number of right answers.
        n: Number of answers.
        units: Number of clusters that they belong to.
        found: [r] bootstrap replicates.
    """
    if not n:
        return None
    clustered = None if found is None else percentiles(found, units)
    if clustered is not None:
        return clustered
    count = units if units >= FEWEST_CLUSTERS and hits in (0, n) else n
    low, high = wilson(hits * count / n, count)
    return Bounds(low=round(low, 6), high=round(high, 6), method="wilson", units=count)


def intraclass(values: Floats, clusters: Sequence[str]) -> float | None:
    """Return the intraclass correlation of right and wrong within clusters (one-way ANOVA).

    0 means that items of a path are no more alike than others, 1 that all items of a path agree.
    Source: A. Donner, A review of inference procedures for the intraclass correlation coefficient,
    Int. Stat. Rev. 54 (1986).

    Args:
        values: [n], none missing.
        clusters: [n] labels.

    Returns:
        In [0, 1]; `None` if undefined: one cluster, only clusters of one item, or no variance.
    """
    member = members(len(values), clusters)
    units = int(member.max(initial=-1)) + 1
    n = len(values)
    if units < 2 or n <= units:
        return None
    sizes = np.bincount(member).astype(np.float64)
    means = np.bincount(member, weights=values) / sizes
    between = float(sizes @ np.square(means - values.mean())) / (units - 1)
    within = float(np.square(values - means[member]).sum()) / (n - units)
    size = (n - float(sizes @ sizes) / n) / (units - 1)
    total = between + (size - 1) * within
    return None if total <= 1e-15 else min(max((between - within) / total, 0.0), 1.0)


def mcnemar(first_only: int, second_only: int) -> tuple[float, float]:
    """Return the exact two-sided p of McNemar's test, and its mid-p.

    Sources: Q. McNemar, Psychometrika 12 (1947); mid-p: M. W. Fagerland, S. Lydersen, P. Laake,
    BMC Med. Res. Methodol. 13:91 (2013), who recommend it.

    Args:
        first_only: Items that only the first got right.
        second_only: Items that only the second got right.
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
        seed: Seed of the permutations; without effect if there are few enough clusters to enumerate all.
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
    """Return the two-sided p of the paired permutation test that flips whole clusters.

    If two answerers are equally good, swapping their names within a path changes nothing. With up to 12
    clusters that have a difference, all patterns are enumerated; with more, `replicates` random ones are drawn.

    Args:
        gaps: [n] differences.
        clusters: [n] labels.
        seed: Seed of the draws.
        replicates: Number of random patterns.
    """
    sums = np.bincount(members(len(gaps), clusters), weights=gaps) if len(gaps) else np.zeros(0)
    sums = sums[np.abs(sums) > 1e-12]
    if not len(sums):
        return 1.0
    seen = abs(float(sums.sum())) - 1e-9
    if len(sums) <= _EXACT_UP_TO:
        patterns = (np.arange(2 ** len(sums))[:, None] >> np.arange(len(sums))) & 1
        return float((np.abs((2.0 * patterns - 1.0) @ sums) >= seen).mean())
    flips = stream(seed, "permutation", "signs").integers(0, 2, size=(replicates, len(sums)))
    extreme = int((np.abs((2.0 * flips - 1.0) @ sums) >= seen).sum())
    return (extreme + 1) / (replicates + 1)


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


def two_proportions(first: float, n_first: float, second: float, n_second: float) -> float:
    """Return the two-sided p that two shares of different items differ (pooled z test)."""
    pooled = (first + second) / (n_first + n_second)
    error = math.sqrt(pooled * (1 - pooled) * (1 / n_first + 1 / n_second))
    if error == 0:
        return 1.0
    return 2 * (1 - _NORMAL.cdf(abs(first / n_first - second / n_second) / error))


def d_prime(hits: float, signals: float, alarms: float, noises: float) -> float | None:
    """Return d', the distance between an answerer's responses to scenes and twins, in standard deviations.

    Uses the log-linear correction (0.5 is added to both counts and 1 to both numbers), which keeps
    perfect answers finite. Source: M. J. Hautus, Behav. Res. Methods 27 (1995).

    Args:
        hits: Scenes that were called out of the ordinary.
        signals: Number of scenes.
        alarms: Twins that were called out of the ordinary.
        noises: Number of twins.

    Returns:
        0 if scenes and twins are called OOD equally often; `None` without scenes or without twins.
    """
    if not signals or not noises:
        return None
    return _NORMAL.inv_cdf((hits + 0.5) / (signals + 1)) - _NORMAL.inv_cdf(
        (alarms + 0.5) / (noises + 1)
    )


def auroc(
    scores: Floats, is_signal: NDArray[np.bool_], resampler: Resampler | None = None
) -> tuple[float, Bounds | None] | None:
    """Return the area under the ROC curve: the probability that a scene scores above a twin, ties half.

    Args:
        scores: [n], higher is more out of the ordinary; NaN if there is none.
        is_signal: [n], true for scenes, false for twins.
        resampler: Resampler of the same n items; gives the interval.

    Returns:
        The area and its interval; `None` without scores of both kinds.
    """
    known = np.isfinite(scores)
    signal, noise = scores[known & is_signal], scores[known & ~is_signal]
    if not len(signal) or not len(noise):
        return None
    above = np.sign(signal[:, None] - noise[None, :]) * 0.5 + 0.5
    area = float(above.mean())
    if resampler is None:
        return area, None
    # Rows and columns are summed by cluster, so that a replicate costs only a small quadratic form.
    rows, columns = resampler.member[known & is_signal], resampler.member[known & ~is_signal]
    half = np.zeros((resampler.units, above.shape[1]))
    np.add.at(half, rows, above)
    wins = np.zeros((resampler.units, resampler.units))
    np.add.at(wins.T, columns, half.T)
    weights = resampler.weights
    over = ((weights @ wins) * weights).sum(axis=1)
    under = (weights @ np.bincount(rows, minlength=resampler.units)) * (
        weights @ np.bincount(columns, minlength=resampler.units)
    )
    found = np.divide(over, under, out=np.full_like(over, np.nan), where=under > 0)
    return area, percentiles(found, resampler.count(known))


def above_chance(value: float, chance: float) -> float | None:
    """Return a share corrected for chance: 0 is the chance level, 1 is perfect, negative is worse than chance.

    Source: the form of J. Cohen's kappa, Educ. Psychol. Meas. 20 (1960).
    """
    return None if chance >= 1 else (value - chance) / (1 - chance)
