"""Small boxes that fill a part more closely than the one box around it."""

import itertools
import math
from collections.abc import Iterator, Sequence

from oodscen.data._designs import shapes
from oodscen.data._designs.extents import (
    Extent,
    Transform,
    around,
    corners_of,
    is_slanted,
    length_of,
)
from oodscen.data._designs.lettering import HEIGHT, width_of
from oodscen.data._designs.shapes import Part, Point

_STEP_M = 0.3
"""Greatest length of a small box, m."""
_MAX_BLOCKS = 160
"""Most small boxes of a body that is cut, or of an ellipsoid."""
_SECTORS = 12
"""Wedges around a round body."""
_ANGLES = [2.0 * math.pi * k / _SECTORS for k in range(_SECTORS)]
_CIRCLE = [(math.cos(angle), math.sin(angle)) for angle in _ANGLES]
"""Cosine and sine at the edge of each wedge."""
_MAX_WEDGES = 4
"""Most pieces of one wedge along a round body."""
_SMALL_M = 0.25
"""Radius up to which the box around a round body is close enough, m."""


def blocks_of(box: Extent, part: Part, transform: Transform) -> list[Extent]:
    """Return small boxes that fill a part more closely than a box around it, or that box itself."""
    match part:
        case shapes.Box():
            return _cut_body(
                box, [transform.point(corner) for corner in corners_of(part.box, part.size)]
            )
        case shapes.Hull():
            corners = [
                transform.point((x, y, face[4]))
                for face in (part.hull, part.top)
                for x in face[:2]
                for y in face[2:4]
            ]
            return _cut_body(box, corners)
        case shapes.Panel(panel=quad):
            return _cut_body(box, _flat_body([transform.point(corner) for corner in quad]))
        case shapes.Text():
            corners = [transform.point(corner) for corner in _letter_corners(part)]
            return _cut_body(around(corners), _flat_body(corners))
        case shapes.Sheet():
            first, *others = (transform.point(corner) for corner in part.sheet)
            return [
                block
                for a, b in itertools.pairwise(others)
                for block in _cut_body(around([first, a, b]), _flat_body([first, a, b, b]))
            ]
        case shapes.Ball() if max(part.radii) > _SMALL_M:
            return list(_ellipsoid_blocks(part.ball, part.radii, transform, lowest=-1.0))
        case shapes.Heap() if max(part.size) > 2 * _SMALL_M:
            x, y = part.heap
            radii = (part.size[0] / 2, part.size[1] / 2, part.size[2])
            return list(_ellipsoid_blocks((x, y, 0.0), radii, transform, lowest=0.0))
        case shapes.Cylinder() if max(part.radius, part.end_radius or 0.0) > _SMALL_M:
            end_radius = part.radius if part.end_radius is None else part.end_radius
            return list(
                _lathe_wedges([(*part.cylinder, part.radius), (*part.to, end_radius)], transform)
            )
        case shapes.Lathe() if max(ring[3] for ring in part.lathe) > _SMALL_M:
            return list(_lathe_wedges(part.lathe, transform))
        case shapes.Column() if max(max(ring[3:]) for ring in part.column) > _SMALL_M:
            return list(_column_wedges(part, transform))
        case shapes.Blot():
            (x, y), (length, width) = part.blot, part.size
            rim = [(x + length / 2 * cos, y + width / 2 * sin, part.height) for cos, sin in _CIRCLE]
            return [transform.box(((x, y, part.height), *edge)) for edge in _rim_edges(rim)]
        case _:
            return [box]


def _letter_corners(part: shapes.Text) -> list[Point]:
    """Return the corners of a text: those of its letters alone if it has no ground."""
    if part.paper:
        return list(part.on)
    width_m, height_m = math.dist(*part.on[:2]), math.dist(part.on[0], part.on[3])
    columns = width_of(part.text)
    dot_m = min(width_m / (columns + 2), height_m / (HEIGHT + 2))
    half_along = 0.5 * columns * dot_m / width_m
    half_up = 0.5 * HEIGHT * dot_m / height_m
    body = _flat_body(part.on)
    return [
        _interpolated(body, (0.0, 0.5 + up * half_up, 0.5 + along * half_along))
        for up, along in ((-1, -1), (-1, 1), (1, 1), (1, -1))
    ]


def _flat_body(quad: Sequence[Point]) -> list[Point]:
    """Return a quad as a body without thickness, in the order of `corners_of`."""
    a, b, c, d = quad
    return [a, b, d, c, a, b, d, c]


