"""Signs that a text is not about driving: numbers alone, and long texts without anything of the road."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.metrics._rarity.subject import is_number, names_road

_PLAIN = st.sampled_from("beat the eggs with sugar until the dough is soft and bake it".split())


@pytest.mark.parametrize(
    "text", ["5 km", "once in 3,000 miles", "three thousand two hundred", "12"]
)
def test_numbers_and_units_are_no_text(text):
    assert is_number(text)


@given(st.text())
def test_a_text_that_names_a_car_is_no_number(text):
    assert not is_number(f"car {text}")


@given(st.lists(_PLAIN, min_size=6, max_size=40))
def test_a_text_names_the_road_once_a_road_is_added(words):
    text = " ".join(words)
    assert not names_road(text)
    assert names_road(f"{text} on the road")


@given(st.lists(_PLAIN, max_size=5))
def test_a_label_need_not_name_the_road(words):
    assert names_road(" ".join(words))
