"""Laws of scenes: a valid one has a twin that differs in the declared parts only."""

import json
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.data._scene import Actor, Behaviour, Ego, Hazard, Placement, Scene, Trigger
from oodscen.data._weather import Weather
from oodscen.errors import DataError, SceneError, UsageError
from oodscen.testing._scenes import example_scene

names = st.sampled_from(["truck", "deer", "box", "cone"])
triggers = st.builds(
    Trigger,
    kind=st.sampled_from(["time", "distance", "ttc"]),
    value=st.floats(0, 500),
    actor=st.sampled_from([None, None, None, "truck", "deer"]),
)
weathers = st.one_of(
    st.builds(Weather, sun_elevation_deg=st.floats(-90, 90), friction=st.floats(0.1, 1.5)),
    st.builds(
        Weather,
        precipitation=st.sampled_from(["rain", "snow"]),
        precipitation_mm_h=st.floats(0.1, 100),
    ),
)


def actors(name):
    return st.builds(
        Actor,
        id=st.just(name),
        asset=st.sampled_from(["car", "deer"]),
        placement=st.builds(
            Placement,
            ahead_m=st.floats(-150, 300),
            lane=st.integers(-6, 6),
            offset_m=st.floats(-25, 25),
            heading_deg=st.floats(-180, 180),
        ),
        behaviour=st.builds(
            Behaviour,
            name=st.just("stand"),
            trigger=triggers,
            parameters=st.dictionaries(st.just("speed"), st.floats(0, 40)),
        ),
    )


def decisions(present):
    return st.builds(
        Trigger,
        kind=st.sampled_from(["time", "distance", "ttc"] if present else ["time"]),
        value=st.floats(0, 500),
        actor=st.sampled_from(present) if present else st.none(),
    )


@st.composite
def drafts(draw):
    """Draw the parts of a scene, mostly consistent ones."""
    present = draw(st.lists(names, unique=True, max_size=4))
    unusual = draw(st.lists(st.sampled_from(present), unique=True)) if present else []
    return {
        "id": "fog-001",
        "scenario_id": "fog-001",
        "map": "avenue",
        "ego": draw(st.builds(Ego, speed=st.floats(0, 45), lane=st.integers(0, 6))),
        "weather": draw(weathers),
        "actors": [draw(actors(name)) for name in present],
        "hazard": Hazard(
            actors={name: draw(st.none() | actors(name)) for name in unusual},
            weather=draw(st.none() | weathers),
        ),
        "decision": draw(decisions(present)),
        "horizon_s": draw(st.floats(0.1, 60)),
    }


def scene_of(draft):
    try:
        return Scene.model_validate(draft)
    except ValueError:
        return None


scenes = drafts().map(scene_of).filter(bool)


def example(**changes):
    truck = Actor(id="truck", asset="truck", placement=Placement(ahead_m=60))
    deer = Actor(
        id="deer",
        asset="deer",
        placement=Placement(ahead_m=45, offset_m=-5),
        behaviour=Behaviour(name="bolt", trigger=Trigger(kind="distance", value=30)),
    )
    parts = {
        "id": "deer-001",
        "scenario_id": "deer-001",
        "map": "avenue",
        "ego": Ego(speed=13),
        "actors": (truck, deer),
        "hazard": Hazard(actors={"deer": None}),
        "decision": Trigger(kind="distance", value=25, actor="deer"),
    }
    return {**parts, **changes}


def paths(draft):
    with pytest.raises(DataError) as caught:
        Scene.parse(draft)
    return [issue.path for issue in caught.value.issues]


@settings(max_examples=50)
@given(scenes, st.floats(0, 100))
def test_a_twin_differs_only_in_what_the_hazard_declares(scene, decision_s):
    twin = scene.twin(decision_s)
    assert twin.is_twin
    assert twin.id == f"{scene.id}~twin"
    assert twin.weather == (scene.hazard.weather or scene.weather)
    assert twin.hazard == Hazard()
    assert twin.decision == Trigger(kind="time", value=decision_s)
    for field in ("scenario_id", "map", "ego", "horizon_s", "schema_version"):
        assert getattr(twin, field) == getattr(scene, field)
    wanted = [
        scene.hazard.actors.get(actor.id, actor)
        for actor in scene.actors
        if scene.hazard.actors.get(actor.id, actor) is not None
    ]
    assert list(twin.actors) == wanted
    if scene.decision.kind != "time":
        assert scene.decision.actor in {actor.id for actor in scene.actors}
    for value in (scene, twin):
        assert Scene.parse(value.to_json()) == value


@pytest.mark.parametrize("time", [math.nan, math.inf, -1.0, 1e308, "1"])
def test_a_twin_is_judged_at_a_time(time):
    with pytest.raises(UsageError, match="decision_s"):
        example_scene().twin(time)


def test_the_example_is_valid():
    scene = Scene.parse(example())
    assert [actor.id for actor in scene.twin(2.0).actors] == ["truck"]
    assert not scene.is_twin


