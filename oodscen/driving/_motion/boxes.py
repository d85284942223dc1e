"""Oriented boxes on the ground plane, with the distance and contact between them."""

import math
from typing import NamedTuple

from oodscen.numerics._exact import sincos
from oodscen.numerics._kernels import part


class Footprint(NamedTuple):
    """The footprint of a body."""

    x: float
    y: float
    yaw: float
    length: float
    """Extent along the heading, m."""
    width: float
    """Extent across the heading, m."""


class Shape(NamedTuple):
    """The heading and size of a box, as kernels take them."""

    cos: float
    """Cosine of the heading."""
    sin: float
    half_length: float
    half_width: float


@part
def radius(length: float, width: float) -> float:
    """Return the radius of the circle around a footprint, m."""
    return 0.5 * math.sqrt(length * length + width * width)


@part
def shape(yaw: float, length: float, width: float) -> Shape:
    """Return the shape of a box with this heading, rad, and size, m."""
    sine, cosine = sincos(yaw)
    return Shape(cosine, sine, 0.5 * length, 0.5 * width)


def gap(a: Footprint, b: Footprint) -> float:
    """Return the distance between two boxes, m; exactly 0 if they touch or overlap."""
    return box_gap(b.x - a.x, b.y - a.y, shape(*a[2:]), shape(*b[2:]))


@part
def box_gap(dx: float, dy: float, a: Shape, b: Shape) -> float:
    """Return the distance between two boxes, m, the second with its centre at `dx`, `dy` from the first's.

    Two disjoint convex shapes have a separating axis along one of their edge normals, and their distance
    is that between a corner of one and an edge of the other.
    """
    cos = a.cos * b.cos + a.sin * b.sin
    sin = a.cos * b.sin - a.sin * b.cos
    u, v = dx * a.cos + dy * a.sin, dy * a.cos - dx * a.sin
    p, q = dx * b.cos + dy * b.sin, dy * b.cos - dx * b.sin
    if (
        abs(u) <= a.half_length + b.half_length * abs(cos) + b.half_width * abs(sin)
        and abs(v) <= a.half_width + b.half_length * abs(sin) + b.half_width * abs(cos)
        and abs(p) <= b.half_length + a.half_length * abs(cos) + a.half_width * abs(sin)
        and abs(q) <= b.half_width + a.half_length * abs(sin) + a.half_width * abs(cos)
    ):
        return 0.0
    nearest = min(
        _corners_to_box(u, v, Shape(cos, sin, b.half_length, b.half_width), a),
        _corners_to_box(-p, -q, Shape(cos, -sin, a.half_length, a.half_width), b),
    )
    return math.sqrt(nearest)


@part
def _corners_to_box(u: float, v: float, box: Shape, origin: Shape) -> float:
    """Return the least squared distance from the corners of a box at `u`, `v` to the box at the origin, in its axes."""
    least = math.inf
    lu, lv = box.half_length * box.cos, box.half_length * box.sin
    wu, wv = -box.half_width * box.sin, box.half_width * box.cos
    for cu, cv in (
        (u + lu + wu, v + lv + wv),
        (u + lu - wu, v + lv - wv),
        (u - lu + wu, v - lv + wv),
        (u - lu - wu, v - lv - wv),
    ):
        du = abs(cu) - origin.half_length
        dv = abs(cv) - origin.half_width
        square = (du * du if du > 0.0 else 0.0) + (dv * dv if dv > 0.0 else 0.0)
        if square < least:
            least = square
    return least
