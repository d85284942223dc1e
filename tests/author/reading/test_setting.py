"""Where, when and by whom a text is told, whoever wrote it."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.author._reading.setting import framed, teller


@pytest.mark.parametrize(
    ("text", "before", "ride", "after"),
    [
        ("A sofa is in my lane on the motorway.", (), "", ("on the motorway",)),
        ("A bull crosses a bridge at noon.", (), "", ("on a bridge", "at noon")),
        (
            "On a wet night, ego drives along an icy street when a bus spins.",
            ("on a wet night",),
            "ego drives along a street",
            (),
        ),
        ("Heavy rain floods the underpass.", (), "", ("in the underpass",)),
        ("A car on the side of the road burns.", (), "", ()),
        ("The crossing vehicle ahead runs on.", (), "", ()),
    ],
)
def test_place_and_time_are_found(
    text: str, before: tuple[str, ...], ride: str, after: tuple[str, ...]
) -> None:
    found = framed(text)
    assert set(before) <= set(found.before)
    assert set(after) <= set(found.after)
    assert found.ride == ride


def test_weather_that_is_the_event_is_left_out() -> None:
    assert framed("In dense fog a car stops.", frozenset({"fog"})).text == ""


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("A dog runs towards the ego vehicle.", "the ego vehicle"),
        ("Ego meets a dog.", "ego"),
        ("The ego-vehicle must stop.", "the ego-vehicle"),
        ("A dog runs towards the AV.", "the AV"),
        ("You meet a dog.", "you"),
        ("A dog sits in our lane.", "we"),
        ("A dog sits in my lane.", "I"),
        ("An autonomous vehicle meets a dog.", "the autonomous vehicle"),
        ("A dog sits there.", ""),
    ],
)
def test_whoever_tells_it_is_found(text: str, name: str) -> None:
    assert teller(text) == name


@given(st.text(max_size=200))
def test_any_text_has_a_frame(text: str) -> None:
    assert framed(text) == framed(text)