def test_every_inconsistency_is_listed_with_its_path():
    truck, deer = example()["actors"]

    def waiting_for(actor, target):
        behaviour = Behaviour(trigger=Trigger(kind="ttc", value=2, actor=target))
        return actor.model_copy(update={"behaviour": behaviour})

    draft = example(
        actors=(
            waiting_for(truck, "deer"),
            waiting_for(deer, "ghost"),
            truck,
            _named(truck, "ego"),
        ),
        hazard=Hazard(
            actors={"deer": None, "ghost": _named(deer, "other"), "ego": waiting_for(truck, "deer")}
        ),
        decision=Trigger(kind="ttc", value=2, actor="nobody"),
    )
    assert sorted(paths(draft)) == [
        "actors[0].behaviour.trigger.actor",
        "actors[1].behaviour.trigger.actor",
        "actors[2].id",
        "actors[3].id",
        "decision.actor",
        "hazard.actors.ego.behaviour.trigger.actor",
        "hazard.actors.ego.id",
        "hazard.actors.ghost",
        "hazard.actors.ghost.id",
    ]


def _named(actor, name):
    return actor.model_copy(update={"id": name})


def test_an_actor_that_is_replaced_may_wait_for_one_that_is_removed():
    truck, deer = example()["actors"]
    waiting = truck.model_copy(update={"behaviour": Behaviour(trigger=Trigger(actor="deer"))})
    assert paths(example(actors=(waiting, deer))) == ["actors[0].behaviour.trigger.actor"]
    scene = Scene.parse(
        example(actors=(waiting, deer), hazard=Hazard(actors={"deer": None, "truck": truck}))
    )
    assert scene.twin(1.0).actors == (truck,)


def test_a_scene_without_a_hazard_is_none():
    assert paths(example(hazard=Hazard())) == ["hazard"]


@pytest.mark.parametrize(
    ("changes", "path"),
    [
        ({"ego": {"speed": -1}}, "ego.speed"),
        ({"ego": {"speed": 3, "gear": 2}}, "ego.gear"),
        ({"weather": {"friction": 0}}, "weather.friction"),
        ({"weather": {"precipitation": "rain"}}, "weather"),
        ({"weather": {"precipitation_mm_h": 3}}, "weather"),
        ({"decision": {"kind": "luck"}}, "decision.kind"),
        ({"actors": [{"id": "a", "asset": "car", "placement": {}}]}, "actors[0].placement.ahead_m"),
        ({"actors": [{"id": "Ä", "asset": "car", "placement": {"ahead_m": 1}}]}, "actors[0].id"),
        ({"id": "../up"}, "id"),
        ({"horizon_s": 0}, "horizon_s"),
        ({"horizon_s": 0.01}, "horizon_s"),
        ({"decision": {"kind": "distance", "value": 25}}, "decision.actor"),
        ({"decision": {"kind": "ttc", "value": 2, "actor": "ego"}}, "decision.actor"),
    ],
)
def test_values_out_of_range_are_named(changes, path):
    assert path in paths(example(**changes))


@pytest.mark.parametrize(
    ("changes", "path"),
    [
        ({"schema_version": True}, "schema_version"),
        ({"horizon_s": "8"}, "horizon_s"),
        ({"horizon_s": True}, "horizon_s"),
        ({"ego": {"speed": "8"}}, "ego.speed"),
        ({"ego": {"speed": 8, "lane": "0"}}, "ego.lane"),
    ],
)
def test_a_number_is_no_text_and_no_truth_value(changes, path):
    plain = {**json.loads(Scene.parse(example()).to_json()), **changes}
    for draft in (plain, json.dumps(plain)):
        assert path in paths(draft)


@given(st.integers(190, 200))
def test_every_scene_that_is_read_has_ordinary_drives(length):
    scene = Scene.parse(example(id="x" * length))
    assert Scene.parse(scene.twin(1.0).to_json()).is_twin


def test_an_id_without_room_for_ordinary_drives_is_refused():
    for length in (201, 205, 300):
        with pytest.raises(DataError, match=r"at most 2[01]0 char"):
            Scene.parse(example(id="x" * length))


@pytest.mark.parametrize("name", ["null", "nan", "na", "none", "undefined"])
def test_an_actor_is_not_named_as_a_missing_value(name):
    with pytest.raises(DataError, match="missing value"):
        Actor(id=name, asset="car", placement=Placement(ahead_m=30.0))


@pytest.mark.parametrize("speed", [math.nan, -500.0])
def test_a_copy_with_values_that_no_scene_can_have_is_neither_written_nor_twinned(speed):
    scene = Scene.parse(example())
    copy = scene.model_copy(update={"ego": scene.ego.model_copy(update={"speed": speed})})
    for use in (copy.to_json, lambda: copy.twin(1.0)):
        with pytest.raises(SceneError, match=r"ego\.speed"):
            use()
