"""Boxes along the axes around the parts of a design."""

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from oodscen.data._designs import shapes
from oodscen.data._designs.shapes import Part, Point
from oodscen.data._designs.tessellation import sagging_points

STEP_M = 0.5
"""Longest stretch of a slanted bar that is boxed as one, m."""
_SQUARE = math.sqrt(2.0)
"""Ratio of a square's side to the radius of the circle around it."""
_SLANT = 0.05
"""Share of a bar's length along a second axis from which it is slanted."""

Row = tuple[float, float, float]


class Extent(NamedTuple):
    """A box along the axes."""

    low: Point
    high: Point
    is_airy: bool = False
    """True for what floats by itself: dust, a swarm."""

    def touches(self, other: "Extent", reach: float) -> bool:
        """Return whether two boxes are at most `reach` apart along every axis."""
        return all(
            self.low[axis] - reach <= other.high[axis]
            and other.low[axis] - reach <= self.high[axis]
            for axis in range(3)
        )


@dataclass(frozen=True)
class Transform:
    """The map from the coordinates of a part to those of the whole design."""

    rows: tuple[Row, Row, Row] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    """Matrix of a rotation, a mirror image or a scale."""
    shift: Point = (0.0, 0.0, 0.0)
    """Translation after it, m."""

    def vector(self, vector: Sequence[float]) -> Point:
        """Return a vector in the coordinates of the design."""
        x, y, z = (sum(a * b for a, b in zip(row, vector, strict=True)) for row in self.rows)
        return x, y, z

    def point(self, point: Sequence[float]) -> Point:
        """Return a point in the coordinates of the design."""
        x, y, z = (a + b for a, b in zip(self.vector(point), self.shift, strict=True))
        return x, y, z

    def box(self, points: Iterable[Sequence[float]], is_airy: bool = False) -> Extent:
        """Return the box around points of the part."""
        return around([self.point(point) for point in points], is_airy)

    def translated(self, offset: Point) -> "Transform":
        """Return the transform of a part that is first moved."""
        return Transform(self.rows, self.point(offset))

    def mirrored(self) -> "Transform":
        """Return the transform of a part that is first mirrored in y."""
        first, second, third = ((x, -y, z) for x, y, z in self.rows)
        return Transform((first, second, third), self.shift)

    def rotated(
        self, roll_deg: float, yaw_deg: float, to: Point, scale: float = 1.0
    ) -> "Transform":
        """Return the transform of a part that is first scaled, turned about x, then about z, and moved."""
        cos_roll, sin_roll = math.cos(math.radians(roll_deg)), math.sin(math.radians(roll_deg))
        cos_yaw, sin_yaw = math.cos(math.radians(yaw_deg)), math.sin(math.radians(yaw_deg))
        columns = (
            (cos_yaw, sin_yaw, 0.0),
            (-sin_yaw * cos_roll, cos_yaw * cos_roll, sin_roll),
            (sin_yaw * sin_roll, -cos_yaw * sin_roll, cos_roll),
        )
        first, second, third = (
            self.vector([scale * value for value in column]) for column in columns
        )
        rows = tuple(zip(first, second, third, strict=True))
        return Transform((rows[0], rows[1], rows[2]), self.point(to))


def extents_of(part: Part, transform: Transform) -> list[Extent]:
    """Return the boxes around one part that is no group, lamp or thing of the catalogue."""
    match part:
        case shapes.Box():
            return [_upright(transform, part.box, part.size)]
        case shapes.Hull():
            ends = (part.hull, part.top)
            return [
                transform.box((x, y, end[4]) for end in ends for x in end[:2] for y in end[2:4])
            ]
        case shapes.Beam():
            end_width = part.width if part.end_width is None else part.end_width
            start, end = transform.point(part.beam), transform.point(part.to)
            return list(_bar(start, end, part.width / _SQUARE, end_width / _SQUARE))
        case shapes.Tube():
            points = [transform.point(point) for point in sagging_points(part)]
            radius = part.width / _SQUARE
            pieces = itertools.pairwise(points)
            return [box for start, end in pieces for box in _bar(start, end, radius, radius)]
        case shapes.Cylinder():
            start, end = transform.point(part.cylinder), transform.point(part.to)
            end_radius = part.radius if part.end_radius is None else part.end_radius
            return list(_bar(start, end, part.radius, end_radius))
        case shapes.Lathe():
            rings = [(transform.point(ring[:3]), ring[3]) for ring in part.lathe]
            pairs = itertools.pairwise(rings)
            return [box for (a, r), (b, q) in pairs for box in _bar(a, b, r, q)]
        case shapes.Ball():
            return [_round_box(part, transform)]
        case shapes.Column():
            return list(_sections(part, transform))
        case shapes.Wheel():
            (x, y), r = part.wheel, part.radius
            return [_upright(transform, (x, y, r), (2 * r, part.width, 2 * r))]
        case shapes.Sheet(sheet=points) | shapes.Panel(panel=points) | shapes.Text(on=points):
            return [transform.box(points)]
        case shapes.Heap():
            return [_upright(transform, (*part.heap, part.size[2] / 2), part.size)]
        case shapes.Veil():
            x, y, z = part.veil
            return [_upright(transform, (x, y, z + part.size[2] / 2), part.size, is_airy=True)]
        case shapes.Swarm():
            return [_upright(transform, part.swarm, part.size, is_airy=True)]
        case shapes.Blot():
            return [_upright(transform, (*part.blot, part.height / 2), (*part.size, part.height))]
        case shapes.Strip():
            return [transform.box(corners) for corners in _stripes(part)]
        case _:
            raise TypeError(f"{type(part).__name__} has no box")


