import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.driving.boxes import Box, gap

place = st.floats(-15, 15)
boxes = st.builds(
    Box, place, place, st.floats(-math.pi, math.pi), st.floats(0.2, 12), st.floats(0.2, 4)
)


def outline(box: Box, density: int = 60) -> np.ndarray:
    """Points on a box's boundary, by an independent construction."""
    k = np.linspace(-0.5, 0.5, density)
    u = np.concatenate([k, k, np.full(density, 0.5), np.full(density, -0.5)]) * box.length
    v = np.concatenate([np.full(density, 0.5), np.full(density, -0.5), k, k]) * box.width
    rotation = np.exp(1j * box.yaw)
    points = (u + 1j * v) * rotation + (box.x + 1j * box.y)
    return np.stack([points.real, points.imag], axis=1)


def contains(box: Box, points: np.ndarray) -> np.ndarray:
    local = (points[:, 0] + 1j * points[:, 1] - (box.x + 1j * box.y)) * np.exp(-1j * box.yaw)
    return (abs(local.real) <= box.length / 2) & (abs(local.imag) <= box.width / 2)


@given(boxes, boxes)
def test_gap_is_symmetric(a: Box, b: Box) -> None:
    assert math.isclose(gap(a, b), gap(b, a), abs_tol=1e-9)


@settings(max_examples=60)
@given(boxes, boxes)
def test_gap_agrees_with_sampled_outlines(a: Box, b: Box) -> None:
    first, second = outline(a), outline(b)
    distances = np.sqrt(((first[:, None] - second[None]) ** 2).sum(axis=2))
    overlap = contains(a, second).any() or contains(b, first).any()
    measured = gap(a, b)
    assert measured <= distances.min() + 1e-9
    assert distances.min() - measured <= 0.25 or overlap
    if overlap:
        assert measured == 0.0
    elif measured == 0.0:
        assert distances.min() < 0.25


@given(boxes, boxes, st.floats(-math.pi, math.pi), place, place)
def test_gap_does_not_change_under_rigid_motion(
    a: Box, b: Box, turn: float, dx: float, dy: float
) -> None:
    def moved(box: Box) -> Box:
        z = complex(box.x, box.y) * complex(math.cos(turn), math.sin(turn)) + complex(dx, dy)
        return box._replace(x=z.real, y=z.imag, yaw=box.yaw + turn)

    assert math.isclose(gap(a, b), gap(moved(a), moved(b)), abs_tol=1e-6)


@given(boxes)
def test_a_box_touches_itself_and_what_it_contains(box: Box) -> None:
    assert gap(box, box) == 0.0
    assert gap(box, box._replace(length=0.1, width=0.1, yaw=1.0)) == 0.0


@given(boxes, st.floats(0.001, 50))
def test_gap_of_a_shifted_copy_is_the_shift_minus_its_length(box: Box, space: float) -> None:
    along = box.length + space
    other = box._replace(x=box.x + along * math.cos(box.yaw), y=box.y + along * math.sin(box.yaw))
    assert math.isclose(gap(box, other), space, abs_tol=1e-6)
