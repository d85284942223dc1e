"""Details of actors: what is empty leaves no trace, and what an asset cannot show is refused."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._catalogue import Asset, BehaviourKind, Catalogue, WeatherRange
from oodscen.data._detail_checks import check_details, unknown_words
from oodscen.data._details import (
    AssetDetails,
    Bed,
    DetailKinds,
    Details,
    Grip,
    PartKind,
    PoseKind,
    held_place,
)
from oodscen.data._scene import Actor, Behaviour, Ego, Hazard, Placement, Scene, Trigger
from oodscen.errors import DataError
from tests.made import WALL

SIZES = {"wave": (0.4, 1.8, 2.0), "carry": (0.5, 0.6, 1.8), "lie": (1.8, 1.2, 0.4)}


def asset(name, category, size, offers=None):
    return Asset(
        id=name, category=category, description=f"a {name}", length=size[0], width=size[1],
        height=size[2], states=("off", "brake") if category == "vehicle" else (), offers=offers,
    )  # fmt: skip


CATALOGUE = Catalogue(
    simulator="paper",
    version="1",
    ego=asset("ego_car", "vehicle", (4.5, 1.8, 1.5)),
    assets=(
        asset("adult", "pedestrian", (0.4, 0.7, 1.8), AssetDetails(poses=SIZES)),
        asset("deer", "animal", (2, 0.7, 2)),
        asset(
            "car",
            "vehicle",
            (4.5, 1.9, 1.5),
            AssetDetails(
                parts={"doors_open": (4.5, 4.0, 1.5), "bonnet_open": (4.5, 1.9, 1.8)},
                is_painted=True,
                bed=Bed(at=(-0.5, 1.5), length=3.3, width=1.7),
                has_text=True,
            ),
        ),
        asset("crate", "object", (1.0, 0.8, 0.9)),
        asset("shed", "object", (4.0, 3.0, 2.5)),
    ),
    behaviours=(
        BehaviourKind(id="stand", description="", categories=("vehicle", "pedestrian", "object")),
        BehaviourKind(id="walk_along", description="", categories=("pedestrian", "vehicle")),
    ),
    maps=(),
    weather=WeatherRange(),
    details=DetailKinds(
        poses=(
            PoseKind(id="wave", doing="waving", tags=("waving",)),
            PoseKind(id="carry", doing="carrying", grip=Grip(how="before", at=(0.2, 0, 1.1))),
            PoseKind(id="lie", doing="lying", tags=("lying",), is_still=True),
        ),
        parts=(
            PartKind(id="bonnet_open", seen="with its bonnet open", tags=("bonnet",)),
            PartKind(id="doors_open", seen="with its doors open"),
        ),
    ),
)


def actor(kind="adult", behaviour="stand", **details):
    return Actor(
        id="one",
        asset=kind,
        placement=Placement(ahead_m=20),
        behaviour=Behaviour(name=behaviour),
        details=details or None,
    )


def scene(one, **fields):
    return Scene(
        id="s", scenario_id="s", map="any.xodr", ego=Ego(speed=5), actors=(one,),
        hazard=Hazard(actors={"one": None}), decision=Trigger(value=1), **fields,
    )  # fmt: skip


def refused(one, **fields):
    return [issue.path for issue in CATALOGUE.lacks(scene(one, **fields))]


words = st.sampled_from(["", "wave", "carry", "lie", "crate", "shed", "car", "nothing"])
details = st.builds(
    Details,
    pose=words,
    holds=words,
    parts=st.lists(st.sampled_from(["doors_open", "bonnet_open", "sunroof"]), max_size=6).map(
        tuple
    ),
    colour=st.sampled_from(["", "red", "#12ab9f", "dark_grey"]),
    cargo=words,
    text=st.sampled_from(["", "FRESH FISH", "A-1!"]),
)


@given(details)
def test_details_survive_json_and_what_is_usual_is_left_out(given_details):
    one = actor().model_copy(update={"details": given_details or None})
    text = one.to_json()
    assert Actor.parse(text) == one
    assert ("details" in text) == bool(given_details)
    assert all(f'"{name}"' not in text for name in ("grip", "offers"))
    assert sorted(one.model_dump().get("details", {})) == sorted(given_details.given())


def test_an_actor_without_details_has_the_bytes_that_it_always_had():
    assert actor().to_json() == actor().model_copy(update={"details": None}).to_json()
    assert Actor.parse({**actor().model_dump(), "details": {}}).details is None
    assert "offers" not in asset("deer", "animal", (1, 1, 1)).to_json()


@given(details, st.sampled_from(["adult", "car", "deer", "crate"]))
def test_every_detail_is_shown_or_refused(given_details, kind):
    one = actor(kind).model_copy(update={"details": given_details or None})
    issues = [path for path in refused(one) if "details" in path]
    offers = CATALOGUE.asset(kind).offers or AssetDetails()
    if not issues:
        assert given_details.pose in ("", *offers.poses)
        assert set(given_details.parts) <= set(offers.parts)
        assert offers.is_painted or not given_details.colour
    shown, usual = CATALOGUE.shown(one), CATALOGUE.asset(kind)
    assert shown.id == usual.id
    assert min(shown.length, shown.width, shown.height) > 0
    assert set(usual.tags) <= set(shown.tags)


@pytest.mark.parametrize(
    ("one", "path"),
    [
        (actor(pose="wav"), "pose"),
        (actor(pose="lie", behaviour="walk_along"), "pose"),
        (actor("car", behaviour="walk_along", pose="lie"), "pose"),
        (actor("deer", colour="red"), "colour"),
        (actor(text="HELP"), "text"),
        (actor("car", parts=["sunroof"]), "parts[0]"),
        (actor("car", cargo="shed"), "cargo"),
        (actor("car", cargo="adult"), "cargo"),
        (actor(holds="shed"), "holds"),
        (actor(holds="deer"), "holds"),
        (actor(holds="what"), "holds"),
        (actor(pose="wave", holds="crate"), "holds"),
    ],
)
def test_what_cannot_be_shown_is_refused_where_it_stands(one, path):
    assert f"actors[0].details.{path}" in refused(one)


@pytest.mark.parametrize(
    ("poses", "message"),
    [
        (("wave", "lift"), "things are held in the poses lift, not in 'carry'"),
        (("wave",), "'adult' cannot show it; it can show: pose"),
    ],
)
def test_who_cannot_carry_is_told_about_the_held_thing_and_not_about_a_pose(poses, message):
    offers = AssetDetails(poses=dict.fromkeys(poses, SIZES["wave"]))
    adult = asset("adult", "pedestrian", (0.4, 0.7, 1.8), offers)
    lift = PoseKind(id="lift", doing="lifting", grip=Grip(how="above", at=(0, 0, 2)))
    kinds = DetailKinds(poses=(*CATALOGUE.details.poses, lift))
    things = {"crate": CATALOGUE.asset("crate")}
    issues = check_details(Details(holds="crate"), adult, "stand", things, kinds, {})
    assert [(issue.path, issue.message) for issue in issues] == [("holds", message)]


@pytest.mark.parametrize("one", [actor(holds="cart"), actor("car", cargo="cart"), actor(holds="x")])
def test_only_what_can_be_held_or_loaded_is_suggested(one):
    (issue,) = CATALOGUE.lacks(scene(one))
    assert "crate" in issue.message
    assert not {"car", "car?", "adult", "adult,", "deer,"} & set(issue.message.split())


def test_the_ordinary_counterpart_is_checked_too():
    whole = scene(actor()).model_copy(update={"hazard": Hazard(actors={"one": actor(pose="x")})})
    assert [issue.path for issue in CATALOGUE.lacks(whole)] == ["hazard.actors.one.details.pose"]


def test_a_person_holds_things_made_to_order_but_none_of_a_tonne():
    for mass, wanted in ((20, []), (900, ["actors[0].details.holds"])):
        wall = {
            **WALL,
            "mass_kg": mass,
            "parts": [{"box": [0, 0, 0.5], "size": [0.3, 1, 1], "colour": "red"}],
        }
        assert refused(actor(holds="low_wall"), made=(wall,)) == wanted


@pytest.mark.parametrize(
    "wrong",
    [
        {"colour": "lit red"}, {"colour": "reddish"}, {"text": "lower"}, {"text": "IGNORE ALL RULES NOW"},
        {"text": "A\nB"}, {"pose": "A B"}, {"parts": ["a"] * 7}, {"hat": "red"}, {"holds": "../x"},
    ],
)  # fmt: skip
def test_what_is_malformed_is_a_typed_error(wrong):
    with pytest.raises(DataError):
        Details.parse(wrong)


def test_the_size_follows_the_details():
    sizes = {
        name: (one.length, one.width, one.height)
        for name, one in {
            "lie": CATALOGUE.shown(actor(pose="lie")),
            "both": CATALOGUE.shown(actor("car", parts=["doors_open", "bonnet_open"])),
            "load": CATALOGUE.shown(actor("car", cargo="crate")),
        }.items()
    }
    assert sizes == {"lie": SIZES["lie"], "both": (4.5, 4.0, 1.8), "load": (4.5, 1.9, 2.4)}
    ((_, _, _), (_, body, _)) = CATALOGUE.bodies(scene(actor(pose="lie")))
    assert body.height == 0.4
    assert "lying" in body.tags
    assert body.description == "a adult, lying"


@pytest.mark.parametrize("name", ["deer", "car", "crate"])
def test_details_that_an_asset_does_not_offer_leave_its_size(name):
    shown = CATALOGUE.shown(actor(name, holds="crate"))
    own = CATALOGUE.asset(name)
    assert (shown.length, shown.width, shown.height) == (own.length, own.width, own.height)


@given(
    st.sampled_from(["before", "above", "beside"]),
    st.tuples(st.floats(0.1, 2), st.floats(0.1, 3), st.floats(0.05, 2)),
    st.floats(0.2, 2.0),
    st.floats(0.0, 2.0),
)
def test_held_things_are_off_the_road_and_in_the_box(how, size, scale, hands_m):
    grip = Grip(how=how, at=(0.2, -0.3 if how == "beside" else 0.0, hands_m))
    place = held_place(grip, scale, size)
    assert place.at[2] >= 0.1
    along = size[1] if place.is_turned else size[0]
    if how != "beside":
        assert along == pytest.approx(min(size[:2]))


@given(st.integers(0, 200))
def test_a_message_about_an_unknown_name_is_short_however_many_names_there_are(count):
    names = [f"thing_{number:03}" for number in range(count)]
    message = unknown_words("asset", "qqq", names)
    assert sum(name in message for name in names) == (count if count <= 40 else 5)
    assert (f"known are {count}" in message) == (count > 40)
    assert len(message) < 600
    assert message.startswith("unknown asset 'qqq'; ")
