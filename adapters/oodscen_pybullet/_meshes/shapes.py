"""Basic geometry of corners, rings and boxes."""

import math
from collections.abc import Sequence
from functools import cache, lru_cache

import numpy as np

from oodscen.numerics._exact import cos, sin
from oodscen_pybullet._types import Array, Heading, Point

ORIGIN: Point = (0.0, 0.0, 0.0)
CIRCLE = tuple(
    (c * p - s * q, s * p + c * q)
    for p, q in ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))
    for c, s in ((1.0, 0.0), (0.9239, 0.3827), (0.7071, 0.7071), (0.3827, 0.9239))
)
"""Sixteen points on the unit circle, counter-clockwise."""
GOLDEN_ANGLE = 2.399963
"""Angle between neighbours of a sunflower's seeds, rad: turns by it spread things evenly."""
LEAST_LENGTH = 1e-9
"""Length up to which a vector has no direction, and by which it is divided at least."""


def rotation(*, roll: float = 0.0, pitch: float = 0.0, yaw: float = 0.0) -> Array:
    """Return the rows of a rotation about x, then y, then z; a positive pitch leans forward, rad."""
    a, b, d, e, f, g = sin(roll), cos(roll), sin(pitch), cos(pitch), sin(yaw), cos(yaw)
    return np.array(
        [
            [g * e, g * d * a - f * b, g * d * b + f * a],
            [f * e, f * d * a + g * b, f * d * b - g * a],
            [-d, e * a, e * b],
        ]
    )


def rotated(points: Array, rows: Array) -> Array:
    """Return rotated points, with the same bits on every machine: no matrix library is used."""
    x, y, z = points[:, 0], points[:, 1], points[:, 2]
    return np.stack([row[0] * x + row[1] * y + row[2] * z for row in rows], axis=1)


def flat_normal(corners: list[list[float]]) -> Point | None:
    """Return a flat polygon's unit normal, or `None` if it has no area."""
    nx = ny = nz = 0.0
    for (x0, y0, z0), (x1, y1, z1) in zip(corners, corners[1:] + corners[:1], strict=True):
        nx += (y0 - y1) * (z0 + z1)
        ny += (z0 - z1) * (x0 + x1)
        nz += (x0 - x1) * (y0 + y1)
    length = math.sqrt(nx * nx + ny * ny + nz * nz)
    return (nx / length, ny / length, nz / length) if length > LEAST_LENGTH else None


def moved(point: Point, scale: float, offset: Point) -> Point:
    """Return a point scaled about the origin, then moved."""
    return (
        point[0] * scale + offset[0],
        point[1] * scale + offset[1],
        point[2] * scale + offset[2],
    )


def placed(point: Point, at: Point, heading: Heading) -> Point:
    """Return a point of what stands at a place and faces along a heading."""
    (x, y, z), (c, s) = point, heading
    return at[0] + c * x - s * y, at[1] + s * x + c * y, at[2] + z


def upright(
    start: tuple[float, float], end: tuple[float, float], low: float, high: float
) -> list[Point]:
    """Return an upright rectangle from its bottom left, as a viewer sees it: `start` is x and y at the left."""
    return [(*start, low), (*end, low), (*end, high), (*start, high)]


def across(x: float, left: float, low: float, high: float) -> list[Point]:
    """Return an upright rectangle across the x axis, from y = `left` to -`left`; it faces -x if `left` is positive."""
    return upright((x, left), (x, -left), low, high)


def rings(
    start: Point, end: Point, radii: tuple[float, float], sides: int, phase: float = 0.0
) -> tuple[Array, Array]:
    """Return points around `start` and around `end`, counter-clockwise about the axis seen from `end`."""
    axis = np.array(end) - np.array(start)
    axis = axis / math.sqrt(float((axis * axis).sum()))
    helper = (0.0, 0.0, 1.0) if abs(axis[2]) < 0.9 else (1.0, 0.0, 0.0)
    along = axis.tolist()
    across = np.array(_cross(helper, along))
    first = across / math.sqrt(float((across * across).sum()))
    second = np.array(_cross(along, first.tolist()))
    stretch = 1.0
    if sides == 4:
        stretch = math.sqrt(2.0)
        phase += math.pi / 4
    circle = _circle(sides, phase)
    around = circle[:, :1] * first + circle[:, 1:] * second
    near, far = (
        np.array(at) + radius * stretch * around
        for at, radius in zip((start, end), radii, strict=True)
    )
    return near, far


@lru_cache(maxsize=256)
def _circle(sides: int, phase: float) -> Array:
    """Return cosines and sines around a circle, [sides, 2]."""
    turns = [2 * math.pi * i / sides + phase for i in range(sides)]
    return np.array([(cos(turn), sin(turn)) for turn in turns])


def _cross(one: Sequence[float], two: Sequence[float]) -> Point:
    """Return the vector product."""
    return (
        one[1] * two[2] - one[2] * two[1],
        one[2] * two[0] - one[0] * two[2],
        one[0] * two[1] - one[1] * two[0],
    )


def unit(way: Point) -> Point:
    """Return a direction scaled to length 1; one of length 0 as it is."""
    largest = max(map(abs, way))
    if largest == 0.0:
        return way
    x, y, z = (part / largest for part in way)  # The squares of tiny parts would be 0.
    length = math.sqrt(x * x + y * y + z * z)
    return x / length, y / length, z / length


def unit_rows(rows: Array, fallback: Array) -> Array:
    """Scale rows to unit length; rows of zero length take the fallback's direction."""
    lengths = np.sqrt((rows * rows).sum(axis=1, keepdims=True))
    rows = np.where(lengths > LEAST_LENGTH, rows, fallback)
    return np.asarray(
        rows / np.maximum(np.sqrt((rows * rows).sum(axis=1, keepdims=True)), LEAST_LENGTH)
    )


@cache
def sphere_grid(around: int, down: int) -> Array:
    """Return the corners of a unit sphere from pole to pole, [down + 1, around, 3], read-only."""
    grid = np.zeros((down + 1, around, 3))
    for i in range(down + 1):
        polar = math.pi * i / down
        for j in range(around):
            turn = 2 * math.pi * j / around
            grid[i, j] = (sin(polar) * cos(turn), sin(polar) * sin(turn), cos(polar))
    grid.setflags(write=False)
    return grid


@cache
def facet_rows(around: int, down: int) -> list[tuple[list[int], list[int]]]:
    """Return the corners of every facet of a sphere's grid: triangles at the poles, quads between.

    Each facet has the rows of its corners and their columns.
    """
    facets = []
    for i in range(down):
        for j in range(around):
            k = (j + 1) % around
            if i == 0:
                facets.append(([0, 1, 1], [j, j, k]))
            elif i == down - 1:
                facets.append(([i, down, i], [j, j, k]))
            else:
                facets.append(([i, i + 1, i + 1, i], [j, j, k, k]))
    return facets
