"""Friction triggers act where they lie, and whatever moves has the speed that it moves at, on the ground."""

import math

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

CAR, WALKER, TRIGGER = "vehicle.tesla.model3", "walker.pedestrian.0001", "static.trigger.friction"
PLACE = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
ONE_EXAMPLE_A_WORLD = settings(
    max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


def control(throttle: float = 1.0) -> list:
    return [throttle, 0.0, 0.0, False, False, False, 0]


def speed_at(served, x: float, y: float) -> float:
    """Return the speed that a car with full throttle gains in a tick."""
    car = served.spawn(CAR, x, y)
    served.get("apply_control_to_vehicle", car, control())
    served.get("tick_cue")
    speed = served.world.actors[car].speed
    served.get("destroy_actor", car)
    return speed


@ONE_EXAMPLE_A_WORLD
@given(st.floats(-180.0, 180.0), st.floats(-12.0, 12.0), st.floats(-12.0, 12.0))
def test_a_trigger_acts_within_its_turned_box(served, yaw, ahead, right):
    served.world.load()
    served.spawn(TRIGGER, 100.0, 0.0, yaw, friction=0.0, extent_x=1000, extent_y=200, extent_z=500)
    turn = math.radians(yaw)
    x = 100.0 + ahead * math.cos(turn) - right * math.sin(turn)
    y = ahead * math.sin(turn) + right * math.cos(turn)
    speed = speed_at(served, x, y)
    if abs(ahead) < 9.9 and abs(right) < 1.9:
        assert speed == 0.0
    elif abs(ahead) > 10.1 or abs(right) > 2.1:
        assert speed > 0.0


def test_a_trigger_goes_with_what_it_is_attached_to(served):
    def spawn_attached(parent: int) -> None:
        sizes = [["friction", 4, "0.0"], *([f"extent_{axis}", 4, "300"] for axis in "xyz")]
        served.get("spawn_actor_with_parent", [1, TRIGGER, sizes], PLACE, parent, 0, "")

    car = served.spawn(CAR, 100.0, 1.7)
    spawn_attached(car)
    served.get("apply_control_to_vehicle", car, control())
    for _ in range(3):
        served.get("tick_cue")
    assert served.world.actors[car].speed == 0.0
    assert speed_at(served, 0.0, 0.0) > 0.0


def test_of_several_triggers_the_first_counts(served):
    for friction in (0.0, 1.0):
        served.spawn(TRIGGER, friction=friction, extent_x=1e3, extent_y=1e3, extent_z=1e3)
    assert speed_at(served, 0.0, 0.0) == 0.0


def test_a_constant_velocity_is_the_speed_and_lasts_beyond_its_end(served):
    car = served.spawn(CAR, 50.0, 1.7, yaw=30.0)
    actor = served.world.actors[car]
    served.get("enable_actor_constant_velocity", car, [20.0, 0.0, 0.0])
    for _ in range(5):
        served.get("tick_cue")
    assert actor.speed == 20.0
    assert math.hypot(*actor.velocity) == pytest.approx(20.0)
    served.get("disable_actor_constant_velocity", car)
    served.get("apply_control_to_vehicle", car, control(0.3))
    served.get("tick_cue")
    assert actor.speed == pytest.approx(20.0, abs=0.5)
    assert math.hypot(*actor.acceleration) < 5.0


def test_at_constant_velocity_nothing_accelerates_or_turns(served):
    car = served.spawn(CAR, 50.0, 1.7)
    actor = served.world.actors[car]
    served.get("apply_control_to_vehicle", car, [1.0, 0.5, 0.0, False, False, False, 0])
    for _ in range(10):
        served.get("tick_cue")
    assert any(actor.acceleration)
    assert actor.angular[2]
    served.get("enable_actor_constant_velocity", car, [5.0, 0.0, 0.0])
    served.get("tick_cue")
    assert actor.acceleration == actor.angular == (0.0, 0.0, 0.0)


def test_a_target_angular_velocity_turns(served):
    car = served.spawn(CAR, 50.0, 1.7, yaw=170.0)
    served.get("set_actor_target_angular_velocity", car, [0.0, 0.0, 30.0])
    for _ in range(20):
        served.get("tick_cue")
    expected = 170.0 + 30.0 * 20 * served.world.step - 360.0
    assert served.world.actors[car].place.rotation[1] == pytest.approx(expected)


@pytest.mark.parametrize("call", ["enable_actor_constant_velocity", "set_actor_target_velocity"])
@pytest.mark.parametrize("blueprint", [CAR, WALKER])
def test_a_given_velocity_follows_the_ground(served, blueprint, call):
    served.world.load("rural_hill")
    samples = served.world.map.samples
    x, y, z, heading, slope = samples[abs(samples[:, 4]).argmax()].tolist()
    assert abs(slope) > 0.05
    place = [[x, -y, z], [0.0, -math.degrees(heading), 0.0]]
    body = served.get("spawn_actor", [1, blueprint, []], place)[0]
    served.get(call, body, [20.0, 0.0, 0.0])
    for _ in range(20):
        served.get("tick_cue")
    actor = served.world.actors[body]
    x, y, z = actor.place.location
    ground, heading, slope = served.world.map.ground(x, -y)
    assert z == pytest.approx(ground)
    assert bool(actor.place.rotation[0]) == (blueprint == CAR)


@ONE_EXAMPLE_A_WORLD
@given(
    st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), st.floats(-3.0, 3.0)),
    st.floats(-5.0, 5.0),
    st.floats(-180.0, 180.0),
)
def test_a_walkers_speed_is_that_of_its_way_along_its_heading(served, direction, speed, yaw):
    served.world.load()
    walker = served.spawn(WALKER, 50.0, 1.7, yaw=yaw)
    served.get("apply_control_to_walker", walker, [list(direction), speed, False])
    served.get("tick_cue")
    actor = served.world.actors[walker]
    x, y, _ = actor.place.location
    turn = math.radians(actor.place.rotation[1])
    along = (x - 50.0) * math.cos(turn) + (y - 1.7) * math.sin(turn)
    assert actor.speed == pytest.approx(along / served.world.step, abs=1e-6)
    assert actor.velocity[2] == 0.0


@pytest.mark.parametrize("blueprint", [CAR, WALKER])
def test_nothing_leaves_the_world_and_its_place_can_be_sent_back(served, blueprint):
    body = served.spawn(blueprint, 999_999.0, 1.7)
    served.get("set_actor_target_velocity", body, [1e6, 0.0, 0.0])
    if blueprint == CAR:
        served.get("apply_control_to_vehicle", body, control())
    for _ in range(3):
        served.get("tick_cue")
    location = served.world.actors[body].place.location
    assert location[0] == 1e6
    served.get("set_actor_location", body, list(location))
