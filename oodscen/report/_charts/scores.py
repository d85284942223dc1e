"""Charts of answers: shares with intervals, success by scenario type, outcomes, and confusions."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple
from xml.etree.ElementTree import SubElement

from oodscen.report._charts.canvas import Canvas, short

_RIGHT = 384.0
_BAR, _GAP = 11.0, 3.0
_LEAST_SQUARE = 15.0
"""Side of a square in which a number of two digits fits."""
MOST_BESIDE = 18
"""With more kinds than this a picture of confusions keeps its size, and does not fit beside a table."""


class ScoreBar(NamedTuple):
    """The score of one model in one group."""

    hits: int
    n: int
    low: float
    high: float


class ScoreRow(NamedTuple):
    """One scenario type with a bar per model."""

    label: str
    bars: Sequence[ScoreBar | None]
    chance: float | None = None
    """Chance level, drawn as a tick across the bars."""


def bars(rows: Sequence[ScoreRow], models: Sequence[str], title: str) -> Canvas:
    """Draw success by scenario type, one bar per model, with intervals.

    Args:
        rows: The scenario types.
        models: Names, in the order of the bars, which have the classes `series-0`, `series-1` ...
        title: Beginning of the text alternative for screen readers.
    """
    label = f"{title}, by scenario type: " + "; ".join(
        f"{row.label}: "
        + ", ".join(
            f"{model} {bar.hits} of {bar.n}"
            for model, bar in zip(models, row.bars, strict=True)
            if bar
        )
        for row in rows
        if any(row.bars)
    )
    height = 4.0 + sum(27 + len(row.bars) * (_BAR + _GAP) for row in rows)
    canvas = Canvas(label, height, kind="chart bars")
    y = 4.0
    for row in rows:
        canvas.text("name", 0, y + 11, short(row.label, 62))
        top = y = y + 17
        for index, (model, bar) in enumerate(zip(models, row.bars, strict=True)):
            _bar(canvas, bar, index, model, y)
            y += _BAR + _GAP
        if row.chance is not None:
            x = _RIGHT * row.chance
            chance = f"a random action: {round(100 * row.chance)} %"
            canvas.path("chance", [(x, top - 2), (x, y - _GAP + 2)], chance)
        y += 10
    return canvas


def _bar(canvas: Canvas, bar: ScoreBar | None, index: int, model: str, y: float) -> None:
    canvas.rect("track", 0, y, _RIGHT, _BAR)
    if bar is None:
        canvas.text("tick", _RIGHT + 8, y + 10, "–")
        return
    share, middle = bar.hits / bar.n, y + _BAR / 2
    title = f"{model}: {bar.hits} of {bar.n}"
    canvas.rect(f"series-{index}", 0, y, _RIGHT * share, _BAR, title)
    canvas.path("span", [(_RIGHT * bar.low, middle), (_RIGHT * bar.high, middle)])
    words = canvas.text("tick", _RIGHT + 8, y + 10, f"{round(100 * share)} % ")
    SubElement(words, "tspan", {"class": "of"}).text = f"of {bar.n}"


def confusion(labels: Sequence[str], counts: Mapping[tuple[int, int], int]) -> Canvas:
    """Draw the confusion matrix: a row per true type, a column per chosen one.

    Args:
        labels: Labels of rows and columns; columns have an extra one for all other answers.
        counts: Counts by row and column.
    """
    nothing = len(labels)
    is_wide = len(labels) > MOST_BESIDE
    size = _LEAST_SQUARE if is_wide else min(24.0, 300.0 / (nothing + 1))
    left, top = 190.0, 22.0
    most = max(counts.values(), default=1)
    canvas = Canvas(
        "Which type of scenario was taken for which; the table below lists the most frequent",
        top + size * len(labels) + 6,
        width=left + size * (nothing + 1) + 4,
        kind="chart confusion" + (" wide" if is_wide else ""),
    )
    if is_wide:
        canvas.fix_size()
    for index, label in enumerate(labels):
        middle = top + size * (index + 0.5) + 3.5
        canvas.text("small end", left - 6, middle, f"{short(label, 27)} {index + 1}", label)
        canvas.text("small middle", left + size * (index + 0.5), top - 6, index + 1)
    canvas.text("small middle", left + size * (nothing + 0.5), top - 6, "–")
    for (row, column), count in sorted(counts.items()):
        chosen = "nothing unusual" if column == nothing else labels[column]
        square = canvas.rect(
            "hit" if row == column else "miss",
            left + size * column,
            top + size * row,
            size - 1,
            size - 1,
            f"{labels[row]}: {count} taken for {chosen}",
        )
        square.set("fill-opacity", f"{0.15 + 0.85 * count / most:.2f}")
    canvas.rect("frame", left, top, size * (nothing + 1), size * len(labels))
    return canvas


def whisker(share: float, low: float, high: float) -> Canvas:
    """Draw a share in [0, 1] as a dot with its interval."""
    width, middle = 120, 9
    canvas = Canvas("", 18, width=width, kind="whisker")
    canvas.line("grid", 1, middle, width - 1, middle)
    for x, half in ((1, 5), (width / 2, 3), (width - 1, 5)):
        canvas.line("grid", x, middle - half, x, middle + half)
    canvas.line("range", 1 + (width - 2) * low, middle, 1 + (width - 2) * high, middle)
    canvas.circle("dot", 1 + (width - 2) * share, middle, 4)
    return canvas


def shares(counts: Sequence[tuple[str, int]]) -> Canvas:
    """Draw counts by kind as one stacked bar; each part has its kind as class."""
    width, total, start = 220.0, sum(count for _, count in counts), 0.0
    canvas = Canvas("", 16, width=width, kind="shares")
    for kind, count in counts:
        if count:
            size = width * count / total
            canvas.rect(f"is-{kind}", start, 2, max(size - 1, 0.5), 12)
            start += size
    return canvas


def intervals(rows: Sequence[tuple[str, float, float, float]]) -> Canvas:
    """Draw balanced accuracies of shortcuts as dots with their intervals, one row each, with a line at one half.

    Args:
        rows: Label, share, and the ends of its interval.
    """
    parts = "; ".join(f"{name} {round(100 * share)} %" for name, share, _, _ in rows)
    height = 8.0 + 27 * len(rows)
    canvas = Canvas(f"Balanced accuracy of shortcuts: {parts}", height, kind="chart bars")
    half = _RIGHT / 2
    canvas.path("chance", [(half, 2), (half, height - 2)], "no better than guessing: 50 %")
    for index, (name, share, low, high) in enumerate(rows):
        middle = 22.0 + 27 * index
        canvas.text("name", 0, middle - 8, short(name, 62))
        canvas.path("grid", [(0, middle), (_RIGHT, middle)])
        canvas.path("span", [(_RIGHT * low, middle), (_RIGHT * high, middle)])
        canvas.circle("dot", _RIGHT * share, middle, 4)
        canvas.text("tick", _RIGHT + 8, middle + 4, f"{round(100 * share)} %")
    return canvas
