"""Ordinary twins: the frame stays, the event goes, name and length are kept."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen._seeding import stream
from oodscen._words.text import folded_words
from oodscen.author._builtin import BuiltinAuthor
from oodscen.author._knowledge.base import Knowledge
from oodscen.author._knowledge.loading import load_knowledge
from oodscen.author._reading.recognition import Recogniser
from oodscen.author._writing.compose import Composer
from oodscen.errors import LLMError
from oodscen.prompts._scenario.describe_ordinary import DescribeOrdinary
from oodscen.prompts._scenario.describe_path import STYLES


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
    assert found.startswith("On a two-lane rural road at dusk, ")
    assert "fallen" not in found
    text = (
        "I am driving on a two-lane rural road. A fallen tree lies across the road in front of me."
    )
    assert "ego" not in twin(author, ask, text)


@pytest.mark.parametrize(
    "text",
    [
        "Zorblax hovers over the quonk and sings about nothing in particular.",
        "Ego is cruising down a gravel lane in Iceland when a fallen tree bars the road.",
        "",
    ],
)
def test_a_text_without_a_known_place_has_no_twin(author: BuiltinAuthor, text: str) -> None:
    with pytest.raises(LLMError) as caught:
        author._twins.twin(text, "", stream(0, text))
    assert not caught.value.retryable


@given(
    place=st.sampled_from(
        [phrase for place in load_knowledge().places for phrase in place.phrases]
    ),
    event=st.text(max_size=60),
)
def test_any_event_at_a_known_place_has_a_twin(place: str, event: str) -> None:
    author, text = BuiltinAuthor(), f"{place[0].upper()}{place[1:]}, {event} stands."
    found = author._twins.twin(text, "", stream(0, text))
    assert folded_words(found)
    assert found == author._twins.twin(text, "", stream(0, text))