def around(points: Sequence[Sequence[float]], is_airy: bool = False) -> Extent:
    """Return the box around points."""
    low = tuple(min(p[axis] for p in points) for axis in range(3))
    high = tuple(max(p[axis] for p in points) for axis in range(3))
    return Extent((low[0], low[1], low[2]), (high[0], high[1], high[2]), is_airy)


def corners_of(centre: Sequence[float], size: Sequence[float]) -> list[Point]:
    """Return the corners of a box: y changes fastest, then x, then z."""
    (x, y, z), (a, b, c) = centre, (value / 2 for value in size)
    return [(x + i * a, y + j * b, z + k * c) for k in (-1, 1) for i in (-1, 1) for j in (-1, 1)]


def _upright(
    transform: Transform, centre: Sequence[float], size: Sequence[float], is_airy: bool = False
) -> Extent:
    return transform.box(corners_of(centre, size), is_airy)


def length_of(vector: Sequence[float]) -> float:
    """Return the length of a vector."""
    return math.sqrt(sum(value * value for value in vector))


def is_slanted(vector: Sequence[float]) -> bool:
    """Return whether a vector runs along more than one axis."""
    length = length_of(vector)
    return sum(abs(value) > _SLANT * length for value in vector) > 1


def _bar(start: Point, end: Point, radius: float, end_radius: float) -> Iterator[Extent]:
    """Yield the boxes along a round bar between two points in the coordinates of the design."""
    vector = [b - a for a, b in zip(start, end, strict=True)]
    length = length_of(vector)
    # Reach of a disc of radius 1 across the bar along each axis.
    disc = [math.sqrt(max(0.0, 1.0 - (value / length) ** 2)) for value in vector]
    count = max(1, math.ceil(length / STEP_M)) if is_slanted(vector) else 1
    for k in range(count):
        points = []
        for share in (k / count, (k + 1) / count):
            reach = radius + share * (end_radius - radius)
            middle = [a + share * value for a, value in zip(start, vector, strict=True)]
            points += [
                [m + sign * reach * d for m, d in zip(middle, disc, strict=True)]
                for sign in (-1, 1)
            ]
        yield around(points)


def _round_box(part: shapes.Ball, transform: Transform) -> Extent:
    """Return the box around an ellipsoid."""
    x, y, z = transform.point(part.ball)
    grown = [radius * (1.0 + part.jitter) for radius in part.radii]
    a, b, c = (
        math.sqrt(sum((m * r) ** 2 for m, r in zip(row, grown, strict=True)))
        for row in transform.rows
    )
    return Extent((x - a, y - b, z - c), (x + a, y + b, z + c))


def _sections(part: shapes.Column, transform: Transform) -> Iterator[Extent]:
    """Yield the boxes between the rings of a column."""
    rings = []
    for x, y, z, one, two in _rings(part):
        offsets = [(i * one, j * two) for i in (-1, 1) for j in (-1, 1)]
        if part.axis == "x":
            rings.append([transform.point((x, y + a, z + b)) for a, b in offsets])
        else:
            rings.append([transform.point((x + a, y + b, z)) for a, b in offsets])
    for ring, after in itertools.pairwise(rings):
        yield around([*ring, *after])


def _rings(part: shapes.Column) -> Iterator[tuple[float, ...]]:
    """Yield the rings of a column, with further ones on long stretches."""
    for start, end in itertools.pairwise(part.column):
        count = max(1, math.ceil(math.dist(start[:3], end[:3]) / STEP_M))
        for k in range(count):
            yield tuple(a + k / count * (b - a) for a, b in zip(start, end, strict=True))
    yield part.column[-1]


def _stripes(part: shapes.Strip) -> Iterator[list[Point]]:
    """Yield the corners of the boxes along a strip."""
    for (x0, y0), (x1, y1) in itertools.pairwise(part.strip):
        length = math.hypot(x1 - x0, y1 - y0)
        a, b = part.width / 2 * (y1 - y0) / length, part.width / 2 * (x1 - x0) / length
        yield [
            (x + sign * a, y - sign * b, z)
            for x, y in ((x0, y0), (x1, y1))
            for sign in (-1, 1)
            for z in (0.0, part.height)
        ]
