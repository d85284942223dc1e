"""Basic elements of the report's pictures."""

from collections.abc import Sequence

from markupsafe import Markup

WIDTH = 480
"""Width of a picture in its own coordinates; the page scales it."""


def svg(label: str, height: float, parts: Sequence[Markup], *, kind: str = "chart") -> Markup:
    """Return a picture of `WIDTH` by `height`.

    Args:
        label: Text alternative for screen readers.
        height: Height in the picture's own coordinates.
        parts: Elements, drawn in order.
        kind: Classes of the style sheet.
    """
    return Markup('<svg class="{}" viewBox="0 0 {} {}" role="img" aria-label="{}">{}</svg>').format(
        kind, WIDTH, px(height), label, Markup("").join(parts)
    )


def px(value: float) -> str:
    """Return a coordinate as short text, rounded to a tenth of a pixel."""
    return f"{value:.1f}".removesuffix(".0")
