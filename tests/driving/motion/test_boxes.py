import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.driving._motion.boxes import Footprint, gap

place = st.floats(-15, 15)
boxes = st.builds(
    Footprint, place, place, st.floats(-math.pi, math.pi), st.floats(0.2, 12), st.floats(0.2, 4)
)


def corners(box: Footprint) -> list[complex]:
    """Corners of a box, counter-clockwise, as complex numbers."""
    turn = complex(math.cos(box.yaw), math.sin(box.yaw)) * 0.5
    signs = ((1, 1), (-1, 1), (-1, -1), (1, -1))
    return [complex(box.x, box.y) + turn * complex(a * box.length, b * box.width) for a, b in signs]


def sides(box: Footprint) -> list[tuple[complex, complex]]:
    points = corners(box)
    return list(zip(points, points[1:] + points[:1], strict=True))


def turns_left(a: complex, b: complex, c: complex) -> float:
    return ((b - a).conjugate() * (c - a)).imag


def cross(one: tuple[complex, complex], two: tuple[complex, complex]) -> bool:
    (a, b), (c, d) = one, two
    return (
        turns_left(a, b, c) * turns_left(a, b, d) < 0.0
        and turns_left(c, d, a) * turns_left(c, d, b) < 0.0
    )


def to_side(point: complex, side: tuple[complex, complex]) -> float:
    a, b = side
    along = ((b - a).conjugate() * (point - a)).real / abs(b - a) ** 2
    return abs(point - a - min(max(along, 0.0), 1.0) * (b - a))


def brute_force(a: Footprint, b: Footprint) -> float:
    """Distance by every corner and side: no separating axes."""
    for one, two in ((a, b), (b, a)):
        if all(turns_left(*side, corners(two)[0]) >= 0.0 for side in sides(one)):
            return 0.0
    if any(cross(one, two) for one in sides(a) for two in sides(b)):
        return 0.0
    pairs = [(c, s) for one, two in ((a, b), (b, a)) for c in corners(one) for s in sides(two)]
    return min(to_side(corner, side) for corner, side in pairs)


@settings(max_examples=400)
@given(boxes, boxes)
def test_gap_is_the_distance_and_0_exactly_on_overlap(a: Footprint, b: Footprint) -> None:
    expected = brute_force(a, b)
    assert gap(a, b) == pytest.approx(expected, abs=1e-9)
    if expected > 1e-9:
        assert gap(a, b) > 0.0


@given(boxes, boxes)
def test_gap_is_symmetric(a: Footprint, b: Footprint) -> None:
    assert math.isclose(gap(a, b), gap(b, a), abs_tol=1e-9)


@given(boxes, boxes, st.floats(-math.pi, math.pi), place, place)
def test_gap_does_not_change_under_rigid_motion(
    a: Footprint, b: Footprint, turn: float, dx: float, dy: float
) -> None:
    def moved(box: Footprint) -> Footprint:
        z = complex(box.x, box.y) * complex(math.cos(turn), math.sin(turn)) + complex(dx, dy)
        return box._replace(x=z.real, y=z.imag, yaw=box.yaw + turn)

    assert math.isclose(gap(a, b), gap(moved(a), moved(b)), abs_tol=1e-6)


@given(boxes)
def test_a_box_touches_itself_and_what_it_contains(box: Footprint) -> None:
    assert gap(box, box) == 0.0
    assert gap(box, box._replace(length=0.1, width=0.1, yaw=1.0)) == 0.0


@given(boxes, st.floats(0.001, 50))
def test_gap_of_a_shifted_copy_is_the_shift_minus_its_length(box: Footprint, space: float) -> None:
    along = box.length + space
    other = box._replace(x=box.x + along * math.cos(box.yaw), y=box.y + along * math.sin(box.yaw))
    assert math.isclose(gap(box, other), space, abs_tol=1e-6)
