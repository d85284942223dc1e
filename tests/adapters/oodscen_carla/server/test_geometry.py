import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_carla.server._geometry import OrientedBox, matrix, mounted, rotated, transform_of
from oodscen_carla.server._values import Transform

METRES = st.floats(-20.0, 20.0)
DEGREES = st.one_of(st.floats(-180.0, 180.0), st.sampled_from([-100.0, -90.0, 0.0, 90.0]))
TRANSFORMS = st.builds(Transform, st.tuples(METRES, METRES, METRES), st.tuples(*[DEGREES] * 3))
BOXES = st.builds(
    OrientedBox,
    st.builds(
        Transform, st.tuples(METRES, METRES, METRES), st.tuples(st.just(0.0), DEGREES, st.just(0.0))
    ),
    st.tuples(*[st.floats(0.1, 5.0)] * 3),
)


@pytest.mark.parametrize(
    ("rotation", "forward", "right", "up"),
    [
        ((90.0, 0.0, 0.0), (0, 0, 1), (0, 1, 0), (-1, 0, 0)),
        ((0.0, 90.0, 0.0), (0, 1, 0), (-1, 0, 0), (0, 0, 1)),
        ((0.0, 0.0, 90.0), (1, 0, 0), (0, 0, -1), (0, 1, 0)),
        ((0.0, 90.0, 90.0), (0, 1, 0), (0, 0, -1), (-1, 0, 0)),
        ((90.0, 90.0, 0.0), (0, 0, 1), (-1, 0, 0), (0, -1, 0)),
    ],
)
def test_axes_turn_the_way_of_carla(rotation, forward, right, up):
    """The vectors are those of CARLA's `Transform.get_forward_vector`, `get_right_vector` and `get_up_vector`."""
    axes = matrix(Transform((1.0, 2.0, 3.0), rotation))[:3, :3].T
    assert np.allclose(axes, [forward, right, up])


@given(TRANSFORMS, TRANSFORMS)
def test_a_mount_has_the_attitude_of_the_product_of_matrices(parent: Transform, mount: Transform):
    found = matrix(mounted(parent, mount))
    assert np.allclose(found, matrix(parent) @ matrix(mount), atol=1e-6)


@given(st.sampled_from([-90.0, 90.0]), st.floats(-80.0, 80.0), DEGREES)
def test_a_mount_that_looks_straight_up_or_down_keeps_its_yaw(pitch, lean, yaw):
    parent = Transform((0.0, 0.0, 0.0), (lean, yaw, 0.0))
    mount = Transform((0.0, 0.0, 0.0), (pitch - lean, 0.0, 0.0))
    _, found, roll = mounted(parent, mount).rotation
    assert math.isclose(math.cos(math.radians(found - yaw)), 1.0, abs_tol=1e-9)
    assert roll == 0.0


@given(TRANSFORMS)
def test_a_transform_of_a_matrix_has_that_matrix(place: Transform):
    assert np.allclose(matrix(transform_of(matrix(place))), matrix(place), atol=1e-6)


@given(BOXES, BOXES)
def test_two_boxes_overlap_each_other(one: OrientedBox, two: OrientedBox):
    assert one.overlaps(two) == two.overlaps(one)


@given(BOXES, st.floats(0.0, 1.0), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), BOXES)
def test_a_box_overlaps_those_whose_middle_it_holds(box, up, ahead, aside, other):
    length, width, height = box.extent
    dx, dy, _ = rotated((ahead * length, aside * width, 0.0), box.place.rotation[1])
    x, y, z = box.place.location
    inside = Transform((x + 0.99 * dx, y + 0.99 * dy, z + up * height), other.place.rotation)
    assert box.overlaps(OrientedBox(inside, other.extent))


def test_boxes_apart_do_not_overlap():
    box = OrientedBox(Transform((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)), (2.0, 1.0, 0.5))
    for place, yaw in (
        ((4.1, 0, 0), 0.0),
        ((0, 2.1, 0), 0.0),
        ((0, 0, 1.1), 0.0),
        ((0, 0, -1.1), 0.0),
        ((3.2, 2.2, 0), 45.0),
    ):
        other = Transform((place[0], place[1], place[2]), (0.0, yaw, 0.0))
        assert not box.overlaps(OrientedBox(other, box.extent if yaw == 0.0 else (0.5, 0.5, 0.5)))
