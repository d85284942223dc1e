"""Signs that a text is not about driving: numbers alone, and long texts without anything of the road."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.metrics._rarity.subject import is_number, names_road, repeats_word

_PLAIN = st.sampled_from("beat the eggs with sugar until the dough is soft and bake it".split())


@pytest.mark.parametrize(
    "text",
    [
        *("5 km", "once in 3,000 miles", "three thousand two hundred", "12", "1 2 3 car"),
        *("fifty tonnes", "ten metres per second", "twenty mph"),
    ],
)
def test_numbers_and_units_are_no_text(text):
    assert is_number(text)


@given(st.lists(_PLAIN, min_size=1), st.lists(st.integers(0), max_size=20))
def test_a_text_is_a_number_if_it_has_more_numbers_than_words(words, numbers):
    text = " ".join([*map(str, numbers), *words])
    other = [word for word in words if word != "and"]
    assert is_number(text) == (len(other) < len(numbers) or not other)


@given(st.lists(_PLAIN, max_size=5), _PLAIN, st.integers(3, 9))
def test_a_word_three_times_in_a_row_is_repeated_until_others_stand_between(others, word, times):
    said = " ".join([*others, *[word] * times, *others])
    assert repeats_word(said)
    assert not repeats_word(f"{word} lorry bus " * times)
    assert not repeats_word(f"{word} {word} lorry " * times)


@given(st.sampled_from(["very", "far", "so"]), st.integers(3, 5))
def test_emphasis_may_be_repeated(word, times):
    assert not repeats_word(f"{word} " * times + "slow lorry")


@given(st.lists(_PLAIN, min_size=6, max_size=40))
def test_a_text_names_the_road_once_a_road_is_added(words):
    text = " ".join(words)
    assert not names_road(text)
    assert names_road(f"{text} on the road")


@given(st.lists(_PLAIN, max_size=5))
def test_a_label_need_not_name_the_road(words):
    assert names_road(" ".join(words))


@pytest.mark.parametrize(
    "text",
    [
        "A pack of feral dogs sprints over the crosswalk",
        "A large boulder has rolled onto the roadway from the hillside above",
        "A helicopter makes an emergency landing on the interstate",
        "Roadworks crews leave a digger with its arm swung out",
        "A mattress flies off the roof rack of the minivan",
        "Thick smoke from a wildfire drifts over the turnpike at noon",
        "A skateboarder holds on to the back of a delivery robot",
    ],
)
def test_american_roads_and_compounds_of_road_are_named(text):
    assert names_road(text)