def _cut_body(box: Extent, corners: Sequence[Point]) -> list[Extent]:
    """Cut a body of eight corners into small boxes; one along the axes stays whole."""
    edges = [
        [
            _vector(corner, corners[index + step])
            for index, corner in enumerate(corners)
            if not index & step
        ]
        for step in (4, 2, 1)
    ]
    if not any(is_slanted(edge) for parallel in edges for edge in parallel):
        return [box]
    counts = _block_counts([max(map(length_of, parallel)) for parallel in edges])
    return [
        around(
            [
                _interpolated(
                    corners, [(k + end) / n for k, end, n in zip(cell, ends, counts, strict=True)]
                )
                for ends in itertools.product((0, 1), repeat=3)
            ]
        )
        for cell in itertools.product(*map(range, counts))
    ]


def _vector(start: Sequence[float], end: Sequence[float]) -> list[float]:
    return [b - a for a, b in zip(start, end, strict=True)]


def _unit(vector: Sequence[float]) -> list[float]:
    length = math.hypot(*vector)
    return [value / length for value in vector]


def _lathe_wedges(
    rings: Sequence[tuple[float, float, float, float]], transform: Transform
) -> Iterator[Extent]:
    """Yield the boxes around the wedges of a body of revolution."""
    for start, end in itertools.pairwise(rings):
        along = _unit(_vector(start[:3], end[:3]))
        # The axis that is most nearly across the body.
        axis = min(range(3), key=lambda index: abs(along[index]))
        across = _unit(_cross_product(along, [float(index == axis) for index in range(3)]))
        upright = _cross_product(along, across)
        rims = [
            [
                [
                    c + radius * (cos * a + sin * u)
                    for c, a, u in zip(centre, across, upright, strict=True)
                ]
                for cos, sin in _CIRCLE
            ]
            for *centre, radius in (start, end)
        ]
        yield from _wedges(start[:3], end[:3], rims, transform)


def _column_wedges(part: shapes.Column, transform: Transform) -> Iterator[Extent]:
    """Yield the boxes around the wedges of a column."""
    for start, end in itertools.pairwise(part.column):
        rims = [_column_rim(part.axis, ring) for ring in (start, end)]
        yield from _wedges(start[:3], end[:3], rims, transform)


def _column_rim(axis: str, ring: tuple[float, float, float, float, float]) -> list[Point]:
    x, y, z, first_radius, second_radius = ring
    if axis == "x":
        return [(x, y + first_radius * cos, z + second_radius * sin) for cos, sin in _CIRCLE]
    return [(x + first_radius * cos, y + second_radius * sin, z) for cos, sin in _CIRCLE]


def _wedges(
    low: Point, high: Point, rims: Sequence[Sequence[Sequence[float]]], transform: Transform
) -> Iterator[Extent]:
    """Yield the boxes around the wedges of a round body between two rims."""
    count = min(_MAX_WEDGES, max(1, math.ceil(math.dist(low, high) / _STEP_M)))
    below, above = ([transform.point(point) for point in rim] for rim in rims)
    axis = transform.point(low), transform.point(high)
    for (a, b), (c, d) in zip(_rim_edges(below), _rim_edges(above), strict=True):
        edges = (axis, (a, c), (b, d))
        for k in range(count):
            yield around(
                [
                    [p + share * (q - p) for p, q in zip(start, end, strict=True)]
                    for start, end in edges
                    for share in (k / count, (k + 1) / count)
                ]
            )


def _cross_product(a: Sequence[float], b: Sequence[float]) -> list[float]:
    return [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]


def _rim_edges(rim: Sequence[Point]) -> list[tuple[Point, Point]]:
    """Return neighbours on a rim, around it."""
    return list(itertools.pairwise([*rim, rim[0]]))


def _block_counts(lengths: Sequence[float]) -> list[int]:
    """Return the numbers of small boxes along the edges of a body."""
    step_m = _STEP_M
    while True:
        counts = [max(1, math.ceil(length / step_m)) for length in lengths]
        if math.prod(counts) <= _MAX_BLOCKS:
            return counts
        step_m *= 1.2


def _interpolated(corners: Sequence[Point], shares: Sequence[float]) -> Point:
    """Return a point within a body of eight corners, by its shares of the way along z, x and y."""
    along_z, along_x, along_y = shares
    point = [0.0, 0.0, 0.0]
    for index, corner in enumerate(corners):
        weight = along_z if index & 4 else 1 - along_z
        weight *= along_x if index & 2 else 1 - along_x
        weight *= along_y if index & 1 else 1 - along_y
        for axis in range(3):
            point[axis] += weight * corner[axis]
    return point[0], point[1], point[2]


def _ellipsoid_blocks(
    centre: Point, radii: Sequence[float], transform: Transform, *, lowest: float
) -> Iterator[Extent]:
    """Yield the small boxes that an ellipsoid fills; `lowest` is -1, or 0 for its upper half."""
    lows = (-1.0, -1.0, lowest)
    counts = _block_counts([(1.0 - low) * radius for low, radius in zip(lows, radii, strict=True)])
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
