"""The table of concepts can be read and extended: every line means what it says."""

import pytest

from oodscen.judging._aspects.concepts import concepts, with_broader
from oodscen.judging._aspects.naming import naming_of
from oodscen.judging._aspects.word_forms import split_words

SPOKEN = [
    (name, expression.replace("*", ""))
    for name, one in concepts().items()
    for expression in one.expressions
]


def test_no_expression_belongs_to_two_concepts():
    taken: dict[tuple[str, ...], str] = {}
    for name, one in concepts().items():
        for expression in one.expressions:
            words, _ = split_words(expression.replace("*", ""))
            spelled = (*words, "*") if "*" in expression else tuple(words)
            assert taken.setdefault(spelled, name) == name, expression


@pytest.mark.parametrize("kind", ["odd", "ordinary", "state", "act", "place"])
def test_every_expression_is_found_for_its_concept_when_it_stands_alone(kind):
    for name, expression in SPOKEN:
        if concepts()[name].kind == kind:
            assert name in [concept.name for concept in naming_of(expression).concepts], expression


def test_what_is_set_aside_names_nothing():
    for name, expression in SPOKEN:
        if concepts()[name].kind == "aside":
            assert not naming_of(expression).concepts, expression


def test_wider_concepts_are_followed_to_the_widest():
    assert with_broader("deer") == {"deer", "wild animal", "animal"}


def test_states_imply_things():
    for concept in concepts().values():
        if concept.implied:
            assert concept.kind in ("state", "act")
            assert concepts()[concept.implied].kind in ("odd", "ordinary")


@pytest.mark.parametrize(
    ("text", "thing"),
    [
        ("The traffic light does not work", "deer"),
        ("A cyclist doing a wheelie", "deer"),
        ("A horse bucking under its rider", "deer"),
        ("A lorry bearing down on the ego", "bear"),
        ("A man caring for an injured person", "vehicle"),
        ("A driver coping with ice", "police officer"),
        ("A man ducking under a barrier", "bird"),
        ("A child skipping with a rope", "skip"),
        ("A tired driver", "tyre"),
        ("A man in training", "train"),
        ("A man wheeling a bicycle", "tyre"),
        ("Planks floating on a flooded road", "carnival float"),
        ("Fog combined with rain", "tractor"),
        ("A lorry barrelling down the hill", "crate"),
        ("A road branching off ahead", "branch"),
        ("A woman hailing a taxi", "hail"),
        ("A pedestrian craning to see an accident", "crane load"),
        ("A van rocking in the wind", "rocks"),
        ("Hailstones drumming on the roof", "cone"),
        ("A staged accident", "deer"),
    ],
)
def test_a_verb_that_sounds_like_a_thing_does_not_name_it(text, thing):
    assert thing not in [concept.name for concept in naming_of(text).concepts]


@pytest.mark.parametrize(
    ("text", "thing"),
    [("Two bears", "bear"), ("Two stags", "deer"), ("Branches", "branch"), ("Wheels", "tyre")],
)
def test_several_things_name_what_one_names(text, thing):
    assert [concept.name for concept in naming_of(text).concepts] == [thing]
