"""Charts as inline SVG, coloured by the page's style sheet to follow its light and dark themes."""

from collections.abc import Sequence
from typing import NamedTuple

from markupsafe import Markup

from oodscen.report._charts.drawing import WIDTH, px, svg


class Point(NamedTuple):
    """The tree after one round of red teaming."""

    round: int
    nodes: int
    decision: str


class Strip(NamedTuple):
    """One row of a histogram: a set of values and the mean to mark."""

    label: str
    values: Sequence[float]
    mean: float


def growth(points: Sequence[Point], start: int, final: int | None = None) -> Markup:
    """Draw the size of a tree over the rounds of red teaming.

    Args:
        points: One per round, in order.
        start: Size before the first round.
        final: Size that the paper reached; drawn as a dotted line.
    """
    left, right, top, bottom = 34, WIDTH - 12, 12, 150
    last = max(points[-1].round if points else 1, 1)
    sizes = [start, *(point.nodes for point in points), *([final] if final else [])]
    low, high, step = scale(min(sizes), max(sizes), 4)

    def x(value: float) -> float:
        return left + (right - left) * value / last

    def y(value: float) -> float:
        return bottom - (bottom - top) * (value - low) / (high - low)

    parts = [
        Markup(
            '<line class="grid" x1="{}" x2="{}" y1="{}" y2="{}"/><text class="tick end" x="{}" y="{}">{}</text>'
        ).format(left, right, px(y(value)), px(y(value)), left - 6, px(y(value) + 4), value)
        for value in range(low, high + 1, step)
    ]
    if final:
        parts.append(
            Markup(
                '<line class="reference" x1="{}" x2="{}" y1="{}" y2="{}"/><text class="tick end" x="{}" y="{}">paper: {}</text>'
            ).format(left, right, px(y(final)), px(y(final)), right, px(y(final) - 5), final)
        )
    line = f"M{px(x(0))},{px(y(start))}"
    for point in points:
        line += f"H{px(x(point.round))}V{px(y(point.nodes))}"
    parts.append(Markup('<path class="line" d="{}"/>').format(line))
    width = max(1.0, min(3.0, 0.6 * (right - left) / last))
    parts += [
        Markup('<rect class="mark {}" x="{}" y="{}" width="{}" height="9"/>').format(
            f"is-{point.decision}", px(x(point.round) - width), bottom + 5, px(width)
        )
        for point in points
    ]
    parts += [
        Markup('<text class="tick middle" x="{}" y="{}">{}</text>').format(
            px(x(value)), bottom + 28, value
        )
        for value in sorted({0, last // 2, last})
    ]
    parts.append(
        Markup('<text class="tick end" x="{}" y="{}">rounds</text>').format(right, bottom + 42)
    )
    label = (
        f"Nodes of the tree over {last} rounds of red teaming, from {start} to {sizes[len(points)]}"
    )
    return svg(label, bottom + 46, parts)


def histogram(strips: Sequence[Strip], marker: float | None = None, marked: str = "") -> Markup:
    """Draw one histogram per set of values over a common axis, each scaled to its own highest bar.

    Args:
        strips: The sets; each has at least one value.
        marker: A value to mark across all of them.
        marked: Label of that value.
    """
    left, right, row, gap = 104, WIDTH - 18, 40, 10
    values = [value for strip in strips for value in strip.values]
    edges = [*values, *([marker] if marker is not None else [])]
    low, high = min(edges), max(edges)
    low, high = _floor(low, 0.1), _floor(high, 0.1) + 0.1
    bins = max(round((high - low) / 0.02), 1)
    height = 22 + len(strips) * (row + gap)

    def x(value: float) -> float:
        return left + (right - left) * (value - low) / (high - low)

    parts = []
    ticks = round((high - low) / 0.1)
    every = 2 if ticks > 6 else 1
    for index in range(0, ticks + 1, every):
        value = low + 0.1 * index
        parts.append(
            Markup(
                '<line class="grid" x1="{0}" x2="{0}" y1="18" y2="{1}"/><text class="tick middle" x="{0}" y="{2}">{3}</text>'
            ).format(px(x(value)), height, height + 16, signed(value, 1))
        )
    bar = (right - left) / bins
    for number, strip in enumerate(strips):
        base = 22 + row + number * (row + gap)
        counts = [0] * bins
        for value in strip.values:
            counts[min(max(int((value - low) / (high - low) * bins), 0), bins - 1)] += 1
        tallest = max(counts)
        parts += [
            Markup('<rect class="bar" x="{}" y="{}" width="{}" height="{}"/>').format(
                px(left + bar * index + 0.5),
                px(base - row * count / tallest),
                px(max(bar - 1, 0.5)),
                px(row * count / tallest),
            )
            for index, count in enumerate(counts)
            if count
        ]
        parts.append(
            Markup(
                '<line class="grid" x1="{}" x2="{}" y1="{}" y2="{}"/>'
                '<text class="name" x="0" y="{}">{}</text><text class="tick" x="0" y="{}">n = {}</text>'
                '<path class="mean" d="M{} {}v-{}"/>'
            ).format(
                left,
                right,
                base,
                base,
                base - 18,
                strip.label,
                base - 4,
                len(strip.values),
                px(x(strip.mean)),
                base,
                row + 4,
            )
        )
    if marker is not None:
        near_right = x(marker) > (left + right) / 2
        parts.append(
            Markup(
                '<line class="reference" x1="{0}" x2="{0}" y1="4" y2="{1}"/><text class="tick{2}" x="{3}" y="12">{4}</text>'
            ).format(
                px(x(marker)),
                height,
                " end" if near_right else "",
                px(x(marker) + (-5 if near_right else 5)),
                marked,
            )
        )
    label = "OOD-ness per text: " + "; ".join(
        f"{strip.label}, {len(strip.values)} texts, mean {signed(strip.mean)}" for strip in strips
    )
    return svg(label, height + 22, parts)


def whisker(share: float, low: float, high: float) -> Markup:
    """Draw a share in [0, 1] as a dot with its interval."""
    width, middle = 120, 9
    return Markup(
        '<svg class="whisker" viewBox="0 0 {0} 18" width="{0}" height="18" aria-hidden="true">'
        '<line class="grid" x1="1" x2="{1}" y1="{2}" y2="{2}"/>'
        '<path class="grid" d="M1 4v10M{3} 6v6M{1} 4v10"/>'
        '<line class="range" x1="{4}" x2="{5}" y1="{2}" y2="{2}"/>'
        '<circle class="dot" cx="{6}" cy="{2}" r="4"/></svg>'
    ).format(
        width,
        width - 1,
        middle,
        px(width / 2),
        px(1 + (width - 2) * low),
        px(1 + (width - 2) * high),
        px(1 + (width - 2) * share),
    )


def shares(counts: Sequence[tuple[str, int]]) -> Markup:
    """Draw counts by kind as one stacked bar; each part has its kind as class."""
    width, total, start = 220.0, sum(count for _, count in counts), 0.0
    parts = []
    for kind, count in counts:
        size = width * count / total if total else 0.0
        if size:
            parts.append(
                Markup('<rect class="is-{}" x="{}" y="2" width="{}" height="12"/>').format(
                    kind, px(start), px(max(size - 1, 0.5))
                )
            )
        start += size
    return Markup(
        '<svg class="shares" viewBox="0 0 220 16" width="220" height="16" aria-hidden="true">{}</svg>'
    ).format(Markup("").join(parts))


def signed(value: float, digits: int = 3) -> str:
    """Return a number as text, with a true minus sign."""
    text = f"{value:.{digits}f}"
    if not float(text):
        text = text.removeprefix("-")
    return text.replace("-", "\N{MINUS SIGN}")


def _floor(value: float, step: float) -> float:
    return round((value + 1e-9) // step * step, 6)


def scale(low: int, high: int, ticks: int) -> tuple[int, int, int]:
    """Return round bounds and a round step for an axis of whole numbers."""
    span = max(high - low, 1)
    step = next(
        s for s in (1, 2, 5, 10, 20, 25, 50, 100, 200, 250, 500, 10**9) if span / s <= ticks
    )
    bottom = low // step * step
    return bottom, max(-(-high // step) * step, bottom + step), step
