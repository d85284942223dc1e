"""Intervals: percentiles of bootstrap replicates, and Wilson's interval of a share."""

import math
from statistics import NormalDist
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from oodscen.data._base import Data

Floats = NDArray[np.float64]

FEWEST_CLUSTERS = 5
"""The fewest units, clusters or items, for a percentile bootstrap; with fewer, it is far too narrow and not computed."""

_NORMAL = NormalDist()
_NO_SPREAD = 1e-12
"""Range of replicates below which they are all the same."""


class Interval(Data):
    """A 95 % interval of a figure, with the method that produced it.

    It shows how much the figure would vary with another draw of similar items (texts, scenes) or paths.
    It does not cover the choice of encoder, baseline or definition.
    """

    level: ClassVar[float] = 0.95

    low: float
    high: float
    method: Literal["wilson", "bootstrap", "cluster bootstrap"]
    units: int = Field(ge=1)
    """Number of units taken as independent: items, or paths."""

    @property
    def is_clustered(self) -> bool:
        """True if whole clusters (the items of one path) were resampled, because they resemble one another."""
        return self.method == "cluster bootstrap"


def wilson(hits: float, n: float, *, level: float = Interval.level) -> tuple[float, float]:
    """Return the Wilson score interval of a share; (0, 1) if nothing was counted.

    Hits and n are fractional after a correction for clustering. Source: E. B. Wilson, Probable inference, the law of
    succession, and statistical inference, JASA 22 (1927).
    """
    if n <= 0:
        return 0.0, 1.0
    z = _NORMAL.inv_cdf(0.5 + level / 2)
    share, z2 = hits / n, z * z
    middle = (share + z2 / (2 * n)) / (1 + z2 / n)
    half = z / (1 + z2 / n) * math.sqrt(share * (1 - share) / n + z2 / (4 * n * n))
    low = 0.0 if hits <= 0 else max(middle - half, 0.0)
    return low, 1.0 if hits >= n else min(middle + half, 1.0)


def percentile_interval(replicates: Floats, units: int, *, is_clustered: bool) -> Interval | None:
    """Return the interval that holds the middle 95 % of replicates [r]; `None` if none is finite."""
    finite = replicates[np.isfinite(replicates)]
    if not len(finite):
        return None
    tail = (1 - Interval.level) / 2
    low, high = np.quantile(finite, [tail, 1 - tail])
    return Interval(
        low=round(float(low), 6),
        high=round(float(high), 6),
        method="cluster bootstrap" if is_clustered else "bootstrap",
        units=units,
    )


def cluster_interval(replicates: Floats, units: int) -> Interval | None:
    """Return the interval of clustered replicates [r]; `None` with too few clusters or without spread."""
    finite = replicates[np.isfinite(replicates)]
    if units < FEWEST_CLUSTERS or not len(finite) or np.ptp(finite) < _NO_SPREAD:
        return None
    return percentile_interval(finite, units, is_clustered=True)


def share_interval(
    hits: float, n: int, units: int, replicates: Floats | None = None
) -> Interval | None:
    """Return the interval of `hits` of `n` answers on `units` clusters, from [r] bootstrap replicates if possible.

    With fewer than `FEWEST_CLUSTERS` paths, hits or misses, or if no replicate differs from another, it is Wilson's
    interval with every path counted as one item: more items of a path add no evidence about other paths, and no
    replicate can have a hit of a path that had none.
    """
    if not n:
        return None
    is_rare = min(hits, n - hits) < FEWEST_CLUSTERS
    if replicates is not None and not is_rare:
        interval = cluster_interval(replicates, units)
        if interval is not None:
            return interval
    low, high = wilson(hits * units / n, units)
    return Interval(low=round(low, 6), high=round(high, 6), method="wilson", units=units)
