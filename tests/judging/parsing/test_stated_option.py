"""Prose states an option if each sentence is a statement of it, or an observation of the road."""

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from oodscen.data._episode import ACTIONS
from oodscen.judging._parsing import read_action

NAMES = st.sampled_from(ACTIONS).map(lambda action: (action, action.replace("_", " ")))


@example(("stop", "stop"), 400)
@example(("stop", "stop"), 401)
@given(NAMES, st.integers(360, 440))
def test_a_sentence_of_more_than_400_characters_states_nothing(named, length):
    filler = "road " + "x" * (
        length - len("I would ? because road .")
    )  # an option is one character
    said = f"I would {named[0]} because {filler}."
    assert (read_action(said, ACTIONS).value == named[0]) is (length <= 400)


OBSERVED = st.sampled_from(
    ["The lane is blocked.", "There is a cow on the road.", "I see two cars ahead.", "A person is in our lane.",
     "It is dark and the road is wet.", "There is no traffic.", "Several people are crossing the street."]
)  # fmt: skip
SAID = st.sampled_from(
    ["Everybody dies.", "That would be fatal.", "Wait.", "I did.", "Not on this road.", "What a road!", "Is the road wet?",
     "If the road is wet.", "The officer on the road says so.", "The truck should wait.", "Alas, no room.", "Psych!",
     "Suppose the road is dry.", "It is not my answer.", "Actually, the road is free.", "Hope this helps."]
)  # fmt: skip
STATED = st.sampled_from(
    ["I would {}.", "{}.", "The safest action is {}.", "The lane is blocked, so I would {}."]
)


@given(OBSERVED, STATED, OBSERVED, NAMES, st.sampled_from(" \n"))
def test_observations_may_stand_beside_a_statement(before, form, after, named, space):
    said = space.join([before, form.format(named[1]), after])
    assert read_action(said, ACTIONS).value == named[0]


@given(SAID, STATED, NAMES, st.booleans(), st.sampled_from(" \n"))
def test_any_other_sentence_makes_it_unreadable(other, form, named, is_first, space):
    parts = [form.format(named[1]), other]
    said = space.join(reversed(parts) if is_first else parts)
    assert read_action(said, ACTIONS).value is None


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
        ("Stopping.", "stop"),
        ("The truck is ahead. Stopping.", None),
        ("I would stop behind the truck.", "stop"),
        ("I would stop so that the road is clear.", "stop"),
        ("I would stop so that they pass on the road.", None),
        ("I would stop; the lane is blocked.", "stop"),
        ("The lane is blocked; I would stop.", "stop"),
        ("stop; the lane is blocked", "stop"),
        ("I would stop; keep speed;", None),
        ("I would change lane left. The right lane is safer.", None),
        ("I would stop. The shoulder is better.", None),
        ("I would stop behind schedule.", None),
    ],
)
def test_whose_action_it_is_and_what_stands_beside_it(said, value):
    assert read_action(said, ACTIONS).value == value


@pytest.mark.parametrize(
    "user",
    ["The lorry is", "The lorries are", "Two buses are", "A bus is", "The tram is", "An ambulance is", "A taxi is",
     "Three trucks are", "The coaches are", "A motorbike is", "A fire engine is"],
)  # fmt: skip
def test_the_vehicle_is_not_the_ego_beside_another_one(user):
    assert read_action(f"{user} on the road. The vehicle should stop.", ACTIONS).value is None
    assert read_action(f"{user} on the road. The ego vehicle should stop.", ACTIONS).value == "stop"
