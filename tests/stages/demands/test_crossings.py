"""Demands at crossings: whole with any catalogue, fair to the slowest driver, and as their texts tell them."""

from collections.abc import Collection

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._catalogue import load_catalogue

from oodscen.data._reactions import REACTIONS_S
from oodscen.data._scene import Scene
from oodscen.driving._roads.building import load_corridor
from oodscen.stages._demands.crossings import _FIRM, _HEAD_START_S, _IN_THE_WAY_M, red_light, zebra
from oodscen.stages._demands.setting import CARS, FRONT_M, PEOPLE, NearbyBodies, Setting
from oodscen.testing._scenes import example_scene

CATALOGUE = load_catalogue()
STREETS = ("residential_two_lane", "urban_avenue", "urban_three_lane")
JUNCTION, ROUNDABOUT, HIGHWAY = "urban_junction", "roundabout", "highway"
LACKING = {
    "cars": CARS,
    "people": PEOPLE,
    "lights": ("traffic_light",),
    "stripes": ("zebra_crossing",),
}
"""Assets that a catalogue may lack, by name."""


def setting_on(road, lane=0, *, speed=8.0, decision_m=30.0, gap_m=30.0, lacks: Collection = ()):
    """Return the setting of a decision on a road, for a catalogue that lacks some assets."""
    gone = {asset for name in lacks for asset in LACKING[name]}
    rest = tuple(asset for asset in CATALOGUE.assets if asset.id not in gone)
    catalogue = CATALOGUE.model_copy(update={"assets": rest})
    example = example_scene()
    ego = example.ego.model_copy(update={"speed": speed, "lane": lane})
    scene = Scene.model_validate({**example.model_dump(), "map": road, "ego": ego.model_dump()})
    return Setting(
        scene=scene,
        catalogue=catalogue,
        decision_m=decision_m,
        speed=speed,
        decision_s=decision_m / speed,
        gap_m=gap_m,
        area_m2=2.8,
        look=NearbyBodies.of([(gap_m, 0.0, 2.8)]),
    )


nothing_lacking = st.just(())
any_lacking = st.sets(st.sampled_from(sorted(LACKING)))


@st.composite
def settings_on(draw, roads, lacks=nothing_lacking):
    road = draw(st.sampled_from(roads))
    lanes = len(load_corridor(road, CATALOGUE).ego_lanes)
    return setting_on(
        road,
        draw(st.integers(0, lanes - 1)),
        speed=draw(st.floats(3.0, 14.0)),
        decision_m=draw(st.floats(10.0, 60.0)),
        gap_m=draw(st.floats(8.0, 60.0)),
        lacks=draw(lacks),
    )


generators = st.integers(0, 2**32 - 1).map(np.random.default_rng)


def named(draft, prefix):
    return [actor for actor in draft.actors if actor.id.startswith(prefix)]


@pytest.mark.parametrize("draw", [red_light, zebra])
@given(data=st.data(), rng=generators)
def test_a_demand_names_only_what_the_catalogue_has(draw, data, rng):
    setting = data.draw(settings_on((*STREETS, JUNCTION, ROUNDABOUT), any_lacking))
    draft = draw(setting, rng)
    if draft is None:
        return
    assert {actor.asset for actor in draft.actors} <= setting.assets.keys()
    assert len({actor.id for actor in draft.actors}) == len(draft.actors)
    if "someone crosses" in draft.event:
        assert any(actor.behaviour.name == "cross_road" for actor in draft.actors)
    if "a car waits" in draft.event:
        assert named(draft, "waiting")


@pytest.mark.parametrize("road", STREETS)
@given(rng=generators)
def test_a_street_has_both_demands_and_neither_without_people(road, rng):
    for draw in (red_light, zebra):
        assert draw(setting_on(road), rng) is not None
        assert draw(setting_on(road, lacks=["people"]), rng) is None
        assert draw(setting_on(road, lacks=["stripes"]), rng) is None
    assert red_light(setting_on(road, lacks=["lights"]), rng) is None


@pytest.mark.parametrize("road", STREETS)
@given(rng=generators)
def test_a_red_light_before_a_crossing_needs_no_cars(road, rng):
    draft = red_light(setting_on(road, lacks=["cars"]), rng)
    assert named(draft, "light")
    assert not named(draft, "beside")


@pytest.mark.parametrize(
    ("lacks", "is_there"), [([], True), (["cars"], False), (["lights"], False)]
)
@given(rng=generators)
def test_a_red_light_at_a_junction_needs_lights_and_a_car(lacks, is_there, rng):
    setting = setting_on(JUNCTION, decision_m=10.0, speed=5.0, lacks=lacks)
    assert (red_light(setting, rng) is not None) == is_there


