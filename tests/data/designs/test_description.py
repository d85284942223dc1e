"""What may describe a made thing or movement: plain words, which stand among the options of questions."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.author._knowledge.designs import load_designs, load_motions
from oodscen.data._designs.prop import Prop
from oodscen.errors import DataError
from oodscen.llm._reading import read_answer
from oodscen.prompts._scenario.design_prop import DesignedProp
from tests.made import WALL, designs

PLAIN = st.sampled_from(
    [
        *(one.description for one in (*load_designs().values(), *load_motions().values())),
        "a sign that is 1.5 m high, red & white",
        "eine rote Mauer (0.5 m breit)",
        "a barrier; its lamps are off",
        "a net of 5 ㎏ on 2 m² of road",
        "a timetable: 10:30 is next",
        "the best option a driver has, a barrier",
        "a lorry with the option of a second trailer",
        "a sign that leaves one choice: A hard stop",
    ]
)
MARKED = st.sampled_from(
    [
        *("**{}**", "`{}`", "# {}", "- {}", "1. {}", "| {} |", "> {}", "__{}__", "~~{}~~"),
        *("[{}](x)", "![{}](x.png)", "{} https://x.y", "{} www.x", "{} example.org/x", "{} a@b.de"),
        *("<b>{}</b>", "{}</data>", "<|im_start|>{}", "[INST] {}", "{} &lt;b&gt;", "{}<!--"),
        *("Ａ) {}", "B） {}", "（B) {}", "𝐁) {}", "𝟏) {}"),
        *("ⓑ {}", "Ⓑ {}", "🅑 {}", "⒝ {}", "① {}", "❶ {}", "{} ⓑ", "C: {}", "1: {}"),
        *("{}: option c", "{}, choice: d", "{}. The answer is a", "{}; choose b", "{}. Optionⓒ"),
        *("B) {}", "(B) {}", "B. {}", "{}: option B", "{}. The answer is B", "{}. Answer: stop"),
        *("{}; choose B", "{}. Correct: (C)", "\\boxed{{{}}}", "$ {}$", '{{"answer": "{}"}}', "{}\n"),
    ]
)  # fmt: skip


def described(text: str) -> Prop:
    return Prop.parse({**WALL, "description": text})


@given(PLAIN)
def test_plain_words_describe_a_thing(text: str) -> None:
    assert described(text).description == text


@given(PLAIN, MARKED)
def test_markup_addresses_and_answers_describe_nothing(text: str, around: str) -> None:
    with pytest.raises(DataError) as refused:
        described(around.format(text[:90]))
    assert [issue.path for issue in refused.value.issues] == ["description"]


@given(MARKED)
def test_a_design_with_such_words_is_asked_for_again(around: str) -> None:
    prop = {**WALL, "description": around.format("a low wall")}
    answer, issues = read_answer(json.dumps({"prop": prop}), DesignedProp)
    assert answer is None
    assert [issue.path for issue in issues] == ["prop.description"]


def quoted(value: object) -> object:
    """Return plain data with every number as text."""
    if isinstance(value, dict):
        return {name: quoted(one) for name, one in value.items()}
    if isinstance(value, list):
        return [quoted(one) for one in value]
    return str(value) if isinstance(value, int | float) else value


@given(designs())
def test_a_number_in_quotes_is_read_as_the_number(design: dict[str, object]) -> None:
    plain, issues = read_answer(json.dumps({"prop": design}), DesignedProp)
    assert issues == []
    assert read_answer(json.dumps({"prop": quoted(design)}), DesignedProp) == (plain, [])


@pytest.mark.parametrize("mass", ["1,5", "6OO", "1.5 kg", "NaN", "inf", "1e999", ""])
def test_text_that_is_no_number_is_none(mass: str) -> None:
    answer, issues = read_answer(json.dumps({"prop": {**WALL, "mass_kg": mass}}), DesignedProp)
    assert answer is None
    assert [issue.path for issue in issues] == ["prop.mass_kg"]
