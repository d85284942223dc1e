"""Polygons seen from above: arrays of their corners, counter-clockwise, m."""

import math

import numpy as np

from oodscen_pybullet._types import Array

_STRAIGHT_M = 0.001
"""Largest distance of a removed corner from the outline that is left, m."""
_LEAST_M2 = 1e-12
"""Least square of a length that divides, m^2."""


def without_straight_corners(outline: Array) -> Array:
    """Return the corners of a polygon, [n, 2], except those within `_STRAIGHT_M` of the outline that is left.

    This is Douglas and Peucker's algorithm, begun at the two corners that are farthest apart.
    """
    count = len(outline)
    ring = np.concatenate([outline, outline])
    gaps = outline[:, None] - outline
    first, second = divmod(int((gaps * gaps).sum(axis=2).argmax()), count)
    corners = {first, second}
    pending = [(first, second), (second, first + count)]
    while pending:
        start, end = pending.pop()
        away = _distances(ring[start + 1 : end], ring[start], ring[end])
        if len(away) and away.max() > _STRAIGHT_M:
            corner = start + 1 + int(away.argmax())
            corners.add(corner % count)
            pending += [(start, corner), (corner, end)]
    return outline[sorted(corners)]


def is_convex(outline: Array) -> bool:
    """Return whether a polygon, [n, 2], turns to the left at every corner, and once round in all."""
    side = outline - np.roll(outline, 1, axis=0)
    onward = np.roll(side, -1, axis=0)
    turns_left = side[:, 0] * onward[:, 1] > side[:, 1] * onward[:, 0]
    # Once a round, a side that leads up follows one that leads down.
    is_up = (side[:, 1] > 0.0) | ((side[:, 1] == 0.0) & (side[:, 0] > 0.0))
    rounds = np.count_nonzero(is_up & ~np.roll(is_up, 1))
    return bool(turns_left.all()) and rounds == 1


def rectangle_around(outline: Array) -> Array:
    """Return the corners, [4, 2], of the smallest rectangle around a polygon that is parallel to one of its sides.

    Around a single point all four are that point.
    """
    best, least_area = np.tile(outline[0], (4, 1)), math.inf
    for dx, dy in (np.roll(outline, -1, axis=0) - outline).tolist():
        length = math.sqrt(dx * dx + dy * dy)
        if not length:
            continue
        cos, sin = dx / length, dy / length
        along = outline[:, 0] * cos + outline[:, 1] * sin
        across = outline[:, 1] * cos - outline[:, 0] * sin
        u0, u1, v0, v1 = along.min(), along.max(), across.min(), across.max()
        if (u1 - u0) * (v1 - v0) < least_area:
            least_area = float((u1 - u0) * (v1 - v0))
            corners = ((u0, v0), (u1, v0), (u1, v1), (u0, v1))
            best = np.array([(u * cos - v * sin, u * sin + v * cos) for u, v in corners])
    return best


def convex_hull(points: Array) -> Array:
    """Return the corners of the convex hull of points, [n, 3], seen from above, counter-clockwise.

    Corners are rounded to millimetres; points that are the same then are one, as high as the last of them.
    """
    heights = {(round(x, 3), round(y, 3)): z for x, y, z in points.tolist()}
    ordered = sorted((x, y, z) for (x, y), z in heights.items())
    if len(ordered) < 2:
        return np.array(ordered).reshape(-1, 3)
    return np.array(_half_hull(ordered) + _half_hull(ordered[::-1]))


def _half_hull(points: list[tuple[float, float, float]]) -> list[tuple[float, float, float]]:
    """Return the corners of the hull's side on the right of ordered points, without the last one."""
    hull: list[tuple[float, float, float]] = []
    for x, y, z in points:
        while len(hull) > 1:
            (ax, ay, _), (bx, by, _) = hull[-2:]
            if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0:
                break
            hull.pop()
        hull.append((x, y, z))
    return hull[:-1]


def _distances(points: Array, start: Array, end: Array) -> Array:
    """Return the distances of points, [n, 2], from the segment between two points."""
    side = end - start
    share = ((points - start) * side).sum(axis=1) / max(float((side * side).sum()), _LEAST_M2)
    nearest = start + np.clip(share, 0.0, 1.0)[:, None] * side
    return np.asarray(np.sqrt(((points - nearest) ** 2).sum(axis=1)))
