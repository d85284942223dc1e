"""Ordinary counterparts: near enough to be seen, never nearer than a driver would follow."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.author._knowledge.base import Recipe
from oodscen.author._knowledge.loading import load_knowledge
from oodscen.author._staging.counterpart_placing import moved_near, placed_counterpart
from oodscen.author._staging.layout import Cast, Layout
from oodscen.author._writing.ordinary_road_user import OrdinaryRoadUser
from oodscen.data._scene import Actor, Behaviour, Placement
from oodscen.prompts._digest import CatalogueDigest
from oodscen.testing._flat import FlatSimulator

CATALOGUE = FlatSimulator().catalogue()
DIGEST = CatalogueDigest.of(CATALOGUE)
SPEEDS = st.floats(6.0, 25.0)
GAPS = st.floats(15.0, 60.0)
TIMES = st.floats(1.0, 6.0)
WALKER = OrdinaryRoadUser(("adult",), False, "a person walks along the pavement")
CAR = OrdinaryRoadUser(("car",), True, "a car drives ahead")


def recipe() -> Recipe:
    return next(hazard.stage for hazard in load_knowledge().hazards if hazard.stage is not None)


def staged(speed: float, lane: int = 0) -> Layout:
    return Layout(
        digest=DIGEST,
        road=DIGEST.maps[0],
        recipe=recipe(),
        rng=np.random.default_rng(0),
        speed=speed,
        slowed=1.0,
        ego_lane=lane,
    )


def actor(name: str, ahead: float, does: str = "stand", lane: int = 0, **values: float) -> Actor:
    return Actor(
        id=name,
        asset="car",
        placement=Placement(ahead_m=ahead, lane=lane),
        behaviour=Behaviour(name=does, parameters=values),
    )


def gap(one: Actor, speed: float, seconds: float) -> float:
    own = one.behaviour.parameters.get("speed", 0.0)
    return one.placement.ahead_m + (own - speed) * seconds


@given(SPEEDS, GAPS, TIMES, st.integers(0, 2))
def test_someone_on_the_pavement_is_in_view_and_no_farther_than_need_be(
    speed: float, away: float, seconds: float, lane: int
) -> None:
    hazard = actor("a", away + speed * seconds)
    one = placed_counterpart(WALKER, staged(speed, lane), hazard, seconds)["a"]
    there = gap(one, speed, seconds)
    aside = 3.5 * lane - one.placement.offset_m
    assert there >= 2.0 * aside
    assert there <= max(away, 2.5 * aside)
    assert one.placement.lane == -lane


@given(SPEEDS, GAPS, TIMES)
def test_a_vehicle_ahead_keeps_its_distance(speed: float, away: float, seconds: float) -> None:
    hazard = actor("a", away + speed * seconds)
    one = placed_counterpart(CAR, staged(speed), hazard, seconds)["a"]
    assert gap(one, speed, seconds) >= 0.9 * speed + 8.0 - 0.01


def test_nobody_stands_in_whom_the_catalogue_lacks() -> None:
    one = OrdinaryRoadUser(("hovercraft",), True, "a hovercraft drives ahead")
    assert not placed_counterpart(one, staged(10.0), actor("a", 50.0), 3.0)


@given(SPEEDS, GAPS, TIMES, st.floats(1.0, 1.5), st.floats(5.0, 120.0))
def test_a_vehicle_that_would_drive_away_is_where_the_hazard_is(
    speed: float, away: float, seconds: float, faster: float, start: float
) -> None:
    hazard = actor("a", away + speed * seconds)
    rows = {
        "a": actor("a", start, "follow_lane", speed=faster * speed),
        "b": actor("b", start + 9.0, "follow_lane", speed=faster * speed),
    }
    found = moved_near(Cast([hazard], rows), staged(speed), hazard, seconds)
    first, second = found["a"], found["b"]
    assert first is not None
    assert second is not None
    assert first.placement.ahead_m <= rows["a"].placement.ahead_m + 0.01
    assert first.placement.ahead_m >= min(start, 0.9 * speed + 8.0) - 0.01
    assert second.placement.ahead_m - first.placement.ahead_m == pytest.approx(9.0, abs=0.02)
    if first != rows["a"]:
        assert gap(first, speed, seconds) >= away - 0.02


@pytest.mark.parametrize(
    "other",
    [
        actor("a", 80.0, "follow_lane", speed=4.0),
        actor("a", 80.0, "follow_lane", lane=1, speed=12.0),
        actor("a", 80.0),
        None,
    ],
)
def test_slower_vehicles_other_lanes_and_standing_things_stay(other: Actor | None) -> None:
    hazard = actor("a", 60.0)
    cast = Cast([hazard], {"a": other})
    assert moved_near(cast, staged(10.0), hazard, 3.0) == cast.unusual


def test_a_vehicle_stays_with_its_trailer() -> None:
    car = actor("a", 80.0, "follow_lane", speed=10.0)
    behaviour = Behaviour(name="towed", other="a")
    trailer = actor("b", 74.0).model_copy(update={"behaviour": behaviour})
    hazard = actor("a", 60.0)
    cast = Cast([hazard, trailer], {"a": car})
    assert moved_near(cast, staged(10.0), hazard, 3.0) == {"a": car}
