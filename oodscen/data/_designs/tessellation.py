"""The number of pieces that a part is drawn with: stretches, bands, cells and triangles."""

import itertools
import math
from collections.abc import Callable

from oodscen.data._designs import shapes
from oodscen.data._designs.lettering import strokes
from oodscen.data._designs.shapes import Part, Point

SAG_STRETCHES = 8
"""Straight pieces into which a stretch that sags is cut."""
MIN_PIECE_M = 1e-4
"""Shortest straight piece of a tube, m."""
MAX_BANDS = 40
"""Most bands of one stretch of a tube, and most columns or rows of a panel's pattern."""
MAX_DASHES = 40
"""Most dashes of one stretch of a strip."""
BLOT_CORNERS = 24
"""Corners of the outline of a blot."""
LUMP_TRIANGLES = 42
SPECK_TRIANGLES = 8
ASSET_TRIANGLES = 1_500
"""Triangles that a thing of the catalogue counts for; none has more."""


def sagging_points(part: shapes.Tube) -> list[Point]:
    """Return the points of a tube, with further ones along stretches that sag."""
    if not part.sag:
        return list(part.tube)
    points = [part.tube[0]]
    for start, end in itertools.pairwise(part.tube):
        for k in range(1, SAG_STRETCHES + 1):
            share = k / SAG_STRETCHES
            x, y, z = (a + share * (b - a) for a, b in zip(start, end, strict=True))
            # A parabola that is lowest, by the sag, in the middle.
            point = (x, y, z - 4.0 * part.sag * share * (1.0 - share))
            # An upright stretch that sags turns back on itself.
            if math.dist(point, points[-1]) > MIN_PIECE_M:
                points.append(point)
    return points


def bands(part: shapes.Tube, start: Point, end: Point) -> int:
    """Return the number of bands of one stretch of a tube."""
    if not part.second_colour:
        return 1
    return _pieces(math.dist(start, end), part.pitch)


def cells(part: shapes.Panel) -> tuple[int, int]:
    """Return the columns and rows of a panel's pattern."""
    width_m, height_m = math.dist(*part.panel[:2]), math.dist(part.panel[0], part.panel[3])
    columns, rows = _pieces(width_m, part.pitch), _pieces(height_m, part.pitch)
    match part.pattern:
        case "plain":
            return 1, 1
        case "planks":
            return 1, rows
        case "stripes":
            return (columns, 1) if width_m >= height_m else (1, rows)
        case _:
            return columns, rows


def _pieces(length_m: float, pitch_m: float) -> int:
    return min(MAX_BANDS, max(1, round(length_m / pitch_m)))


def _round_triangles(sides: int) -> int:
    """Return the triangles of a round bar with both ends closed."""
    return 4 * sides - 4


_TRIANGLES: dict[type[Part], Callable[..., int]] = {
    shapes.Box: lambda part: 12,
    shapes.Hull: lambda part: 12,
    shapes.Beam: lambda part: 12,
    shapes.Cylinder: lambda part: _round_triangles(part.sides),
    shapes.Lathe: lambda part: (len(part.lathe) - 1) * _round_triangles(part.sides),
    shapes.Ball: lambda part: part.around * (2 * part.down - 2),
    shapes.Column: lambda part: 2 * len(part.column) * part.sides,
    shapes.Sheet: lambda part: 2 * len(part.sheet),
    shapes.Wheel: lambda part: _round_triangles(14) + _round_triangles(10),
    shapes.LampPart: lambda part: 0,
    shapes.Text: lambda part: 2 + 2 * len(strokes(part.text)),
    shapes.Heap: lambda part: LUMP_TRIANGLES * part.lumps,
    shapes.Veil: lambda part: 0,
    shapes.Swarm: lambda part: SPECK_TRIANGLES * part.count,
    shapes.Blot: lambda part: BLOT_CORNERS,
    shapes.Strip: lambda part: 2 * (MAX_DASHES if part.dash else 1) * (len(part.strip) - 1),
    shapes.AssetPart: lambda part: ASSET_TRIANGLES,
}
"""Triangles of the parts that count for themselves."""
_CELL_TRIANGLES = {"bricks": 6, "windows": 6, "speckle": 4, "planks": 4}
"""Triangles of one cell of a panel's pattern; 2 for the others."""


def triangles(part: Part) -> int:
    """Return the largest number of triangles that one part is drawn with."""
    match part:
        case shapes.Tube():
            stretches = itertools.pairwise(sagging_points(part))
            return 12 * sum(bands(part, start, end) for start, end in stretches)
        case shapes.Panel():
            columns, rows = cells(part)
            pattern = _CELL_TRIANGLES.get(part.pattern, 2) * columns * rows
            if part.pattern == "net":
                pattern = 4 * (columns + rows + 2)
            return 2 + pattern * (2 if part.back else 1)
        case _:
            return _TRIANGLES[type(part)](part)
