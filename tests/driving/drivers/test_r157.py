"""The driver of UN Regulation No. 157 perceives, waits and brakes by its numbers."""

import pytest

from oodscen.driving._drivers.braking import DECELERATION, RAMP_S, DelayedBrake
from oodscen.driving._drivers.r157 import CRITICAL_TTC_S, EVALUATION_S, WANDER_M, R157Driver
from tests.driving.drivers.courses import DT, LENGTH, WIDTH, collides, cut_in, observation

PREVENTABLE = [(60, 20, 25), (60, 40, 10), (90, 40, 35), (110, 70, 25), (50, 20, 17)]
"""Speeds of ego and cut-in, km/h, and the greatest gap, m, at which `CC_check_safety_lane_info` and
`CC_react` of ec-jrc/JRC-FSM (01b05c2; 3.5 m lanes, cut-in at 1.8 m/s) do not prevent the collision."""


@pytest.mark.parametrize(("ego", "other", "gap"), PREVENTABLE)
def test_cut_ins_are_prevented_from_the_gap_of_the_published_code(ego, other, gap):
    assert cut_in(R157Driver(), ego, other, 1.8, gap - 1.5)
    assert not cut_in(R157Driver(), ego, other, 1.8, gap + 1.5)


@pytest.mark.parametrize("kmh", [60, 130])
def test_a_leader_that_brakes_fully_is_no_collision_at_two_seconds(kmh):
    """The Regulation's deceleration case: headway 2.0 s, and no collision in the published code either."""
    leader = [2.0 * kmh / 3.6 + LENGTH, 0.0, kmh / 3.6]

    def brake():
        leader[2] = max(0.0, leader[2] - 9.5 * DT)

    assert not collides(R157Driver(), kmh, leader, brake)


def test_it_begins_to_brake_when_perception_evaluation_and_delay_are_over():
    """Table 1 of Annex 4, Appendix 3: 0.375 m, 0.4 s, 0.75 s, and 0.774 g after 0.6 s more."""
    times, speed = [], 20.0

    class Recorded(R157Driver):
        def act(self, seen):
            control = super().act(seen)
            times.append((seen.time, control.acceleration))
            return control

    other = [30.0 + LENGTH, 1.6 + WIDTH, 5.0]
    assert 30.0 / (speed - other[2]) <= CRITICAL_TTC_S

    def move():
        other[1] = max(0.0, other[1] - 1.8 * DT)

    collides(Recorded(), speed * 3.6, other, move, seconds=2.5)
    due = WANDER_M / 1.8 + EVALUATION_S + 0.75
    braked = next(time for time, rate in times if rate < -0.1)
    assert braked == pytest.approx(due, abs=2.5 * DT)
    full = next(time for time, rate in times if rate <= -DECELERATION)
    assert full - braked == pytest.approx(RAMP_S, abs=1.5 * DT)


def test_the_ramp_has_the_published_jerk():
    brake = DelayedBrake()
    rates = [brake.deceleration(step * DT, demanded=True) for step in range(40)]
    begin = round(0.75 / DT)
    assert not any(rates[: begin + 1])
    assert (rates[begin + 2] - rates[begin + 1]) / DT == pytest.approx(12.65, abs=0.01)
    assert rates[-1] == pytest.approx(7.593, abs=0.001)
    assert brake.deceleration(3.0, demanded=True, friction=0.3) == pytest.approx(0.3 * rates[-1])
    assert brake.deceleration(3.05, demanded=False) == 0.0
    assert brake.deceleration(3.1, demanded=True) == 0.0


def test_it_ignores_a_wander_within_the_lane():
    other = [15.0, 3.5, 10.0]
    sign = [-1.0]

    def wander():
        other[1] += sign[0] * 0.5 * DT
        if abs(other[1] - 3.5) >= 0.3:
            sign[0] = -sign[0]

    driver = R157Driver()
    assert not collides(driver, 60.0, other, wander, seconds=3.0)
    assert driver.act(observation(3.0, 16.7)).acceleration > -0.1


def test_without_a_state_it_keeps_the_speed():
    assert R157Driver().act(observation(0.0, 20.0)).acceleration == pytest.approx(0.0)
