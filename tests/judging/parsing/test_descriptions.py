"""A description may be prose, but not a refusal."""

import pytest

from oodscen.judging._parsing import read_description


@pytest.mark.parametrize(
    ("said", "value", "outcome"),
    [
        ('{"description": "A road."}', "A road.", "answered"),
        ('{"road": "wet", "weather": ["rain", "fog"]}', "wet; rain; fog", "answered"),
        ("<think>hm</think>A wet road at night.", "A wet road at night.", "answered"),
        ("**Description:** A wet road.", "A wet road.", "answered"),
        ("I cannot see the frame well. " + "A wet road. " * 30, None, "answered"),
        ("I'm sorry, I can't help.", None, "refused"),
        ("...", None, "unparsed"),
        ("Wet", None, "unparsed"),
        ('{"description": "<a description of the frame>"}', None, "unparsed"),
        ("Rain", "Rain", "answered"),
        ('{"description": "..."} {"description": "A road."}', None, "unparsed"),
        ("I cannot see the frame. ".ljust(299, "x") + "x", None, "refused"),
        ("I cannot see the frame. ".ljust(300, "x") + "x", None, "answered"),
        ('{"description": ""} A road.', None, "unparsed"),
        ('{"description": "A wet ro', None, "unparsed"),
    ],
)
def test_a_description_may_be_prose_but_not_a_refusal(said, value, outcome):
    reading = read_description(said)
    assert reading.outcome == outcome
    assert value is None or reading.value == value


def test_a_description_left_empty_is_not_the_one_that_counts():
    assert read_description('{"summary": "", "text": "A wet road."}').value == "A wet road."
