"""The hold of a design's parts on each other, by small boxes where the one around a part is too coarse."""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from oodscen.data import _shapes as shapes
from oodscen.data._extents import Extent, Transform, around, corners_of, is_slanted, length_of
from oodscen.data._lettering import HEIGHT, width_of
from oodscen.data._shapes import Part, Point

REACH_M = 0.06
"""Gap up to which parts hold each other, m."""
_STEP = 0.3
"""Greatest length of a small box, m."""
_MOST = 160
"""Most small boxes of one part."""
_SECTORS = 12
"""Wedges around a round body."""
_SMALL_M = 0.25
"""Radius up to which the box around a round body is close enough, m."""


@dataclass(frozen=True, eq=False)
class Solid:
    """A part, or a piece of it."""

    box: Extent
    """The box around it."""
    part: Part
    transform: Transform

    @cached_property
    def blocks(self) -> list[Extent]:
        """Small boxes that fill it more closely than the box around it, if they can."""
        return _blocks(self.box, self.part, self.transform)

    @property
    def reaches_road(self) -> bool:
        """True if the road holds it."""
        if self.box.low[2] > REACH_M:
            return False
        is_text = isinstance(self.part, shapes.Text)
        return not is_text or min(block.low[2] for block in self.blocks) <= REACH_M

    def touches(self, other: "Solid") -> bool:
        """Return whether two solids hold each other."""
        if not self.box.touches(other.box, REACH_M):
            return False
        near = [block for block in self.blocks if block.touches(other.box, REACH_M)]
        far = [block for block in other.blocks if block.touches(self.box, REACH_M)]
        return any(extent.touches(two, REACH_M) for extent in near for two in far)


def held(solids: Sequence[Solid], *, is_standing: bool) -> list[bool]:
    """Return for each solid whether the road holds it, directly or by others.

    Args:
        solids: The solids in the order of the design.
        is_standing: True if the road holds what reaches it; otherwise the first solid is held.
    """
    if is_standing:
        found = [solid.reaches_road for solid in solids]
    else:
        found = [index == 0 for index in range(len(solids))]
    front = [solid for solid, is_held in zip(solids, found, strict=True) if is_held]
    while front:
        holder = front.pop()
        for index, solid in enumerate(solids):
            if not found[index] and holder.touches(solid):
                found[index] = True
                front.append(solid)
    return found


def _blocks(box: Extent, part: Part, transform: Transform) -> list[Extent]:
    """Return small boxes that fill a solid more closely than the box around it, if they can."""
    match part:
        case shapes.Box():
            return _cut(
                box, [transform.point(corner) for corner in corners_of(part.box, part.size)]
            )
        case shapes.Hull():
            corners = [
                transform.point((x, y, flat[4]))
                for flat in (part.hull, part.top)
                for x in flat[:2]
                for y in flat[2:4]
            ]
            return _cut(box, corners)
        case shapes.Panel(panel=quad):
            return _cut(box, _flat([transform.point(corner) for corner in quad]))
        case shapes.Text():
            corners = [transform.point(corner) for corner in _written(part)]
            return _cut(around(corners), _flat(corners))
        case shapes.Sheet():
            first, *others = (transform.point(corner) for corner in part.sheet)
            return [
                block
                for a, b in itertools.pairwise(others)
                for block in _cut(around([first, a, b]), _flat([first, a, b, b]))
            ]
        case shapes.Ball() if max(part.radii) > _SMALL_M:
            return list(_round(part.ball, part.radii, transform, lowest=-1.0))
        case shapes.Heap() if max(part.size) > 2 * _SMALL_M:
            x, y = part.heap
            radii = (part.size[0] / 2, part.size[1] / 2, part.size[2])
            return list(_round((x, y, 0.0), radii, transform, lowest=0.0))
        case shapes.Cylinder() if max(part.radius, part.end_radius or 0.0) > _SMALL_M:
            last = part.radius if part.end_radius is None else part.end_radius
            return list(_turned([(*part.cylinder, part.radius), (*part.to, last)], transform))
        case shapes.Lathe() if max(ring[3] for ring in part.lathe) > _SMALL_M:
            return list(_turned(part.lathe, transform))
        case shapes.Column() if max(max(ring[3:]) for ring in part.column) > _SMALL_M:
            return list(_column(part, transform))
        case shapes.Blot():
            (x, y), (length, width) = part.blot, part.size
            rim = [
                (x + length / 2 * c, y + width / 2 * s, part.height) for c, s in _circle(_SECTORS)
            ]
            return [transform.box(((x, y, part.height), *two)) for two in _pairs(rim)]
        case _:
            return [box]


def _written(part: shapes.Text) -> list[Point]:
    """Return the corners of what is seen of a text: its letters alone, if they have no ground."""
    if part.paper:
        return list(part.on)
    one, two, _, four = part.on
    width, height, columns = math.dist(one, two), math.dist(one, four), width_of(part.text)
    dot = min(width / (columns + 2), height / (HEIGHT + 2))
    a, b = 0.5 * columns * dot / width, 0.5 * HEIGHT * dot / height
    whole = _flat(part.on)
    shares = ((0.5 - b, 0.5 - a), (0.5 - b, 0.5 + a), (0.5 + b, 0.5 + a), (0.5 + b, 0.5 - a))
    return [_between(whole, (0.0, up, along)) for up, along in shares]


def _flat(quad: Sequence[Point]) -> list[Point]:
    """Return a quad as a body without thickness, in the order of `corners_of`."""
    a, b, c, d = quad
    return [a, b, d, c, a, b, d, c]


