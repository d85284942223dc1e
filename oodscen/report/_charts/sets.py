"""Charts of sets of texts: distributions of scores, diversity over the size, a map of the space."""

import math
from collections.abc import Sequence
from itertools import chain
from typing import NamedTuple

import numpy as np

from oodscen.report._charts.canvas import (
    CHARACTER,
    WIDTH,
    Canvas,
    legend_height,
    linear,
    set_class,
    short,
    signed,
)

_STRIP, _GAP = 40, 10
_BOX = 34
_CURVE, _MAP = 210, 300
_NAMES = 104
"""Least width of the column of names."""
_LONGEST_NAME = 32
"""Most characters of a name in that column."""
_LEAST_SPAN = 1e-9
"""Least span of an axis: a single value has none."""
_ROUNDING = 1e-9
"""Amount by which a value may fall short of a tick and count as on it."""


class HistogramRow(NamedTuple):
    """One row of a histogram: a set of values and the mean to mark."""

    label: str
    values: Sequence[float]
    mean: float


class DrawnSizeCurve(NamedTuple):
    """Both diversities of random subsets of one set, by their size."""

    label: str
    sizes: Sequence[int]
    means: Sequence[Sequence[float]]
    """To the nearest text, and over all pairs; one value per size each."""
    bands: Sequence[tuple[Sequence[float], Sequence[float]]] = ()
    """The lower and upper rim of each of `means`, if known."""


class Cloud(NamedTuple):
    """The texts of one set on two axes."""

    label: str
    points: Sequence[Sequence[float]]
    """[n, 2]."""


def histogram(
    strips: Sequence[HistogramRow],
    marker: float | None = None,
    marker_label: str = "",
    *,
    quantity: str = "OOD-ness",
) -> Canvas:
    """Draw one histogram per set of values over a common axis, each scaled to its own highest bar.

    Args:
        strips: The sets; each has at least one value.
        marker: A value to mark across all of them.
        marker_label: Label of that value.
        quantity: Name of the values.
    """
    left = _names_width([strip.label for strip in strips])
    right, height = WIDTH - 18, 22 + len(strips) * (_STRIP + _GAP)
    edges = [value for strip in strips for value in strip.values]
    edges += [] if marker is None else [marker]
    step = _step(max(edges) - min(edges), 10, least=0.1)
    low, high = _floor(min(edges), step), _floor(max(edges), step) + step
    x, ticks = linear(low, high, left, right), round((high - low) / step)
    canvas = Canvas(
        f"{quantity} per text: "
        + "; ".join(
            f"{strip.label}, {len(strip.values)} texts, mean {signed(strip.mean)}"
            for strip in strips
        ),
        height + 22,
    )
    for index in range(0, ticks + 1, 2 if ticks > 6 else 1):
        canvas.column(x(low + step * index), 18, height, signed(low + step * index, _digits(step)))
    canvas.text("tick", 0, height + 16, quantity)
    for number, strip in enumerate(strips):
        base = 22 + _STRIP + number * (_STRIP + _GAP)
        counts = np.histogram(np.clip(strip.values, low, high), max(5 * ticks, 1), (low, high))[
            0
        ].tolist()
        width = (right - left) / len(counts)
        for index, count in enumerate(counts):
            if count:
                tall = _STRIP * count / max(counts)
                at = left + width * index + 0.5
                canvas.rect("bar", at, base - tall, max(width - 1, 0.5), tall)
        canvas.line("grid", left, base, right, base)
        _row_label(canvas, base - 18, strip.label, len(strip.values))
        canvas.text("tick", 0, base + 8, f"mean {signed(strip.mean)}")
        canvas.line("mean", x(strip.mean), base, x(strip.mean), base - _STRIP - 4)
    if marker is not None:
        canvas.line("reference", x(marker), 4, x(marker), height)
        end, gap = (" end", -5) if x(marker) > (left + right) / 2 else ("", 5)
        canvas.text(f"tick{end}", x(marker) + gap, 12, marker_label)
    return canvas


