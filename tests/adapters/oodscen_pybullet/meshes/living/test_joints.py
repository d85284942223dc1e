"""Limbs in poses keep their length and bend by their angle."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._meshes.living.joints import (
    FOREARM,
    SHIN,
    THIGH,
    UPPER_ARM,
    arm_joints,
    leg_joints,
)


def angle(low, high):
    return st.floats(low, high, allow_nan=False)


@given(
    st.tuples(angle(-60, 185), angle(-40, 110), angle(0, 150), angle(-95, 95)),
    st.tuples(angle(-30, 140), angle(-10, 60), angle(0, 155), angle(-40, 85)),
    st.sampled_from([-1.0, 1.0]),
)
def test_limbs_keep_their_length_and_bend_by_their_angle(arm_angles, leg_angles, side):
    for chain, one, two, bend in (
        (arm_joints(arm_angles, side, (0.0, side * 0.2, 1.4)), UPPER_ARM, FOREARM, arm_angles[2]),
        (leg_joints(leg_angles, side, (0.0, side * 0.1, 0.9), 0.0), THIGH, SHIN, leg_angles[2]),
    ):
        assert math.dist(chain.start, chain.middle) == pytest.approx(one)
        assert math.dist(chain.middle, chain.end) == pytest.approx(two)
        reach = math.sqrt(one**2 + two**2 + 2 * one * two * math.cos(math.radians(bend)))
        assert math.dist(chain.start, chain.end) == pytest.approx(reach, abs=1e-6)
        assert math.hypot(*chain.way) == pytest.approx(1.0)


@given(st.tuples(angle(-60, 185), angle(-40, 110), angle(0, 150), angle(-95, 95)))
def test_the_right_arm_is_the_mirror_image_of_the_left(angles):
    left, right = (
        arm_joints(angles, 1.0, (0.0, 0.2, 1.4)),
        arm_joints(angles, -1.0, (0.0, -0.2, 1.4)),
    )
    for one, two in zip(left, right, strict=True):
        assert (one[0], -one[1], one[2]) == pytest.approx(two)
