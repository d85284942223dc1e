import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.protocols import Observation, State

pytest.importorskip("gymnasium")

from oodscen.gymnasium._observing import EGO, NEIGHBOUR, ego_numbers, neighbour_numbers

SCALES = dict(NEIGHBOUR)
COLUMNS = {name: column for column, (name, _) in enumerate(NEIGHBOUR)}
PLACES = st.lists(st.tuples(st.floats(-90, 90), st.floats(-15, 15)), max_size=5, unique=True)


def observation(**fields):
    return Observation(
        **{
            "time": 0.0,
            "speed": 10.0,
            "offset_m": 0.5,
            "heading_error": 0.0,
            "curvature": 0.0,
            "wheelbase": 2.7,
            "lane_left_m": 3.5,
            "lane_right_m": None,
            "roadside_m": -2.0,
            "friction": 1.0,
            "visual_range_m": 100.0,
            "curve_speed": 40.0,
            **fields,
        }
    )


def state(places, yaw=0.0, road=None):
    n = len(places) + 1
    poses = np.zeros((n, 4))
    poses[1:, :2] = np.reshape(places, (-1, 2))
    poses[:, 3] = yaw
    speeds = np.arange(10.0, 10.0 + n)
    gaps = np.array([math.inf, *(max(0.0, math.hypot(*place) - 5.0) for place in places)])
    ids = ("ego", *(f"actor-{row}" for row in range(1, n)))
    return State(0, 0.0, ids, poses, speeds, gaps, False, None, road)


@given(PLACES, st.integers(1, 7), st.floats(0.0, 120.0))
def test_the_nearest_bodies_within_sight_come_first_and_the_rest_is_zero(places, most, sight_m):
    numbers = neighbour_numbers(state(places), observation(visual_range_m=sight_m), most)
    assert numbers.shape == (most, len(NEIGHBOUR))
    assert (np.abs(numbers) <= 1.0).all()
    ranked = sorted(places, key=lambda place: place[0] ** 2 + place[1] ** 2)
    seen = [place for place in ranked if place[0] ** 2 + place[1] ** 2 <= sight_m * sight_m][:most]
    assert numbers[:, COLUMNS["present"]].tolist() == [1.0] * len(seen) + [0.0] * (most - len(seen))
    assert not numbers[len(seen) :].any()
    for row, (ahead, left) in zip(numbers, seen, strict=False):
        assert row[COLUMNS["ahead"]] * SCALES["ahead"] == pytest.approx(ahead, abs=1e-3)
        assert row[COLUMNS["left"]] * SCALES["left"] == pytest.approx(left, abs=1e-3)


@given(st.floats(-3.0, 3.0))
def test_ahead_and_left_turn_with_the_ego_and_speeds_are_relative(yaw):
    place = (20.0 * math.cos(yaw), 20.0 * math.sin(yaw))
    (row,) = neighbour_numbers(state([place], yaw), observation(visual_range_m=100.0), 1)
    told = {name: float(row[column]) * SCALES[name] for name, column in COLUMNS.items()}
    expected = {"present": 1.0, "ahead": 20.0, "left": 0.0, "along": 20.0, "across": 0.0}
    expected |= {"speed_ahead": 1.0, "speed_left": 0.0, "cos_heading": 1.0, "sin_heading": 0.0}
    assert told == pytest.approx({**expected, "gap": 15.0}, abs=1e-3)


def test_along_and_across_are_those_of_the_road_if_the_simulator_knows_it():
    road = np.array([[100.0, -1.0], [130.0, 2.0]])
    (row,) = neighbour_numbers(state([(20, 5)], road=road), observation(visual_range_m=100.0), 1)
    assert row[COLUMNS["along"]] * SCALES["along"] == pytest.approx(30.0, abs=1e-4)
    assert row[COLUMNS["across"]] * SCALES["across"] == pytest.approx(3.0, abs=1e-4)


def test_lanes_are_relative_to_the_ego_and_a_missing_one_is_zero():
    numbers = dict(zip(dict(EGO), ego_numbers(state([]), observation()).tolist(), strict=True))
    assert numbers["speed"] == pytest.approx(0.25)
    assert numbers["lane_left"] == pytest.approx(0.3)
    assert numbers["lane_right"] == 0.0
    assert numbers["roadside"] == pytest.approx(-0.25)
    assert numbers["acceleration"] == 0.0
