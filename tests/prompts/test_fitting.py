"""Questions become shorter without losing what they are about."""

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oodscen_pybullet._catalogue import load_catalogue

from oodscen import make_catalogue
from oodscen.errors import DataError
from oodscen.prompts._digest import CatalogueDigest
from oodscen.prompts._fitting import ANSWER_TOKENS, fitted, tokens_of
from oodscen.prompts._scenario.stage_scene import StageScene
from oodscen.prompts._tree.judge_branch import JudgeBranch
from oodscen.study._config import StudyConfig

CATALOGUE = CatalogueDigest.of(load_catalogue())
PATH = ("OOD", "Interactional", "Animals", "Deer on the road")
QUESTIONS = (
    JudgeBranch(path=PATH, catalogue=CATALOGUE),
    StageScene(text="A stag bolts across the lane.", path=PATH, catalogue=CATALOGUE),
)


@pytest.mark.parametrize("question", QUESTIONS, ids=lambda question: question.purpose)
def test_a_question_fits_four_thousand_tokens(question):
    short = fitted(question, 4_096)
    assert tokens_of(question) >= tokens_of(short)
    assert tokens_of(short) + ANSWER_TOKENS <= 4_096
    rendered = short.instructions()
    assert "stag with antlers" in rendered
    assert all(line.id in rendered for line in CATALOGUE.assets)
    assert all(line.id in rendered for line in CATALOGUE.behaviours)


@settings(max_examples=20)
@given(st.integers(0, 8_000))
def test_the_vocabulary_stays_whole(context):
    short = fitted(QUESTIONS[0], context).catalogue
    for field in ("assets", "behaviours"):
        whole = [line.id for line in getattr(CATALOGUE, field)]
        assert [line.id for line in getattr(short, field)] == whole
    assert [road.id for road in short.maps] == [road.id for road in CATALOGUE.maps]


def test_roads_that_the_claims_rule_out_go_first():
    possible = ("tunnel", "bridge")
    question = QUESTIONS[1].model_copy(update={"roads": possible})
    assert [road.id for road in fitted(question, 4_096).catalogue.maps] == [*possible]
    assert tokens_of(fitted(question, 0)) < tokens_of(fitted(QUESTIONS[1], 0))
    assert fitted(question, 100_000) is question


@settings(max_examples=10)
@given(st.sampled_from(QUESTIONS), st.integers(0, 8_000))
def test_a_question_fits_or_is_the_shortest(question, context):
    short, shortest = fitted(question, context), fitted(question, 0)
    assert tokens_of(short) + ANSWER_TOKENS <= context or short == shortest
    assert not any(line.description for line in shortest.catalogue.assets)


@pytest.mark.parametrize("question", QUESTIONS, ids=lambda question: question.purpose)
def test_a_model_that_reads_enough_gets_everything(question):
    assert fitted(question, None) is question
    assert fitted(question, 100_000) is question


@settings(max_examples=10)
@given(st.integers(3_500, 8_600))
def test_sets_of_states_that_a_shortened_question_names_are_defined_in_it(context):
    rendered = fitted(QUESTIONS[1], context).instructions()
    named = set(re.findall(r"states (set \d+)", rendered))
    assert named <= set(re.findall(r"`(set \d+)`: ", rendered))


@pytest.mark.parametrize("name", ["flat", "highway", "pybullet", "sumo"])
def test_the_least_window_of_a_study_holds_a_question_about_a_scene(name):
    digest = CatalogueDigest.of(make_catalogue(name))
    shortest = fitted(QUESTIONS[1].model_copy(update={"catalogue": digest}), 0)
    needed = tokens_of(shortest) + ANSWER_TOKENS
    assert StudyConfig(context=4_096).context >= needed
    with pytest.raises(DataError, match="4096"):
        StudyConfig(context=min(needed, 4_095))
