"""The safe distances of RSS are the published ones, and its driver keeps them."""

from dataclasses import fields, replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.driving._drivers.rss import (
    RSSDriver,
    RSSParameters,
    lateral_distance,
    longitudinal_distance,
    opposing_distance,
)
from oodscen.errors import UsageError
from tests.driving.drivers.courses import DT, LENGTH, collides, cut_in

LIBRARY = RSSParameters(
    response_s=2.0,
    acceleration=3.5,
    least_braking=4.0,
    most_braking=8.0,
    correct_braking=3.0,
    lateral_acceleration=0.2,
    lateral_braking=0.8,
    margin_m=0.1,
)
"""The parameters of the unit tests of intel/ad-rss-lib (`RssTestParameters.hpp`)."""
STOPPING = [(100, 2.0, 3.5, 213.74), (100, 1.0, 3.5, 151.81), (50, 2.0, 2.0, 71.77)]
"""Speed, km/h, response time, s, acceleration, m/s^2, and distance to the stop, m, from its
`RssFormulaTestsCalculateDistanceAfterStatedBrakingPattern`."""
LATERAL = [
    *((0, 0, 1.1), (1, 1, 1.19), (-1, -1, 1.19), (5, 5, 2.9), (-5, -5, 2.9)),
    *((1, 0, 1.84), (-1, 0, 0.45), (5, 0, 5.77), (-5, 0, 0.0)),
]
"""Sideways speeds of the left and right vehicle to the right, km/h, and the safe distance, m, from its
`RssFormulaTestsCalculateSafeLateralDistance`; the paper keeps the margin where the library has 0."""
PREVENTABLE = [(60, 20, 20), (60, 40, 8), (90, 40, 27), (110, 70, 20), (50, 20, 13), (130, 70, 36)]
"""Speeds of ego and cut-in, km/h, and the greatest gap, m, at which `RSS_check_safety` and `RSS_react`
of ec-jrc/JRC-FSM (01b05c2; cut-in at 1.8 m/s) do not prevent the collision."""
speeds = st.floats(0.0, 45.0)
parameters = st.builds(
    RSSParameters,
    **{field.name: st.floats(0.1, 10.0) for field in fields(RSSParameters)},
)


@pytest.mark.parametrize(("kmh", "response", "acceleration", "distance"), STOPPING)
def test_distances_behind_a_standing_vehicle_are_the_published_ones(
    kmh, response, acceleration, distance
):
    given_ = replace(LIBRARY, response_s=response, acceleration=acceleration)
    assert longitudinal_distance(kmh / 3.6, 0.0, given_) == pytest.approx(distance, abs=0.01)


@pytest.mark.parametrize(("left", "right", "distance"), LATERAL)
def test_distances_side_by_side_are_the_published_ones(left, right, distance):
    found = lateral_distance(left / 3.6, right / 3.6, LIBRARY, LIBRARY)
    assert found == pytest.approx(max(distance, LIBRARY.margin_m), abs=0.011)


def test_a_much_faster_leader_needs_no_distance():
    assert longitudinal_distance(10 / 3.6, 100 / 3.6, LIBRARY) == 0.0


@given(speeds, speeds, parameters)
def test_distances_grow_with_the_speed_behind_and_shrink_with_the_one_in_front(rear, front, p):
    here = longitudinal_distance(rear, front, p)
    assert here >= 0.0
    assert longitudinal_distance(rear + 1.0, front, p) >= here
    assert longitudinal_distance(rear, front + 1.0, p) <= here
    assert opposing_distance(rear, front, p) >= longitudinal_distance(front, 0.0, p)


@given(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), parameters, parameters)
def test_side_by_side_left_and_right_are_mirror_images(left, right, one, two):
    here = lateral_distance(left, right, one, two)
    assert here >= 0.5 * (one.margin_m + two.margin_m)
    assert lateral_distance(-right, -left, two, one) == pytest.approx(here)


@pytest.mark.parametrize(("ego", "other", "gap"), PREVENTABLE)
def test_cut_ins_are_prevented_from_the_gap_of_the_published_code(ego, other, gap):
    assert cut_in(RSSDriver(), ego, other, 1.8, gap - 1.5)
    assert not cut_in(RSSDriver(), ego, other, 1.8, gap + 1.5)


@given(st.floats(5.0, 30.0))
def test_the_safe_distance_is_enough_for_a_leader_that_brakes_as_assumed(speed):
    given_ = RSSParameters()
    leader = [longitudinal_distance(speed, speed, given_) + LENGTH, 0.0, speed]

    def brake():
        leader[2] = max(0.0, leader[2] - given_.most_braking * DT)

    assert not collides(RSSDriver(), speed * 3.6, leader, brake, seconds=12.0)


def test_nonsense_is_refused():
    for field in fields(RSSParameters):
        with pytest.raises(UsageError, match=field.name):
            RSSParameters(**{field.name: float("nan")})
    with pytest.raises(UsageError, match="least_braking"):
        RSSParameters(least_braking=0.0)
    with pytest.raises(UsageError, match="response_s"):
        RSSDriver(response=1.0)
