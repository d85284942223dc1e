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
    untold: int


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
    known = {
        name: rarity
        for name in labels
        if metrics is not None and (rarity := metrics.sets[name].rarity) is not None
    }
    rows, boxes, ends, clouds = [], [], [], []
    families: list[RarityFamily] = []
    for name, rarity in known.items():
        estimated = [
            (place, one) for place, one in enumerate(rarity.per_text) if one.best is not None
        ]
        values = [one.best for _, one in estimated if one.best is not None]
        if not values or rarity.median is None:
            continue
        low, high = np.quantile(values, [0.1, 0.9])
        middle = f"{_power(low)} to {_power(high)}"
        median = _power(rarity.median)
        rows.append(RarityRow(labels[name], len(rarity.per_text), median, middle, rarity.untold))
        boxes.append((name, values))
        oodness = metrics.sets[name].oodness.per_text if metrics is not None else ()
        step = max(1, len(estimated) // _MOST)
        points = [
            (one.best, oodness[place]) for place, one in estimated[::step] if one.best is not None
        ]
        clouds.append(charts.Cloud(labels[name], points))
        own = texts.get(name, ())
        if len(own) == len(rarity.per_text):
            if name == "simulatable":
                families = _families([(own[place], one.best or 0.0) for place, one in estimated])
            order = sorted(estimated, key=lambda item: (-(item[1].best or 0.0), item[0]))
            shown = [
                (f"{_power(one.best)} ({one.low:.1f} to {one.high:.1f})", own[place].text)
                for place, one in order
            ]
            ends.append(RarityEnds(labels[name], tuple(shown[:_ENDS]), tuple(shown[-_ENDS:])))
    chart: Canvas | None = charts.boxes(boxes) if boxes else None
    against = (
        charts.scatter(
            clouds,
            "Rarity and OOD-ness of every text",
            ("rarity, decimal logarithm of kilometres", "OOD-ness"),
        )
        if clouds
        else None
    )
    return {
        "rarity_rows": rows,
        "rarity_chart": chart,
        "rarity_ends": ends,
        "rarity_families": families,
        "rarity_against": against,
        "rarity_model": metrics.asked if metrics is not None else None,
    }


def _families(texts: Sequence[tuple[Scenario, float]]) -> list[RarityFamily]:
    """Return one row per family, the rarest first."""
    known: dict[str, list[float]] = {}
    for text, value in texts:
        if len(text.path) > 2:
            known.setdefault(text.path[2], []).append(value)
    found = []
    for label, values in sorted(known.items(), key=lambda item: -float(np.median(item[1]))):
        low, high = np.quantile(values, [0.1, 0.9])
        middle = f"{_power(low)} to {_power(high)}"
        found.append(RarityFamily(label, len(values), _power(float(np.median(values))), middle))
    return found


def _power(value: float | None) -> str:
    return "\u2013" if value is None else f"10^{value:.1f} km"
