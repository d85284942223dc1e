"""Oriented boxes on the ground plane, with the distance and contact between them."""

import math
from typing import NamedTuple

from oodscen.numerics._exact import sincos
from oodscen.numerics._kernels import part


class Box(NamedTuple):
    """The footprint of a body."""

    x: float
    y: float
    yaw: float
    length: float
    """Extent along the heading, m."""
    width: float
    """Extent across the heading, m."""


def radius(length: float, width: float) -> float:
    """Return the radius of the circle around a footprint, m."""
    return 0.5 * math.sqrt(length * length + width * width)


def gap(a: Box, b: Box) -> float:
    """Return the distance between two boxes, m; exactly 0 if they touch or overlap."""
    sin_a, cos_a = sincos(a.yaw)
    sin_b, cos_b = sincos(b.yaw)
    dx, dy = b.x - a.x, b.y - a.y
    return box_gap(dx, dy, cos_a, sin_a, a.length, a.width, cos_b, sin_b, b.length, b.width)


@part
def box_gap(
    dx: float,
    dy: float,
    cos_a: float,
    sin_a: float,
    length_a: float,
    width_a: float,
    cos_b: float,
    sin_b: float,
    length_b: float,
    width_b: float,
) -> float:
    """Return the distance between two boxes, m; the kernel form of `gap`.

    Two disjoint convex shapes have a separating axis along one of their edge normals, and their distance
    is that between a corner of one and an edge of the other.

    Args:
        dx: x of the second centre relative to the first, m.
        dy: y of the second centre relative to the first, m.
        cos_a: Cosine of the first box's yaw.
        sin_a: Sine of the first box's yaw.
        length_a: Length of the first box, m.
        width_a: Width of the first box, m.
        cos_b: Cosine of the second box's yaw.
        sin_b: Sine of the second box's yaw.
        length_b: Length of the second box, m.
        width_b: Width of the second box, m.
    """
    half_la, half_wa = 0.5 * length_a, 0.5 * width_a
    half_lb, half_wb = 0.5 * length_b, 0.5 * width_b
    turn_cos = cos_a * cos_b + sin_a * sin_b
    turn_sin = cos_a * sin_b - sin_a * cos_b
    abs_cos, abs_sin = abs(turn_cos), abs(turn_sin)
    u, v = dx * cos_a + dy * sin_a, dy * cos_a - dx * sin_a
    p, q = dx * cos_b + dy * sin_b, dy * cos_b - dx * sin_b
    if (
        abs(u) <= half_la + half_lb * abs_cos + half_wb * abs_sin
        and abs(v) <= half_wa + half_lb * abs_sin + half_wb * abs_cos
        and abs(p) <= half_lb + half_la * abs_cos + half_wa * abs_sin
        and abs(q) <= half_wb + half_la * abs_sin + half_wa * abs_cos
    ):
        return 0.0
    nearest = min(
        _corners_to_box(u, v, turn_cos, turn_sin, half_lb, half_wb, half_la, half_wa),
        _corners_to_box(-p, -q, turn_cos, -turn_sin, half_la, half_wa, half_lb, half_wb),
    )
    return math.sqrt(nearest)


@part
def _corners_to_box(
    u: float,
    v: float,
    cos: float,
    sin: float,
    half_length: float,
    half_width: float,
    half_u: float,
    half_v: float,
) -> float:
    """Return the least squared distance from a box's corners to an axis-aligned box at the origin.

    Args:
        u: First coordinate of the centre of the box with the corners.
        v: Second coordinate of that centre.
        cos: Cosine of its heading.
        sin: Sine of its heading.
        half_length: Half of its length.
        half_width: Half of its width.
        half_u: Half extent of the box at the origin along the first axis.
        half_v: Half extent of the box at the origin along the second axis.
    """
    least = math.inf
    lu, lv = half_length * cos, half_length * sin
    wu, wv = -half_width * sin, half_width * cos
    for cu, cv in (
        (u + lu + wu, v + lv + wv),
        (u + lu - wu, v + lv - wv),
        (u - lu + wu, v - lv + wv),
        (u - lu - wu, v - lv - wv),
    ):
        du = abs(cu) - half_u
        dv = abs(cv) - half_v
        square = (du * du if du > 0.0 else 0.0) + (dv * dv if dv > 0.0 else 0.0)
        if square < least:
            least = square
    return least
