"""Names of things: every plural is found, the longest name counts, every asset has a name."""

import pytest

from oodscen import make_catalogue
from oodscen.claims._things import may_be, mentions, thing_named, things
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE


def test_every_name_is_found_in_a_sentence():
    for thing in things():
        for word in thing.words:
            found = [mention.thing for mention in mentions(f"There it is: {word}, at last.")]
            assert (thing in found) == bool(thing.terms), word


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("two lorries and three women", ["lorry", "person"]),
        ("a police car beside a car park", ["police car"]),
        ("children ran past the bus stop", ["child"]),
        ("an overturned vehicle", ["overturned car"]),
        ("two oxen, and two residents on foot", ["cow", "person"]),
        ("fire appliances with flashing beacons below unmanned aircraft", ["fire engine", "drone"]),
    ],
)
def test_the_longest_name_counts(text, expected):
    assert [mention.thing.name for mention in mentions(text)] == expected


def test_every_asset_has_a_name():
    names = [thing for thing in things() if thing.name not in ("object", "vehicle", "animal")]
    for asset in FLAT_CATALOGUE.assets:
        assert any(thing.fits(asset) for thing in names), asset.id


@pytest.mark.parametrize("catalogue", ["flat", "pybullet", "highway", "sumo"])
def test_an_asset_is_what_its_id_says(catalogue):
    for asset in make_catalogue(catalogue).assets:
        named = thing_named(asset.id.replace("_", " "))
        assert named is None or named.fits(asset), asset.id


def test_a_phrase_names_its_head():
    assert thing_named("lorry with a mattress").name == "lorry"
    assert thing_named("large cardboard box").name == "cardboard box"
    assert thing_named("car 2").name == "car"
    assert thing_named("spaceship") is None


@pytest.mark.parametrize("link", ["with a", "on a", "in a", "that carries a", "from a"])
def test_what_an_unknown_thing_has_or_is_on_is_not_it(link):
    ball = FLAT_CATALOGUE.asset("ball")
    assert thing_named(f"spaceship {link} ball") is None
    assert not may_be(f"spaceship {link} ball", ball)
    assert thing_named(f"heap of balls {link} spaceship").name == "ball"


def test_a_name_may_hold_a_preposition():
    assert thing_named("appliance with flashing beacons with a ball").name == "fire engine"


def test_an_unknown_name_is_compared_with_the_asset_itself():
    by_id = {asset.id: asset for asset in FLAT_CATALOGUE.assets}
    sphere = by_id["ball"].model_copy(update={"description": "a spheroid"})
    assert thing_named("big spheroid") is None
    assert may_be("big spheroid", sphere)
    assert may_be("heap of spheroids", sphere)
    assert not may_be("big spheroid", by_id["ball"])
    assert not may_be("spaceship", by_id["ball"])
