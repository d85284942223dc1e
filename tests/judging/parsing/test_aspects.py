"""Aspects and confidences are read from JSON, labelled lines and short prose; "nothing" is no aspect."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.judging._parsing import Detected, names_nothing, read_aspect, read_named_aspect


@pytest.mark.parametrize(
    ("said", "found"),
    [
        ('{"is_ood": true, "aspect": "a deer", "confidence": 0.9}', Detected(True, "a deer", 0.9)),
        ('{"is_ood": "No", "aspect": "none", "confidence": "80%"}', Detected(False, "", 0.8)),
        ('{"is_ood": true, "aspect": "a deer", "confidence": 7}', Detected(True, "a deer")),
        ("is_ood: true\nconfidence: 0.9\naspect: a deer", Detected(True, "a deer", 0.9)),
        ("Yes, a deer. Confidence: 80%", Detected(True, "a deer", 0.8)),
        ("No, nothing unusual. I am 70% sure.", Detected(False, "", 0.7)),
        ("Nothing is out of the ordinary.", Detected(False)),
        ("Yes. Confidence: 0.8. Confidence: 0.6.", Detected(True)),
        ("Yes. " + "The road is wet and dark. " * 20, None),
        ('{"is_ood": true, "is_ood": false}', None),
        ("OOD: yes\nOOD: no", None),
        ("Yes, the road is ordinary.", None),
        ("No, a deer.", None),
    ],
)
def test_whether_what_and_how_surely(said, found):
    read = read_aspect(said)
    assert read.value == found


@pytest.mark.parametrize(
    ("said", "aspect"),
    [
        ('{"reasoning": "x", "aspect": "a deer"}', "a deer"),
        ("**OOD aspect:** An overturned vehicle ahead.", "An overturned vehicle ahead"),
        ("An overturned vehicle ahead.", "An overturned vehicle ahead"),
        ("The OOD aspect is an overturned vehicle.", "an overturned vehicle"),
        ("No traffic lights working", "No traffic lights working"),
        ('{"aspect": "none"}', ""),
        ('{"aspect": ""}', ""),
        ("There is nothing unusual.", ""),
        ("None.", ""),
    ],
)
def test_a_named_aspect(said, aspect):
    reading = read_named_aspect(said)
    assert (reading.value, reading.outcome) == (aspect, "answered")


@pytest.mark.parametrize(
    ("said", "outcome"),
    [
        ("I'm sorry, I can't help with that.", "refused"),
        ("", "unparsed"),
        ('{"reasoning": "x"}', "unparsed"),
        ('{"aspect": "..."}', "unparsed"),
        ('{"aspect": "."} a deer', "unparsed"),
        ('{"aspect": "a deer"} {"aspect": "a box"}', "unparsed"),
        ('{"aspect": "a deer", "aspect": "a box"}', "unparsed"),
        ("I don't know.", "unparsed"),
        ("A deer? Or a dog?", "unparsed"),
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
