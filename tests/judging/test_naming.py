"""The paper's task one: an aspect is read from JSON, marks and short prose; "nothing" is no aspect."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.judging.naming import names_nothing, read_named_aspect


@pytest.mark.parametrize(
    ("said", "aspect"),
    [
        ('{"reasoning": "x", "aspect": "a deer"}', "a deer"),
        ("**OOD aspect:** An overturned vehicle ahead.", "An overturned vehicle ahead"),
        ("An overturned vehicle ahead.", "An overturned vehicle ahead"),
        ("The OOD aspect is an overturned vehicle.", "an overturned vehicle"),
        ("No traffic lights working", "No traffic lights working"),
        ('{"aspect": "none"}', ""),
        ("There is nothing unusual.", ""),
        ("None.", ""),
    ],
)
def test_an_aspect_is_read_as_a_person_would(said, aspect):
    reading = read_named_aspect(said)
    assert (reading.value, reading.outcome) == (aspect, "answered")


@pytest.mark.parametrize(
    ("said", "outcome"),
    [
        ("I'm sorry, I can't help with that.", "refused"),
        ("", "unparsed"),
        ('{"reasoning": "x"}', "unparsed"),
        ('{"aspect": "..."}', "unparsed"),
        ('{"aspect": "a deer"} {"aspect": "a box"}', "unparsed"),
        ("word " * 200_000, "unparsed"),
    ],
)
def test_what_names_no_aspect_is_told_apart(said, outcome):
    assert read_named_aspect(said).outcome == outcome


@given(st.text(max_size=60))
def test_any_text_is_read_and_names_something_or_nothing(said):
    reading = read_named_aspect(said)
    assert (reading.value is None) == (reading.outcome != "answered")
    assert not reading.value or not names_nothing(reading.value)
    again = read_named_aspect(json.dumps({"aspect": said}))
    assert again.value is None or isinstance(again.value, str)
