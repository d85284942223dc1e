"""Reading: what the words say and nothing else, whatever the words are."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.ask import ask
from oodscen.llms.author import BuiltinAuthor
from oodscen.llms.author.claiming import read_claims
from oodscen.llms.author.compose import Composer
from oodscen.prompts import ExtractClaims
from oodscen.seeding import stream


def told(text):
    return {" ".join(filter(None, (c.subject, c.kind, c.value))) for c in read_claims(text)}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (
            "Ego is traveling on a two-lane road at night in thick fog, with another vehicle ahead in the same lane.",
            {
                "weather thick_fog",
                "time night",
                "lanes 2",
                "vehicle thing present",
                "vehicle place ahead",
                "vehicle place in_lane",
            },
        ),
        (
            "The ego vehicle is driving on a straight road when a pedestrian suddenly crosses from the right front.",
            {"person thing present", "person motion crossing", "person motion from_right"},
        ),
        (
            "A tanker stands on the right, and three cars come the other way.",
            {
                "tanker thing present",
                "tanker motion stationary",
                "tanker place right",
                "car thing present",
                "car count 3",
            },
        ),
        (
            "The ego vehicle is turning left at a signalised junction in drizzling rain.",
            {"ego turns_left", "road junction", "road signalised", "weather light_rain"},
        ),
        (
            "A car stands in the ego's lane 60 metres ahead, and a second car crosses from the left.",
            {
                "car thing present",
                "car place in_lane",
                "car place ahead",
                "car distance 60",
                "car motion stationary",
                "car 2 thing present",
                "car 2 motion crossing",
                "car 2 motion from_left",
            },
        ),
    ],
)
def test_plain_sentences_are_read(text, expected):
    assert expected <= told(text)


@pytest.mark.parametrize(
    "text",
    [
        "There is no car, no pedestrian and no animal here.",
        "A hole as big as a lorry, the sound of a train, a sign for pedestrians.",
        "Beside the car park and the bus stop nothing happens.",
        "It is not raining, and after a frosty night the road is between two junctions.",
        "",
    ],
)
def test_what_is_denied_or_compared_is_no_claim(text):
    assert told(text) == set()


@settings(max_examples=150)
@given(
    st.lists(
        st.sampled_from(
            "a the ego's ego vehicle car lorry two in lane of behind ahead stands crosses which "
            "it and , . from right left no without slow at night rain 60 metres with".split()
        ),
        max_size=25,
    )
)
def test_any_words_are_read_and_answered_validly(words):
    text = " ".join(words)
    claims = read_claims(text)
    assert claims == read_claims(text)
    if claims:
        assert tuple(ask(BuiltinAuthor(), ExtractClaims(text=text)).claims) == claims


@given(st.text(max_size=60))
def test_nothing_that_is_written_breaks_the_reading(text):
    read_claims(text)


def test_every_text_of_the_author_says_something(knowledge):
    composer = Composer(knowledge)
    total = 0
    hazards = knowledge.hazards[::4]
    for hazard in hazards:
        text = next(composer.texts(hazard, stream(3, hazard.id), set()))
        total += len(read_claims(text))
    assert total >= 4 * len(hazards)
