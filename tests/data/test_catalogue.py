"""A catalogue finds everything in a scene that it does not offer."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._catalogue import (
    FLAT_M,
    Asset,
    BehaviourKind,
    BehaviourParameter,
    Catalogue,
    RoadMap,
    WeatherRange,
)
from oodscen.data._scene import Actor, Behaviour, Ego, Hazard, Placement, Scene, Trigger
from oodscen.data._weather import Weather


def asset(name, category, states=()):
    return Asset(
        id=name,
        category=category,
        description=name,
        length=4,
        width=2,
        height=1.5,
        states=states,
    )


CATALOGUE = Catalogue(
    simulator="paper",
    version="1",
    ego=asset("ego_car", "vehicle"),
    assets=(asset("car", "vehicle", ("off", "hazard")), asset("deer", "animal")),
    behaviours=(
        BehaviourKind(id="stand", description="stands", categories=("vehicle", "animal")),
        BehaviourKind(
            id="bolt",
            description="runs",
            categories=("animal",),
            parameters={"speed": BehaviourParameter(minimum=1, maximum=15, default=8)},
        ),
    ),
    maps=(
        RoadMap(
            id="avenue",
            description="an avenue",
            file="a.xodr",
            lanes=2,
            speed_limit=13.9,
            length_m=500,
        ),
    ),
    weather=WeatherRange(
        min_sun_elevation_deg=-30,
        min_fog_visual_range_m=30,
        precipitation=("none", "rain"),
        max_precipitation_mm_h=20,
        min_friction=0.5,
    ),
)

DEER = Actor(
    id="deer",
    asset="deer",
    placement=Placement(ahead_m=40),
    behaviour=Behaviour(name="bolt", parameters={"speed": 9}),
)


def scene(**changes):
    parts = {
        "id": "deer-001",
        "scenario_id": "deer-001",
        "map": "avenue",
        "ego": Ego(speed=10),
        "actors": (DEER,),
        "hazard": Hazard(actors={"deer": None}),
        "decision": Trigger(kind="distance", value=20, actor="deer"),
    }
    return Scene(**{**parts, **changes})


def actor(**changes):
    return scene(actors=(DEER.model_copy(update=changes),))


def behaving(name="bolt", **parameters):
    return actor(behaviour=Behaviour(name=name, parameters=parameters))


def test_what_is_offered_passes():
    assert CATALOGUE.lacks(scene()) == []
    assert CATALOGUE.lacks(scene(map="own/road.xodr")) == []
    car = DEER.model_copy(update={"asset": "car", "state": "hazard", "behaviour": Behaviour()})
    assert CATALOGUE.lacks(scene(actors=(car,))) == []


@pytest.mark.parametrize(
    ("wrong", "path", "hint"),
    [
        (scene(map="avenu"), "map", "avenue"),
        (actor(asset="dear"), "actors[0].asset", "deer"),
        (actor(asset="zzz"), "actors[0].asset", "car"),
        (actor(state="on"), "actors[0].state", "none"),
        (behaving("bold"), "actors[0].behaviour.name", "bolt"),
        (behaving(sped=3), "actors[0].behaviour.parameters.sped", "speed"),
        (behaving(speed=99), "actors[0].behaviour.parameters.speed", "15"),
        (behaving("stand", speed=1), "actors[0].behaviour.parameters.speed", "none"),
        (actor(asset="car"), "actors[0].behaviour.name", "animal"),
        (scene(weather=Weather(sun_elevation_deg=-40)), "weather.sun_elevation_deg", "-30"),
        (scene(weather=Weather(fog_visual_range_m=20)), "weather.fog_visual_range_m", "30"),
        (scene(weather=Weather(friction=0.2)), "weather.friction", "0.5"),
        (
            scene(weather=Weather(precipitation="snow", precipitation_mm_h=1)),
            "weather.precipitation",
            "rain",
        ),
        (
            scene(weather=Weather(precipitation="rain", precipitation_mm_h=50)),
            "weather.precipitation_mm_h",
            "20",
        ),
    ],
)
def test_what_is_not_offered_is_named_with_a_way_out(wrong, path, hint):
    (issue,) = CATALOGUE.lacks(wrong)
    assert issue.path == path
    assert hint in issue.message


def test_all_faults_come_at_once():
    bad = DEER.model_copy(
        update={
            "asset": "dear",
            "state": "on",
            "behaviour": Behaviour(name="bolt", parameters={"speed": 99, "sped": 1}),
        }
    )
    ordinary = DEER.model_copy(update={"asset": "car", "state": "of"})
    wrong = scene(
        map="nowhere",
        actors=(bad,),
        weather=Weather(friction=0.1),
        hazard=Hazard(actors={"deer": ordinary}, weather=Weather(fog_visual_range_m=1)),
    )
    assert [issue.path for issue in CATALOGUE.lacks(wrong)] == [
        "map",
        "weather.friction",
        "hazard.weather.fog_visual_range_m",
        "actors[0].asset",
        "actors[0].behaviour.parameters.sped",
        "actors[0].behaviour.parameters.speed",
        "hazard.actors.deer.behaviour.name",
        "hazard.actors.deer.state",
    ]


@given(st.sampled_from(["asset", "behaviour", "map"]), st.text(max_size=6))
def test_looking_up_finds_what_is_there(kind, name):
    known = {"asset": ["car", "deer"], "behaviour": ["stand", "bolt"], "map": ["avenue"]}[kind]
    look_up = getattr(CATALOGUE, kind)
    assert [look_up(item).id for item in known] == known
    if name not in known:
        with pytest.raises(KeyError):
            look_up(name)


def belonging(*pairs):
    """Return the catalogue with trailers, and a scene of who is towed by whom."""
    towed = BehaviourKind(
        id="towed", description="follows", categories=("vehicle",), needs_other=True
    )
    catalogue = CATALOGUE.model_copy(update={"behaviours": (*CATALOGUE.behaviours, towed)})
    actors = tuple(
        Actor(
            id=name,
            asset="car",
            placement=Placement(ahead_m=20.0 + 10.0 * index),
            behaviour=Behaviour(name=behaviour, other=other),
        )
        for index, (name, behaviour, other) in enumerate(pairs)
    )
    staged = Scene(
        id="s",
        scenario_id="s",
        map="avenue",
        ego=Ego(speed=5),
        actors=actors,
        hazard=Hazard(weather=Weather()),
        decision=Trigger(),
    )
    return [issue.path for issue in catalogue.lacks(staged)]


def test_whoever_is_towed_needs_somebody_and_not_itself():
    assert belonging(("car", "stand", None), ("trailer", "towed", "car")) == []
    assert belonging(("trailer", "towed", None)) == ["actors[0].behaviour.other"]
    assert belonging(("a", "towed", "b"), ("b", "towed", "a")) == [
        "actors[0].behaviour.other",
        "actors[1].behaviour.other",
    ]


@given(st.floats(0.01, 0.2), st.sampled_from(["", "shut", "open"]), st.booleans())
def test_what_lies_flat_or_stands_open_can_be_passed(height, state, opens_first):
    states = ("open", "shut") if opens_first else ("shut", "open")
    gate = Asset(
        id="gate", category="object", description="a gate", length=1.0, width=1.0, height=height,
        states=states, passable=("open",),
    )  # fmt: skip
    assert gate.is_passable(state) == (height < FLAT_M or (state or states[0]) == "open")


def test_no_scene_is_about_a_sun_that_is_not_drawn() -> None:
    low = Weather(sun_elevation_deg=10.0)
    scene = Scene(
        id="s",
        scenario_id="s",
        map=CATALOGUE.maps[0].id,
        ego=Ego(speed=5.0),
        weather=low,
        hazard=Hazard(weather=Weather()),
        decision=Trigger(value=1.0),
    )
    path = "hazard.weather.sun_elevation_deg"
    for is_drawn in (True, False):
        sun = CATALOGUE.weather.model_copy(update={"sun_is_drawn": is_drawn})
        issues = CATALOGUE.model_copy(update={"weather": sun}).lacks(scene)
        assert (path in [issue.path for issue in issues]) is not is_drawn
