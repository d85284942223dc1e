import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from oodscen_pybullet._meshes.living.limbs import joint, stride

places = st.tuples(*[st.floats(-1.0, 1.0)] * 3)
bones = st.floats(0.2, 0.6)


@given(places, places, bones, bones)
def test_bones_keep_their_length_and_reach_as_far_as_they_can(
    start: tuple[float, float, float], end: tuple[float, float, float], one: float, two: float
) -> None:
    far = math.dist(start, end)
    assume(far > abs(one - two) + 0.01)
    middle, last = joint(start, end, one, two, (1.0, 0.2, 0.1))
    assert math.dist(start, middle) == pytest.approx(one, abs=1e-3)
    assert math.dist(middle, last) == pytest.approx(two, abs=1e-3)
    if far < 0.99 * (one + two):
        assert math.dist(last, end) < 1e-6


@given(st.floats(-3, 3), st.floats(0.1, 1.0), st.floats(0.05, 0.5), st.floats(0.3, 0.7))
def test_a_foot_on_the_ground_goes_backwards_evenly(
    phase: float, half: float, lift: float, stance: float
) -> None:
    ahead, height = stride(phase, half, lift, stance)
    assert abs(ahead) <= half + 1e-9
    assert 0.0 <= height <= lift + 1e-9
    step = 1e-4
    share = phase - math.floor(phase)
    if share + step < stance:
        assert height == 0.0
        later, _ = stride(phase + step, half, lift, stance)
        assert (ahead - later) / step == pytest.approx(2 * half / stance, rel=1e-3)
