"""A faithful scene has no mismatch; each single change that its text forbids has one."""

import pytest
from oodscen_pybullet._catalogue import load_catalogue

from oodscen.claims._checking import check_claims, mismatches
from oodscen.claims._watching import watch
from oodscen.data._claim import Claim
from oodscen.data._scene import Actor, Behaviour, Placement, Scene, Trigger
from oodscen.data._weather import Weather
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE
from oodscen.testing._scenes import example_scene

BOX = "cardboard box"
CLAIMS = (
    Claim(kind="time", value="day"),
    Claim(kind="weather", value="clear"),
    Claim(kind="road", value="residential"),
    Claim(kind="lanes", value="2"),
    Claim(kind="own_lanes", value="1"),
    Claim(kind="traffic", value="none"),
    Claim(kind="thing", value="present", subject=BOX),
    Claim(kind="place", value="in_lane", subject=BOX),
    Claim(kind="place", value="ahead", subject=BOX),
    Claim(kind="distance", value="55", subject=BOX),
    Claim(kind="motion", value="stationary", subject=BOX),
)
SCENE = example_scene()


def changed(**fields):
    return Scene.parse({**SCENE.model_dump(), **fields})


def actor(**fields):
    return changed(actors=[{**SCENE.actors[0].model_dump(), **fields}])


def broken(scene, claims=CLAIMS):
    return [mismatch.claim for mismatch in mismatches(check_claims(claims, scene, FLAT_CATALOGUE))]


def test_a_faithful_scene_has_no_mismatch():
    assert broken(SCENE) == []
    assert {check_claim.status for check_claim in check_claims(CLAIMS, SCENE, FLAT_CATALOGUE)} == {
        "holds"
    }


CAR = Actor(
    id="car",
    asset="car",
    placement=Placement(ahead_m=140.0, lane=1),
    behaviour=Behaviour(name="follow_lane", parameters={"speed": 8.0}),
)


@pytest.mark.parametrize(
    ("scene", "kinds"),
    [
        (changed(weather=Weather(sun_elevation_deg=-20)), {"time"}),
        (changed(weather=Weather(precipitation="rain", precipitation_mm_h=5)), {"weather"}),
        (changed(map="urban_avenue"), {"road", "lanes", "own_lanes"}),
        (actor(placement=Placement(ahead_m=60.0, lane=1)), {"place"}),
        (actor(placement=Placement(ahead_m=60.0, offset_m=-4.0)), {"place"}),
        (actor(asset="sofa"), {"thing", "place", "distance", "motion"}),
        (actor(placement=Placement(ahead_m=30.0)), {"distance"}),
        (
            actor(behaviour=Behaviour(name="walk_along", parameters={"speed": 1.0})),
            {"motion"},
        ),
        (changed(actors=[*SCENE.actors, CAR]), {"traffic"}),
    ],
)
def test_a_change_that_the_text_forbids_is_named(scene, kinds):
    found = broken(scene)
    assert found
    assert {claim.kind for claim in found} <= kinds


def test_what_is_left_open_matches_anything():
    claims = [claim for claim in CLAIMS if claim.kind == "thing"]
    for scene in (SCENE, actor(placement=Placement(ahead_m=60.0, lane=1)), changed(map="bridge")):
        assert broken(scene, claims) == []


def test_two_of_a_name_are_two_actors():
    two = [Claim(kind="thing", value="present", subject=name) for name in ("car", "car 2")]
    one_car = changed(actors=[*SCENE.actors, CAR])
    other = CAR.model_copy(update={"id": "other", "placement": Placement(ahead_m=170.0, lane=1)})
    assert len(broken(one_car, two)) == 1
    assert broken(changed(actors=[*SCENE.actors, CAR, other]), two) == []
    many = [*two[:1], Claim(kind="count", value="2", subject="car")]
    assert [claim.kind for claim in broken(one_car, many)] == ["count"]


