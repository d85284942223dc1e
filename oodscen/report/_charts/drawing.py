"""What all pictures of the report are made of."""

from collections.abc import Sequence

from markupsafe import Markup

WIDTH = 480
"""Of a picture's own coordinates; the page scales it."""


def svg(label: str, height: float, parts: Sequence[Markup], *, kind: str = "chart") -> Markup:
    """Return a picture of `WIDTH` by `height`.

    Args:
        label: What it shows, for those who cannot see it.
        height: In its own coordinates.
        parts: Drawn in order.
        kind: Classes of the style sheet.
    """
    return Markup('<svg class="{}" viewBox="0 0 {} {}" role="img" aria-label="{}">{}</svg>').format(
        kind, WIDTH, px(height), label, Markup("").join(parts)
    )


def px(value: float) -> str:
    """Write a coordinate in as few characters as a tenth of a pixel needs."""
    return f"{value:.1f}".removesuffix(".0")
