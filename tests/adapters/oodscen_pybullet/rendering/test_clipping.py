import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._rendering.clipping import cut

numbers = st.floats(-5.0, 5.0).map(lambda x: round(x, 3))
triangles = st.lists(st.tuples(*[numbers] * 9), min_size=1, max_size=6).map(
    lambda rows: np.array(rows, np.float64).reshape(-1, 3, 3)
)


def area(corners: np.ndarray) -> np.ndarray:
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


@given(triangles, numbers)
def test_a_cut_keeps_the_area_and_parts_the_sides(corners: np.ndarray, level: float) -> None:
    below, above, border = cut(corners, 2, level)
    assert np.isclose(area(below).sum() + area(above).sum(), area(corners).sum(), atol=1e-6)
    assert (below[:, :, 2] <= level + 1e-6).all()
    assert (above[:, :, 2] >= level - 1e-6).all()
    assert np.allclose(border[:, :, 2], level, atol=1e-6)


@given(triangles, numbers)
def test_a_cut_keeps_the_turn(corners: np.ndarray, level: float) -> None:
    some = corners[area(corners) > 1e-3]
    below, above, _ = cut(some, 2, level)
    assert (area(np.concatenate([below, above])) > -1e-6).all()


def test_what_is_below_lies_on_the_left_of_the_border_seen_from_above() -> None:
    corners = np.array([[[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 2.0]]])
    _, _, border = cut(corners, 2, 1.0)
    (x0, y0, _), (x1, y1, _) = border[0]
    below = np.array([0.5, 0.2])
    assert (x1 - x0) * (below[1] - y0) - (y1 - y0) * (below[0] - x0) > 0.0
