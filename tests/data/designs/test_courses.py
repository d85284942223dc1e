"""Courses: the key poses that a walk, a roll, a drift, a swing and a circle yield."""

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._designs.courses import Circle, Drift, Roll, Swing, Walk

METRES = st.floats(1.0, 50.0)
SPEEDS = st.floats(1.0, 9.0)


@given(METRES, SPEEDS, st.integers(0, 6), st.booleans())
def test_a_walk_takes_the_time_of_its_way_and_its_pauses(distance, speed, pauses, back):
    poses = Walk(distance=distance, speed=speed, pauses=pauses, pause_s=2, back=back).poses()
    assert max(pose.ahead for pose in poses) == pytest.approx(distance)
    assert poses[-1].ahead == pytest.approx(0.0 if back else distance)
    duration = distance / speed * (1 + back) + 2 * (pauses + back)
    assert poses[-1].at == pytest.approx(duration)


@given(METRES, SPEEDS, st.floats(0.5, 5), st.floats(0.3, 2), st.booleans())
def test_a_roll_covers_its_distance_and_turns_over_without_slip(
    distance, speed, acceleration, radius, stops
):
    roll = Roll(
        distance=distance, speed=speed, acceleration=acceleration, radius=radius, stops=stops
    )
    poses = roll.poses()
    assert poses[-1].ahead <= distance + 1e-6
    # A stretch at even speed that is short is left out.
    assert poses[-1].ahead >= distance - 0.3 * speed - 1e-6
    for start, end in pairwise(poses):
        assert end.ahead > start.ahead
        assert (end.ahead - start.ahead) / (end.at - start.at) <= speed + 1e-6
        assert end.pitch == pytest.approx(end.ahead / radius * 180 / math.pi)


@given(SPEEDS, st.floats(1, 30), st.floats(0.5, 10), st.floats(0, 3), st.floats(0, 8))
def test_a_drift_stays_above_the_road(speed, seconds, gust_s, height, rise):
    drift = Drift(speed=speed, seconds=seconds, gust_s=gust_s, height=height, rise=rise)
    poses = drift.poses()
    assert poses[-1].at == pytest.approx(seconds)
    assert all(start.ahead < end.ahead for start, end in pairwise(poses))
    assert all(pose.up >= 0.0 for pose in poses)


@given(st.floats(1, 90), st.floats(0.5, 5), st.integers(1, 10), st.booleans(), st.booleans())
def test_a_swing_goes_to_both_sides_and_ends_upright(angle, period, swings, sideways, fades):
    swing = Swing(
        angle_deg=angle, period_s=period, swings=swings, sideways=sideways, fades=fades, up=1
    )
    poses = swing.poses()
    tilts = [pose.roll if sideways else pose.pitch for pose in poses]
    assert tilts[0] == tilts[-1] == 0.0
    assert tilts[1] == angle
    assert all(after * before < 0 for before, after in pairwise(tilts[1:-1]))
    sizes = [abs(tilt) for tilt in tilts[1:-1]]
    assert all(after < before if fades else after == before for before, after in pairwise(sizes))
    assert poses[-1].at == pytest.approx(period * swings)


@given(st.floats(0.3, 20), SPEEDS, st.booleans())
def test_a_circle_comes_back_round_its_middle(radius, speed, clockwise):
    poses = Circle(radius=radius, speed=speed, clockwise=clockwise).poses()
    side = -radius if clockwise else radius
    for pose in poses:
        assert pose.ahead**2 + (pose.left - side) ** 2 == pytest.approx(radius**2)
    assert poses[-1].ahead == pytest.approx(0.0, abs=1e-9)
    assert poses[-1].at == pytest.approx(2 * math.pi * radius / speed)
    assert poses[1].ahead > 0.0
