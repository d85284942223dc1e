"""The content of a text, as far as staging heeds it."""

import pytest

from oodscen.author._staging.told import Told


@pytest.mark.parametrize(
    ("text", "distance_m"),
    [
        ("A box lies 40 m ahead.", 40.0),
        ("A box lies 40m ahead.", 40.0),
        ("A box, 1 metre wide, lies 40 metres ahead.", 1.0),
        ("The car keeps 1.50 m of room.", 1.5),
        ("The road goes on for 1,500 m.", None),
        ("It drives at 12 mph.", None),
        ("Nothing is said.", None),
    ],
)
def test_a_distance_is_read_whole(text: str, distance_m: float | None) -> None:
    told = Told.__new__(Told)
    object.__setattr__(told, "text", text)
    assert told.distance_m == distance_m
