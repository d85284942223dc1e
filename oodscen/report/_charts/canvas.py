"""A picture as SVG elements: inline on the page, or as a matplotlib figure for files and notebooks.

The page's style sheet colours the elements by class and follows its light and dark themes; `figure` gives
the same classes the colours of the light theme.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import count, groupby
from typing import TYPE_CHECKING, Any
from xml.etree.ElementTree import Element, SubElement, tostring

from oodscen.errors import MissingExtra

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDTH = 480
"""Width of a picture in its own coordinates; the page scales it."""

_LINES: dict[str, dict[str, Any]] = {
    "grid": {"color": "#dddcd6"},
    "reference": {"color": "#565d66", "dashes": (4, 3)},
    "mean": {"color": "#1b1e22", "linewidth": 2},
    "range": {"color": "#1d5a9e", "linewidth": 2.5},
    "curve": {"linewidth": 2},
    "dashed": {"dashes": (5, 4)},
}
_FILLS: dict[str, dict[str, Any]] = {
    "bar": {"color": "#1d5a9e", "alpha": 0.5},
    "band": {"alpha": 0.15},
    "point": {"alpha": 0.7},
    "faint": {"alpha": 0.45},
}
_TEXTS: dict[str, dict[str, Any]] = {
    "tick": {"color": "#565d66"},
    "name": {"color": "#1b1e22", "weight": "bold"},
    "end": {"ha": "right"},
    "middle": {"ha": "center"},
}
_SETS = ("#8b9098", "#1d5a9e", "#b23a1e", "#0f7558", "#7a5200", "#c27c0e")
"""Colours of the classes `set-0`, `set-1` ..., by which sets of texts are told apart."""
_INCHES = 7.2
_FONT = 12.0
CHARACTER = 6.5
"""Mean width of a character, in a picture's own coordinates."""
_LONGEST_LABEL = 66
"""Most characters of a name in a legend, which then fills a row."""


