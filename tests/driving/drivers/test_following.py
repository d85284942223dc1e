import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.driving._drivers.following import following_acceleration

SETTINGS = {"headway_s": 1.5, "standing_m": 2.5, "comfortable": 2.0}
SPEEDS = st.floats(0.0, 40.0)


@given(SPEEDS, st.floats(0.1, 40.0), st.floats(0.0, 200.0), st.floats(-20.0, 20.0))
def test_less_room_and_a_faster_approach_never_accelerate_more(speed, desired, gap, closing):
    def acceleration(gap, closing):
        return following_acceleration(speed, desired, gap, closing, **SETTINGS)

    assert acceleration(gap, closing) <= acceleration(gap + 1.0, closing) + 1e-9
    assert acceleration(gap, closing + 1.0) <= acceleration(gap, closing) + 1e-9
    assert math.isfinite(acceleration(gap, closing))
    assert acceleration(0.0, closing) == acceleration(0.1, closing)


@given(st.floats(0.1, 40.0))
def test_on_a_free_road_it_reaches_the_desired_speed_and_stays(desired):
    free = [
        following_acceleration(share * desired, desired, math.inf, 0.0, **SETTINGS)
        for share in (0.0, 0.5, 1.0, 1.5)
    ]
    assert free[0] == 2.0
    assert free[1] > 0.0
    assert free[2] == pytest.approx(0.0)
    assert free[3] < 0.0


def test_it_stands_still_at_the_gap_of_a_standstill():
    assert following_acceleration(0.0, 10.0, 2.5, 0.0, **SETTINGS) == pytest.approx(0.0)
