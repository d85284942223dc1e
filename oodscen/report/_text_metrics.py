"""The figures and pictures of a study's measurements, beside the paper's."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from oodscen import _paper as paper
from oodscen.data._scenario import Scenario
from oodscen.metrics._measurements import Measurements
from oodscen.report._charts import sets as charts
from oodscen.report._charts.canvas import Canvas, signed
from oodscen.report._load import Material
from oodscen.report._rarity import ends_of, rarity_variables
from oodscen.statistics._intervals import Interval
from oodscen.study._study import Study


@dataclass(frozen=True)
class PrintedFigure:
    """One number and its uncertainty, formatted for print."""

    value: str = ""
    bounds: str = ""
    """`−0.71 to −0.65`, `± 0.004`, or empty."""


@dataclass(frozen=True)
class MeasureRow:
    """One set of texts."""

    label: str
    n: int
    oodness: PrintedFigure
    paper_oodness: str
    nearest: PrintedFigure
    pairwise: PrintedFigure
    paper_diversity: str


@dataclass(frozen=True)
class Example:
    """One text with its score and the nearest ordinary text."""

    text: str
    oodness: str
    nearest: str


@dataclass(frozen=True)
class ExtremeTexts:
    """The most ordinary and the most unusual texts of one set."""

    label: str
    highest: tuple[Example, ...]
    lowest: tuple[Example, ...]


def text_metric_variables(material: Material) -> dict[str, Any]:
    """Return the template's variables about the measures; without measurements, `measured` is `None`."""
    measurements = material.metrics
    texts = {**material.texts, "simulatable": material.scenarios}
    labels = {name: label_of(name) for name in set_names(measurements)} if measurements else {}
    return {
        **rarity_variables(measurements, labels, texts),
        "measured": measurements,
        "measure_rows": rows(measurements) if measurements else [],
        "margins": margins(measurements) if measurements else [],
        "measure_chart": chart(measurements) if measurements else None,
        "examples": examples(measurements, texts) if measurements else [],
    }


def label_of(name: str) -> str:
    """Return the displayed name of a set of texts."""
    return f"Diverse tree, {name} texts" if name.isdigit() else "Simulatable tree, all texts"


def set_names(metrics: Measurements) -> list[str]:
    """Return the names of the measured sets: by size, the simulatable one last."""
    return sorted(
        metrics.sets, key=lambda name: (not name.isdigit(), int(name) if name.isdigit() else 0)
    )


def rows(metrics: Measurements) -> list[MeasureRow]:
    """Return one row per set, the baseline first."""
    batch, spread = metrics.baseline_batch, metrics.baseline_diversity
    first = MeasureRow(
        label="Ordinary driving (the baseline itself)",
        n=batch.N,
        oodness=PrintedFigure(signed(batch.mean), f"± {batch.spread:.3f}"),
        paper_oodness=_papers(paper.OODNESS, "baseline batch"),
        nearest=_figure(spread.nearest, spread.nearest_interval),
        pairwise=_figure(spread.pairwise, spread.pairwise_interval),
        paper_diversity=_papers(paper.DIVERSITY, "baseline"),
    )
    return [first, *(_row(name, metrics) for name in set_names(metrics))]


def _row(name: str, metrics: Measurements) -> MeasureRow:
    report = metrics.sets[name]
    diversity = report.diversity
    return MeasureRow(
        label=label_of(name),
        n=report.n,
        oodness=_figure(report.oodness.mean, report.oodness.interval),
        paper_oodness=_papers(paper.OODNESS, name),
        nearest=_figure(diversity.nearest, diversity.nearest_interval),
        pairwise=_figure(diversity.pairwise, diversity.pairwise_interval),
        paper_diversity=_papers(paper.DIVERSITY, name),
    )


def margins(metrics: Measurements) -> list[tuple[str, str]]:
    """Return the OOD-ness of every set relative to that of ordinary driving itself."""
    margins = []
    for name in set_names(metrics):
        margin = metrics.sets[name].oodness.mean - metrics.baseline_batch.mean
        side = "above" if margin >= 0 else "below"
        margins.append((label_of(name), f"{abs(margin):.3f} {side}"))
    return margins


def chart(metrics: Measurements) -> Canvas | None:
    """Draw the OOD-ness of every text, one strip per set, if there are any."""
    strips = _strips(metrics)
    if not strips:
        return None
    return charts.histogram(strips, metrics.baseline_batch.mean, "ordinary driving")


