"""The metric tables: the figures of `metrics.json` beside the paper's."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup

from oodscen import _paper as paper
from oodscen.data._scenario import Scenario
from oodscen.report._charts import svg as charts
from oodscen.report._load import dig, mapping, number


@dataclass(frozen=True)
class Figure:
    """One number and its uncertainty, formatted for print."""

    value: str = ""
    bounds: str = ""
    """`−0.71 to −0.65`, `± 0.004`, or empty."""


@dataclass(frozen=True)
class MeasureRow:
    """One set of texts."""

    label: str
    n: str
    oodness: Figure
    paper_oodness: str
    nearest: Figure
    pairwise: Figure
    paper_diversity: str


@dataclass(frozen=True)
class Example:
    """One text with its score and the nearest ordinary text."""

    text: str
    oodness: str
    nearest: str


@dataclass(frozen=True)
class Examples:
    """The most ordinary and the most unusual texts of one set."""

    label: str
    highest: tuple[Example, ...]
    lowest: tuple[Example, ...]


def label_of(name: str) -> str:
    """Return the displayed name of a set of texts."""
    return f"Diverse tree, {name} texts" if name.isdigit() else "Simulatable tree, all texts"


def set_names(metrics: Mapping[str, Any]) -> list[str]:
    """Return the names of the measured sets: by size, the simulatable one last."""
    names = [str(name) for name in mapping(metrics.get("sets"))]
    return sorted(names, key=lambda name: (not name.isdigit(), int(name) if name.isdigit() else 0))


def rows(metrics: Mapping[str, Any]) -> list[MeasureRow]:
    """Return one row per set, the baseline first."""
    batch, spread = dig(metrics, "baseline_batch"), dig(metrics, "baseline_diversity")
    found = []
    if mapping(batch) or mapping(spread):
        deviation = number(batch, "spread")
        found.append(
            MeasureRow(
                label="Ordinary driving (the baseline itself)",
                n=_whole(batch, "N") or _whole(spread, "n"),
                oodness=Figure(
                    _signed(number(batch, "mean")),
                    f"± {deviation:.3f}" if deviation is not None else "",
                ),
                paper_oodness=_signed(paper.OODNESS["baseline batch"]),
                nearest=_figure(spread, "nearest"),
                pairwise=_figure(spread, "pairwise"),
                paper_diversity=_signed(paper.DIVERSITY["baseline"]),
            )
        )
    for name in set_names(metrics):
        report = dig(metrics, "sets", name)
        diversity = dig(report, "diversity")
        found.append(
            MeasureRow(
                label=label_of(name),
                n=_whole(report, "n"),
                oodness=Figure(
                    _signed(number(report, "oodness", "mean")),
                    _bounds(dig(report, "oodness", "interval")),
                ),
                paper_oodness=_signed(paper.OODNESS.get(name)),
                nearest=_figure(diversity, "nearest"),
                pairwise=_figure(diversity, "pairwise"),
                paper_diversity=_signed(paper.DIVERSITY.get(name)),
            )
        )
    return found


def margins(metrics: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return the OOD-ness of every set relative to that of ordinary driving itself."""
    ordinary = number(metrics, "baseline_batch", "mean")
    found = []
    for name in set_names(metrics):
        mean = number(metrics, "sets", name, "oodness", "mean")
        if ordinary is not None and mean is not None:
            side = "above" if mean >= ordinary else "below"
            found.append((label_of(name), f"{abs(mean - ordinary):.3f} {side}"))
    return found


def chart(metrics: Mapping[str, Any]) -> Markup:
    """Draw the OOD-ness of every text, one strip per set; empty if nothing was measured."""
    strips = []
    for name in set_names(metrics):
        values = scores(metrics, name)
        if values:
            mean = number(metrics, "sets", name, "oodness", "mean")
            short = f"{name} texts" if name.isdigit() else name
            strips.append(
                charts.Strip(short, values, sum(values) / len(values) if mean is None else mean)
            )
    if not strips:
        return Markup("")
    return charts.histogram(strips, number(metrics, "baseline_batch", "mean"), "ordinary driving")


def scores(metrics: Mapping[str, Any], name: str) -> list[float]:
    """Return the OOD-ness of every text of a set, in order; empty unless all are numbers."""
    values = dig(metrics, "sets", name, "oodness", "per_text")
    if not isinstance(values, list):
        return []
    numbers = [number(value) for value in values]
    return [value for value in numbers if value is not None] if None not in numbers else []


def neighbours(metrics: Mapping[str, Any], name: str) -> list[str]:
    """Return the nearest baseline text of every text of a set; empty if unknown."""
    found = dig(metrics, "sets", name, "oodness", "nearest")
    return [str(dig(item, "text") or "") for item in found] if isinstance(found, list) else []


def examples(
    metrics: Mapping[str, Any], sets: Mapping[str, Sequence[Scenario]], count: int = 4
) -> list[Examples]:
    """Return the most ordinary and most unusual texts of every set whose scores match its texts."""
    found = []
    for name in set_names(metrics):
        texts, values = sets.get(name, ()), scores(metrics, name)
        if not texts or len(texts) != len(values):
            continue
        near = neighbours(metrics, name)
        near = near if len(near) == len(values) else [""] * len(values)
        order = sorted(range(len(values)), key=lambda index: (-values[index], index))
        shown = [
            Example(texts[index].text, charts.signed(values[index]), near[index]) for index in order
        ]
        found.append(Examples(label_of(name), tuple(shown[:count]), tuple(shown[-count:])))
    return found


def _figure(diversity: object, key: str) -> Figure:
    return Figure(_signed(number(diversity, key)), _bounds(dig(diversity, f"{key}_interval")))


def _bounds(interval: object) -> str:
    low, high = number(interval, "low"), number(interval, "high")
    return "" if low is None or high is None else f"{charts.signed(low)} to {charts.signed(high)}"


def _signed(value: float | None) -> str:
    return "" if value is None else charts.signed(value)


def _whole(value: object, key: str) -> str:
    found = number(value, key)
    return "" if found is None else f"{found:.0f}"
