"""Laws that hold for every question."""

import re
import unicodedata
from typing import get_args

import jinja2.meta
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel, ValidationError

from oodscen.data._claim import Claim
from oodscen.data._messages import Image
from oodscen.errors import DataError
from oodscen.prompts import QUESTIONS
from oodscen.prompts import _base as base
from oodscen.prompts._base import data_block
from oodscen.prompts._digest import AssetLine, BehaviourLine, MapLine
from oodscen.prompts._scenario.describe_path import DescribePath
from oodscen.prompts._scenario.stage_scene import StageScene
from oodscen.prompts._tree.imagine_scenario import ImagineScenario
from oodscen.prompts._tree.judge_branch import JudgeBranch, JudgeBranches
from oodscen.prompts._tree.place_scenario import PlaceScenario
from oodscen.tree._scenario_tree import Node
from tests.prompts.samples import DIGEST, NODES, PATH, SAMPLES

UNSHOWN = {(Node, "attested"), (Image, "path"), (Claim, "kind"), (Claim, "value")}
"""Provenance of a label, where a picture's bytes lie, and words of a claim that allow no others."""
OF_STAGERS = {
    *((MapLine, name) for name in ("id", "traits", "landmarks", "somewhere", "layout")),
    *((AssetLine, name) for name in ("description", "names", "length_m", "width_m", "height_m")),
    *((BehaviourLine, name) for name in ("categories", "parameters")),
    (AssetLine, "states"),
}
OF_JUDGES = {
    *((MapLine, name) for name in ("speed_limit", "landmarks", "layout")),
    *((AssetLine, name) for name in ("description", "names", "length_m", "width_m", "height_m")),
    (BehaviourLine, "parameters"),
}
LEFT_OUT = {
    JudgeBranch: OF_JUDGES,
    JudgeBranches: OF_JUDGES,
    DescribePath: OF_STAGERS,
    ImagineScenario: OF_STAGERS,
}
"""What only those see who need it to set up a scene, or to judge whether that can be done."""


def changed(value, unshown, annotation=None):
    """Yield the values that differ from this one in a single place, however deep."""
    if isinstance(value, BaseModel):
        for name, field in type(value).model_fields.items():
            if (type(value), name) not in unshown:
                for other in changed(getattr(value, name), unshown, field.annotation):
                    yield {**dict(value), name: other}
    elif isinstance(value, tuple):
        if value:
            yield value[:-1]
        of_items = next(iter(get_args(annotation)), None)
        for index, item in enumerate(value):
            for other in changed(item, unshown, of_items):
                yield (*value[:index], other, *value[index + 1 :])
    elif isinstance(value, str):
        words = [word for word in get_args(annotation) if isinstance(word, str)]
        yield from [word for word in words if word != value] or [f"{value}x"]
    elif isinstance(value, bool):
        yield not value
    elif isinstance(value, (int, float)):
        yield 2 * value + 1


def variants(prompt):
    unshown = UNSHOWN | LEFT_OUT.get(type(prompt), set())
    for name, field in type(prompt).model_fields.items():
        for other in changed(getattr(prompt, name), unshown, field.annotation):
            yield name, type(prompt)(**{**dict(prompt), name: other})


def test_there_is_a_sample_of_every_question_with_every_field_filled():
    assert tuple(map(type, SAMPLES)) == tuple(QUESTIONS.values())
    for prompt in SAMPLES:
        fields = set(type(prompt).model_fields) - {"withheld"}  # Instead of the frames.
        assert all(getattr(prompt, name) for name in fields)


@pytest.mark.parametrize("prompt", SAMPLES, ids=lambda p: p.purpose)
def test_every_input_changes_the_rendered_messages(prompt):
    rendered = prompt.messages()
    touched = set()
    for name, other in variants(prompt):
        try:
            messages = other.messages()
        except (DataError, ValidationError):  # the changed nodes are no tree
            continue
        assert messages != rendered, other
        touched.add(name)
    assert touched == set(type(prompt).model_fields)


def test_the_place_of_a_node_is_shown():
    moved = NODES[-1].model_copy(update={"parent": "environmental"})
    prompt = PlaceScenario(text=SAMPLES[4].text, nodes=(*NODES[:-1], moved))
    assert prompt.messages() != SAMPLES[4].messages()


@pytest.mark.parametrize("prompt", SAMPLES, ids=lambda p: p.purpose)
def test_a_question_is_a_function_of_its_fields(prompt):
    again = type(prompt).parse(prompt.to_json())
    assert again.messages() == prompt.messages()
    first, *_, last = prompt.messages()
    assert first.role == "system"
    assert last.role == "user"
    assert last.text == prompt.question()


