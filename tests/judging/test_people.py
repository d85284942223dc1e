"""Answers of people: tokens that tell nothing, files of other studies refused, rows like those of models."""

import unicodedata
from typing import Literal

import hypothesis
import pytest
from hypothesis import strategies as st

from oodscen.data._episode import ACTIONS, ActionOutcome, Episode
from oodscen.errors import DataError
from oodscen.judging._people import PersonAnswers, QuizAnswers, token
from oodscen.judging._references import AspectOption
from oodscen.stages._evaluate import evaluate


def episode(name: str, sha: str = "a") -> Episode:
    file = f"frames/{name}/last.jpg"
    return Episode(
        id=name,
        scene_id=name,
        status="ok",
        frames={"last": file},
        file_sha256={file: sha},
        actions={action: ActionOutcome(safe=action == "stop") for action in ACTIONS},
    )


EPISODES = (episode("deer-001"), episode("deer-001~twin"))


def given(*items: str, name: str = "Ada", **more: object) -> QuizAnswers:
    said = {
        "is_ood": True,
        "confidence": 0.8,
        "aspect": "a deer",
        "choice": "deer",
        "action": "stop",
        **more,
    }
    said = {name: value for name, value in said.items() if value is not ...}
    return QuizAnswers.parse({"id": name, "answers": [{"item": item, **said} for item in items]})


def test_a_person_is_judged_like_a_model():
    answers = PersonAnswers.matched(given(token(EPISODES[0])), EPISODES)
    assert set(answers.items) == {"deer-001"}
    options = (AspectOption(id="deer", label="Deer on the road"),)
    path = ("OOD", "Animals", "Deer on the road")
    verdict = evaluate(EPISODES[0], {}, answers, path=path, leaf="deer", options=options)
    assert (verdict.model, verdict.kind) == ("human:Ada", "model")
    assert verdict.is_ood
    assert verdict.aspect_is_right
    assert verdict.choice_is_right
    assert verdict.action_is_safe


def test_tokens_tell_nothing_and_depend_on_the_pictures():
    names = [token(one) for one in (*EPISODES, episode("deer-001", "b"))]
    assert len(set(names)) == 3
    assert not any("deer" in name or "twin" in name for name in names)


@pytest.mark.parametrize("items", [("unknown",), (token(EPISODES[0]),) * 2])
def test_answers_about_no_drive_of_the_study_or_twice_about_one_are_refused(items):
    with pytest.raises(DataError):
        PersonAnswers.matched(given(*items), EPISODES)


@pytest.mark.parametrize(
    "fault",
    [
        {"name": "../x"},
        {"name": "Ada without pictures"},
        {"name": "Ada\u200d"},
        {"name": "A\u200ddb"},
        {"name": "Ada\ufe0f"},
        {"name": "Ada\u3164"},
        {"name": ""},
        {"action": "fly"},
        {"action": None},
        {"action": ...},
        {"choice": None},
        {"choice": ...},
        {"confidence": 0.1},
        {"confidence": True},
        {"confidence": "0.8"},
        {"more": 1},
        {"is_ood": "yes"},
    ],
)
def test_a_malformed_file_is_refused(fault):
    with pytest.raises(DataError):
        given(token(EPISODES[0]), **fault)


@hypothesis.given(
    st.text("e\u0301\u00e9a\u030a\u00e5\u1112\u1161\u11ab\ud55c", min_size=1, max_size=9),
    st.sampled_from(["NFC", "NFD"]),
)
def test_a_name_is_one_person_in_every_form_of_the_same_characters(
    name: str, form: Literal["NFC", "NFD"]
) -> None:
    try:
        one = given("x", name=name)
    except DataError:
        return
    assert given("x", name=unicodedata.normalize(form, name)).id == one.id
    assert unicodedata.is_normalized("NFC", one.id)
