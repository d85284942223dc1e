"""The area under the ROC curve: how well scores separate two sets.

It is the share of pairs (x, y) with x < y, ties half: the Mann-Whitney statistic over n m. 0.5 means no separation,
1 a perfect order. Sets that also differ in something irrelevant, such as style or length, mislead it.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from oodscen.data._base import Data
from oodscen.statistics._intervals import (
    FEWEST_CLUSTERS,
    Floats,
    Interval,
    cluster_interval,
    percentile_interval,
)
from oodscen.statistics._resampling import REPLICATES, Resampler, quotients


class Auroc(Data):
    """Area under the ROC curve of two sets of scores, with a bootstrap interval."""

    value: float
    """In [0, 1]; 0.5 means no separation, 1 puts every text of the second set above all of the first."""
    interval: Interval | None
    """`None` if either set has fewer than five units: groups, or texts without groups."""
    n_ordinary: int
    n_ood: int
    is_paired: bool
    """True if matched texts were resampled together."""


def auroc(ordinary: Floats, ood: Floats) -> float:
    """Return the share of pairs in which the OOD score is the higher; ties count half."""
    order = np.sort(ordinary)
    below = np.searchsorted(order, ood, "left") + np.searchsorted(order, ood, "right")
    return float(below.sum() / (2.0 * len(ordinary) * len(ood)))


def auroc_interval(
    ordinary: Floats,
    ood: Floats,
    clusters: Sequence[str] | None = None,
    *,
    is_paired: bool = False,
    seed: int = 0,
    replicates: int = REPLICATES,
) -> Auroc:
    """Return the AUROC of [m] ordinary and [n] OOD scores with its interval.

    OOD texts of one cluster are resampled together; if `is_paired`, so are the i-th scores of both sets.
    The order of the scores, or of the pairs, changes nothing.
    """
    if is_paired and clusters is None:
        order = np.lexsort((ordinary, ood))
        ordinary, ood = ordinary[order], ood[order]
    elif not is_paired:
        ordinary, ood = np.sort(ordinary), np.sort(ood) if clusters is None else ood
    resampler = Resampler(
        len(ood) if clusters is None else clusters, seed=seed, replicates=replicates, purpose="ood"
    )
    others = resampler
    if not is_paired:
        others = Resampler(len(ordinary), seed=seed, replicates=replicates, purpose="ordinary")
    interval = None
    if min(resampler.units, len(ordinary)) >= FEWEST_CLUSTERS:
        areas = _replicates(
            _ResampledScores(ordinary, others, others.cluster),
            _ResampledScores(ood, resampler, resampler.cluster),
        )
        interval = percentile_interval(areas, resampler.units, is_clustered=resampler.is_clustered)
    return Auroc(
        value=auroc(ordinary, ood),
        interval=interval,
        n_ordinary=len(ordinary),
        n_ood=len(ood),
        is_paired=is_paired,
    )


def auroc_of_items(
    scores: Floats, is_signal: NDArray[np.bool_], resampler: Resampler
) -> tuple[float, Interval | None] | None:
    """Return the probability that a scene scores above a twin, and its interval over whole paths.

    Args:
        scores: [n], higher is more out of the ordinary; NaN if there is none.
        is_signal: [n], true for scenes, false for twins.
        resampler: Resampler of the same n items.

    Returns:
        `None` without scores of both kinds.
    """
    is_scored = np.isfinite(scores)
    noise, signal = (
        _ResampledScores(scores[is_chosen], resampler, resampler.cluster[is_chosen])
        for is_chosen in (is_scored & ~is_signal, is_scored & is_signal)
    )
    if not len(noise.scores) or not len(signal.scores):
        return None
    interval = cluster_interval(_replicates(noise, signal), resampler.count(is_scored))
    return auroc(noise.scores, signal.scores), interval


class _ResampledScores(NamedTuple):
    """Scores, and the clusters by which they are resampled."""

    scores: Floats
    resampler: Resampler
    cluster: NDArray[np.int64]
    """[n], the cluster's number of every score."""


def _replicates(noise: _ResampledScores, signal: _ResampledScores) -> Floats:
    """Return the areas of the resampled sets; NaN if a replicate lacks one of both.

    Pairs are summed by cluster first, so that a replicate costs only a small quadratic form.
    """
    is_above = np.sign(signal.scores[:, None] - noise.scores) * 0.5 + 0.5
    half = np.zeros((signal.resampler.units, is_above.shape[1]))
    np.add.at(half, signal.cluster, is_above)
    wins = np.zeros((noise.resampler.units, signal.resampler.units))
    np.add.at(wins, noise.cluster, half.T)
    sizes, others_sizes = (
        np.bincount(scores.cluster, minlength=scores.resampler.units) for scores in (signal, noise)
    )
    areas = []
    for drawn, others in zip(
        signal.resampler.blocks(beside=noise.resampler),
        noise.resampler.blocks(beside=signal.resampler),
        strict=True,
    ):
        wins_drawn = ((others @ wins) * drawn).sum(axis=1)
        areas.append(quotients(wins_drawn, (drawn @ sizes) * (others @ others_sizes)))
    return np.concatenate(areas)
