"""The visible part of a hazard: thing, place and motion, each told once."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oodscen_pybullet._catalogue import load_catalogue

from oodscen.data._scene import Actor, Behaviour, Ego, Hazard, Placement
from oodscen.data._weather import DARK_DEG, Weather
from oodscen.driving._motion.behaviours.table import having
from oodscen.driving._roads.building import read_map
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.protocols import Control
from oodscen.stages._hazard_words import visible_of
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._scenes import example_scene
from tests.mirrors import mirrored_map, swapped


def told_of(catalogue=None, **changes):
    """Return what is told of the example scene after changes."""
    scene = example_scene().model_copy(update=changes)
    return visible_of(scene, catalogue or FlatSimulator().catalogue())


def seen(map=None, ego=None, **changes):
    scene = example_scene()
    (box,) = scene.actors
    place = box.placement.model_copy(update=changes)
    actors = (box.model_copy(update={"placement": place}),)
    return told_of(actors=actors, ego=ego or scene.ego, map=map or scene.map)


def told(catalogue=None, *, asset="car", speed=8.0, state="", details=None, **behaviour):
    """Return what is told of one actor; the members of a placement and of a behaviour are named alike."""
    scene = example_scene()
    place = {name: behaviour.pop(name) for name in ("lane", "heading_deg") if name in behaviour}
    place = {"ahead_m": behaviour.pop("ahead_m", 60.0), **place}
    actor = Actor.parse(
        {
            "id": "box",
            "asset": asset,
            "placement": place,
            "behaviour": behaviour,
            "state": state,
            "details": details,
        }
    )
    ego = scene.ego.model_copy(update={"speed": speed})
    (one,) = told_of(catalogue or load_catalogue(), actors=(actor,), ego=ego)
    return one


@given(
    st.sampled_from(having(lambda row: row.has_side)),
    st.floats(-180.0, 0.0).filter(lambda turn: min(abs(turn % 45.0), 45.0 - turn % 45.0) > 1e-6),
)
def test_a_motion_is_told_as_the_ego_sees_it_in_whichever_lane_it_begins(name, heading_deg):
    catalogue = FlatSimulator().catalogue()
    own = told(catalogue, asset="dog", name=name, heading_deg=heading_deg)
    facing = told(catalogue, asset="dog", name=name, heading_deg=heading_deg + 180.0, lane=1)
    assert own.doing == facing.doing


@pytest.mark.parametrize(
    ("doing", "actor"),
    [
        ("coming towards the ego vehicle", {"name": "follow_lane", "lane": 1}),
        ("coming towards the ego vehicle", {"name": "follow_lane", "heading_deg": 180.0}),
        ("coming towards the ego vehicle", {"name": "wrong_way"}),
        ("driving the same way", {"name": "wrong_way", "lane": 1}),
        ("coming towards the ego vehicle", {"asset": "dog", "name": "bolt", "heading_deg": 180.0}),
        ("running across from the right", {"asset": "dog", "name": "bolt", "heading_deg": 90.0}),
        ("driving slowly ahead", {"name": "follow_lane", "speed": 30.0}),
        ("driving slowly", {"name": "follow_lane", "speed": 30.0, "ahead_m": -30.0}),
        ("driving the same way", {"name": "follow_lane", "speed": 12.0}),
        (
            "moving the other way",
            {"asset": "dog", "name": "bolt", "heading_deg": 180.0, "ahead_m": -30.0},
        ),
        ("moving the same way", {"asset": "dog", "name": "bolt", "ahead_m": -30.0}),
    ],
)
def test_what_a_motion_leaves_out_has_the_meaning_that_it_has_in_the_world(doing, actor):
    assert told(**actor).doing == doing


@pytest.mark.parametrize("name", having(lambda row: "speed" in row.parameters))
def test_what_has_no_speed_stands_still(name):
    assert told(name=name, parameters={"speed": 0.0}, heading_deg=90.0).doing == "standing still"


@pytest.mark.parametrize("asset", [one.id for one in load_catalogue().assets if one.states])
def test_the_usual_state_is_told_alike_whether_it_is_named_or_not(asset):
    usual, *_ = load_catalogue().asset(asset).states
    assert told(asset=asset, state=usual) == told(asset=asset)
    is_light = asset in ("traffic_light", "temporary_light", "pedestrian_light")
    assert (told(asset=asset).doing == "showing red") is is_light


def test_a_signal_that_moves_is_told_as_moving():
    assert told(asset="temporary_light", name="roll_away").doing == "rolling, showing red"
    assert told(asset="temporary_light", state="green").doing == "showing green"


def test_a_behaviour_of_a_simulators_own_is_told_as_the_one_that_it_is_like():
    catalogue = load_catalogue()
    nap = catalogue.behaviour("stand").model_copy(update={"id": "nap", "like": "stand"})
    own = catalogue.model_copy(update={"behaviours": (*catalogue.behaviours, nap)})
    assert told(own, name="nap").doing == "standing still"


def test_a_long_description_ends_with_a_whole_word():
    kept = {"holds": "fallen_tree", "colour": "fluor_orange", "text": "CAUTION WIDE"}
    details = {**kept, "parts": ["bonnet_open", "boot_open"], "cargo": "cardboard_box"}
    what = told(details=details).what
    assert 100 < len(what) <= 120
    assert what.endswith(" …")


@pytest.mark.parametrize(
    ("words", "weather"),
    [
        ("rain", {"precipitation": "rain", "precipitation_mm_h": 1.0}),
        ("heavy rain", {"precipitation": "rain", "precipitation_mm_h": 10.0}),
        ("heavy snow", {"precipitation": "snow", "precipitation_mm_h": 5.0}),
        ("low sun", {"sun_elevation_deg": 4.0}),
        ("twilight", {"sun_elevation_deg": -2.0}),
        ("darkness", {"sun_elevation_deg": -20.0}),
    ],
)
def test_weather_is_told_by_its_strength(words, weather):
    scene = example_scene()
    hazard = scene.hazard.model_copy(update={"weather": Weather()})
    (one,) = told_of(actors=(), hazard=hazard, weather=Weather(**weather))
    assert (one.what, one.where) == (words, "everywhere")


@pytest.mark.parametrize(
    ("ordinary_deg", "sun_deg", "words"), [(DARK_DEG, -20.0, "darkness"), (12.0, 3.0, "low sun")]
)
def test_light_is_told_from_the_last_ordinary_elevation_on(ordinary_deg, sun_deg, words):
    hazard = Hazard(weather=Weather(sun_elevation_deg=ordinary_deg))
    weather = Weather(sun_elevation_deg=sun_deg)
    (one,) = told_of(actors=(), hazard=hazard, weather=weather)
    assert one.what == words


def test_snow_in_place_of_rain_is_told():
    scene = example_scene()
    rain, snow = (Weather(precipitation=form, precipitation_mm_h=2.0) for form in ("rain", "snow"))
    hazard = scene.hazard.model_copy(update={"weather": rain})
    (one,) = told_of(actors=(), hazard=hazard, weather=snow)
    assert one.what == "snow"


def test_places_are_told_as_the_ego_sees_them():
    wheres = {
        "in the ego's lane": {},
        "beside the ego's lane on the right": {"offset_m": -3.0},
        "beside the ego's lane on the left": {"offset_m": 2.0},
        "in the oncoming lane": {"lane": 1},
        "beside the lanes on the left": {"lane": 1, "offset_m": 3.0},
        "behind the ego vehicle": {"ahead_m": -20.0},
    }
    for where, changes in wheres.items():
        (one,) = seen(**changes)
        assert (one.what, one.where) == ("large cardboard box", where)
        assert one.doing == "standing still"


LANE_M = 3.5
"""Width of the lanes of the map with three lanes one way, m."""


@pytest.mark.parametrize(
    ("own", "lane", "offset_m", "where"),
    [
        (1, -1, 1.3, "in a lane to the right"),
        (1, -1, -1.5, "in a lane to the right"),
        (1, -1, -2.4, "beside the lanes on the right"),
        (1, 1, 2.4, "beside the lanes on the left"),
        (1, -1, LANE_M, "in the ego's lane"),
        (1, -1, LANE_M + 1.5, "beside the ego's lane on the left"),
        (1, -1, 2.0, "beside the ego's lane on the right"),
        (0, 2, -LANE_M, "in a lane to the left"),
    ],
)
def test_a_place_is_told_by_what_is_beneath_it_and_not_by_the_lane_it_is_counted_from(
    own, lane, offset_m, where
):
    ego = example_scene().ego.model_copy(update={"lane": own})
    (one,) = seen("urban_three_lane", ego, lane=lane, offset_m=offset_m)
    assert one.where == where


@given(st.integers(0, 2), st.floats(-6.0, 13.0))
def test_a_place_has_the_same_name_from_every_other_lane(own, across_m):
    ego = example_scene().ego.model_copy(update={"lane": own})
    told = {
        seen("urban_three_lane", ego, lane=number - own, offset_m=across_m - LANE_M * number)
        for number in range(3)
        if number != own and abs(across_m - LANE_M * number) > LANE_M / 2
    }
    assert len(told) <= 1


def test_poses_are_told_as_what_somebody_does_and_parts_as_what_is_seen():
    scene, catalogue = example_scene(), load_catalogue()
    told = []
    for asset, details in (
        ("adult", {"pose": "kneel", "holds": "cone"}),
        ("car", {"parts": ["bonnet_open"], "colour": "pink"}),
    ):
        actors = tuple(
            Actor.parse({**actor.model_dump(), "asset": asset, "details": details})
            for actor in scene.actors
        )
        told += told_of(catalogue, actors=actors)
    assert [(one.what, one.doing) for one in told] == [
        (
            "adult on foot, holding an orange traffic cone with white bands",
            "kneeling on the ground",
        ),
        ("passenger car, painted pink, with its bonnet open", "standing still"),
    ]


def test_lanes_of_an_own_map_and_of_left_hand_traffic_are_told_by_their_direction(tmp_path):
    scene = example_scene()
    one_way, avenue = (
        next(road for road in SHIPPED_MAPS if road.id == name)
        for name in ("urban_three_lane", "urban_avenue")
    )
    for road, lanes in (
        (one_way, {1: "in a lane to the left"}),
        (avenue, {1: "in a lane to the left", 2: "in the oncoming lane"}),
    ):
        plain, mirrored = tmp_path / f"{road.id}.xodr", tmp_path / f"{road.id}-mirrored.xodr"
        plain.write_bytes(read_map(road.file))
        mirrored.write_bytes(mirrored_map(read_map(road.file)))
        for lane, where in lanes.items():
            told = [
                seen(
                    map=str(path), ego=scene.ego.model_copy(update={"lane": ego}), lane=side * lane
                )
                for path, ego, side in ((plain, 0, 1), (mirrored, road.lanes - 1, -1))
            ]
            assert [one.where for (one,) in told] == [
                where,
                swapped(where),
            ]


MOVES = st.tuples(
    st.sampled_from(["follow_lane", "wrong_way", "walk_along"]), st.sampled_from([0.0, 180.0])
) | st.tuples(st.sampled_from(["cross_road", "walk_along", "bolt"]), st.sampled_from([-90.0, 90.0]))


@given(move=MOVES, lane=st.sampled_from([0, 1]))
@settings(max_examples=12, deadline=None)
def test_motions_are_told_as_the_ego_sees_them(move, lane):
    (name, heading_deg), scene = move, example_scene()
    (box,) = scene.actors
    actor = box.model_copy(
        update={
            "asset": "car" if name in ("follow_lane", "wrong_way") else "adult",
            "placement": Placement(ahead_m=60.0, lane=lane, heading_deg=heading_deg),
            "behaviour": Behaviour(name=name),
        }
    )
    scene = scene.model_copy(update={"actors": (actor,)})
    with FlatSimulator() as simulator:
        start = simulator.reset(scene, 0).places[1]
        for _ in range(10):
            end = simulator.step(Control()).places[1]
    forward, left = end - start
    if abs(forward) > abs(left):
        right = {"driving the same way", "moving the same way"}
        right = right if forward > 0.0 else {"coming towards the ego vehicle"}
    else:
        side = "right" if left > 0.0 else "left"
        right = {f"{doing} from the {side}" for doing in ("crossing", "running across")}
    (told,) = visible_of(scene, simulator.catalogue())
    assert told.doing in right


@pytest.mark.parametrize(
    ("ahead_m", "parameters", "doing"),
    [
        (40.0, {}, "driving slowly ahead"),
        (40.0, {"speed": 24.0}, "driving the same way"),
        (-40.0, {"speed": 5.0}, "driving slowly"),
        (40.0, {"speed": 0.0}, "standing still"),
    ],
)
def test_a_driver_is_slow_at_the_speed_at_which_it_drives(ahead_m, parameters, doing):
    scene = example_scene()
    (box,) = scene.actors
    driver = box.model_copy(
        update={
            "asset": "car",
            "placement": Placement(ahead_m=ahead_m),
            "behaviour": Behaviour(name="follow_lane", parameters=parameters),
        }
    )
    (told,) = told_of(actors=(driver,), ego=Ego(speed=25.0))
    assert told.doing == doing


@pytest.mark.parametrize(
    ("weather", "told"),
    [
        (Weather(sun_elevation_deg=-8.0), "darkness"),
        (Weather(sun_elevation_deg=-2.0), "twilight"),
        (Weather(sun_elevation_deg=6.0), "low sun"),
        (Weather(sun_elevation_deg=6.0, cloud_cover=1.0), "unusual weather"),
        (Weather(sun_elevation_deg=6.0, fog_visual_range_m=80.0), "fog"),
    ],
)
def test_a_low_sun_is_told_only_where_it_shines(weather, told):
    hazard = Hazard(weather=Weather())
    seen_of_it = told_of(actors=(), hazard=hazard, weather=weather)
    assert [one.what for one in seen_of_it] == [told]


@pytest.mark.parametrize(
    ("description", "what"),
    [("", "cardboard box"), (" ", "cardboard box"), ("A big\nbox", "big box"), ("The box", "box")],
)
def test_descriptions_of_an_own_catalogue_are_told_in_one_line(description, what):
    scene, catalogue = example_scene(), FlatSimulator().catalogue()
    box = catalogue.asset("cardboard_box").model_copy(update={"description": description})
    own = catalogue.model_copy(update={"assets": (box,)})
    (told,) = visible_of(scene, own)
    assert told.what == what
