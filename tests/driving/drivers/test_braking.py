import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.driving._drivers.braking import DECELERATION, RAMP_S, DelayedBrake

DT = 0.05


@given(st.floats(0.0, 2.0), st.floats(0.0, 100.0), st.floats(0.1, 1.5))
def test_it_begins_after_the_delay_rises_and_keeps_to_the_limit(delay_s, begin, friction):
    brake = DelayedBrake(delay_s)
    times = [begin + step * DT for step in range(100)]
    rates = [brake.deceleration(time, demanded=True, friction=friction) for time in times]
    assert rates == sorted(rates)
    assert rates[-1] == pytest.approx(DECELERATION * min(1.0, friction))
    first = next(index for index, rate in enumerate(rates) if rate > 0.0)
    assert delay_s - 1e-6 <= times[first] - begin <= delay_s + 2 * DT + 1e-6
    full = rates.index(rates[-1])
    assert times[full] - times[first] <= RAMP_S + DT


def test_a_risk_that_ends_releases_it_and_the_next_one_waits_again():
    brake = DelayedBrake(0.1)
    for time in (0.0, 0.1, 0.2):
        rate = brake.deceleration(time, demanded=True)
    assert rate > 0.0
    assert brake.is_demanded
    assert brake.deceleration(0.3, demanded=False) == 0.0
    assert not brake.is_demanded
    assert brake.deceleration(0.4, demanded=True) == 0.0
