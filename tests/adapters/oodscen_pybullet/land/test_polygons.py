import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._land.polygons import (
    convex_hull,
    is_convex,
    rectangle_around,
    without_straight_corners,
)

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


def distances(points: np.ndarray, outline: np.ndarray) -> np.ndarray:
    """Return how far points, [n, 2], lie from an outline."""
    start, side = outline[None], (np.roll(outline, -1, axis=0) - outline)[None]
    away = points[:, None] - start
    share = (away * side).sum(axis=2) / np.maximum((side**2).sum(axis=2), 1e-30)
    nearest = np.clip(share, 0.0, 1.0)[:, :, None] * side
    return np.sqrt(((away - nearest) ** 2).sum(axis=2)).min(axis=1)


def is_subset(corners: np.ndarray, outline: np.ndarray) -> bool:
    """Tell whether corners stand in an outline, in the same order."""
    rest = iter(outline.tolist())
    return all(corner in rest for corner in corners.tolist())


def assert_simplified(outline: np.ndarray) -> np.ndarray:
    kept = without_straight_corners(outline)
    assert is_subset(kept, outline)
    assert distances(outline, kept).max() <= 0.001 + 1e-9
    assert np.array_equal(without_straight_corners(kept), kept)
    assert len(kept) == 1 or (kept != np.roll(kept, 1, axis=0)).any(axis=1).all()
    return kept


COORDINATE = st.one_of(st.floats(-5.0, 5.0), st.integers(-2, 2), st.floats(0.0, 0.003))


@given(st.lists(st.tuples(COORDINATE, COORDINATE), min_size=1, max_size=12))
def test_an_outline_without_its_straight_corners_is_the_same_outline(corners):
    assert_simplified(np.array(corners, float))


@pytest.mark.parametrize("position", range(5))
@pytest.mark.parametrize("tip", [(-1, -1), (2, 0), (1e-4, 0), (9, 9)])
def test_an_outline_with_a_spike_has_no_repeated_corner(position, tip):
    square = [(0, 0), (4, 0), (4, 3), (0, 3)]
    base = square[position - 1]
    corners = [*square[:position], base, (base[0] + tip[0], base[1] + tip[1]), base]
    kept = assert_simplified(np.array(corners + square[position:], float))
    around = rectangle_around(kept)
    assert np.isfinite(around).all()
    assert is_convex(around)


@pytest.mark.parametrize("spacing", [0.001, 0.005, 0.02, 0.08])
def test_an_arc_keeps_its_shape(spacing):
    angles = np.arange(0.0, math.pi, spacing)
    arc = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    assert 30 < len(assert_simplified(arc)) < 75


@given(st.integers(0, 8), ANGLES)
def test_corners_on_the_sides_of_a_square_are_none(first, angle):
    corners = [(0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (1.5, 2), (1, 2), (0, 2), (0, 1)]
    kept = assert_simplified(np.roll(turned(corners, angle), first, axis=0))
    square = turned([(0, 0), (2, 0), (2, 2), (0, 2)], angle)
    assert sorted(kept.tolist()) == sorted(square.tolist())


@given(st.integers(1, 5), st.integers(1, 8), ANGLES)
def test_only_a_star_that_goes_round_once_is_convex(rounds, more, angle):
    count = 2 * rounds + more
    angles = [angle + rounds * math.tau * index / count for index in range(count)]
    star = np.array([(3.0 * math.cos(one), math.sin(one)) for one in angles])
    assert is_convex(star) == (rounds == 1)


def test_the_rectangle_around_a_point_is_that_point():
    assert (rectangle_around(np.array([(2.0, 3.0)] * 3)) == (2.0, 3.0)).all()


@given(st.lists(st.tuples(st.integers(-3, 3), st.integers(-3, 3)), min_size=1, max_size=12))
def test_the_hull_of_points_is_convex_and_holds_them(points):
    corners = convex_hull(np.array([(x, y, 0.0) for x, y in points]))
    if len(corners) < 3:
        return
    assert is_convex(corners[:, :2])
    assert {(x, y) for x, y, _ in corners.tolist()} <= set(points)
    for (ax, ay, _), (bx, by, _) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        assert all((bx - ax) * (y - ay) - (by - ay) * (x - ax) >= 0.0 for x, y in points)


def test_points_on_a_line_have_no_hull():
    line = np.array([(float(k), 2.0 * k, 0.0) for k in range(4)])
    assert len(convex_hull(line)) == 2
    assert convex_hull(line[:1]).shape == (1, 3)
    assert convex_hull(line[:0]).shape == (0, 3)
