"""Polygons in the picture plane: the outlines of bodies, and their part inside the picture."""

from collections.abc import Iterable, Sequence

Pixel = tuple[float, float]
"""A point in the picture plane: pixels to the right of its left edge and below its top."""
Outline = Sequence[Pixel]


def hull(points: Iterable[Pixel]) -> list[Pixel]:
    """Return the convex hull of points (Andrew's monotone chain)."""
    ordered = sorted(set(points))
    if len(ordered) < 3:
        return ordered
    chains: list[list[Pixel]] = []
    for sequence in (ordered, ordered[::-1]):
        chain: list[Pixel] = []
        for point in sequence:
            while len(chain) > 1 and _turn(chain[-2], chain[-1], point) <= 0.0:
                chain.pop()
            chain.append(point)
        chains.append(chain[:-1])
    return chains[0] + chains[1]


def area(outline: Outline) -> float:
    """Return the area of a polygon."""
    total = 0.0
    for (x0, y0), (x1, y1) in zip(outline, [*outline[1:], *outline[:1]], strict=True):
        total += x0 * y1 - x1 * y0
    return 0.5 * abs(total)


def clipped(outline: Outline, width: float, height: float) -> list[Pixel]:
    """Return the part of a convex polygon inside a picture (Sutherland and Hodgman, 1974)."""
    shown = list(outline)
    for axis, limit, sign in ((0, 0.0, 1.0), (0, width, -1.0), (1, 0.0, 1.0), (1, height, -1.0)):
        before, shown = shown, []
        for index, point in enumerate(before):
            last = before[index - 1]
            a, b = sign * (last[axis] - limit), sign * (point[axis] - limit)
            if (a >= 0.0) != (b >= 0.0):
                f = a / (a - b)
                cut = (last[0] + f * (point[0] - last[0]), last[1] + f * (point[1] - last[1]))
                shown.append(cut)
            if b >= 0.0:
                shown.append(point)
    return shown


def _turn(a: Pixel, b: Pixel, c: Pixel) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
