"""Cars stop at what they hit, whatever moves them and in whatever order they spawn, and get away again."""

from itertools import permutations

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from oodscen_carla.server import _world
from oodscen_carla.server._collisions import collide
from oodscen_carla.server._vehicles import MASS_KG

from tests.adapters.oodscen_carla.server.conftest import Served

CAR, HAY = "vehicle.tesla.model3", "static.prop.haybale"
Y = 1.7
GO = [1.0, 0.0, 0.0, False, False, False, 0]


def drive(served: Served, car: int, speed: float) -> None:
    """Give a car full throttle and a speed."""
    served.get("apply_control_to_vehicle", car, GO)
    served.world.actors[car].speed = speed


def start(served: Served, car: int, speed: float, motion: str) -> None:
    """Let a car that faces along x drive at a speed, or give it a velocity once or for good."""
    call = {"target": "set_actor_target_velocity", "constant": "enable_actor_constant_velocity"}
    if motion in call:
        served.get(call[motion], car, [speed, 0.0, 0.0])
    else:
        drive(served, car, speed)


MOTIONS = st.sampled_from(("throttle", "target", "constant"))


def x_of(served: Served, car: int) -> float:
    return served.world.actors[car].place.location[0]


def hits(served: Served) -> set[tuple[int, int]]:
    return {(one.id, other.id) for one, other in served.world.collisions}


def overlapping(served: Served, cars: list[int]) -> set[frozenset[int]]:
    """Return the pairs of cars whose boxes overlap."""
    boxes = {car: served.world.actors[car].box for car in cars}
    return {frozenset((a, b)) for a in cars for b in cars if a < b and boxes[a].overlaps(boxes[b])}


@pytest.mark.parametrize("order", list(permutations(("wall", "lead", "tail"))))
def test_a_queue_that_runs_into_something_stops_whole_in_any_order(served, order):
    places = {"wall": 112.0, "lead": 105.0, "tail": 100.1}
    ids = {name: served.spawn(CAR, places[name], Y) for name in order}
    for name in ("lead", "tail"):
        drive(served, ids[name], 30.0)
    found = set()
    for _ in range(12):
        served.get("tick_cue")
        assert not overlapping(served, [*ids.values()])
        found |= hits(served)
    assert {(ids["lead"], ids["wall"]), (ids["tail"], ids["lead"])} <= found
    assert x_of(served, ids["tail"]) < x_of(served, ids["lead"]) < 108.0


@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    st.permutations(range(5)),
    st.lists(st.tuples(st.sampled_from((-40.0, 0.0, 10.0, 40.0)), MOTIONS), min_size=5, max_size=5),
    st.sampled_from((0.05, 0.3)),
)
def test_no_moving_cars_overlap_that_did_not_before(served, order, starts, dt):
    served.world.load()
    served.world.settings = served.world.settings._replace(fixed_step_s=dt)
    cars = [served.spawn(CAR, 100.0 + 6.0 * place, Y) for place in order]
    for car, (speed, motion) in zip(cars, starts, strict=True):
        start(served, car, speed, motion)
    for _ in range(6):
        served.get("tick_cue")
        assert not overlapping(served, cars)


@pytest.mark.parametrize(("motion", "most"), [("target", 1), ("constant", 50)])
def test_a_car_with_a_velocity_stops_at_what_it_hits_and_a_constant_one_hits_again(
    served, motion, most
):
    car, wall = served.spawn(CAR, 100.0, Y), served.spawn(HAY, 106.0, Y)
    start(served, car, 10.0, motion)
    told = []
    for _ in range(50):
        served.get("tick_cue")
        told += hits(served)
        assert not overlapping(served, [car, wall])
    assert x_of(served, wall) == 106.0
    assert set(told) == {(car, wall)}
    assert 0.8 * most < len(told) <= most
    assert served.world.actors[car].speed == 0.0


def test_a_car_without_physics_keeps_the_speed_that_its_script_tells_wherever_it_is_put(served):
    car = served.spawn(CAR, 100.0, Y)
    served.spawn(CAR, 106.0, Y)
    served.get("set_actor_simulate_physics", car, False)
    for x in (101.0, 102.0, 103.0):
        served.get("set_actor_location", car, [x, Y, 0.0])
        served.get("set_actor_target_velocity", car, [20.0, 0.0, 0.0])
        served.get("tick_cue")
        assert (x_of(served, car), served.world.actors[car].speed) == (x, 20.0)


