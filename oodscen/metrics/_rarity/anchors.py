"""Published rates of events in traffic, and the calibration of estimates on them.

An estimate x of an event of a kind k is calibrated to `offset_k + slope x`, by least squares on decimal logarithms of
kilometres. Kinds of rate are kept apart by their offsets: an event that happens to the ego (`own`), one that happens
somewhere in the traffic (`occurring`), and one that the ego comes upon (`met`), which is many times as frequent as its
occurrence. A scenario's text is of the last kind. Fewer than six anchors, or such of nearly equal estimates, move the
offset alone.
"""

import tomllib
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from oodscen._arguments import instances_of
from oodscen._display import cut
from oodscen._files import read_utf8
from oodscen._text import folded_words
from oodscen.baselines._texts import bundled
from oodscen.data._base import Data
from oodscen.errors import DataError, Issue

Kind = Literal["own", "occurring", "met"]
_FEWEST = 6
"""Rates from which they give a slope."""
_NOUN = "file of rates"
_LEAST_KM, _MOST_KM = 0.001, 1e15
"""Range of published rates, km; all that was ever driven on roads is less than 1e15 km."""
_LEAST_SPREAD = 0.3
"""Spread of estimates within kinds from which they give a slope, decades; two readings of one text differ by as much."""
_FLATTEST, _STEEPEST = 0.25, 4.0
"""Range of usable slopes; that of the shipped rates is 1.5 to 1.8."""


class PublishedRate(Data):
    """One published or own rate of an event."""

    noun: ClassVar[str] = "rate"
    _refuses_conversion: ClassVar = True

    number: int = 0
    event: str = Field(min_length=1)
    kind: Kind = "met"
    grade: Literal["A", "B", "C", "M"] = "A"
    """A from a primary source, B from a secondary one, C with an assumed denominator, M from memory."""
    km: tuple[float, float, float]
    """Kilometres between two events: least, best, most."""
    source: str = Field(min_length=1)
    texts: tuple[str, ...] = Field(min_length=1)
    """Wordings of the event."""

    @model_validator(mode="after")
    def _is_ordered(self) -> "PublishedRate":
        if not _LEAST_KM <= self.km[0] <= self.km[1] <= self.km[2] <= _MOST_KM:
            raise ValueError(
                f"km: three numbers in order, least, best, most, from {_LEAST_KM} to {_MOST_KM:.0e}"
            )
        if not all(text.strip() for text in self.texts):
            raise ValueError("texts: none may be blank")
        return self

    @property
    def log10_km(self) -> float:
        """The decimal logarithm of the best figure."""
        return float(np.log10(self.km[1]))


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


def published_rates() -> tuple[PublishedRate, ...]:
    """Return the shipped rates."""
    return _rates(bundled("anchors.toml", "oodscen.metrics._rarity"), "anchors.toml")


def load_rates(path: str | Path) -> tuple[PublishedRate, ...]:
    """Read rates from a TOML file with one `[[rate]]` each: `event`, `km`, `source`, `texts`, and `kind` if not met.

    Raises:
        DataError: If the file cannot be read or holds no valid rates.
    """
    return _rates(read_utf8(path, _NOUN), str(path))


def resolve_rates(
    anchors: Sequence[PublishedRate] | str | Path | None,
) -> tuple[PublishedRate, ...] | None:
    """Return the rates that a caller names: `published` for the shipped ones, a file, or the rates themselves.

    Raises:
        DataError: If there is none, or the file holds no valid rates.
        UsageError: If they are no rates.
    """
    if anchors is None:
        return None
    if anchors == "published":
        return published_rates()
    if isinstance(anchors, str | Path):
        return load_rates(anchors)
    instances_of("anchors", anchors, PublishedRate)
    if faults := _contradictions(anchors) if anchors else [Issue("", "there is none")]:
        raise DataError("rates", faults)
    return tuple(anchors)


@contextmanager
def anchored(
    anchors: Sequence[PublishedRate] | str | Path | None,
) -> Iterator[tuple[PublishedRate, ...] | None]:
    """Give the rates that a caller names, and name their file where they turn out to be of no use.

    Raises:
        DataError: As `resolve_rates` does, and for rates that cannot be calibrated on.
        UsageError: If they are no rates.
    """
    rates = resolve_rates(anchors)
    try:
        yield rates
    except DataError as error:
        if error.noun != "rates" or not isinstance(anchors, str | Path):
            raise
        raise DataError("rates", error.issues, source=str(anchors)) from None


def _rates(content: str, source: str) -> tuple[PublishedRate, ...]:
    try:
        table = tomllib.loads(content)
    except (ValueError, RecursionError) as error:
        raise DataError(_NOUN, [Issue("", f"is not TOML: {error}")], source=source) from None
    rows = table.pop("rate", None)
    if not isinstance(rows, list) or not rows:
        raise DataError(_NOUN, [Issue("rate", "holds no [[rate]]")], source=source)
    if table:
        unknown = [Issue(name, "is no member of a file of rates") for name in table]
        raise DataError(_NOUN, unknown, source=source)
    rates = tuple(
        PublishedRate.parse(row, source=f"{source}, rate {number}")
        for number, row in enumerate(rows, 1)
    )
    counts = Counter(rate.number for rate in rates if rate.number)
    if repeated := [str(number) for number, count in counts.items() if count > 1]:
        issue = Issue("number", f"stands for more than one rate: {', '.join(repeated)}")
        raise DataError(_NOUN, [issue], source=source)
    if faults := _contradictions(rates):
        raise DataError(_NOUN, faults, source=source)
    return rates


def _contradictions(rates: Sequence[PublishedRate]) -> list[Issue]:
    """Return the rates whose figures exclude those of rates before them of the same kind and wording."""
    ranges: dict[tuple[Kind, str], tuple[float, float]] = {}
    faults = []
    for index, rate in enumerate(rates):
        for text in rate.texts:
            key = rate.kind, folded_words(text)
            least_km, most_km = ranges.get(key, (_LEAST_KM, _MOST_KM))
            least_km, most_km = max(least_km, rate.km[0]), min(most_km, rate.km[2])
            if least_km <= most_km:
                ranges[key] = least_km, most_km
                continue
            fault = (
                f"excludes the figures of the rates before it that have the text {cut(text)!r}, too"
            )
            faults.append(Issue(f"rate[{index}].km", fault))
    return faults


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
    return float(np.clip(calibrated, np.log10(_LEAST_KM), np.log10(_MOST_KM)))


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
