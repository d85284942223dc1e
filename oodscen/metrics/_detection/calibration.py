"""Calibrates scores against those of ordinary texts that are held out of the baseline.

A text of the baseline scored against the whole baseline finds itself, and scored against all others finds its
near-duplicates. Whole groups of similar texts are therefore held out: each text joins the first text that it
resembles (cosine of 0.8 or more), and is scored against the texts of all other groups.

    percentile     share of held-out texts that score below, in percent. In [0, 100].
    conformal p    (1 + number of held-out texts that score at least as high) / (1 + number). In (0, 1]. If a text
                   has the same source as the baseline, p is at most a with a probability of at most a
                   (Vovk et al., *Algorithmic learning in a random world*, 2005).

Pitfall: style. Ordinary text worded unlike the baseline has a small p, too; p compares with the baseline's
texts, not with driving in general.
"""

from collections.abc import Sequence
from typing import Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from oodscen._seeding import stream
from oodscen.data._base import Data
from oodscen.data._issues import same_length
from oodscen.encoders._similarity import Vectors

_ALIKE = 0.8
_MOST = 20_000
_SAMPLE = 2_000
_STEP = 512
_EQUAL = 1e-9
"""Amount by which a held-out score may fall short of a score and count as no lower."""


class Calibration(Data):
    """The OOD-ness of a set relative to that of held-out groups of the baseline."""

    percentiles: tuple[float, ...]
    """One per text, in [0, 100]."""
    p_values: tuple[float, ...]
    """One conformal p-value per text, in (0, 1]."""
    median_percentile: float
    share_below_5_percent: float
    """Share of texts with p at most 0.05; about 0.05 for text like the baseline."""
    held_out: int = Field(ge=1)
    """Number of held-out texts."""
    groups: int = Field(ge=1)
    """Number of groups of similar texts, held out one at a time."""
    held_out_mean: float
    """Mean OOD-ness of the held-out texts."""

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        same_length(percentiles=len(self.percentiles), p_values=len(self.p_values))
        return self


def held_out_scores(vectors: Vectors, seed: int = 0) -> tuple[NDArray[np.float64], int]:
    """Return the scores of a baseline's texts against all groups but their own.

    A baseline of more than 20,000 texts is represented by a sample.

    Returns:
        OOD-ness (`tabulated`) of up to 2,000 texts, and the number of groups. If all texts fall into one
        group, each text is a group of its own.
    """
    if len(vectors) > _MOST:
        chosen = np.sort(stream(seed, "calibration").permutation(len(vectors))[:_MOST])
        vectors = np.ascontiguousarray(vectors[chosen])
    group = separate_groups(vectors)
    asked = np.arange(len(vectors))
    if len(asked) > _SAMPLE:
        asked = np.sort(stream(seed, "calibration", "asked").permutation(len(asked))[:_SAMPLE])
    found = np.empty(len(asked))
    for first in range(0, len(asked), _STEP):
        rows = asked[first : first + _STEP]
        cosines = vectors[rows] @ vectors.T
        cosines[group[rows, None] == group] = -np.inf
        found[first : first + _STEP] = -np.clip(cosines.max(axis=1), -1.0, 1.0)
    return found, int(group.max()) + 1


def separate_groups(vectors: Vectors) -> NDArray[np.int64]:
    """Return [n] groups of similar rows; if all fall into one, each row is a group of its own."""
    group = like_groups(vectors)
    return group if group.any() else np.arange(len(vectors))


def like_groups(vectors: Vectors, threshold: float = _ALIKE) -> NDArray[np.int64]:
    """Return [n] groups, numbered in order: each row joins the first leader that it resembles, or becomes one."""
    n = len(vectors)
    group = np.full(n, -1, np.int64)
    leaders = np.empty_like(vectors)
    count = 0
    for first in range(0, n, _STEP):
        block = vectors[first : first + _STEP]
        if count:
            near = block @ leaders[:count].T >= threshold
            joins = near.any(axis=1)
            group[first : first + _STEP][joins] = near.argmax(axis=1)[joins]
        among = block @ block.T
        start = count
        fresh: list[int] = []
        for row in np.flatnonzero(group[first : first + _STEP] < 0).tolist():
            joined = next((k for k in fresh if among[row, k] >= threshold), None)
            if joined is None:
                fresh.append(row)
                leaders[count] = block[row]
                group[first + row] = count
                count += 1
            else:
                group[first + row] = start + fresh.index(joined)
    return group


def calibrate(
    values: Sequence[float] | NDArray[np.float64], held_out: NDArray[np.float64], groups: int
) -> Calibration:
    """Return where scores lie among those of held-out texts."""
    scores = np.asarray(values, np.float64)
    order = np.sort(held_out)
    below = np.searchsorted(order, scores - _EQUAL, "left")
    p_values = (1 + len(order) - below) / (1 + len(order))
    percentiles = 100.0 * below / len(order)
    return Calibration(
        percentiles=tuple(percentiles.tolist()),
        p_values=tuple(p_values.tolist()),
        median_percentile=float(np.median(percentiles)),
        share_below_5_percent=float((p_values <= 0.05).mean()),
        held_out=len(order),
        groups=groups,
        held_out_mean=float(held_out.mean()),
    )