def test_cars_that_meet_both_stop_and_tell_of_it(served):
    left, right = served.spawn(CAR, 100.0, Y), served.spawn(CAR, 106.0, Y, yaw=180.0)
    for car in (left, right):
        drive(served, car, 30.0)
    served.get("tick_cue")
    assert hits(served) == {(left, right), (right, left)}
    assert [served.world.actors[car].speed for car in (left, right)] == [0.0, 0.0]


def test_a_car_that_stands_in_something_drives_away(served):
    wall, car = served.spawn(CAR, 100.0, Y), served.spawn(CAR, 120.0, Y)
    served.get("set_actor_location", car, [104.5, Y, 0.0])
    assert overlapping(served, [wall, car])
    drive(served, car, 0.0)
    for _ in range(60):
        served.get("tick_cue")
    assert x_of(served, car) > 110.0
    assert not hits(served)


def test_a_car_backs_away_from_what_it_hit(served):
    car = served.spawn(CAR, 100.0, Y)
    served.spawn(HAY, 106.0, Y)
    drive(served, car, 20.0)
    for _ in range(10):
        served.get("tick_cue")
    assert x_of(served, car) < 106.0
    served.get("apply_control_to_vehicle", car, [1.0, 0.0, 0.0, False, True, False, -1])
    for _ in range(40):
        served.get("tick_cue")
    assert x_of(served, car) < 100.0
    assert not hits(served)


def test_a_car_that_is_put_back_is_met_by_what_it_had_left_behind(served):
    """A very fast car is put back by more than the reach of what follows it."""
    lead, wall, tail = (served.spawn(CAR, x, Y) for x in (105.0, 132.0, 100.0))
    drive(served, lead, 500.0)
    drive(served, tail, 100.0)
    served.get("tick_cue")
    assert not overlapping(served, [tail, lead, wall])
    assert (tail, lead) in hits(served)


@pytest.mark.parametrize("dt", [0.05, 0.06, 0.5, 2.0])
@pytest.mark.parametrize("speed", [10.0, 50.0])
def test_a_tick_of_any_length_ends_at_what_is_in_the_way(served, dt, speed):
    served.world.settings = served.world.settings._replace(fixed_step_s=dt)
    car, wall = served.spawn(CAR, 100.0, Y), served.spawn(HAY, 110.0, Y)
    drive(served, car, speed)
    crashes = []
    for _ in range(round(4.0 / dt)):
        served.get("tick_cue")
        crashes += [
            impulse for pair, impulse in served.world.collisions.items() if pair[1].id == wall
        ]
    assert x_of(served, car) < 110.0
    assert crashes[0][0] == pytest.approx(MASS_KG * speed, rel=0.25)


@pytest.mark.parametrize("dt", [0.01, 0.05])
def test_short_ticks_are_not_divided(served, dt, monkeypatch):
    served.world.settings = served.world.settings._replace(fixed_step_s=dt)
    moves = []
    monkeypatch.setattr(_world, "move", lambda actor, surface, step: moves.append(step))
    served.spawn(CAR, 100.0, Y)
    served.get("tick_cue")
    assert moves == [dt]


def test_a_crash_has_the_impulse_before_the_stop(served):
    left, right = served.spawn(CAR, 100.0, Y), served.spawn(CAR, 106.0, Y, yaw=180.0)
    drive(served, left, 30.0)
    drive(served, right, 20.0)
    served.get("tick_cue")
    impulses = {one.id: impulse for (one, _), impulse in served.world.collisions.items()}
    assert impulses[left][0] == pytest.approx(MASS_KG * 50.0, rel=0.01)
    assert impulses[right] == tuple(-value for value in impulses[left])


def test_a_car_that_stood_alone_for_a_tick_has_left_what_it_touched(served):
    wall, car = served.spawn(CAR, 100.0, Y), served.spawn(CAR, 120.0, Y)
    served.get("set_actor_location", car, [104.5, Y, 0.0])
    drive(served, car, 0.0)
    served.get("tick_cue")
    assert served.world.actors[car].touching == {wall}
    served.get("destroy_actor", wall)
    served.get("tick_cue")
    assert served.world.actors[car].touching == set()


def test_both_sides_of_a_contact_with_the_hero_tell_of_it(served):
    hero, other = (served.world.actors[served.spawn(CAR, x, Y)] for x in (100.0, 130.0))
    hero.staged, other.staged = "ego", "lorry"
    assert collide((hero, other), {}, {"lorry"}).keys() == {(hero, other), (other, hero)}
    assert not collide((hero, other), {}, set())
