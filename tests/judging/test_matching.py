"""The documented matcher of open answers: lenient in words, strict in content."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.judging.matching import names_aspect


@pytest.mark.parametrize(
    ("aspect", "label", "is_right"),
    [
        ("a flipped car", "Overturned vehicle ahead", True),
        ("dense mist", "Thick fog at night with a vehicle ahead", True),
        ("a crate in the lane", "Large cardboard box on the road", True),
        ("a stag", "Deer on the road", True),
        ("a demonstration", "Large group of people (parade, protest)", True),
        ("no deer, only a box", "Deer on the road", False),
        ("a vehicle ahead", "Overturned vehicle ahead", False),
        ("fog, snow, deer, box, parade, police, tree, wreck", "Deer on the road", False),
        ("", "Deer on the road", False),
    ],
)
def test_other_words_for_the_same_count_and_other_things_do_not(aspect, label, is_right):
    assert names_aspect(aspect, ("OOD", label)) is is_right


@given(st.text(min_size=1).filter(str.strip), st.sampled_from([str.upper, str.title, str]))
def test_the_label_itself_is_always_right(label, spelling):
    if label.casefold() == spelling(label).casefold():
        assert names_aspect(spelling(label), ("OOD", label))


def test_a_label_that_denies_something_is_right_too():
    for label in (
        "Parked car pulling out without looking",
        "A car, a van, no light, a dog, x, y, z",
    ):
        assert names_aspect(label.lower(), ("OOD", label))