class Canvas:
    """A picture under construction, `WIDTH` wide; elements are drawn in order.

    Args:
        label: Text alternative for screen readers.
        height: Height in the picture's own coordinates.
        width: Width in the same coordinates.
        kind: Classes of the style sheet.
    """

    def __init__(
        self, label: str, height: float, *, width: float = WIDTH, kind: str = "chart"
    ) -> None:
        self._size = (width, height)
        self._root = Element("svg", {"class": kind, "viewBox": f"0 0 {px(width)} {px(height)}"})
        if label:
            self._root.attrib |= {"role": "img", "aria-label": label}
        else:
            self._root.attrib |= {"width": px(width), "height": px(height), "aria-hidden": "true"}

    def fix_size(self) -> None:
        """Give the picture a size of its own on the page, a pixel and a quarter per unit, instead of its column's."""
        width, height = self._size
        self._root.attrib |= {"width": px(1.25 * width), "height": px(1.25 * height)}

    def line(self, kind: str, x1: float, y1: float, x2: float, y2: float) -> None:
        """Draw a straight line."""
        self._add("line", kind, "", x1=x1, y1=y1, x2=x2, y2=y2)

    def path(self, kind: str, points: Iterable[tuple[float, float]], title: str = "") -> None:
        """Draw a line through points."""
        at = "L".join(f"{px(x)},{px(y)}" for x, y in points)
        self._add("path", kind, title, d=f"M{at}")

    def rect(
        self, kind: str, x: float, y: float, width: float, height: float, title: str = ""
    ) -> Element:
        """Draw a rectangle and return its element."""
        return self._add("rect", kind, title, x=x, y=y, width=width, height=height)

    def circle(self, kind: str, x: float, y: float, radius: float) -> None:
        """Draw a dot."""
        self._add("circle", kind, "", cx=x, cy=y, r=radius)

    def text(self, kind: str, x: float, y: float, words: object, title: str = "") -> Element:
        """Write words and return their element; classes `middle` and `end` place them before x."""
        element = self._add("text", kind, title, x=x, y=y)
        element.text = str(words)
        return element

    def row(self, y: float, left: float, right: float, label: object) -> None:
        """Draw a line of the grid with its label on the left."""
        self.line("grid", left, y, right, y)
        self.text("tick end", left - 6, y + 4, label)

    def column(self, x: float, top: float, bottom: float, label: object) -> None:
        """Draw an upright line of the grid with its label below."""
        self.line("grid", x, top, x, bottom)
        self.text("tick middle", x, bottom + 16, label)

    def legend(self, entries: Sequence[tuple[str, str]], top: float) -> None:
        """Draw classes and names of sets, three in a row or as many as fit; see `legend_height`."""
        columns = _legend_columns(entries)
        for index, (kind, label) in enumerate(entries):
            x, y = 10 + (WIDTH - 15) / columns * (index % columns), top + 18 * (index // columns)
            self.circle(kind, x, y - 4, 5)
            self.text("tick", x + 10, y, short(label, _LONGEST_LABEL))

    def __html__(self) -> str:
        """Return the picture as inline SVG, which templates insert as it is."""
        return tostring(self._root, encoding="unicode")

    def figure(self) -> "Figure":
        """Return the picture as a matplotlib figure.

        It is made without pyplot, so that no global state changes and no window opens.

        Raises:
            MissingExtra: If matplotlib is not installed.
        """
        try:
            from matplotlib.figure import Figure
        except ImportError:
            raise MissingExtra("pictures of the metrics", "plots", "matplotlib") from None
        width, height = self._size
        unit = _INCHES / width
        figure = Figure(figsize=(_INCHES, height * unit), dpi=110)
        axes = figure.add_axes((0, 0, 1, 1), xlim=(0, width), ylim=(height, 0))
        axes.set_axis_off()
        alike = groupby(
            self._root, lambda element: (element.tag, element.get("class"), element.get("r"))
        )
        for order, ((tag, *_), elements) in enumerate(alike):
            _DRAW[tag](axes, list(elements), unit * 72, order)
        return figure

    def _add(self, tag: str, kind: str, title: str, **attributes: float | str) -> Element:
        written = {
            name: value if isinstance(value, str) else px(value)
            for name, value in attributes.items()
        }
        element = SubElement(self._root, tag, {"class": kind, **written})
        if title:
            SubElement(element, "title").text = title
        return element


def _styled(element: Element, table: dict[str, dict[str, Any]], points: float) -> dict[str, Any]:
    """Return matplotlib's arguments for the classes of an element; `points` is the size of one unit."""
    style: dict[str, Any] = {}
    for name in element.attrib["class"].split():
        style |= table.get(name, {})
        if name.startswith("set-"):
            style["color"] = _SETS[int(name.removeprefix("set-"))]
    if "linewidth" in style:
        style["linewidth"] *= points
    return style


def _numbers(element: Element, *names: str) -> list[float]:
    return [float(element.attrib[name]) for name in names]


def _draw_lines(axes: Any, lines: Sequence[Element], points: float, order: int) -> None:
    for line in lines:
        x1, y1, x2, y2 = _numbers(line, "x1", "y1", "x2", "y2")
        style = {"linewidth": points} | _styled(line, _LINES, points)
        axes.plot([x1, x2], [y1, y2], zorder=order, **style)


def _draw_paths(axes: Any, paths: Sequence[Element], points: float, order: int) -> None:
    for path in paths:
        pairs = [pair.split(",") for pair in path.attrib["d"][1:].split("L")]
        xs, ys = [float(x) for x, _ in pairs], [float(y) for _, y in pairs]
        if "band" in path.attrib["class"].split():
            axes.fill(xs, ys, linewidth=0, zorder=order, **_styled(path, _FILLS, points))
        else:
            axes.plot(xs, ys, zorder=order, **_styled(path, _LINES, points))


def _draw_rects(axes: Any, rects: Sequence[Element], points: float, order: int) -> None:
    for rect in rects:
        x, y, width, height = _numbers(rect, "x", "y", "width", "height")
        around = [x, x + width, x + width, x], [y, y, y + height, y + height]
        axes.fill(*around, linewidth=0, zorder=order, **_styled(rect, _FILLS, points))


def _draw_circles(axes: Any, circles: Sequence[Element], points: float, order: int) -> None:
    xs, ys, radii = zip(*(_numbers(circle, "cx", "cy", "r") for circle in circles), strict=True)
    size = (2 * radii[0] * points) ** 2
    style = _styled(circles[0], _FILLS, points)
    axes.scatter(xs, ys, s=size, linewidths=0, zorder=order, **style)


def _draw_texts(axes: Any, texts: Sequence[Element], points: float, order: int) -> None:
    for text in texts:
        style = _styled(text, _TEXTS, points)
        style |= {"fontsize": _FONT * points, "zorder": order, "parse_math": False}
        axes.text(*_numbers(text, "x", "y"), text.text, **style)


_DRAW: dict[str, Callable[[Any, Sequence[Element], float, int], None]] = {
    "line": _draw_lines,
    "path": _draw_paths,
    "rect": _draw_rects,
    "circle": _draw_circles,
    "text": _draw_texts,
}


def set_class(index: int) -> str:
    """Return the class of the n-th set: `set-0` is grey, the others take five colours in turn."""
    colours = len(_SETS) - 1
    return f"set-{1 + (index - 1) % colours if index else 0}"


def legend_height(entries: Sequence[tuple[str, str]]) -> float:
    """Return the height that a legend takes."""
    return 18.0 * math.ceil(len(entries) / _legend_columns(entries))


def _legend_columns(entries: Sequence[tuple[str, str]]) -> int:
    longest = max((len(label) for _, label in entries), default=0)
    return min(max(int(WIDTH / (25 + CHARACTER * longest)), 1), 3)


def linear(low: float, high: float, start: float, end: float) -> Callable[[float], float]:
    """Return the map from values between `low` and `high` to coordinates between `start` and `end`."""
    return lambda value: start + (end - start) * (value - low) / (high - low)


def whole_axis(low: int, high: int) -> tuple[int, int, int]:
    """Return round bounds and a round step for an axis of whole numbers."""
    span = max(high - low, 1)
    step = next(step for step in _whole_steps() if span / step <= 4)
    bottom = low // step * step
    return bottom, max(-(-high // step) * step, bottom + step), step


def _whole_steps() -> Iterator[int]:
    """Yield the round steps of an axis of whole numbers: 1, 2, 5, 10, 20, 25, 50, 100, 200, 250 ..."""
    yield from (1, 2, 5)
    for power in count(1):
        yield from (10**power, 2 * 10**power, 25 * 10 ** (power - 1), 5 * 10**power)


def px(value: float) -> str:
    """Return a coordinate as short text, rounded to a tenth of a pixel."""
    return f"{value:.1f}".removesuffix(".0")


def signed(value: float, digits: int = 3) -> str:
    """Return a number as text, with a true minus sign."""
    text = f"{value:.{digits}f}"
    if not float(text):
        text = text.removeprefix("-")
    return text.replace("-", "\N{MINUS SIGN}")


def short(text: str, most: int) -> str:
    """Return a text cut to `most` characters."""
    return text if len(text) <= most else f"{text[: most - 1]}…"
