import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen._seeding import stream
from oodscen.author import Knowledge
from oodscen.author._reading.recognition import Recogniser
from oodscen.author._reading.stemming import stems
from oodscen.author._writing.compose import Composer


def test_every_phrasing_is_recognised(knowledge: Knowledge, recogniser: Recogniser) -> None:
    wrong = [
        (hazard.id, event)
        for hazard in knowledge.hazards
        for event in hazard.events
        if recogniser.recognise(event.replace("{where}", "ahead")).hazard is not hazard
    ]
    assert wrong == []


def test_every_composed_text_is_recognised(knowledge: Knowledge, recogniser: Recogniser) -> None:
    composer = Composer(knowledge)
    wrong = []
    for hazard in knowledge.hazards:
        for sample in range(2):
            texts = composer.texts(hazard, stream(7, hazard.label, sample), set())
            for text, _ in zip(texts, range(3), strict=False):
                if recogniser.recognise(text).hazard is not hazard:
                    wrong.append((hazard.id, text))
    assert wrong == []


def test_every_label_is_recognised(knowledge: Knowledge, recogniser: Recogniser) -> None:
    for hazard in knowledge.hazards:
        assert recogniser.label(hazard.label) == (hazard, False)
        assert recogniser.covered_by(hazard.label) == (hazard,)
        if hazard.wider:
            assert recogniser.label(hazard.wider) == (hazard, True)
            assert recogniser.covered_by(hazard.wider) == (hazard, *knowledge.kin(hazard))
    for family in knowledge.families:
        assert recogniser.family(family) == family


@pytest.mark.parametrize(
    ("text", "label"),
    [
        (
            "Ego is traveling on a two-lane road at night in thick fog, with another vehicle ahead "
            "in the same lane. The visibility is greatly diminished due to the fog.",
            "Thick fog at night with a vehicle ahead",
        ),
        (
            "The ego vehicle is traveling on a two-lane residential road under clear and sunny "
            "weather conditions. A large cardboard box, serving as static debris, is positioned in "
            "the middle of the road ahead.",
            "Large cardboard box on the road",
        ),
        (
            "Ego is moving on a three-lane road under clear weather conditions, with an overturned "
            "vehicle positioned ahead in the same lane.",
            "Overturned vehicle ahead in the lane",
        ),
        (
            "The ego vehicle is moving through an area where a construction project is taking "
            "place. A piece of heavy equipment has been accidentally left out of place, creating "
            "an unmarked construction zone with barricades positioned incorrectly.",
            "Misplaced heavy equipment with wrong barricades",
        ),
        (
            "The ego vehicle is moving through a city when a sudden traffic management system "
            "failure during rush hour causes all traffic lights and electronic signals in a busy "
            "urban area to become non-functional.",
            "Traffic lights failing in rush hour",
        ),
    ],
)
def test_the_papers_own_sentences(recogniser: Recogniser, text: str, label: str) -> None:
    found = recogniser.recognise(text).hazard
    assert found is not None
    assert found.label == label


@pytest.mark.parametrize(
    "text",
    [
        "The ego vehicle waits at a red traffic light behind a white van.",
        "The ego vehicle follows a car on a two-lane road in clear weather.",
        "A pedestrian walks on the sidewalk on the right.",
        "Ego is driving on a highway with light traffic, another car is in the left lane.",
        "The ego vehicle slows down behind a bus that stops at a bus stop.",
        "The recipe calls for two eggs and a cup of flour.",
        "",
    ],
)
def test_what_is_ordinary_or_off_topic_is_not_recognised(recogniser: Recogniser, text: str) -> None:
    assert recogniser.recognise(text).hazard is None


@pytest.mark.parametrize(
    ("text", "keys"),
    [
        ("Ego drives on a street at night in the rain.", {"rainy_night"}),
        ("It is foggy and the street is dark.", {"fog", "night"}),
        ("Ego drives on a street.", set()),
    ],
)
def test_conditions(recogniser: Recogniser, text: str, keys: set[str]) -> None:
    assert {condition.key for condition in recogniser.conditions(text)} == keys


def test_a_hazards_own_words_are_no_weather(knowledge: Knowledge, recogniser: Recogniser) -> None:
    hazard = knowledge.by_id["unlit-car"]
    text = "A dark, abandoned car with no lights and no warning triangle stands in the ego's lane."
    assert recogniser.conditions(text, hazard) == ()


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("The car drives along the motorway.", "highway"),
        ("Ego is on a three-lane road.", "urban"),
        ("Ego is on a winding country lane.", "rural"),
        ("Ego is somewhere.", None),
    ],
)
def test_places(recogniser: Recogniser, text: str, key: str | None) -> None:
    place = recogniser.place(text)
    assert (place.key if place else None) == key


@given(st.text(max_size=300))
def test_any_text_can_be_looked_at(recogniser: Recogniser, text: str) -> None:
    recogniser.recognise(text)
    recogniser.conditions(text)
    recogniser.place(text)
    assert all(token == token.casefold() for token in stems(text))
