"""Ordinary twins: the frame stays, the event goes, name and length are kept."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen._seeding import stream
from oodscen.author import BuiltinAuthor, Knowledge
from oodscen.author._reading.recognition import Recogniser
from oodscen.author._writing.compose import Composer
from oodscen.prompts import STYLES, DescribeOrdinary
from oodscen.prompts._scenario.describe_path import plain


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
    assert found.startswith("The ego vehicle is cruising down a gravel lane in Iceland, ")
    assert "fallen" not in found


def test_what_nobody_knows_becomes_ordinary_traffic(author: BuiltinAuthor, ask) -> None:
    found = twin(
        author, ask, "Zorblax hovers over the quonk and sings about nothing in particular."
    )
    assert "Zorblax" not in found
    assert "traffic" in found


FOREIGN = {
    "A sofa is in my lane on the motorway.": ("on the motorway", "me"),
    "Two meteors hit the street in front of the ego vehicle at dusk.": (
        "the street",
        "at dusk",
        "the ego vehicle",
    ),
    "On a rainy night, a deer leaps into the lane of the ego vehicle.": ("On a rainy night", "ego"),
    "The light at the crossing is broken and everyone drives at once.": ("at the crossing",),
    "A lorry has overturned on the bridge ahead of my car.": ("on the bridge", "me"),
    "While it is snowing, an escaped elephant walks along the highway towards ego.": (
        "While it is snowing",
        "the highway",
        "ego",
    ),
    "The autonomous vehicle approaches a roundabout at dawn where a circus goes round the wrong way.": (
        "The autonomous vehicle approaches a roundabout at dawn",
    ),
    "Our car is going through a tunnel when the lamps on the ceiling begin to fall.": (
        "Our car is going through a tunnel",
    ),
    "In the fog a cow stands on the country road.": ("In the fog", "the country road"),
    "You are driving through the old town at night; a drunk juggler blocks the way.": (
        "You are driving through the old town at night",
    ),
    "Early in the morning, the ego car meets a wrong-way driver on a bridge over the bay.": (
        "Early in the morning",
        "on a bridge over the bay",
    ),
    "Somebody has painted false lines on the boulevard, and the ego vehicle heads for a wall in heavy rain.": (
        "the boulevard",
        "in heavy rain",
        "the ego vehicle",
    ),
    "During a foggy and drizzly evening, the AV travels at 15 m/s on a gravel road with a steep drop, and "
    "must react to a truck that cuts in after 30 seconds and brakes at 4 m/s. The driver behind does not "
    "react in time. What should be the first thing that it does to avoid a crash with either of the two?": (
        "During a foggy and drizzly evening",
        "on a gravel road",
        "the AV",
    ),
}
"""Texts in other words than the author's, each with what its twin has to keep."""


@pytest.mark.parametrize("text", FOREIGN)
def test_twins_of_anybodys_texts_keep_place_time_name_and_length(
    author: BuiltinAuthor, ask, text: str
) -> None:
    found = twin(author, ask, text)
    for kept in FOREIGN[text]:
        assert kept.casefold() in found.casefold(), found
    assert 0.7 <= len(plain(found).split()) / len(plain(text).split()) <= 1.3, found
    event = (
        r"sofa|meteor|deer|broken|overturned|elephant|circus|fall|cow|juggler|wrong|false|cuts in"
    )
    assert not re.search(event, found), found
    assert re.search(r"clear|as usual|rules|own lane|is open|free|usual", found), found


@given(
    place=st.sampled_from(("on a gravel road", "in the old town", "at a busy intersection", "")),
    time=st.sampled_from(("at dawn", "in heavy snow", "on a windy morning", "")),
    event=st.sampled_from(
        ("a piano falls from the sky", "three zebras wander about", "a mob throws paint")
    ),
    is_first=st.booleans(),
)
def test_place_and_time_are_kept_wherever_they_stand(
    author: BuiltinAuthor, place: str, time: str, event: str, is_first: bool
) -> None:
    frame = " ".join(part for part in (time, place) if part)
    parts = (f"{frame},", event) if is_first and frame else (event, frame)
    text = " ".join(part for part in parts if part) + " ahead of the ego vehicle."
    found = author._twins.twin(text[0].upper() + text[1:], "", stream(0, text)).casefold()
    assert place in found
    assert time in found
    assert "the ego vehicle" in found
    assert not re.search("piano|zebra|mob", found)


@given(st.text(min_size=1, max_size=300).filter(lambda text: text.strip()))
def test_any_text_has_an_answer(text: str) -> None:
    author = BuiltinAuthor()
    first = author._twins.twin(text, "", stream(0, text))
    assert plain(first)
    assert first == author._twins.twin(text, "", stream(0, text))
