"""Figures of right and wrong answers: correction for chance, sensitivity index, likeness within paths."""

import math
from collections.abc import Sequence
from statistics import NormalDist

import numpy as np

from oodscen.statistics._intervals import Floats
from oodscen.statistics._resampling import cluster_numbers

_NORMAL = NormalDist()
_NO_VARIANCE = 1e-15
"""Variance of answers up to which they are all the same."""


def intraclass(values: Floats, clusters: Sequence[str]) -> float | None:
    """Return the intraclass correlation of [n] right and wrong answers within clusters (one-way ANOVA).

    0 means that items of a path are no more alike than others, 1 that all items of a path agree.
    Source: A. Donner, A review of inference procedures for the intraclass correlation coefficient,
    Int. Stat. Rev. 54 (1986).

    Returns:
        In [0, 1]; `None` if undefined: one cluster, only clusters of one item, or no variance.
    """
    cluster = cluster_numbers(len(values), clusters)
    units = int(cluster.max(initial=-1)) + 1
    n = len(values)
    if units < 2 or n <= units:
        return None
    sizes = np.bincount(cluster).astype(np.float64)
    means = np.bincount(cluster, weights=values) / sizes
    between = float(sizes @ np.square(means - values.mean())) / (units - 1)
    within = float(np.square(values - means[cluster]).sum()) / (n - units)
    mean_size = (n - float(sizes @ sizes) / n) / (units - 1)
    total = between + (mean_size - 1) * within
    if total <= _NO_VARIANCE:
        return None
    return min(max((between - within) / total, 0.0), 1.0)


def two_proportions(first: float, n_first: float, second: float, n_second: float) -> float:
    """Return the two-sided p of a difference between two shares of different items (pooled z test).

    `first` of the `n_first` items and `second` of the `n_second`; neither number of items is 0.
    """
    pooled = (first + second) / (n_first + n_second)
    error = math.sqrt(pooled * (1 - pooled) * (1 / n_first + 1 / n_second))
    if error == 0:
        return 1.0
    return 2 * (1 - _NORMAL.cdf(abs(first / n_first - second / n_second) / error))


def d_prime(hits: float, signals: float, alarms: float, noises: float) -> float | None:
    """Return d', the distance between an answerer's responses to scenes and twins, in standard deviations.

    `hits` of the `signals` scenes and `alarms` of the `noises` twins were called out of the ordinary. The log-linear
    correction keeps perfect answers finite: it adds the share of scenes among all items to the hits, that of twins to
    the alarms, and twice as much to the numbers; 0.5 and 1 where there are as many twins as scenes. Source: M. J. Hautus,
    Behav. Res. Methods 27 (1995).

    Returns:
        0 if scenes and twins are called OOD equally often; `None` without scenes or without twins.
    """
    if not signals or not noises:
        return None
    of_signals, of_noises = signals / (signals + noises), noises / (signals + noises)
    hit_rate = (hits + of_signals) / (signals + 2 * of_signals)
    alarm_rate = (alarms + of_noises) / (noises + 2 * of_noises)
    return _NORMAL.inv_cdf(hit_rate) - _NORMAL.inv_cdf(alarm_rate)


def above_chance(value: float, chance: float) -> float | None:
    """Return a share corrected for chance: 0 is the chance level, 1 is perfect, negative is worse than chance.

    Source: the form of J. Cohen's kappa, Educ. Psychol. Meas. 20 (1960).
    """
    return None if chance >= 1 else (value - chance) / (1 - chance)