def examples(metrics: Measurements, sets: Mapping[str, Sequence[Scenario]]) -> list[ExtremeTexts]:
    """Return the most ordinary and most unusual texts of every set whose scores match its texts."""
    extremes = []
    for name in set_names(metrics):
        texts, oodness = sets.get(name, ()), metrics.sets[name].oodness
        values = oodness.per_text
        if not texts or len(texts) != len(values):
            continue
        order = sorted(range(len(values)), key=lambda index: (-values[index], index))
        shown = [
            Example(texts[index].text, signed(values[index]), oodness.nearest[index].text)
            for index in order
        ]
        extremes.append(ExtremeTexts(label_of(name), *ends_of(shown)))
    return extremes


def pictures(study: Study, material: Material) -> dict[str, Any] | None:
    """Return the pictures of the measurements, each with its caption.

    Args:
        study: Unused; all parts of the page share one signature.
        material: The material read from the study.
    """
    if material.metrics is None:
        return None
    draw = (_distributions, _detected, _curves, _map)
    return {"pictures": [draw_picture(material.metrics) for draw_picture in draw]}


def _distributions(metrics: Measurements) -> tuple[Canvas, str]:
    picture = metrics.pictures.oodness
    strips = _strips(metrics)
    for label, values in (("ordinary", picture.control), ("baseline", picture.held_out)):
        strips.append(charts.HistogramRow(label, values, sum(values) / len(values)))
    return charts.histogram(strips), (
        "OOD-ness of the study’s texts, of hand-written ordinary sentences in the style of scenarios, and of "
        "ordinary driving texts scored without their like. Where the first lie over the second, this measure "
        "does not tell them apart."
    )


def _detected(metrics: Measurements) -> tuple[Canvas, str]:
    detector = metrics.pictures.detector
    names = set_names(metrics)
    boxes = [(_short(name), detector.sets[name].per_text) for name in names]
    areas = []
    for name in names:
        area = detector.sets[name].auroc
        bounds = f" [{area.interval.low:.2f}, {area.interval.high:.2f}]" if area.interval else ""
        areas.append(f"{_short(name)} {area.value:.2f}{bounds}")
    return charts.boxes([*boxes, ("ordinary", detector.control)]), (
        f"The detector “{detector.name}” in standard deviations of ordinary driving; boxes hold "
        "the middle half, lines the middle nine tenths. Area under the ROC curve against the ordinary sentences "
        f"(0.5 tells nothing): {'; '.join(areas)}."
    )


def _curves(metrics: Measurements) -> tuple[Canvas, str]:
    measured = metrics.pictures.curves
    curves = [
        charts.DrawnSizeCurve(
            _short(name), measured[name].sizes, (measured[name].nearest, measured[name].pairwise)
        )
        for name in ("baseline", *set_names(metrics))
        if name in measured
    ]
    return charts.size_curves(curves), (
        "Diversity of random subsets by their number of texts: to the nearest other text (solid) it "
        "falls as a set grows, over all pairs (dashed) it does not. Compare sets at equal size."
    )


def _map(metrics: Measurements) -> tuple[Canvas, str]:
    picture = metrics.pictures.map
    clouds = [
        charts.Cloud(_short(name), picture.points[name])
        for name in ("baseline", *set_names(metrics))
    ]
    return charts.cloud_map(clouds, picture.share), (
        "Texts on the two principal axes of the ordinary driving texts, at most 400 of each set. The axes hold "
        f"{sum(picture.share):.0%} of the variance: neighbours here may be far apart in the other dimensions."
    )


def _strips(metrics: Measurements) -> list[charts.HistogramRow]:
    reports = [(name, metrics.sets[name].oodness) for name in set_names(metrics)]
    return [
        charts.HistogramRow(_short(name), oodness.per_text, oodness.mean)
        for name, oodness in reports
    ]


def _figure(value: float | None, interval: Interval | None) -> PrintedFigure:
    bounds = f"{signed(interval.low)} to {signed(interval.high)}" if interval else ""
    return PrintedFigure("" if value is None else signed(value), bounds)


def _papers(figures: Mapping[str, float], name: str) -> str:
    return signed(figures[name]) if name in figures else ""


def _short(name: str) -> str:
    return f"{name} texts" if name.isdigit() else name
