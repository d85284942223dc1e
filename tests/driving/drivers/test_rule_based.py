import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.driving._drivers.rule_based import RuleBasedDriver
from oodscen.errors import UsageError
from oodscen.protocols import Observation, State
from oodscen.testing._flat import FlatSimulator
from tests.driving.staging import actor, scene

ALONE = Observation(0.0, 10.0, 0.0, 0.0, 0.0, 2.7, None, None, -2.0, 1.0)


def state(*actors, ego_speed=10.0):
    """Return a state with actors at (s, t, heading, speed) beside an ego at the origin."""
    rows = np.array([(0.0, 0.0, 0.0, ego_speed), *actors])
    poses = np.zeros((len(rows), 4))
    poses[:, :2], poses[:, 3] = rows[:, :2], rows[:, 2]
    gaps = np.array([math.inf, *(max(0.0, math.hypot(s, t) - 4.5) for s, t, *_ in actors)])
    ids = ("ego", *(f"actor-{row}" for row in range(1, len(rows))))
    return State(0, 0.0, ids, poses, rows[:, 3], gaps, False, None, rows[:, :2])


def acceleration(*actors, **settings):
    driver = RuleBasedDriver(**settings)
    driver.look(state(*actors))
    return driver.act(ALONE).acceleration


@given(st.floats(5.0, 60.0), st.floats(-2.0, 2.0), st.floats(0.0, 20.0))
def test_a_body_ahead_never_makes_it_faster(s, t, speed):
    assert -8.0 <= acceleration((s, t, 0.0, speed)) <= acceleration() == 0.0


@given(st.floats(-60.0, 0.0), st.floats(-9.0, 9.0))
def test_a_body_behind_or_beside_the_region_ahead_is_ignored(s, t):
    assert acceleration((s, t, 0.0, 20.0)) == 0.0
    assert acceleration((20.0, 2.2 + abs(t), 0.0, 0.0)) == 0.0


def test_it_brakes_hard_for_what_is_close_and_what_steps_into_its_path():
    assert acceleration((15.0, 0.0, 0.0, 0.0)) == -8.0
    walking, standing = (18.0, -3.5, math.pi / 2, 1.5), (18.0, -3.5, math.pi / 2, 0.0)
    assert acceleration(walking) == -8.0
    assert acceleration(standing) == 0.0
    assert acceleration(standing, corridor_m=3.5) == -8.0


@given(st.floats(2.2, 9.0), st.floats(1.0, 30.0), st.sampled_from([-1.0, 1.0]))
def test_it_brakes_hard_for_what_crosses_its_path_within_a_second(aside, speed, side):
    crossing = (15.0, side * aside, -side * math.pi / 2, speed)
    assert acceleration(crossing) == (-8.0 if aside - speed <= 2.1 else 0.0)


def hardest_braking(other, **place):
    driver, least = RuleBasedDriver(), 0.0
    with FlatSimulator() as simulator:
        seen = simulator.reset(scene(other, **place), 0)
        for _ in range(round(12.0 / simulator.dt)):
            driver.look(seen)
            control = driver.act(simulator.observe())
            least = min(least, control.acceleration)
            seen = simulator.step(control)
    return -least


def test_a_bend_turns_no_leader_and_no_oncoming_car_into_an_obstacle():
    leader = actor("a", behaviour="follow_lane", ahead=25.0)
    assert hardest_braking(leader, map="roundabout") < hardest_braking(leader) + 0.3
    oncoming = actor("a", behaviour="follow_lane", ahead=20.0, lane=1, heading=180.0)
    assert hardest_braking(oncoming, map="downhill_bend") < 1.0


def test_what_can_be_driven_over_is_no_obstacle():
    puddle = actor("a", "puddle", ahead=200.0)
    assert hardest_braking(puddle, map="highway", speed=35.0) < 0.1


def test_the_nearest_body_counts():
    far, near = (60.0, 0.0, 0.0, 10.0), (12.0, 0.0, 0.0, 10.0)
    assert acceleration(far, near) == acceleration(near, far) == acceleration(near)


def test_without_places_it_keeps_its_speed():
    blind = state((5.0, 0.0, 0.0, 0.0))
    object.__setattr__(blind, "places", None)
    driver = RuleBasedDriver()
    driver.look(blind)
    assert driver.act(ALONE).acceleration == 0.0


@pytest.mark.parametrize(
    "settings", [{"headway_s": -1.0}, {"comfortable": 0.0}, {"corridor_m": "a"}]
)
def test_settings_out_of_range_are_refused(settings):
    with pytest.raises(UsageError, match=next(iter(settings))):
        RuleBasedDriver(**settings)
