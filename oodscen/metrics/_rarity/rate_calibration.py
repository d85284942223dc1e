"""The calibration of estimates of rarity on published rates.

An estimate x of an event of a kind k is calibrated to `offset_k + slope x`, by least squares on decimal logarithms of
kilometres. Kinds of rate are kept apart by their offsets: an event that happens to the ego (`own`), one that happens
somewhere in the traffic (`occurring`), and one that the ego comes upon (`met`), which is many times as frequent as its
occurrence. A scenario's text is of the last kind. Fewer than six anchors, or such of nearly equal estimates, move the
offset alone.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from oodscen.data._base import Data
from oodscen.errors import DataError, Issue
from oodscen.metrics._rarity.rates import LEAST_KM, MOST_KM, Kind, PublishedRate

_FEWEST = 6
"""Rates from which they give a slope."""
_LEAST_SPREAD = 0.3
"""Spread of estimates within kinds from which they give a slope, decades; two readings of one text differ by as much."""
_FLATTEST, _STEEPEST = 0.25, 4.0
"""Range of usable slopes; that of the shipped rates is 1.5 to 1.8."""


class RateCalibration(Data):
    """A map from estimates to published rates, in decimal logarithms of kilometres."""

    slope: float
    offsets: dict[Kind, float]
    anchors: int = Field(ge=1)
    factor_before: float
    """Median error as a factor, before calibration."""
    factor_left_out: float | None
    """The same after calibration, each anchor by a calibration on all others; `None` below three anchors."""

    def apply(self, value: float, kind: Kind = "met") -> float:
        """Return the calibrated value, within the range of rates; a kind without anchors gets the mean offset."""
        return _calibrated(self.slope, self.offsets, value, kind)


def calibrate(rates: Sequence[PublishedRate], estimates: Sequence[float]) -> RateCalibration:
    """Return the calibration of estimates, one per rate, and its error leave-one-out.

    Raises:
        DataError: If the rates do not rise with the estimates, or too little or too much for a calibration.
    """
    slope, offsets = _fit(rates, np.asarray(estimates, np.float64))
    if not _FLATTEST <= slope <= _STEEPEST:
        fault = (
            f"do not rise as the estimates of their texts do: their slope is {round(slope, 2) + 0.0:g}, not from {_FLATTEST:g} to"
            f" {_STEEPEST:g}; correct them, or give fewer than {_FEWEST} to move the offset alone"
        )
        raise DataError("rates", [Issue("km", fault)])
    before = [abs(value - rate.log10_km) for value, rate in zip(estimates, rates, strict=True)]
    after = left_out(rates, estimates)
    return RateCalibration(
        slope=slope,
        offsets=offsets,
        anchors=len(rates),
        factor_before=float(10.0 ** np.median(before)),
        factor_left_out=float(10.0 ** np.median(np.abs(after))) if len(after) else None,
    )


def left_out(rates: Sequence[PublishedRate], estimates: Sequence[float]) -> NDArray[np.float64]:
    """Return the error of each rate by a calibration on all others, in decades; empty below three rates."""
    if len(rates) < 3:
        return np.empty(0)
    values = np.asarray(estimates, np.float64)
    errors = []
    for index, rate in enumerate(rates):
        others = [*rates[:index], *rates[index + 1 :]]
        slope, offsets = _fit(others, np.delete(values, index))
        errors.append(_calibrated(slope, offsets, values[index], rate.kind) - rate.log10_km)
    return np.array(errors)


def _calibrated(slope: float, offsets: dict[Kind, float], value: float, kind: Kind) -> float:
    mean_offset = sum(offsets.values()) / len(offsets)
    calibrated = offsets.get(kind, mean_offset) + slope * value
    return float(np.clip(calibrated, np.log10(LEAST_KM), np.log10(MOST_KM)))


def _fit(
    rates: Sequence[PublishedRate], values: NDArray[np.float64]
) -> tuple[float, dict[Kind, float]]:
    """Return slope and offsets by least squares of the rates on the estimates `values`."""
    kinds = list(dict.fromkeys(rate.kind for rate in rates))
    membership = np.array([[rate.kind == kind for kind in kinds] for rate in rates], np.float64)
    counts = membership.sum(axis=0)
    targets = np.array([rate.log10_km for rate in rates])
    slope = 1.0
    if len(rates) >= _FEWEST and len(rates) > len(kinds) + 1:
        within = values - membership @ (membership.T @ values / counts)
        if np.sqrt(np.mean(np.square(within))) >= _LEAST_SPREAD:
            slope = float(within @ targets / (within @ within))
    offsets = membership.T @ (targets - slope * values) / counts
    return slope, dict(zip(kinds, offsets.tolist(), strict=True))
