"""Diversity: how much the texts of a set differ from one another.

Source: the paper's section Metrics: `div = -sim`, where `sim` is the mean over j of the largest
cosine between text j and any other text. Two definitions are computed:

    nearest     -mean_j max_{k != j} cos(e_j, e_k)     as printed
    pairwise    -mean_{j < k} cos(e_j, e_k)            the one that fits the paper's table

Both lie in [-1, 1]; higher is more diverse; -1 means that all texts are equal. Every added text can
only bring the nearest text closer, so `nearest` falls as a set grows, but the paper's values
(-0.635, -0.638, -0.642 for 10, 100 and 1000 texts) hardly do. `pairwise` does not depend on the size on
average. Never compare sets of different size by `nearest`: `Metrics.compare` draws equal sizes.

Pitfalls: near-duplicates (one copy per text makes `nearest` -1 while `pairwise` hardly moves), a
common opening phrase (lowers both), and off-topic text (raises both).
"""

from collections.abc import Sequence
from typing import Self

import numpy as np
from pydantic import Field, model_validator

from oodscen.data._base import Data
from oodscen.data._issues import same_length
from oodscen.encoders._similarity import Vectors, nearest_other
from oodscen.statistics._intervals import Interval
from oodscen.statistics._resampling import bootstrap_mean, bootstrap_pairwise


class Diversity(Data):
    """The diversity of a set of texts; `oodscen.metrics._diversity` explains formulas and pitfalls."""

    nearest: float | None = None
    """In [-1, 1], higher is more diverse; falls as the set grows. `None` for a single text."""
    pairwise: float | None = None
    """In [-1, 1], higher is more diverse. `None` for a single text."""
    nearest_interval: Interval | None = None
    """Interval of `nearest`, with each text's neighbour held fixed."""
    pairwise_interval: Interval | None = None
    nearest_index: tuple[int, ...] = ()
    """For each text the index of the most similar text; empty for a single text."""
    n: int = Field(ge=1)
    encoder: str
    seed: int = 0
    """Seed of the bootstrap."""
    reason: str = ""
    """The reason why values are missing, if any are."""

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        same_length(n=self.n, nearest_index=len(self.nearest_index) or self.n)
        return self


def diversity(
    vectors: Vectors, encoder: str, clusters: Sequence[str] | None = None, *, seed: int = 0
) -> Diversity:
    """Return the diversity of [n, d] rows of unit length or zero by both definitions.

    Texts of one cluster are resampled together for the intervals.
    """
    n = len(vectors)
    if n < 2:
        reason = "one text has no other to differ from"
        return Diversity(n=n, encoder=encoder, seed=seed, reason=reason)
    nearest = nearest_other(vectors)
    interval = bootstrap_pairwise(vectors, clusters, seed=seed)
    if interval is not None:
        interval = interval.model_copy(update={"low": -interval.high, "high": -interval.low})
    return Diversity(
        nearest=0.0 - float(nearest.cosine.mean()),
        pairwise=0.0 - mean_pairwise(vectors),
        nearest_interval=bootstrap_mean(0.0 - nearest.cosine, clusters, seed=seed),
        pairwise_interval=interval,
        nearest_index=tuple(nearest.index.tolist()),
        n=n,
        encoder=encoder,
        seed=seed,
    )


def mean_nearest(vectors: Vectors) -> float:
    """Return the mean over texts of the largest cosine to another text; needs at least two rows."""
    return float(nearest_other(vectors).cosine.mean())


def mean_pairwise(vectors: Vectors) -> float:
    """Return the mean cosine over all pairs; needs at least two rows of unit length or zero.

    The cosines of a set sum to the squared length of its sum, so no matrix of pairs is built.
    """
    wide = vectors.astype(np.float64)
    n = len(wide)
    pairs = np.square(wide.sum(axis=0)).sum() - np.square(wide).sum()
    return float(np.clip(pairs / (n * (n - 1)), -1.0, 1.0))
