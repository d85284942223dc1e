"""Exposure: the share of all meetings that some kinds of situation make up.

A kind that is met about once in k kilometres is met 1/k times per kilometre. The share of some kinds is the sum of
theirs over the sum of all; it is ruled by the commonest kinds, whose number is small.
"""

from collections.abc import Sequence
from typing import Self

import numpy as np
from pydantic import Field, model_validator

from oodscen._arguments import instances_of
from oodscen._seeding import stream
from oodscen._words.decimals import fine_percent
from oodscen.data._base import Data
from oodscen.data._issues import same_length
from oodscen.errors import UsageError
from oodscen.metrics._rarity.estimates import Rarity, TextRarity

_DRAWS = 1_000
"""Draws of the kinds' errors, from which the interval is taken."""
_Z = 1.645
"""Standard deviations from the median of a normal distribution to its 95th percentile."""


class Exposure(Data):
    """The share of meetings that some of a set's kinds make up."""

    share: float = Field(ge=0.0, le=1.0)
    low: float
    """Lower end of the 90 % interval, if the errors of the kinds are independent."""
    high: float
    chosen: int
    """Number of the kinds whose share it is."""
    total: int
    unknown: int
    """Number of kinds without a rarity; they count in neither sum."""

    def __str__(self) -> str:
        others = f"; {self.unknown} of {self.total} kinds cannot be told" if self.unknown else ""
        share, low, high = map(fine_percent, (self.share, self.low, self.high))
        return f"{share} of what a driver would meet ({low} to {high}{others})"


class TreeRarity(Data):
    """The rarity of a tree's leaves by their labels."""

    leaves: tuple[str, ...]
    """Ids of the leaves."""
    rarity: Rarity

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        same_length(leaves=len(self.leaves), texts=len(self.rarity.per_text))
        return self

    def per_km(self) -> dict[str, float]:
        """Return meetings per kilometre by leaf, for those with a rarity."""
        pairs = zip(self.leaves, self.rarity.per_text, strict=True)
        return {leaf: 10.0**-rarity.best for leaf, rarity in pairs if rarity.best is not None}

    def of(self, leaves: set[str]) -> Exposure | None:
        """Return the exposure of some leaves; see `exposure`."""
        return exposure(self.rarity.per_text, [leaf in leaves for leaf in self.leaves])


def exposure(per_text: Sequence[TextRarity], chosen: Sequence[bool]) -> Exposure | None:
    """Return the share of meetings that the chosen kinds make up.

    It is `None` if no kind has a rarity, or kinds were chosen and none of them has one.

    Raises:
        UsageError: If there is not one choice per text, or one is neither true nor false.
    """
    check_choices(chosen, len(per_text))
    figures = [
        (rarity.low, rarity.best, rarity.high, is_chosen)
        for rarity, is_chosen in zip(per_text, chosen, strict=True)
        if rarity.best is not None
    ]
    if not figures or (any(chosen) and not any(is_chosen for *_, is_chosen in figures)):
        return None
    low, best, high, weights = np.array(figures, np.float64).T
    share = _share(best, weights)
    errors = stream(0, "exposure").standard_normal((_DRAWS, len(figures)))
    drawn = best + errors * np.where(errors < 0.0, best - low, high - best) / _Z
    ends = np.quantile([_share(log10_km, weights) for log10_km in drawn], [0.05, 0.95])
    return Exposure(
        share=share,
        low=min(float(ends[0]), share),
        high=max(float(ends[1]), share),
        chosen=sum(map(bool, chosen)),
        total=len(per_text),
        unknown=len(per_text) - len(figures),
    )


def check_choices(chosen: Sequence[bool], count: int) -> None:
    """Check that there is one choice for each of `count` texts.

    Raises:
        UsageError: If there is not, or one is neither true nor false.
    """
    instances_of("chosen", chosen, bool, np.bool_)
    if len(chosen) != count:
        raise UsageError(f"{len(chosen)} choices do not fit {count} texts")


def _share(log10_km: np.ndarray, weights: np.ndarray) -> float:
    """Return the share of meetings with the kinds of weight 1, the others having 0."""
    rates = 10.0 ** (log10_km.min() - log10_km)
    chosen, others = float(rates @ weights), float(rates @ (1.0 - weights))
    return chosen / (chosen + others)
