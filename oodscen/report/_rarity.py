"""Rarity of a study's texts: figures by set, the distribution, and the ends of each set."""

import itertools
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from oodscen.data._scenario import Scenario
from oodscen.metrics._measurements import Measurements
from oodscen.report._charts import sets as charts

_ENDS = 4
_MOST = 400
"""Points of a set that are drawn."""


@dataclass(frozen=True)
class RarityRow:
    """The rarity of one set of texts."""

    label: str
    n: int
    median: str
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


def context(
    metrics: Measurements | None, labels: Mapping[str, str], texts: Mapping[str, Sequence[Scenario]]
) -> dict[str, Any]:
    """Return the template's variables about rarity; all empty for a study without it.

    Args:
        metrics: The study's measurements.
        labels: The displayed name of every set, in the order of display.
        texts: The texts of the sets.
    """
    rows, boxes, ends, clouds = [], [], [], []
    families: list[RarityFamily] = []
    for name, label in labels.items():
        if metrics is None:
            break
        measured = metrics.sets[name]
        estimates = () if measured.rarity is None else measured.rarity.per_text
        values = {
            place: rarity.best for place, rarity in enumerate(estimates) if rarity.best is not None
        }
        if not values:
            continue
        rows.append(
            RarityRow(
                label, len(estimates), *_spread(values.values()), len(estimates) - len(values)
            )
        )
        boxes.append((name, list(values.values())))
        drawn = itertools.islice(values.items(), None, None, max(1, len(values) // _MOST))
        oodness = measured.oodness.per_text
        clouds.append(charts.Cloud(label, [(value, oodness[place]) for place, value in drawn]))
        own = texts.get(name, ())
        if len(own) != len(estimates):
            continue
        if name == "simulatable":
            families = _families([(own[place], value) for place, value in values.items()])
        order = sorted(values, key=lambda place: (-values[place], place))
        shown = [
            (
                f"{_power(values[place])} ({estimates[place].low:.1f} to {estimates[place].high:.1f})",
                own[place].text,
            )
            for place in order
        ]
        ends.append(RarityEnds(label, tuple(shown[:_ENDS]), tuple(shown[-_ENDS:])))
    title, axes = (
        "Rarity and OOD-ness of every text",
        ("rarity, decimal logarithm of kilometres", "OOD-ness"),
    )
    return {
        "rarity_rows": rows,
        "rarity_chart": charts.boxes(boxes) if boxes else None,
        "rarity_ends": ends,
        "rarity_families": families,
        "rarity_against": charts.scatter(clouds, title, axes) if clouds else None,
        "rarity_model": metrics.asked if metrics is not None else None,
    }


def _families(texts: Sequence[tuple[Scenario, float]]) -> list[RarityFamily]:
    """Return one row per family, the rarest first."""
    known: dict[str, list[float]] = {}
    for text, value in texts:
        if len(text.path) > 2:
            known.setdefault(text.path[2], []).append(value)
    ranked = sorted(known.items(), key=lambda item: -float(np.median(item[1])))
    return [RarityFamily(label, len(values), *_spread(values)) for label, values in ranked]


def _spread(values: Collection[float]) -> tuple[str, str]:
    """Return the median and the range of the middle 80 % in words."""
    low, median, high = np.quantile(list(values), [0.1, 0.5, 0.9])
    return _power(median), f"{_power(low)} to {_power(high)}"


def _power(value: float) -> str:
    return f"10^{value:.1f} km"
