"""Rarity of a study's texts: figures by set, the distribution, and the ends of each set."""

import itertools
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self, TypeVar

import numpy as np

from oodscen.data._scenario import Scenario
from oodscen.metrics._measurements import Measurements
from oodscen.metrics._rarity.estimates import TextRarity
from oodscen.metrics._report import MetricsReport
from oodscen.report._charts.sets import Cloud, boxes, scatter
from oodscen.statistics._intervals import Interval

_ENDS = 4
"""Texts that are shown from either end of a set."""
_MOST = 400
"""Points of a set that are drawn."""
T = TypeVar("T")


@dataclass(frozen=True)
class RarityRow:
    """The rarity of one set of texts."""

    label: str
    n: int
    median: str
    interval: str
    """95 % interval of the median; empty without one."""
    middle: str
    """Range of the middle 80 % of texts."""
    unknown: int


@dataclass(frozen=True)
class RarityEnds:
    """The rarest and the commonest texts of one set, each with its rarity and interval."""

    label: str
    rarest: tuple[tuple[str, str], ...]
    commonest: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class RarityFamily:
    """The rarity of the texts of one family of the simulatable tree."""

    label: str
    n: int
    median: str
    middle: str


@dataclass(frozen=True)
class _RatedSet:
    """One set of texts, with the rarity of those whose rarity can be told."""

    name: str
    label: str
    estimates: Sequence[TextRarity]
    interval: Interval | None
    """Interval of the median."""
    values: Mapping[int, float]
    """The best estimate by index of the text; decimal logarithm of kilometres."""
    oodness: Sequence[float]

    @classmethod
    def of(cls, name: str, label: str, report: MetricsReport) -> Self:
        """Return a measured set."""
        estimates = () if report.rarity is None else report.rarity.per_text
        values = {
            index: rarity.best for index, rarity in enumerate(estimates) if rarity.best is not None
        }
        interval = None if report.rarity is None else report.rarity.interval
        return cls(name, label, estimates, interval, values, report.oodness.per_text)

    def row(self) -> RarityRow:
        """Return the figures of the set."""
        n = len(self.estimates)
        median, middle = _spread(self.values.values())
        interval = _range(self.interval.low, self.interval.high) if self.interval else ""
        return RarityRow(self.label, n, median, interval, middle, n - len(self.values))

    def cloud(self) -> Cloud:
        """Return rarity and OOD-ness of its texts, evenly thinned to some `_MOST`."""
        every = max(1, len(self.values) // _MOST)
        drawn = itertools.islice(self.values.items(), None, None, every)
        return Cloud(self.label, [(value, self.oodness[index]) for index, value in drawn])

    def ends(self, texts: Sequence[Scenario]) -> RarityEnds:
        """Return its rarest and its commonest texts."""
        order = sorted(self.values, key=lambda index: (-self.values[index], index))
        shown = [(self._in_words(index), texts[index].text) for index in order]
        return RarityEnds(self.label, *ends_of(shown))

    def _in_words(self, index: int) -> str:
        estimate = self.estimates[index]
        return f"{_power(self.values[index])} ({estimate.low:.1f} to {estimate.high:.1f})"


def ends_of(ranked: Sequence[T]) -> tuple[tuple[T, ...], tuple[T, ...]]:
    """Return the first and the last few of a ranking; none of them is in both."""
    first = ranked[: min(_ENDS, math.ceil(len(ranked) / 2))]
    return tuple(first), tuple(ranked[len(first) :][-_ENDS:])


def rarity_variables(
    metrics: Measurements | None, labels: Mapping[str, str], texts: Mapping[str, Sequence[Scenario]]
) -> dict[str, Any]:
    """Return the template's variables about rarity; all empty for a study without it.

    Args:
        metrics: The study's measurements.
        labels: The displayed name of every set, in the order of display.
        texts: The texts of the sets.
    """
    rated: list[_RatedSet] = []
    if metrics is not None:
        measured = [_RatedSet.of(name, label, metrics.sets[name]) for name, label in labels.items()]
        rated = [rated_set for rated_set in measured if rated_set.values]
    # Rarities belong to texts only as long as there are as many of both.
    matched = [
        rated_set
        for rated_set in rated
        if len(texts.get(rated_set.name, ())) == len(rated_set.estimates)
    ]
    simulatable = next(
        (rated_set for rated_set in matched if rated_set.name == "simulatable"), None
    )
    distributions = [(rated_set.name, list(rated_set.values.values())) for rated_set in rated]
    clouds = [rated_set.cloud() for rated_set in rated]
    title = "Rarity and OOD-ness of every text"
    axes = ("rarity, decimal logarithm of kilometres", "OOD-ness")
    return {
        "rarity_rows": [rated_set.row() for rated_set in rated],
        "rarity_chart": boxes(distributions) if rated else None,
        "rarity_ends": [rated_set.ends(texts[rated_set.name]) for rated_set in matched],
        "rarity_families": _families(simulatable, texts) if simulatable else [],
        "rarity_against": scatter(clouds, title, axes) if rated else None,
        "rarity_model": metrics.asked if metrics is not None else None,
    }


def _families(rated: _RatedSet, texts: Mapping[str, Sequence[Scenario]]) -> list[RarityFamily]:
    """Return one row per family, the rarest first."""
    by_family: dict[str, list[float]] = {}
    for index, value in rated.values.items():
        path = texts[rated.name][index].path
        if len(path) > 2:
            by_family.setdefault(path[2], []).append(value)
    ranked = sorted(by_family.items(), key=lambda item: -float(np.median(item[1])))
    return [RarityFamily(label, len(values), *_spread(values)) for label, values in ranked]


def _spread(values: Collection[float]) -> tuple[str, str]:
    """Return the median and the range of the middle 80 % in words."""
    low, median, high = np.quantile(list(values), [0.1, 0.5, 0.9])
    return _power(median), _range(low, high)


def _range(low: float, high: float) -> str:
    return f"{_power(low)} to {_power(high)}"


def _power(value: float) -> str:
    return f"10^{value:.1f} km"
