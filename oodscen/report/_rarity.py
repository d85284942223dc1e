"""Rarity of a study's texts: figures by set, the distribution, and the ends of each set."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from oodscen.data._scenario import Scenario
from oodscen.metrics._measurements import Measurements
from oodscen.report._charts import sets as charts
from oodscen.report._charts.canvas import Canvas

_ENDS = 4


@dataclass(frozen=True)
class RarityRow:
    """The rarity of one set of texts."""

    label: str
    n: int
    median: str
    middle: str
    """Range of the middle 80 % of texts."""
    untold: int


@dataclass(frozen=True)
class RarityEnds:
    """The rarest and the commonest texts of one set, each with its rarity and interval."""

    label: str
    rarest: tuple[tuple[str, str], ...]
    commonest: tuple[tuple[str, str], ...]


def context(
    metrics: Measurements | None, labels: Mapping[str, str], texts: Mapping[str, Sequence[Scenario]]
) -> dict[str, Any]:
    """Return the template's variables about rarity; all empty for a study without it.

    Args:
        metrics: The study's measurements.
        labels: The displayed name of every set, in the order of display.
        texts: The texts of the sets.
    """
    known = {
        name: rarity
        for name in labels
        if metrics is not None and (rarity := metrics.sets[name].rarity) is not None
    }
    rows, boxes, ends = [], [], []
    for name, rarity in known.items():
        told = [(place, one) for place, one in enumerate(rarity.per_text) if one.best is not None]
        values = [one.best for _, one in told if one.best is not None]
        if not values or rarity.median is None:
            continue
        low, high = np.quantile(values, [0.1, 0.9])
        middle = f"{_power(low)} to {_power(high)}"
        median = _power(rarity.median)
        rows.append(RarityRow(labels[name], len(rarity.per_text), median, middle, rarity.untold))
        boxes.append((name, values))
        own = texts.get(name, ())
        if len(own) == len(rarity.per_text):
            order = sorted(told, key=lambda item: (-(item[1].best or 0.0), item[0]))
            shown = [
                (f"{_power(one.best)} ({one.low:.1f} to {one.high:.1f})", own[place].text)
                for place, one in order
            ]
            ends.append(RarityEnds(labels[name], tuple(shown[:_ENDS]), tuple(shown[-_ENDS:])))
    chart: Canvas | None = charts.boxes(boxes) if boxes else None
    return {"rarity_rows": rows, "rarity_chart": chart, "rarity_ends": ends}


def _power(value: float | None) -> str:
    return "\u2013" if value is None else f"10^{value:.1f} km"