def boxes(rows: Sequence[tuple[str, Sequence[float]]]) -> Canvas:
    """Draw a box per set: the middle half, the middle nine tenths, and the median."""
    ends = [value for _, values in rows for value in values]
    low, high = math.floor(min(ends)), math.ceil(max(ends))
    high = max(high, low + 1)
    height = 12 + _BOX * len(rows)
    x = linear(low, high, _names_width([name for name, _ in rows]), WIDTH - 14)
    canvas = Canvas("Scores of the detector by set", height + 22)
    for value in range(low, high + 1, max(1, math.ceil((high - low) / 8))):
        canvas.column(x(value), 6, height, signed(value, 0))
    for place, (name, values) in enumerate(rows):
        y = 12 + _BOX * place + _BOX / 2 - 6
        a, b, c, d, e = map(x, np.quantile(values, (0.05, 0.25, 0.5, 0.75, 0.95)).tolist())
        _row_label(canvas, y, name, len(values))
        canvas.line("range", a, y, e, y)
        canvas.rect("bar", b, y - 7, max(d - b, 1.0), 14)
        canvas.line("mean", c, y - 7, c, y + 7)
    return canvas


def size_curves(curves: Sequence[DrawnSizeCurve], *, colour: int = 0) -> Canvas:
    """Draw both diversities over the number of texts: to the nearest solid, over pairs dashed.

    Args:
        curves: The sets, at least one.
        colour: Number of the first set's colour; 0 is grey.
    """
    left, right, top, bottom = 40, WIDTH - 22, 10, 10 + _CURVE
    lines = [line for curve in curves for line in (*curve.means, *chain(*curve.bands))]
    values = list(chain(*lines))
    low, high = math.floor(min(values) * 10) / 10, math.ceil(max(values) * 10) / 10
    longest = max(max(curve.sizes) for curve in curves)
    y = linear(low, max(high, low + 0.1), bottom, top)
    along = linear(0.0, max(math.log(longest / 2), _LEAST_SPAN), left, right)

    def x(size: float) -> float:
        return along(math.log(max(size, 2) / 2))

    entries = [(set_class(place), curve.label) for place, curve in enumerate(curves, colour)]
    height = bottom + 46 + legend_height(entries)
    canvas = Canvas("Diversity by number of texts", height)
    steps = max(round((high - low) * 10), 1)
    for index in range(0, steps + 1, max(1, math.ceil(steps / 6))):
        canvas.row(y(low + index / 10), left, right, signed(low + index / 10, 1))
    for size in (10**power for power in range(1, 7) if 10**power <= longest):
        canvas.text("tick middle", x(size), bottom + 16, size)
    canvas.text("tick middle", x(2), bottom + 16, 2)
    for place, curve in enumerate(curves, colour):
        for lower, upper in curve.bands:
            rims = ((*curve.sizes, *reversed(curve.sizes)), (*lower, *reversed(upper)))
            around = [(x(size), y(value)) for size, value in zip(*rims, strict=True)]
            canvas.path(f"band {set_class(place)}", around)
        for kind, line in zip(("curve", "curve dashed"), curve.means, strict=True):
            points = zip(map(x, curve.sizes), map(y, line), strict=True)
            canvas.path(f"{kind} {set_class(place)}", points)
    canvas.legend(entries, bottom + 38)
    words = "diversity: nearest text (solid), all pairs (dashed); by number of texts"
    canvas.text("tick", 0, height - 6, words)
    return canvas