def test_motion_is_told_from_what_happens():
    oncoming = Claim(kind="motion", value="oncoming", subject="car")
    side = Claim(kind="motion", value="from_right", subject="dog")
    dog = Actor(
        id="dog",
        asset="dog",
        placement=Placement(ahead_m=60.0, offset_m=-5.0, heading_deg=90.0),
        behaviour=Behaviour(
            name="cross_road",
            trigger=Trigger(kind="ttc", value=4.0),
            parameters={"speed": 2.0, "distance": 8.0},
        ),
    )
    scene = changed(actors=[*SCENE.actors, CAR, dog])
    assert broken(scene, [oncoming, side]) == []
    left = dog.model_copy(
        update={"placement": Placement(ahead_m=60.0, offset_m=8.0, heading_deg=-90.0)}
    )
    assert broken(changed(actors=[*SCENE.actors, CAR, left]), [side]) == [side]
    away = CAR.model_copy(update={"placement": Placement(ahead_m=90.0)})
    assert broken(changed(actors=[*SCENE.actors, away]), [oncoming]) == [oncoming]


def test_watching_is_deterministic_and_goes_beyond_the_decision():
    one, other = watch(SCENE, FLAT_CATALOGUE), watch(SCENE, FLAT_CATALOGUE)
    assert all((one[name] == other[name]).all() for name in ("x", "y", "speed"))
    assert one["s"][-1, 0] > SCENE.actors[0].placement.ahead_m


LANES = [Claim(kind="place", value=name, subject="lorry") for name in ("in_lane", "left_lane")]


@pytest.mark.parametrize(
    ("offset", "heading", "missing"),
    [
        (1.7, 90.0, []),
        (1.0, 90.0, []),
        (0.0, 0.0, ["left_lane"]),
        (3.4, 0.0, ["in_lane"]),
        (0.4, 0.0, ["left_lane"]),
        (3.0, 0.0, ["in_lane"]),
    ],
)
def test_a_thing_across_two_lanes_is_in_both(offset, heading, missing):
    place = Placement(ahead_m=60.0, offset_m=offset, heading_deg=heading)
    lorry = Actor(id="lorry", asset="truck", placement=place)
    scene = changed(
        map="urban_avenue", actors=[lorry], hazard={"actors": {"lorry": None}},
        decision=Trigger(kind="distance", value=25.0, actor="lorry"),
    )  # fmt: skip
    claims = [Claim(kind="thing", value="present", subject="lorry"), *LANES]
    assert [one.value for one in broken(scene, claims)] == missing
    oncoming = [claims[0], Claim(kind="place", value="oncoming_lane", subject="lorry")]
    assert broken(scene, oncoming)


@pytest.mark.parametrize(
    ("asset", "details", "holding", "failing"),
    [
        ("adult", {"pose": "kneel"}, ["kneeling"], ["lying", "waving"]),
        ("adult", {"pose": "wave_on"}, ["waving"], ["sitting", "stopping"]),
        ("adult", {"pose": "lie"}, ["lying"], ["crouching"]),
        ("person_lying", {}, ["lying"], []),
        ("police_officer", {}, ["stopping"], ["kneeling"]),
        ("adult", {"holds": "ladder"}, ["carrying"], ["lying"]),
        ("car", {"parts": ["bonnet_open"]}, ["bonnet_open"], ["doors_open", "dirty"]),
        ("car", {"parts": ["crushed_rear"]}, ["damaged"], ["boot_open"]),
        ("overturned_car", {}, ["damaged"], []),
    ],
)
def test_poses_and_parts_are_claims_about_what_is_seen(asset, details, holding, failing):
    scene = actor(asset=asset, details=details or None)
    subject = "man" if asset in ("adult", "person_lying", "police_officer") else "car"
    told = {**dict.fromkeys(holding, "holds"), **dict.fromkeys(failing, "fails")}
    claims = [Claim(kind="state", value=value, subject=subject) for value in told]
    scene = scene.model_copy(update={"stands_for": {subject: (scene.actors[0].id,)}})
    found = check_claims(claims, scene, load_catalogue())
    assert {one.claim.value: one.status for one in found} == told


def test_who_moves_backwards_is_seen_to():
    walks = {"name": "walk_along", "parameters": {"speed": 1.4}}
    claims = [Claim(kind="motion", value="reversing", subject="man")]
    for details, status in (({"pose": "backwards"}, "holds"), (None, "fails")):
        scene = actor(asset="adult", behaviour=walks, details=details)
        assert check_claims(claims, scene, load_catalogue())[0].status == status
