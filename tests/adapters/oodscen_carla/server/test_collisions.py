"""Driven cars stop at what they hit, whatever the order of spawning, and get away again."""

from itertools import permutations

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.adapters.oodscen_carla.server.conftest import Served

CAR, HAY = "vehicle.tesla.model3", "static.prop.haybale"
Y = 1.7
GO = [1.0, 0.0, 0.0, False, False, False, 0]


def drive(served: Served, car: int, speed: float) -> None:
    """Give a car full throttle and a speed."""
    served.get("apply_control_to_vehicle", car, GO)
    served.world.actors[car].speed = speed


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
    st.lists(st.sampled_from((-40.0, 0.0, 10.0, 40.0)), min_size=5, max_size=5),
    st.sampled_from((0.05, 0.3)),
)
def test_no_driven_cars_overlap_that_did_not_before(served, order, speeds, dt):
    served.world.load()
    served.world.settings = served.world.settings._replace(fixed_step_s=dt)
    cars = [served.spawn(CAR, 100.0 + 6.0 * place, Y) for place in order]
    for car, speed in zip(cars, speeds, strict=True):
        drive(served, car, speed)
    for _ in range(6):
        served.get("tick_cue")
        assert not overlapping(served, cars)


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
    """With long ticks a car is put back by more than the reach of what follows it."""
    served.world.settings = served.world.settings._replace(fixed_step_s=0.5)
    lead, wall, tail = (served.spawn(CAR, x, Y) for x in (105.0, 132.0, 100.0))
    drive(served, lead, 50.0)
    drive(served, tail, 10.0)
    served.get("tick_cue")
    assert not overlapping(served, [tail, lead, wall])
    assert (tail, lead) in hits(served)