def cloud_map(clouds: Sequence[Cloud], share: Sequence[float], *, colour: int = 0) -> Canvas:
    """Draw sets of texts on two axes of equal scale.

    Args:
        clouds: The sets, at least one point each.
        share: Share of the variance that each axis holds.
        colour: Number of the first set's colour; 0 is grey and faint.
    """
    every = np.array([point for cloud in clouds for point in cloud.points], np.float64)
    low, spans = every.min(axis=0), np.maximum(np.ptp(every, axis=0), _LEAST_SPAN)
    scale = min((WIDTH - 20) / spans[0], (_MAP - 20) / spans[1])
    height, left = 20 + float(spans[1] * scale), (WIDTH - float(spans[0] * scale)) / 2
    entries = [
        (set_class(place), f"{cloud.label} ({len(cloud.points)})")
        for place, cloud in enumerate(clouds, colour)
    ]
    canvas = Canvas("Texts on two principal axes", height + 22 + legend_height(entries))
    for place, cloud in enumerate(clouds, colour):
        kind, radius = ("point", 2.6) if place else ("point faint", 1.8)
        for first, second in (np.array(cloud.points) - low) * scale:
            canvas.circle(f"{kind} {set_class(place)}", left + first, height - 10 - second, radius)
    canvas.legend(entries, height + 14)
    axes = ", ".join(f"{name}: {part:.0%}" for name, part in zip("xy", share, strict=False))
    canvas.text("tick", 5, height + 14 + legend_height(entries), f"Share of the variance, {axes}")
    return canvas


def scatter(clouds: Sequence[Cloud], title: str, axes: tuple[str, str]) -> Canvas:
    """Draw sets of texts by two measures, each on a scale of its own.

    Args:
        clouds: The sets, at least one point each.
        title: Title for readers who cannot see the picture.
        axes: Names of the measures, across and up.
    """
    every = np.array([point for cloud in clouds for point in cloud.points], np.float64)
    (left, bottom), (right, top) = every.min(axis=0).tolist(), every.max(axis=0).tolist()
    x = linear(left, max(right, left + _LEAST_SPAN), 40, WIDTH - 14)
    y = linear(bottom, max(top, bottom + _LEAST_SPAN), _MAP - 10, 10)
    entries = [
        (set_class(place), f"{cloud.label} ({len(cloud.points)})")
        for place, cloud in enumerate(clouds, 1)
    ]
    canvas = Canvas(title, _MAP + 44 + legend_height(entries))
    for value, label in _ticks(left, right, 5, digits=1):
        canvas.text("tick middle", x(value), _MAP + 8, label)
    for value, label in _ticks(bottom, top, 4, digits=2):
        canvas.row(y(value), 40, WIDTH - 14, label)
    for place, cloud in enumerate(clouds, 1):
        for first, second in cloud.points:
            canvas.circle(f"point {set_class(place)}", x(first), y(second), 2.2)
    canvas.legend(entries, _MAP + 34)
    canvas.text("tick", 0, _MAP + 36 + legend_height(entries), f"across: {axes[0]}; up: {axes[1]}")
    return canvas


def _row_label(canvas: Canvas, y: float, label: str, n: int) -> None:
    canvas.text("name", 0, y, short(label, _LONGEST_NAME))
    canvas.text("tick", 0, y + 13, f"n = {n}")


def _names_width(names: Sequence[str]) -> float:
    """Return the width of a column of names in bold."""
    longest = min(max(map(len, names)), _LONGEST_NAME)
    return max(_NAMES, 1.1 * CHARACTER * longest + 10)


def _floor(value: float, step: float) -> float:
    return round((value + _ROUNDING) // step * step, 6)


def _step(span: float, ticks: int, *, least: float) -> float:
    """Return a round step that cuts a span into at most about this many parts."""
    sizes = (factor * least * 10**power for power in range(9) for factor in (1, 2, 5))
    return next((size for size in sizes if span / size <= ticks), span / ticks)


def _ticks(low: float, high: float, count: int, *, digits: int) -> list[tuple[float, str]]:
    """Return evenly spaced values with labels that tell them apart; one value if there is no more."""
    if high - low < _LEAST_SPAN:
        return [(low, signed(low, digits))]
    digits = max(digits, _digits((high - low) / (count - 1)))
    return [(value, signed(value, digits)) for value in np.linspace(low, high, count).tolist()]


def _digits(step: float) -> int:
    """Return the number of decimals that tells ticks apart which are this far from each other."""
    return min(max(0, -math.floor(math.log10(max(step, _LEAST_SPAN)))), 9)
