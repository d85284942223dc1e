import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._land.polygons import is_convex, rectangle_around, without_straight_corners

ANGLES = st.floats(0.0, 6.2)


def turned(points, angle: float) -> np.ndarray:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([(x * cos - y * sin + 40.0, x * sin + y * cos - 7.0) for x, y in points])


@given(st.floats(0.5, 20.0), st.floats(0.5, 20.0), ANGLES)
def test_the_rectangle_around_a_rectangle_is_itself(length, width, angle):
    corners = turned([(0, 0), (length, 0), (length, width), (0, width)], angle)
    around = rectangle_around(corners)
    distances = np.sqrt(((corners[:, None] - around[None]) ** 2).sum(axis=2))
    assert (distances.min(axis=1) < 1e-6).all()
    assert is_convex(around)


@given(st.integers(3, 40), ANGLES)
def test_the_rectangle_around_a_polygon_holds_it(count, angle):
    angles = [angle + math.tau * index / count for index in range(count)]
    corners = np.array([(3.0 * math.cos(one), math.sin(one)) for one in angles])
    around = rectangle_around(corners)
    sides = np.roll(around, -1, axis=0) - around
    for (x, y), (dx, dy) in zip(around, sides, strict=True):
        assert (dx * (corners[:, 1] - y) - dy * (corners[:, 0] - x) > -1e-6).all()


@given(ANGLES, st.integers(0, 4))
def test_an_arrow_is_not_convex_and_keeps_its_corners(angle, first):
    arrow = turned([(0, 0), (4, 0), (2, 3), (4, 7), (0, 7)], angle)
    arrow = np.roll(arrow, first, axis=0)
    assert not is_convex(arrow)
    assert (without_straight_corners(arrow) == arrow).all()


@pytest.mark.parametrize("repeats", [1, 2, 3])
def test_repeated_corners_are_one(repeats):
    square = turned([(0, 0), (1, 0), (1, 1), (0, 1)], 0.3)
    found = without_straight_corners(np.repeat(square, repeats, axis=0))
    assert sorted(found.tolist()) == sorted(square.tolist())


def test_an_arc_keeps_its_shape():
    angles = np.linspace(0.0, math.pi, 200)
    arc = np.stack([5.0 * np.cos(angles), 5.0 * np.sin(angles)], axis=1)
    kept = without_straight_corners(arc)
    assert 10 < len(kept) < 200
    x, y = kept.T
    area = abs(float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())) / 2.0
    assert area == pytest.approx(12.5 * math.pi, rel=0.01)
