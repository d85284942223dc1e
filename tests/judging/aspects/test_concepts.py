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