@pytest.mark.parametrize("draw", [red_light, zebra])
def test_a_highway_has_no_crossing(draw):
    assert draw(setting_on(HIGHWAY), np.random.default_rng(0)) is None


@given(settings_on(STREETS), generators)
def test_the_slowest_driver_can_stop_before_the_light(setting, rng):
    draft = red_light(setting, rng)
    (place,) = {one.placement.ahead_m for one in named(draft, "light")}
    needed = REACTIONS_S[-1] * setting.speed + setting.braking_m(_FIRM)
    assert place - setting.decision_m - FRONT_M >= needed


@given(settings_on(STREETS), generators)
def test_a_light_is_red_at_the_decision(setting, rng):
    for light in named(red_light(setting, rng), "light"):
        assert light.behaviour.trigger.kind == "time"
        assert (
            not light.behaviour.trigger.value or light.behaviour.trigger.value < setting.decision_s
        )


@given(settings_on(STREETS), generators)
def test_a_light_is_red_before_anyone_steps_onto_the_crossing(setting, rng):
    draft = red_light(setting, rng)
    (red_since,) = {one.behaviour.trigger.value for one in named(draft, "light")}
    steps = [one.behaviour.trigger.value for one in named(draft, "walker")]
    if red_since:
        assert min(steps) > red_since
        assert not named(draft, "beside"), "nobody waits yet at a light that turns red"


@given(settings_on(STREETS), generators)
def test_cars_beside_the_ego_stand_before_the_line_in_lanes_of_its_way(setting, rng):
    draft = red_light(setting, rng)
    (light, *_) = named(draft, "light")
    for car in named(draft, "beside"):
        place, asset = car.placement, setting.assets[car.asset]
        assert place.lane in setting.same_way_lanes
        assert place.lane
        assert place.ahead_m + 0.5 * asset.length < light.placement.ahead_m


@given(settings_on((JUNCTION,)), generators)
def test_the_car_at_the_junction_leaves_room_to_stop_behind_it(setting, rng):
    draft = red_light(setting, rng)
    if draft is None:
        return
    (car,) = named(draft, "waiting")
    tail = car.placement.ahead_m - 0.5 * setting.assets[car.asset].length
    assert tail - setting.decision_m - FRONT_M > setting.braking_m(_FIRM)
    assert all(tail < one.placement.ahead_m for one in named(draft, "light"))


@given(settings_on(STREETS), generators)
def test_the_first_walker_is_in_the_way_when_the_ego_would_arrive(setting, rng):
    draft = zebra(setting, rng)
    ahead = named(draft, "zebra")[0].placement.ahead_m
    walker = named(draft, "walker-1")[0]
    arrives = setting.decision_s + (ahead - setting.decision_m) / setting.speed
    side = 1.0 if walker.placement.heading_deg > 0.0 else -1.0
    behaviour = walker.behaviour
    walked = behaviour.parameters["speed"] * (arrives - behaviour.trigger.value - _HEAD_START_S)
    rounding = 0.01 + 0.006 * arrives
    assert abs(walker.placement.offset_m + side * walked) < _IN_THE_WAY_M + rounding


@given(settings_on(STREETS), generators)
def test_stripes_lie_side_by_side_across_the_road(setting, rng):
    stripes = [one.placement for one in named(zebra(setting, rng), "zebra")]
    assert len({place.ahead_m for place in stripes}) == 1
    assert len({place.offset_m for place in stripes}) == len(setting.corridor.driving)


def test_the_crossing_of_a_roundabout_is_the_maps():
    drafts = [
        zebra(setting_on(ROUNDABOUT, decision_m=10.0, speed=5.0), np.random.default_rng(seed))
        for seed in range(20)
    ]
    places = [draft.actors[0].placement.ahead_m for draft in drafts]
    assert max(places) - min(places) <= 0.4
    assert not any(named(draft, "zebra") for draft in drafts)


@given(
    settings_on(STREETS),
    st.floats(0.0, 9.0),
    st.floats(-5.0, 5.0),
    st.floats(1.0, 6.0),
    st.floats(0.0, 20.0),
)
def test_a_body_is_no_nearer_than_the_rare_scenes_and_leaves_room_to_brake(
    setting, half_length, spare_m, deceleration, to_speed
):
    gap_m = setting.gap_to(half_length, spare_m, deceleration, to_speed)
    left_m = gap_m - half_length - FRONT_M - setting.braking_m(deceleration, to_speed)
    assert gap_m >= setting.gap_m
    assert left_m > spare_m - 1e-6
    assert gap_m == setting.gap_m or left_m < spare_m + 1e-6