def _cut(box: Extent, corners: Sequence[Point]) -> list[Extent]:
    """Cut a body of eight corners into small boxes; one along the axes stays whole."""
    edges = [
        [
            _way(corner, corners[index + step])
            for index, corner in enumerate(corners)
            if not index & step
        ]
        for step in (4, 2, 1)
    ]
    if not any(is_slanted(edge) for parallel in edges for edge in parallel):
        return [box]
    counts = _counts([max(map(length_of, parallel)) for parallel in edges])
    return [
        around(
            [
                _between(corners, [(i + p) / counts[0], (j + q) / counts[1], (k + r) / counts[2]])
                for p in (0, 1)
                for q in (0, 1)
                for r in (0, 1)
            ]
        )
        for i, j, k in itertools.product(*map(range, counts))
    ]


def _way(start: Sequence[float], end: Sequence[float]) -> list[float]:
    return [b - a for a, b in zip(start, end, strict=True)]


def _turned(
    rings: Sequence[tuple[float, float, float, float]], transform: Transform
) -> Iterator[Extent]:
    """Yield the boxes around the wedges of a body of revolution."""
    for start, end in itertools.pairwise(rings):
        way = _way(start[:3], end[:3])
        length = math.hypot(*way)
        along = [w / length for w in way]
        least = min(range(3), key=lambda axis: abs(along[axis]))
        across = _crossed(along, [float(axis == least) for axis in range(3)])
        size = math.hypot(*across)
        one = [value / size for value in across]
        two = _crossed(along, one)
        rims = [
            [
                (
                    x + r * (c * one[0] + s * two[0]),
                    y + r * (c * one[1] + s * two[1]),
                    z + r * (c * one[2] + s * two[2]),
                )
                for c, s in _circle(_SECTORS)
            ]
            for x, y, z, r in (start, end)
        ]
        yield from _wedges(start[:3], end[:3], rims[0], rims[1], transform)


def _column(part: shapes.Column, transform: Transform) -> Iterator[Extent]:
    """Yield the boxes around the wedges of a column."""
    rims = [
        [
            (x, y + one * c, z + two * s) if part.axis == "x" else (x + one * c, y + two * s, z)
            for c, s in _circle(_SECTORS)
        ]
        for x, y, z, one, two in part.column
    ]
    middles: list[Point] = [(ring[0], ring[1], ring[2]) for ring in part.column]
    for (low, high), (below, above) in zip(
        itertools.pairwise(middles), itertools.pairwise(rims), strict=True
    ):
        yield from _wedges(low, high, below, above, transform)


def _wedges(
    low: Point,
    high: Point,
    low_rim: Sequence[Point],
    high_rim: Sequence[Point],
    transform: Transform,
) -> Iterator[Extent]:
    """Yield the boxes around the wedges of a round body between two rims."""
    count = min(4, max(1, math.ceil(math.dist(low, high) / _STEP)))
    below, above = ([transform.point(point) for point in rim] for rim in (low_rim, high_rim))
    ends = transform.point(low), transform.point(high)
    for (a, b), (c, d) in zip(_pairs(below), _pairs(above), strict=True):
        wedge = ((ends[0], ends[1]), (a, c), (b, d))
        for k in range(count):
            yield around(
                [
                    [p + (k + one) / count * (q - p) for p, q in zip(start, end, strict=True)]
                    for start, end in wedge
                    for one in (0, 1)
                ]
            )


def _crossed(a: Sequence[float], b: Sequence[float]) -> list[float]:
    return [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]


def _circle(count: int) -> list[tuple[float, float]]:
    turns = [2.0 * math.pi * k / count for k in range(count)]
    return [(math.cos(turn), math.sin(turn)) for turn in turns]


def _pairs(rim: Sequence[Point]) -> list[tuple[Point, Point]]:
    """Return neighbours on a rim, around it."""
    return list(itertools.pairwise([*rim, rim[0]]))


def _counts(lengths: Sequence[float]) -> list[int]:
    """Return the numbers of small boxes along the edges of a body."""
    step = _STEP
    while True:
        counts = [max(1, math.ceil(length / step)) for length in lengths]
        if math.prod(counts) <= _MOST:
            return counts
        step *= 1.2


def _between(corners: Sequence[Point], shares: Sequence[float]) -> Point:
    """Return a point within a body, by its shares of the way along z, x and y."""
    w, u, v = shares
    found = [0.0, 0.0, 0.0]
    for index, corner in enumerate(corners):
        weight = (w if index & 4 else 1 - w) * (u if index & 2 else 1 - u) * (v if index & 1 else 1 - v)  # fmt: skip
        for axis in range(3):
            found[axis] += weight * corner[axis]
    return found[0], found[1], found[2]


def _round(
    centre: Point, radii: Sequence[float], transform: Transform, *, lowest: float
) -> Iterator[Extent]:
    """Yield the small boxes that an ellipsoid fills; `lowest` is -1, or 0 for its upper half."""
    lows = (-1.0, -1.0, lowest)
    counts = _counts([(1.0 - low) * radius for low, radius in zip(lows, radii, strict=True)])
    steps = [(1.0 - low) / count for low, count in zip(lows, counts, strict=True)]
    for cell in itertools.product(*map(range, counts)):
        ends = [
            (low + k * step, low + (k + 1) * step)
            for low, k, step in zip(lows, cell, steps, strict=True)
        ]
        nearest = [0.0 if a <= 0.0 <= b else min(abs(a), abs(b)) for a, b in ends]
        if sum(value * value for value in nearest) < 1.0:
            scaled = [
                [middle + share * radius for share in end]
                for middle, radius, end in zip(centre, radii, ends, strict=True)
            ]
            yield transform.box(itertools.product(*scaled))
