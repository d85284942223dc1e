"""Answers of people: tokens that tell nothing, files of other studies refused, rows like those of models."""

import json
import unicodedata
from pathlib import Path
from typing import Literal

import hypothesis
import pytest
from hypothesis import strategies as st

from oodscen._io.study_files import PEOPLE
from oodscen.data._episode import ACTIONS, ActionOutcome, Episode
from oodscen.errors import DataError
from oodscen.judging._people import PersonAnswers, QuizAnswers, token
from oodscen.judging._references import AspectOption, Case
from oodscen.stages._evaluate import evaluate
from oodscen.study._store import Store


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


def stored(folder: Path, *lines: object) -> Store:
    store = Store(folder)
    store.prepare()
    text = "".join(f"{json.dumps(line)}\n" for line in lines)
    (store.folder / PEOPLE).write_text(text, encoding="utf-8")
    return store


def test_stored_answers_are_those_of_the_file_without_changed_drives(tmp_path):
    quiz = given(token(EPISODES[0]), "changed")
    loaded = PersonAnswers.load(stored(tmp_path, quiz.model_dump()), "Ada", EPISODES)
    matched = PersonAnswers.matched(given(token(EPISODES[0])), EPISODES)
    assert (loaded.name, loaded.items, loaded.sha256) == (
        matched.name,
        matched.items,
        matched.sha256,
    )


def test_a_name_in_another_form_is_the_same_row(tmp_path):
    composed, apart = "Jos\u00e9", "Jose\u0301"
    store = stored(tmp_path, given(token(EPISODES[0]), name=composed).model_dump())
    assert PersonAnswers.load(store, apart, EPISODES).name == f"human:{composed}"


@pytest.mark.parametrize("line", [{}, {"id": 3}, {"id": "Bob", "answers": []}])
def test_a_damaged_line_is_named(tmp_path, line):
    store = stored(tmp_path, given(token(EPISODES[0])).model_dump(), line)
    with pytest.raises(DataError, match="line 2"):
        PersonAnswers.load(store, "Ada", EPISODES)


def test_two_stored_answers_about_one_drive_are_refused(tmp_path):
    store = stored(tmp_path, given(*[token(EPISODES[0])] * 2).model_dump())
    with pytest.raises(DataError, match="two answers"):
        PersonAnswers.load(store, "Ada", EPISODES)


def test_the_remedy_for_an_absent_person_can_be_pasted(tmp_path):
    store = stored(tmp_path / "my study")
    with pytest.raises(DataError, match="lacks 'Bob'") as caught:
        PersonAnswers.load(store, "Bob", EPISODES)
    assert f"oodscen evaluate '{store.folder}' --drop human:Bob" in str(caught.value)


def test_a_choice_that_is_not_offered_is_none():
    answers = PersonAnswers.matched(given(token(EPISODES[0])), EPISODES)
    options = (AspectOption(id="fox", label="Fox on the road"),)
    assert answers.judge(Case(EPISODES[0], options=options)).choice is None


def test_a_drive_without_an_answer_is_named():
    answers = PersonAnswers.matched(given(token(EPISODES[0])), EPISODES)
    with pytest.raises(DataError, match="deer-001~twin"):
        answers.judge(Case(EPISODES[1]))
