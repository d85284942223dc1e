"""Polygons on the ground: arrays of their corners, counter-clockwise, [n, 2] m."""

import math

import numpy as np

from oodscen_pybullet._types import Array

_STRAIGHT_M = 0.001
"""Distance from the line between its neighbours up to which a corner is none, m."""


def without_straight_corners(outline: Array) -> Array:
    """Return the corners of a polygon, [n, 2], except those on the line between their neighbours."""
    corners = outline.tolist()
    index = 0
    while index < len(corners) > 2:
        (ax, ay), (x, y) = corners[index - 1], corners[index]
        bx, by = corners[(index + 1) % len(corners)]
        dx, dy = bx - ax, by - ay
        if abs(dx * (y - ay) - dy * (x - ax)) > _STRAIGHT_M * math.sqrt(dx * dx + dy * dy):
            index += 1
        else:
            del corners[index]
    return np.array(corners)


def is_convex(outline: Array) -> bool:
    """Return whether a counter-clockwise polygon, [n, 2], turns to the left at every corner."""
    side = outline - np.roll(outline, 1, axis=0)
    onward = np.roll(side, -1, axis=0)
    return bool((side[:, 0] * onward[:, 1] > side[:, 1] * onward[:, 0]).all())


def rectangle_around(outline: Array) -> Array:
    """Return the corners, [4, 2], of the smallest rectangle around a polygon that is parallel to one of its sides."""
    found, least = outline, math.inf
    for dx, dy in (np.roll(outline, -1, axis=0) - outline).tolist():
        length = math.sqrt(dx * dx + dy * dy)
        cos, sin = dx / length, dy / length
        along = outline[:, 0] * cos + outline[:, 1] * sin
        across = outline[:, 1] * cos - outline[:, 0] * sin
        u0, u1, v0, v1 = along.min(), along.max(), across.min(), across.max()
        if (u1 - u0) * (v1 - v0) < least:
            least = float((u1 - u0) * (v1 - v0))
            corners = ((u0, v0), (u1, v0), (u1, v1), (u0, v1))
            found = np.array([(u * cos - v * sin, u * sin + v * cos) for u, v in corners])
    return found
