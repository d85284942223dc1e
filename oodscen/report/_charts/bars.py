"""Bar charts by scenario type and the confusion matrix of aspects, as inline SVG."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from markupsafe import Markup

from oodscen.report._charts.drawing import px, svg

_LEFT, _RIGHT = 0.0, 384.0
_BAR, _GAP = 11.0, 3.0


class Bar(NamedTuple):
    """The score of one model in one group."""

    hits: int
    n: int
    low: float
    high: float


class Row(NamedTuple):
    """One scenario type with a bar per model."""

    label: str
    bars: Sequence[Bar | None]
    chance: float | None = None
    """Chance level, drawn as a tick across the bars."""


def bars(rows: Sequence[Row], models: Sequence[str], what: str) -> Markup:
    """Draw success by scenario type, one bar per model, with intervals.

    Args:
        rows: The scenario types.
        models: Names, in the order of the bars; the n-th has the class `series-n`.
        what: Text alternative for screen readers.
    """
    parts: list[Markup] = []
    y = 4.0
    for row in rows:
        parts.append(
            Markup('<text class="name" x="{}" y="{}">{}</text>').format(
                px(_LEFT), px(y + 11), _short(row.label, 62)
            )
        )
        top = y + 17
        y = top
        for index, bar in enumerate(row.bars):
            parts += _bar(bar, index, models[index], y)
            y += _BAR + _GAP
        if row.chance is not None:
            parts.append(
                Markup(
                    '<path class="chance" d="M{} {}V{}"><title>a random action: {} %</title></path>'
                ).format(px(_x(row.chance)), px(top - 2), px(y - _GAP + 2), round(100 * row.chance))
            )
        y += 10
    label = f"{what}, by scenario type: " + "; ".join(
        f"{row.label}: "
        + ", ".join(
            f"{name} {bar.hits} of {bar.n}"
            for name, bar in zip(models, row.bars, strict=True)
            if bar
        )
        for row in rows
    )
    return svg(label, y, parts, kind="chart bars")


def _bar(bar: Bar | None, index: int, model: str, y: float) -> list[Markup]:
    track = Markup('<rect class="track" x="{}" y="{}" width="{}" height="{}"/>').format(
        px(_LEFT), px(y), px(_RIGHT - _LEFT), px(_BAR)
    )
    if bar is None or not bar.n:
        return [
            track,
            Markup('<text class="tick" x="{}" y="{}">–</text>').format(px(_RIGHT + 8), px(y + 10)),
        ]
    share = bar.hits / bar.n
    middle = px(y + _BAR / 2)
    return [
        track,
        Markup('<rect class="series-{}" x="{}" y="{}" width="{}" height="{}"><title>{}: {} of {}</title></rect>').format(
            index % 6, px(_LEFT), px(y), px((_RIGHT - _LEFT) * share), px(_BAR), model, bar.hits, bar.n
        ),
        Markup('<path class="span" d="M{0} {2}H{1}"/>').format(px(_x(bar.low)), px(_x(bar.high)), middle),
        Markup('<text class="tick" x="{}" y="{}">{} % <tspan class="of">of {}</tspan></text>').format(
            px(_RIGHT + 8), px(y + 10), round(100 * share), bar.n
        ),
    ]  # fmt: skip


def confusion(labels: Sequence[str], counts: Mapping[tuple[int, int], int], nothing: int) -> Markup:
    """Draw the confusion matrix: a row per true type, a column per chosen one.

    Args:
        labels: Labels of rows and columns; columns have an extra one for all other answers.
        counts: Counts by row and column.
        nothing: Column of "nothing unusual".
    """
    size = min(24.0, 300.0 / (nothing + 1))
    left, top = 190.0, 22.0
    most = max(counts.values(), default=1)
    width = left + size * (nothing + 1) + 4
    parts = []
    for index, label in enumerate(labels):
        middle = top + size * (index + 0.5) + 3.5
        parts.append(
            Markup('<text class="small end" x="{}" y="{}">{} {}<title>{}</title></text>').format(
                px(left - 6), px(middle), _short(label, 27), index + 1, label
            )
        )
        parts.append(
            Markup('<text class="small middle" x="{}" y="{}">{}</text>').format(
                px(left + size * (index + 0.5)), px(top - 6), index + 1
            )
        )
    parts.append(
        Markup('<text class="small middle" x="{}" y="{}">–</text>').format(
            px(left + size * (nothing + 0.5)), px(top - 6)
        )
    )
    parts += [
        Markup('<rect class="{}" x="{}" y="{}" width="{}" height="{}" fill-opacity="{}"><title>{}: {} taken for {}</title></rect>').format(
            "hit" if row == column else "miss",
            px(left + size * column), px(top + size * row), px(size - 1), px(size - 1),
            f"{0.15 + 0.85 * count / most:.2f}", labels[row], count,
            "nothing unusual" if column == nothing else labels[column],
        )
        for (row, column), count in sorted(counts.items())
    ]  # fmt: skip
    parts.append(
        Markup('<rect class="frame" x="{}" y="{}" width="{}" height="{}"/>').format(
            px(left), px(top), px(size * (nothing + 1)), px(size * len(labels))
        )
    )
    return Markup(
        '<svg class="chart confusion" viewBox="0 0 {} {}" role="img" aria-label="Which type of scenario was taken for which; the table below lists the most frequent">{}</svg>'
    ).format(px(width), px(top + size * len(labels) + 6), Markup("").join(parts))


def _x(share: float) -> float:
    return _LEFT + (_RIGHT - _LEFT) * share


def _short(text: str, most: int) -> str:
    return text if len(text) <= most else f"{text[: most - 1]}…"
