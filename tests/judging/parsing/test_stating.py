"""A sentence states an option if all of it does: within a length, with a short place, and of the ego."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._episode import ACTIONS
from oodscen.judging._parsing import read_action
from oodscen.judging._parsing.surroundings import FEW

NAMES = st.sampled_from(ACTIONS).map(lambda action: (action, action.replace("_", " ")))


@given(NAMES, st.integers(0, 16))
def test_a_place_after_an_option_is_short(named, n):
    action, name = named
    said = f"I would {name} behind {' '.join(['box'] * n)}."
    assert (read_action(said, ACTIONS).value == action) is (n <= 8)


@given(NAMES, st.integers(560, 640))
def test_a_sentence_of_more_than_600_characters_states_nothing(named, length):
    filler = "x" * (length - len("I would ? because ."))  # an option counts as one character
    said = f"I would {named[0]} because {filler}."
    assert (read_action(said, ACTIONS).value == named[0]) is (length <= 600)


@given(NAMES, st.integers(0, 9))
def test_a_short_denial_after_a_statement_unsays_it(named, n):
    said = f"I would {named[1]}. {' '.join(['word'] * n)} not."
    assert (read_action(said, ACTIONS).value is None) is (n + 1 < FEW)


@pytest.mark.parametrize(
    ("said", "value"),
    [
        ("The vehicle should stop.", "stop"),
        ("A vehicle is near. The vehicle should stop.", None),
        ("stop\nThe lane is blocked.", "stop"),
        ("The lane is blocked.\nstop", "stop"),
        ("Actions to avoid\nstop", None),
        ("I would stop. The lane is blocked. But not now.", None),
        ("I would stop. But not now. The lane is blocked.", None),
        ("Suppose it is dry. I would stop.", None),
    ],
)
def test_whose_action_it_is_and_what_stands_beside_it(said, value):
    assert read_action(said, ACTIONS).value == value
