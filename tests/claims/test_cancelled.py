"""Weather is over at the end of a clause, and at work before an object; a compound noun is neither weather nor an hour."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.claims._cancelled import (
    describes_noun,
    is_over,
    is_weather_cancelled,
    names_thing,
    precedes_subject,
)

WEATHER = st.sampled_from(["rain", "heavy snow", "fog", "thick mist", "hail"])
ENDS = st.sampled_from(
    ["", ".", ", and a cow stands ahead", " and the sun shines", " when a cow comes", " - at last", " an hour ago", " now", "; a cow waits"]
)  # fmt: skip
OBJECTS = st.sampled_from(
    [
        "the traffic", "traffic", "all cars", "some cars", "two buses", "a lorry", "oncoming cars", "other vehicles", "pedestrians from crossing",
        "both lanes", "work ahead", "my car", "cyclists", "a roof onto the road",
    ]
)  # fmt: skip


def mention(text: str, words: str) -> re.Match[str]:
    found = re.search(words, text)
    assert found is not None
    return found


@given(
    WEATHER,
    st.sampled_from(["has", "had", "has just", "has finally", ""]),
    st.sampled_from(["stopped", "lifted", "cleared", "passed", "ended"]),
    ENDS,
)
def test_weather_is_over_at_the_end_of_a_clause(weather, has, verb, end):
    text = f"The {weather} {has} {verb}{end}".replace("  ", " ")
    assert is_over(mention(text, weather))
    assert is_weather_cancelled(mention(text, weather))


@given(
    WEATHER,
    st.sampled_from(["has", "has just", ""]),
    st.sampled_from(["stopped", "lifted", "cleared", "passed"]),
    OBJECTS,
)
def test_weather_with_an_object_is_at_work(weather, has, verb, what):
    text = f"The {weather} {has} {verb} {what}.".replace("  ", " ")
    assert not is_weather_cancelled(mention(text, weather))


@given(
    WEATHER,
    st.sampled_from(["is over", "is gone", "has gone", "was over", "is finally over", "is past"]),
    ENDS,
    st.sampled_from(
        [" the road", " a metre deep", " 30 cm deep", " both lanes", " from thin to dense", " on"]
    ),
)
def test_what_is_over_or_gone_is_so_at_the_end_of_a_clause(weather, is_gone, end, more):
    assert is_over(mention(f"The {weather} {is_gone}{end}", weather))
    assert not is_over(mention(f"The {weather} {is_gone}{more}", weather))


@given(WEATHER, st.sampled_from(["in", "amid", "during the", "despite"]), OBJECTS)
def test_weather_around_others_is_not_over(weather, where, what):
    assert not is_over(mention(f"{where} {weather} stopped, {what}", weather))
    assert not is_weather_cancelled(mention(f"{where} {weather} warning lights flash", weather))


@pytest.mark.parametrize(
    "after",
    [
        "ceased", "let up", "has stopped falling", "banks have cleared", "that hid the road has lifted", "or hail has passed", "and the wind have ended", "gives way to sun",
        "stopped in the city", "lifted quickly", "is gone from the road", "has gone by", "blows over", "turned into drizzle",
    ],
)  # fmt: skip
def test_other_words_for_an_end(after):
    assert is_over(mention(f"The rain {after}.", "rain"))


@pytest.mark.parametrize(
    "after",
    ["yesterday", "earlier in the day", "of the night before", "fell two hours ago", "warning ahead"],
)  # fmt: skip
def test_weather_of_another_time_is_cancelled(after):
    assert is_weather_cancelled(mention(f"Rain {after}.", "Rain"))


@pytest.mark.parametrize(
    "after",
    [
        "falls", "blows over the road", "moves on the road", "earlier than usual covers the road", "covers both lanes", "coats roads",
        "lights a lorry", "and cars have stopped", "set in an hour ago", "line both sides of the road",
    ],
)  # fmt: skip
def test_weather_that_is_there_is_not_cancelled(after):
    assert not is_weather_cancelled(mention(f"Snow {after}.", "Snow"))


@pytest.mark.parametrize(
    "name",
    ["snow plough", "fog lights dazzle", "fog light", "rain coat", "rain sensor", "snow machine", "ice cream", "snow fences"],
)  # fmt: skip
def test_a_thing_that_weather_names_is_no_weather(name):
    text = f"A {name} ahead"
    assert is_weather_cancelled(mention(text, name.split()[0]))
    assert not is_over(mention(text, name.split()[0]))


def test_an_hour_names_a_thing():
    assert names_thing(mention("The night vision fails.", "night"))
    assert not names_thing(mention("The night falls.", "night"))


@pytest.mark.parametrize("actor", ["watchman", "crew", "bus", "taxi", "rescue team", "guard"])
def test_an_hour_describes_those_who_work_in_it(actor):
    text = f"A night {actor} stands ahead."
    assert describes_noun(mention(text, "night"))
    assert not precedes_subject(mention(text, "night"))


@pytest.mark.parametrize(
    "subject",
    ["crew members cross", "taxi drivers wait", "train services run", "guards stand", "buses stop", "rescue teams work"],
)  # fmt: skip
@pytest.mark.parametrize("when", ["At night", "During the night", "By night", "In the night"])
def test_those_who_act_at_an_hour_are_a_subject(when, subject):
    text = f"{when} {subject} here."
    assert precedes_subject(mention(text, "night"))
    assert not describes_noun(mention(text, "night"))
