"""A test of a share against a bar that holds with few paths and for any likeness within them.

The percentile bootstrap and tests that estimate a variance call "shown" far too often with few paths and
shares near 0 or 1: five paths without a fault have no variance at all. This test adds one path of the worst
kind to those seen and weighs all of them at random (exponential weights), which is N. Gaffke's bound (Three
test statistics for a nonparametric one-sided hypothesis on the mean of a nonnegative variable, Math. Methods
Stat. 14, 2005). If every path is all right or all wrong, it is the exact binomial test of Clopper and Pearson
over paths. `benchmarks/requirements.py` compares it with the others.
"""

import numpy as np
from numpy.typing import NDArray

from oodscen._seeding import stream
from oodscen.statistics._intervals import Floats

DRAWS = 20_000
"""Random weightings of a test; a p-value of 0.005 then has a standard error of 0.0005."""
MOST_TIMES = 1_000.0
"""The largest study that is planned for, as a multiple of the one at hand."""
_PLANNED_DRAWS = 4_000
"""Random weightings of a test while a study is planned."""
_PLANNED_WITHIN = 0.02
"""Relative accuracy of the size of a planned study."""
_BATCH = 1_000
"""Random weightings that are drawn and summed at once."""


def p_below(gaps: Floats, least: float, *, seed: int = 0) -> float:
    """Return the one-sided p of the hypothesis that the mean gap is at most 0.

    Args:
        gaps: [units] sums over a path of what was scored minus the bar, divided by the items of the
            largest path.
        least: The smallest gap that a path can have, negative.
        seed: Seed of the weights.
    """
    return float(p_below_many(gaps[:, None], least, seed=seed)[0])


def p_below_many(
    gaps: Floats, least: float, *, seed: int = 0, times: float = 1.0, draws: int = DRAWS
) -> Floats:
    """Return [k] p-values, (1 + count) / (1 + draws), of [units, k] sets of gaps with the same weights.

    Every path seen weighs `times`, as if the study were so many times as large and its figures the same.
    """
    generator = stream(seed, "bound")
    units, sets = gaps.shape
    worst = least * generator.standard_exponential(draws)
    count: NDArray[np.int64] = np.zeros(sets, np.int64)
    for start in range(0, draws, _BATCH):
        rows = worst[start : start + _BATCH, None]
        weights = generator.standard_gamma(times, (len(rows), units))
        count += (weights @ gaps + rows <= 0).sum(axis=0)
    p_values: Floats = (1 + count) / (1 + draws)
    return p_values


def times_needed(gaps: Floats, least: float, alpha: float, *, seed: int = 0) -> float | None:
    """Return how many times as large a study would have to be to show that the mean gap is above 0.

    Its figures are taken to stay as they are; `alpha` is the level of the test.

    Returns:
        `None` if the mean gap is not above 0, or if more than `MOST_TIMES` are needed.
    """
    if not len(gaps) or gaps.mean() <= 0:
        return None

    def is_shown(times: float) -> bool:
        p_values = p_below_many(gaps[:, None], least, seed=seed, times=times, draws=_PLANNED_DRAWS)
        return bool(p_values[0] <= alpha)

    low, high = 1.0, 2.0
    while not is_shown(high):
        if high >= MOST_TIMES:
            return None
        low, high = high, min(2.0 * high, MOST_TIMES)
    while high - low > _PLANNED_WITHIN * low:
        middle = (low + high) / 2
        low, high = (low, middle) if is_shown(middle) else (middle, high)
    return high
