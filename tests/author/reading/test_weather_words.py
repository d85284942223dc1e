"""Weather and darkness are read where a noun phrase is about them, and nowhere else."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.author._reading.recognition import Recogniser
from oodscen.author._reading.weather_words import (
    WEATHER_WORDS,
    circumstances,
    without_circumstances,
)

NOUNS = {
    word: kind
    for kind, words in WEATHER_WORDS.items()
    for word in words
    if word not in ("ice", "icy", "foggy", "misty", "rainy", "snowy")
} | dict.fromkeys(
    ("night", "nighttime", "night-time", "nightfall", "darkness", "the dark"), "night"
)


@given(
    st.sampled_from(sorted(NOUNS)),
    st.sampled_from(["at", "In", "during", "under", "by", "amid"]),
    st.sampled_from(["", "a ", "heavy ", "a very thick ", "near-total "]),
    st.sampled_from(["", " on the road", ", ahead", " crossing the road", " - and a cow", "."]),
)
def test_every_noun_for_weather_is_read(noun, preposition, modifiers, rest):
    assert circumstances(f"Moose {preposition} {modifiers}{noun}{rest}") == (NOUNS[noun],)


@pytest.mark.parametrize(
    ("label", "kinds", "rest"),
    [
        ("Deer in night rain", ("night", "rain"), "Deer"),
        ("Deer in foggy weather", ("fog",), "Deer"),
        ("Deer in misty weather", ("fog",), "Deer"),
        ("Moose in icy conditions", ("ice",), "Moose"),
        ("Moose in snowy conditions", ("snow",), "Moose"),
        ("Moose during a rainy night", ("rain", "night"), "Moose"),
        ("Moose on a dark night", ("night",), "Moose"),
        ("Moose on a very foggy night", ("fog", "night"), "Moose"),
        ("Moose on snow at night", ("night",), "Moose on snow"),
        ("Moose in icy and wet conditions", ("ice",), "Moose and wet conditions"),
        ("Car in a snow storm ahead", ("snow",), "Car ahead"),
        ("Cow in the dark of night", ("night",), "Cow"),
        ("Dog during a rainstorm at night", ("rain", "night"), "Dog"),
        ("Deer at night jumps onto the road", ("night",), "Deer jumps onto the road"),
        ("Deer in lane at night", ("night",), "Deer in lane"),
        ("Moose in fog an arm's length ahead", ("fog",), "Moose an arm's length ahead"),
        ("Dog in snow-covered lane", ("snow",), "Dog -covered lane"),
    ],
)
def test_phrases_about_weather_are_read_and_taken_out(label, kinds, rest):
    assert circumstances(label) == kinds
    assert without_circumstances(label) == rest


@pytest.mark.parametrize(
    "label",
    [
        "Deer by a dark van",
        "Deer on a snowy bank",
        "Man in a dark coat",
        "Man on a night train",
        "Pedestrian in dark clothing on the road",
        "Pedestrian by a snow plough",
        "Man with ice cream",
        "Moose in ice cream",
        "Lorry with fish in ice",
        "Tree felled in last night's gale",
        "The junction by the theatre is dark",
    ],
)
def test_words_that_describe_another_thing_are_no_weather(label):
    assert circumstances(label) == ()
    assert without_circumstances(label) == label


@pytest.mark.parametrize(
    ("label", "weather"),
    [
        ("Dog during a snowstorm", ("snow",)),
        ("Moose in a downpour", ("rain",)),
        ("Deer in night rain", ("night", "rain")),
        ("Deer in foggy weather", ("fog",)),
        ("Deer by a dark van", ()),
        ("Man in a dark coat", ()),
    ],
)
def test_a_label_needs_the_weather_that_it_names(recogniser: Recogniser, label, weather):
    (alternative,) = recogniser.reading(label).alternatives
    assert [part.weather for part in alternative.parts] == [weather]


def test_the_reason_names_the_thing_without_blanks_around_it(recogniser: Recogniser):
    (alternative,) = recogniser.reading("Kangaroo at night").alternatives
    assert "'Kangaroo'" in alternative.parts[0].why
