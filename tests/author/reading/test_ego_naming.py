"""Naming the ego: one name throughout, and verbs that fit the driver's own words."""

import pytest

from oodscen.author._reading.ego_naming import with_ego_named

TEXT = (
    "The ego vehicle is driving on a road. A box lies in the ego's lane ahead of the ego vehicle."
)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("the ego vehicle", TEXT),
        ("ego", "Ego is driving on a road. A box lies in ego's lane ahead of ego."),
        (
            "the ego car",
            "The ego car is driving on a road. A box lies in the ego lane ahead of the ego car.",
        ),
        ("I", "I am driving on a road. A box lies in my lane ahead of me."),
    ],
)
def test_one_name_throughout(name, expected):
    assert with_ego_named(TEXT, name) == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("A van in front of the ego vehicle has slowed.", "A van in front of me has slowed."),
        (
            "The path of the ego vehicle is blocked in the ego's own lane.",
            "The path of my car is blocked in my own lane.",
        ),
        ("A horse runs at the ego vehicle.", "A horse runs at my car."),
        ("A dog comes towards the ego vehicle in its lane.", "A dog comes towards me in my lane."),
        (
            "A boy starts in front of the ego vehicle and goes on into its path.",
            "A boy starts in front of me and goes on into my path.",
        ),
        (
            "A van passes the ego vehicle and turns into its lane.",
            "A van passes my car and turns into its lane.",
        ),
    ],
)
def test_the_driver_tells_it(text, expected):
    assert with_ego_named(text, "I") == expected
