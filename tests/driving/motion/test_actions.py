from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._episode import ACTIONS
from oodscen.driving import KinematicWorld
from oodscen.driving._motion.actions import (
    ASIDE,
    CODES,
    LEFT,
    Cruise,
    SeenRoad,
    action_driver,
    is_available,
    lateral_course,
    plan_action,
)
from oodscen.driving._motion.bodies import GRAVITY
from oodscen.driving._roads.building import load_corridor
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.errors import UnknownComponent
from oodscen.protocols import Driver, Observation
from tests.driving.staging import scene, world

HARDEST = 4.0
"""Lateral acceleration above which drivers do not take a bend, m/s^2."""


def drive(
    map: str, speed: float, lane: int, friction: float, action: str, *, lead_s: float = 0.0
) -> tuple[KinematicWorld, list[Observation]] | None:
    one = world(scene(map=map, speed=speed, lane=lane, friction=friction))
    cruise = Cruise()
    while one.time < lead_s:
        one.step(cruise.act(one.observe()))
    if not is_available(action, one.observe()):
        return None
    driver = action_driver(action)
    told = [one.observe()]
    for step in range(240):
        one.step(driver.act(told[-1]))
        told.append(one.observe())
        where = (map, speed, lane, friction, action, lead_s, one.time)
        assert step % 4 or not one.is_off_road(), where
    return one, told


def test_there_is_a_driver_for_every_action() -> None:
    assert tuple(CODES) == ACTIONS
    assert tuple(CODES.values()) == tuple(range(len(ACTIONS)))
    for action in ACTIONS:
        assert isinstance(action_driver(action), Driver)
        assert action_driver(action) is not action_driver(action)


def test_unknown_actions_name_close_matches() -> None:
    with pytest.raises(UnknownComponent) as caught:
        action_driver("emergency_break")
    assert caught.value.matches[0] == "emergency_brake"


@pytest.mark.parametrize("action", ACTIONS)
@pytest.mark.parametrize("road", SHIPPED_MAPS, ids=lambda road: road.id)
def test_actions_keep_to_the_road_and_to_their_course(road, action: str) -> None:
    is_round = road.id == "roundabout"
    if road.id in ("roundabout", "narrow_passage") and action in ("change_lane_left", "pull_over"):
        pytest.skip("the road beside the lane ends ahead, which actions do not foresee")
    bend = 0.0 if is_round else float(np.abs(load_corridor(road).curvature).max())
    within = 0.6 if is_round else 0.15
    drives = ((8.0, 1.0), (14.0, 1.0)) if is_round else ((8.0, 1.0), (18.0, 0.35), (28.0, 1.0))
    for speed, friction in drives:
        if speed * speed * bend > min(HARDEST, 0.8 * friction * GRAVITY):
            continue
        for lane in range(road.lanes):
            result = drive(road.id, speed, lane, friction, action, lead_s=2.0)
            if result is None:
                continue
            one, told = result
            target = 0.0
            if action in ("change_lane_left", "change_lane_right", "pull_over"):
                plan = plan_action(CODES[action], SeenRoad.at(told[0]))
                target = plan.origin + plan.shift
            offsets = [now.offset_m for now in told]
            assert abs(offsets[-1] - target) < within
            assert max(offsets) < max(0.0, target) + within
            assert min(offsets) > min(0.0, target) - within
            assert abs(told[-1].heading_error) < 0.02 or is_round or one.ego.speed > 0.0


@pytest.mark.parametrize(
    ("action", "final"),
    [
        ("keep_speed", 12.0),
        ("slow_down", 6.0),
        ("stop", 0.0),
        ("emergency_brake", 0.0),
        ("change_lane_left", 12.0),
        ("pull_over", 0.0),
    ],
)
def test_actions_reach_their_speed(action: str, final: float) -> None:
    one, _ = drive("urban_avenue", 12.0, 0, 1.0, action)
    assert abs(one.ego.speed - final) < 0.1


def test_decelerations_are_as_named() -> None:
    for action, expected in (("slow_down", 2.0), ("stop", 3.5), ("emergency_brake", 8.0)):
        _, told = drive("urban_avenue", 14.0, 0, 1.0, action)
        hardest = max(a.speed - b.speed for a, b in pairwise(told)) / 0.05
        assert abs(hardest - expected) < 0.02
    _, told = drive("urban_avenue", 14.0, 0, 0.35, "emergency_brake")
    hardest = max(a.speed - b.speed for a, b in pairwise(told)) / 0.05
    assert 3.2 < hardest <= 0.35 * 9.81


def test_a_lane_change_takes_about_three_seconds() -> None:
    _, told = drive("highway", 25.0, 0, 1.0, "change_lane_left")
    arrival = next(now.time for now in told if now.offset_m > 3.75 - 0.1)
    assert 2.2 < arrival < 3.5


def test_lanes_decide_what_is_available() -> None:
    right = world(scene(lane=0)).observe()
    left = world(scene(lane=1)).observe()
    assert is_available("change_lane_left", right)
    assert not is_available("change_lane_right", right)
    assert is_available("change_lane_left", left)
    assert is_available("change_lane_right", left)
    assert is_available("change_lane_left", world(scene(map="rural_curve")).observe())
    assert not is_available("change_lane_left", world(scene(map="highway", lane=1)).observe())
    with pytest.raises(UnknownComponent):
        is_available("fly", right)


@given(st.floats(0.1, 1.2), st.floats(3.0, 35.0), st.sampled_from([LEFT, ASIDE]))
def test_a_shift_uses_at_most_half_of_the_grip(friction: float, speed: float, goal: int) -> None:
    start = replace(world(scene()).observe(), friction=friction, speed=speed)
    plan = plan_action(goal, SeenRoad.at(start))
    bends = [abs(lateral_course(plan, plan.distance * part / 100.0)[2]) for part in range(101)]
    assert max(bends) * speed * speed <= min(2.5, 0.5 * friction * GRAVITY) * (1.0 + 1e-3)


@pytest.mark.parametrize("speed", [0.5, 1.0, 2.0, 3.0, 4.5, 6.0])
def test_pulling_over_slowly_keeps_the_corners_on_the_road(speed: float) -> None:
    for road in ("residential_two_lane", "highway", "tunnel"):
        result = drive(road, speed, 0, 1.0, "pull_over")
        assert result is not None
        assert result[0].ego.speed == 0.0
