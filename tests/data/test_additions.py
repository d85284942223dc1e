"""Additions: one thing has one name, and a catalogue that has them shows them."""

from typing import get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._additions import Addition, AdditionKind, extend, map_with
from oodscen.data._catalogue import Catalogue
from oodscen.errors import UsageError
from oodscen.prompts._digest import CatalogueDigest
from oodscen.testing._flat import FlatSimulator

CATALOGUE = FlatSimulator().catalogue()
NAMES = st.text(st.characters(codec="utf-8", categories=["L", "N", "Z"]), min_size=1).filter(
    lambda text: text.strip() != ""
)


@given(st.sampled_from(get_args(AdditionKind)), NAMES)
def test_it_survives_its_json(kind, name):
    addition = Addition.parse({"kind": kind, "name": name[:160]})
    assert Addition.parse(addition.to_json()) == addition
    assert addition.brings(addition)


@pytest.mark.parametrize(
    ("text", "kind", "name"),
    [
        ("an asset: Fallen Tree", "asset", "fallen_tree"),
        ("fallen  tree", "asset", "fallen_tree"),
        ("weather: snow", "weather", "snow"),
        ("a behavior: spin", "behaviour", "spin"),
        ("a state: car: beacon", "state", "car: beacon"),
        ("state: car:beacon", "state", "car: beacon"),
        ("state: Police Car: beacon", "state", "police_car: beacon"),
        ("map: bridge + urban", "map", "bridge + urban"),
        ("a map: Rail  Crossing+urban +", "map", "rail_crossing + urban"),
    ],
)
def test_a_model_may_write_it_as_text(text, kind, name):
    addition = Addition.model_validate(text)
    assert (addition.kind, addition.name) == (kind, name)


def test_a_map_brings_every_map_with_fewer_traits():
    both, one = map_with(["bridge", "urban"]), map_with(["bridge"])
    assert both.brings(one)
    assert not one.brings(both)


@pytest.mark.parametrize(
    "addition",
    [
        Addition(kind="asset", name="piano", category="object"),
        Addition(kind="asset", name="camel", category="animal"),
        Addition(kind="behaviour", name="spin"),
        Addition(kind="weather", name="dust"),
        map_with(["coastal", "tunnel"]),
        map_with([]),
        Addition(kind="state", name="deer: asleep"),
    ],
    ids=lambda one: one.words,
)
def test_an_extended_catalogue_is_valid_and_has_it(addition):
    richer = extend(CATALOGUE, [addition])
    assert Catalogue.parse(richer.to_json()) == richer
    digest = CatalogueDigest.of(richer)
    has = {
        "asset": bool(digest.called(addition.name)),
        "behaviour": addition.name in {line.id for line in digest.behaviours},
        "weather": digest.limits.offers(addition.name),
        "map": any(set(addition.traits) <= set(road.features) for road in digest.maps),
        "state": "asleep" in digest.called("deer")[0].states,
    }
    assert has[addition.kind]


@given(st.sampled_from(get_args(AdditionKind)), st.lists(NAMES, min_size=1, max_size=3))
def test_a_catalogue_extended_again_stays_as_it_is(kind, names):
    """Names that differ only in letters of other scripts are names of different things."""
    additions = [Addition.parse({"kind": kind, "name": name[:160]}) for name in names]
    richer = extend(CATALOGUE, additions)
    assert Catalogue.parse(richer.to_json()) == richer
    assert extend(richer, additions) == richer


@pytest.mark.parametrize("name", ["deer: asleep", "deer:", "deer"])
def test_a_state_is_added_once_and_has_a_name(name):
    richer = extend(CATALOGUE, [Addition(kind="state", name=name)] * 2)
    asleep = ("asleep",) if name.endswith("asleep") else ()
    assert richer.asset("deer").states == (*CATALOGUE.asset("deer").states, *asleep)


def test_an_addition_that_the_catalogue_has_changes_nothing():
    kind = CATALOGUE.behaviours[0].id
    assert extend(CATALOGUE, [Addition(kind="behaviour", name=kind)]) == CATALOGUE


@pytest.mark.parametrize("name", ["night", "fog", "rain", "snow", "ice"])
def test_weather_that_a_scene_can_ask_for_is_added_as_such(name):
    bare = CATALOGUE.model_copy(
        update={"weather": type(CATALOGUE.weather)(min_sun_elevation_deg=0.0)}
    )
    assert not CatalogueDigest.of(bare).limits.offers(name)
    richer = extend(bare, [Addition(kind="weather", name=name)])
    assert CatalogueDigest.of(richer).limits.offers(name)
    assert richer.weather.others == ()


def test_what_no_catalogue_can_bring_changes_nothing():
    assert extend(CATALOGUE, [Addition(kind="other", name="a recipe")]) == CATALOGUE


@pytest.mark.parametrize("traits", [["oncoming"], ["shoulder"], ["tunnel", "oncoming", "shoulder"]])
def test_an_added_map_has_the_lanes_that_its_traits_name(traits):
    model = CATALOGUE.maps[0].model_copy(update={"oncoming_lanes": 0, "has_shoulder": False})
    bare = CATALOGUE.model_copy(update={"maps": (model,)})
    added = extend(bare, [map_with(traits)]).maps[-1]
    assert added.oncoming_lanes == int("oncoming" in traits)
    assert added.has_shoulder == ("shoulder" in traits)
    assert added.landmarks == (("tunnel",) if "tunnel" in traits else ())


def test_what_is_no_addition_is_refused():
    with pytest.raises(UsageError, match="must be an Addition, not 1"):
        CATALOGUE.extended([1])
