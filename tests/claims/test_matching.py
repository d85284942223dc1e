"""What is said to stand for a thing is believed if words or meaning make it plausible."""

import pytest
from oodscen_pybullet._catalogue import load_catalogue

from oodscen.claims._matching import Likeness, doubt, likeness_of
from oodscen.claims._things import may_be
from oodscen.testing._encoder import HashEncoder

CATALOGUE = load_catalogue()


@pytest.fixture(scope="module")
def likeness(minilm) -> Likeness:
    return Likeness(minilm, CATALOGUE)


PLAUSIBLE = [
    ("uprooted maple", "a large uprooted maple", "fallen_tree"),
    ("toppled birch", "A toppled birch", "fallen_tree"),
    ("leaked diesel", "leaked diesel with a purple sheen", "oil_spill"),
    ("hurt cyclist", "a cyclist lies hurt", "person_lying"),
    ("person on a cargo bike", "a person on a cargo bike", "cargo_bike"),
    ("grass fire", "a roadside grass fire", "fire"),
    ("poodle", "a white poodle", "dog"),
    ("stallion", "a black stallion", "horse"),
    ("armchair", "an old armchair", "sofa"),
]
FALSE = [
    ("uprooted maple", "a large uprooted maple", "oil_spill"),
    ("girl on a horse", "a girl on a horse", "cow"),
    ("leaked diesel", "leaked diesel", "fallen_tree"),
    ("hurt cyclist", "a cyclist lies hurt", "child"),
    ("dog", "a brown dog", "cat"),
    ("child", "a child runs out", "adult"),
    ("poodle", "a white poodle", "cow"),
    ("armchair", "an old armchair", "cone"),
    ("ambulance", "an ambulance", "police_car"),
]


@pytest.mark.parametrize(("subject", "quote", "asset"), PLAUSIBLE)
def test_another_word_for_the_same_thing_is_believed(likeness, subject, quote, asset):
    assert doubt(subject, [quote], CATALOGUE.asset(asset), CATALOGUE, likeness) == ""


@pytest.mark.parametrize(("subject", "quote", "asset"), FALSE)
def test_another_thing_is_refused_with_what_was_compared(likeness, subject, quote, asset):
    told = doubt(subject, [quote], CATALOGUE.asset(asset), CATALOGUE, likeness)
    assert repr(asset) in told
    assert subject in told


def test_a_noun_that_fits_needs_no_meaning():
    subjects = [subject for subject, _, _ in (*PLAUSIBLE, *FALSE)]
    for asset in CATALOGUE.assets:
        for subject in subjects:
            if may_be(subject, asset):
                assert doubt(subject, [], asset, CATALOGUE, None) == ""


def test_an_encoder_whose_cosines_mean_nothing_is_not_asked():
    assert likeness_of(HashEncoder(), CATALOGUE) is None
    assert likeness_of(None, CATALOGUE) is None
    assert doubt("uprooted maple", [], CATALOGUE.asset("fallen_tree"), CATALOGUE, None) == ""
    assert doubt("dog", [], CATALOGUE.asset("cat"), CATALOGUE, None) != ""