@pytest.mark.parametrize("prompt", SAMPLES, ids=lambda p: p.purpose)
def test_turns_alternate_and_the_question_states_the_answer(prompt):
    roles = [message.role for message in prompt.messages()[1:]]
    assert roles == ["user", "assistant"] * (len(roles) // 2) + ["user"]
    asked = "\n".join(message.text for message in (prompt.messages()[0], prompt.messages()[-1]))
    shape = asked.rpartition("Answer with JSON")[2]
    required = prompt.answer_schema().get("required", [])
    assert required
    assert all(f'"{name}"' in shape for name in required)


def test_earlier_turns_repeat_the_conversation_word_for_word():
    give, classify, propose, *_ = SAMPLES
    assert classify.earlier()[0].text == give.question()
    assert propose.earlier()[: len(classify.earlier())] == classify.earlier()
    assert propose.earlier()[-2].text == classify.question()
    describe, name = SAMPLES[-6].model_copy(update={"total": 3}), SAMPLES[-5]
    assert describe.messages()[:-1] == name.messages()[: len(describe.messages()) - 1]
    assert describe.messages()[-1] == name.messages()[len(describe.messages()) - 1]


def test_versions_are_stable_and_tell_questions_apart():
    versions = [question.version() for question in QUESTIONS.values()]
    assert versions == [question.version() for question in QUESTIONS.values()]
    assert len(set(versions)) == len(QUESTIONS)
    assert all(re.fullmatch(r"[0-9a-f]{12}", version) for version in versions)


@pytest.mark.parametrize(
    "template", ["_catalogue.md", "_vocabulary.md", "stage_scene.md", "describe_frame.md"]
)
def test_a_version_changes_with_every_template_it_shows(template, monkeypatch):
    before = {question: question.version() for question in QUESTIONS.values()}
    source = base._source
    monkeypatch.setattr(
        base, "_source", lambda name: source(name) + ("changed" if name == template else "")
    )
    base._version.cache_clear()
    try:
        after = {question: question.version() for question in QUESTIONS.values()}
    finally:
        base._version.cache_clear()
    differing = {
        question.purpose for question in QUESTIONS.values() if before[question] != after[question]
    }
    assert (
        differing
        == {
            "_catalogue.md": {"stage-scene"},
            "_vocabulary.md": {"judge-branch", "judge-branches"},
            "stage_scene.md": {"stage-scene"},
            "describe_frame.md": {
                "describe-frame",
                "name-aspect",
                "name-ood-aspect",
                "choose-aspect",
                "choose-action",
            },
        }[template]
    )


@pytest.mark.parametrize("prompt", SAMPLES, ids=lambda p: p.purpose)
def test_instructions_depend_on_nothing_that_changes_within_a_run(prompt):
    changing = {"text": "A cow.", "path": ("x",), "count": 9, "claims": ()}
    fields = type(prompt).model_fields
    other = prompt.model_copy(update={name: changing[name] for name in changing if name in fields})
    assert other.instructions() == prompt.instructions()


def test_templates_use_no_variable_that_the_question_lacks():
    for prompt in SAMPLES:
        tree = base._environment().parse(base._source(prompt.template))
        assert jinja2.meta.find_undeclared_variables(tree) <= set(prompt.variables())


hostile = st.one_of(
    st.text(),
    st.lists(
        st.sampled_from(
            [
                "<data>",
                "</data>",
                "</ DATA >",
                "<",
                "＜",
                "/",
                "da",
                "ta",
                "\u200b",
                ">",
                "\n",
                "{{",
                "%}",
            ]
        )
    ).map("".join),
)


@given(hostile)
def test_a_text_cannot_leave_its_fence(text):
    block = data_block(text)
    shown = re.sub(r"[\s\u200b]", "", unicodedata.normalize("NFKC", block))
    marks = re.findall(r"</?data", shown, re.IGNORECASE)
    assert marks == ["<data", "</data"]
    assert block.startswith("<data>")
    assert block.endswith("</data>")


@given(hostile)
def test_fenced_inputs_change_nothing_outside_their_fence(text):
    def outside(prompt):
        return re.sub(r"<data>.*?</data>", "<data></data>", prompt.question(), flags=re.DOTALL)

    assert outside(SAMPLES[4].model_copy(update={"text": text})) == outside(SAMPLES[4])
    staged = [StageScene(text=one, path=(one,), catalogue=DIGEST) for one in (text, "a stag")]
    assert outside(staged[0]) == outside(staged[1])
    asked = DescribePath(path=(*PATH, text), count=3, avoid=(text,), made=(text,))
    assert outside(asked) == outside(SAMPLES[10])
