"""Ordinary twins: the frame stays, the event goes, name and length are kept."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.llms.author import BuiltinAuthor, Knowledge
from oodscen.llms.author.compose import Composer
from oodscen.llms.author.recognise import Recogniser
from oodscen.prompts import STYLES, DescribeOrdinary
from oodscen.prompts.describe_path import plain
from oodscen.seeding import stream


def twin(author: BuiltinAuthor, ask, text: str, label: str = "") -> str:
    return ask(author, DescribeOrdinary(text=text, path=(label,) if label else ())).text


@pytest.mark.parametrize("style", STYLES)
def test_every_kind_has_a_twin_without_its_event(
    author: BuiltinAuthor, ask, knowledge: Knowledge, recogniser: Recogniser, style: str
) -> None:
    composer, still = Composer(knowledge), []
    for hazard in knowledge.hazards[:: 5 if style == "natural" else 15]:
        text = composer.text(hazard, stream(1, hazard.id), style)
        question = DescribeOrdinary(text=text, path=(hazard.label,))
        answer = ask(author, question)
        assert question.check(answer) == []
        assert answer.text[0].isupper()
        assert answer.text.endswith(".")
        assert not re.search(r"\s\s|\s[,.]|[,.]{2}", answer.text), answer.text
        told = recogniser.recognise(answer.text)
        if told.hazard is hazard and told.weight > recogniser.recognise(text).weight * 0.8:
            still.append((text, answer.text))
    assert still == []


def test_place_weather_and_name_stay(author: BuiltinAuthor, ask) -> None:
    text = "On a two-lane rural road at dusk, a fallen tree bars the road ahead of ego."
    found = twin(author, ask, text)
    assert found.startswith("On a two-lane rural road at dusk, the trees stand upright beside")
    text = (
        "I am driving on a two-lane rural road. A fallen tree lies across the road in front of me."
    )
    assert "ego" not in twin(author, ask, text)


def test_a_text_of_another_author_keeps_where_it_is(author: BuiltinAuthor, ask) -> None:
    text = "The ego vehicle is cruising down a gravel lane in Iceland when a fallen tree bars the road."
    found = twin(author, ask, text)
    assert found.startswith("The ego vehicle is cruising down a gravel lane in Iceland ")
    assert "fallen" not in found


def test_what_nobody_knows_becomes_ordinary_traffic(author: BuiltinAuthor, ask) -> None:
    found = twin(
        author, ask, "Zorblax hovers over the quonk and sings about nothing in particular."
    )
    assert "Zorblax" not in found
    assert "traffic" in found


@given(st.text(min_size=1, max_size=300).filter(lambda text: text.strip()))
def test_any_text_has_an_answer(text: str) -> None:
    author = BuiltinAuthor()
    first = author._twins.twin(text, "", stream(0, text))
    assert plain(first)
    assert first == author._twins.twin(text, "", stream(0, text))
