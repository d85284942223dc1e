"""Charts over the rounds of red teaming: the growth of the tree, and its saturation with new kinds."""

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

from oodscen.report._charts.canvas import WIDTH, Canvas, linear, whole_axis
from oodscen.stages._redteam.saturation import Saturation

_LEFT = 34


class Point(NamedTuple):
    """The tree after one round of red teaming."""

    round: int
    nodes: int
    decision: str


def growth(points: Sequence[Point], start: int, final: int | None = None) -> Canvas:
    """Draw the size of a tree over the rounds of red teaming.

    Args:
        points: One per round, in order.
        start: Size before the first round.
        final: Size that the paper reached; drawn as a dotted line.
    """
    right, top, bottom = WIDTH - 12, 12, 150
    last = max(points[-1].round if points else 1, 1)
    sizes = [start, *(point.nodes for point in points)]
    every = [*sizes, *([final] if final else [])]
    low, high, step = whole_axis(min(every), max(every))
    x, y = linear(0, last, _LEFT, right), linear(low, high, bottom, top)
    canvas = Canvas(
        f"Nodes of the tree over {last} rounds of red teaming, from {start} to {sizes[-1]}",
        bottom + 46,
    )
    for value in range(low, high + 1, step):
        canvas.row(y(value), _LEFT, right, value)
    if final:
        canvas.line("reference", _LEFT, y(final), right, y(final))
        canvas.text("tick end", right, y(final) - 5, f"paper: {final}")
    canvas.path("line", _steps((0, start), [(point.round, point.nodes) for point in points], x, y))
    width = max(1.0, min(3.0, 0.6 * (right - _LEFT) / last))
    for point in points:
        canvas.rect(f"mark is-{point.decision}", x(point.round) - width, bottom + 5, width, 9)
    for value in sorted({0, last // 2, last}):
        canvas.text("tick middle", x(value), bottom + 28, value)
    canvas.text("tick end", right, bottom + 42, "rounds")
    return canvas


def saturation_chart(estimates: Saturation) -> Canvas | None:
    """Draw new kinds and Good-Turing coverage over the rounds.

    The line counts the new kinds. The dot and bar at its end are the estimated total and its interval, as
    far as they lie inside the chart. The dotted line is the coverage, on the right axis.

    Args:
        estimates: Of the new kinds, by round; without rounds there is no chart.
    """
    if not estimates.curve:
        return None
    right, top, bottom = WIDTH - 58, 14, 160
    last, total = max(estimates.curve[-1].round, 1), estimates.kinds + estimates.unseen
    _, high, step = whole_axis(0, max(round(min(1.1 * total, 1.6 * estimates.kinds)), 4))
    x, height = linear(0, last, _LEFT, right), linear(0, high, bottom, top)

    def y(value: float) -> float:
        return height(min(value, high))

    canvas = Canvas(
        f"New kinds over {last} rounds of red teaming: {estimates.kinds}; about {estimates.unseen:.0f} unseen, "
        f"coverage {estimates.coverage:.0%}",
        bottom + 34,
    )
    for value in range(0, high + 1, step):
        canvas.row(y(value), _LEFT, right, value)
    for share in (0, 50, 100):
        canvas.text("tick", right + 12, y(high * share / 100) + 4, f"{share} %")
    coverage = [(x(point.round), y(high * point.coverage)) for point in estimates.curve]
    canvas.path("reference", coverage)
    canvas.path(
        "line",
        _steps(
            (0, 0),
            [(point.round, point.kinds) for point in estimates.curve],
            x,
            y,
        ),
    )
    end = right + 5
    if estimates.unseen_high > 0.0 and estimates.kinds + estimates.unseen_low < high:
        least, most = (
            estimates.kinds + estimates.unseen_low,
            estimates.kinds + estimates.unseen_high,
        )
        canvas.line("range", end, y(least), end, y(most))
    if estimates.unseen > 0.0 and total <= high:
        canvas.circle("dot", end, y(total), 3.5)
    if estimates.dry_from is not None:
        canvas.line("grid", x(estimates.dry_from), top, x(estimates.dry_from), bottom)
        canvas.text(
            "tick end", x(estimates.dry_from) - 4, bottom - 6, f"dry from {estimates.dry_from}"
        )
    for value in sorted({0, last // 2, last}):
        canvas.text("tick middle", x(value), bottom + 16, value)
    canvas.text("tick end", right, bottom + 30, "rounds")
    canvas.text("tick", 0, bottom + 30, "new kinds (line), Good-Turing coverage (dotted)")
    return canvas


def _steps(
    first: tuple[int, int],
    rounds: Iterable[tuple[int, int]],
    x: Callable[[float], float],
    y: Callable[[float], float],
) -> list[tuple[float, float]]:
    """Return the corners of a line that changes its height at each round."""
    corners, before = [(x(first[0]), y(first[1]))], first[1]
    for number, value in rounds:
        corners += [(x(number), y(before)), (x(number), y(value))]
        before = value
    return corners
