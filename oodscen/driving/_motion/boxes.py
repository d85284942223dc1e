"""Oriented boxes on the ground plane: whether two bodies touch, and how far apart they are."""

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
    """Along the heading, m."""
    width: float
    """Across it, m."""


def radius(length: float, width: float) -> float:
    """Return the radius of the circle around a footprint."""
    return 0.5 * math.sqrt(length * length + width * width)


def gap(a: Box, b: Box) -> float:
    """Return the distance between two boxes, m; 0 exactly when they touch or overlap."""
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
    """Return the distance between two boxes, m; like `gap`, for kernels.

    Two convex shapes that are apart have a separating axis along one of their edges' normals, and
    their distance is attained at a corner of one and an edge of the other.

    Args:
        dx: From the centre of the first to that of the second.
        dy: Likewise.
        cos_a: Of the first one's yaw.
        sin_a: Likewise.
        length_a: Of the first.
        width_a: Likewise.
        cos_b: Of the second one's yaw.
        sin_b: Likewise.
        length_b: Of the second.
        width_b: Likewise.
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
        u: Centre of the box whose corners are meant.
        v: Likewise.
        cos: Of its heading.
        sin: Likewise.
        half_length: Half of its length.
        half_width: Half of its width.
        half_u: Half of the extent of the box at the origin.
        half_v: Likewise.
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
