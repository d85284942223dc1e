"""A choice is the option of a number or of a label, and never one that is not there."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._episode import ACTIONS
from oodscen.judging._parsing import contradiction, read_action, read_choice

LABELS = {f"leaf-{n}": "Deer" + " on the road" * (n % 2) + f" of kind {'xyz'[n % 3]}" * (n > 1) for n in range(5)}  # fmt: skip
FORMS = st.sampled_from(["{}", "{}.", "Option {}", "The answer is {}.", "({})", "My choice: {}", '{{"choice": "{}"}}'])  # fmt: skip


@given(st.integers(-3, 12), FORMS)
def test_a_number_is_an_option_only_if_it_was_offered(number, form):
    wanted = f"leaf-{number - 1}" if 1 <= number <= len(LABELS) else None
    assert read_choice(form.format(number), LABELS).value == wanted
    assert read_choice(json.dumps({"choice": number}), LABELS).value == wanted
    assert read_choice(json.dumps({"choice": [number]}), LABELS).value == wanted
    assert read_choice(json.dumps({"choice": float(number)}), LABELS).value == wanted
    assert read_choice(json.dumps({"choice": number + 0.5}), LABELS).value is None


@given(st.sampled_from(sorted(LABELS)), FORMS)
def test_a_label_that_begins_another_is_not_taken_for_it(name, form):
    assert read_choice(form.format(LABELS[name]), LABELS).value == name


@given(
    st.lists(st.sampled_from(("go", "go left", "go_left_now", "turn back", *ACTIONS)), min_size=1)
)
def test_every_offered_action_reads_as_itself_however_often_and_in_whatever_order(offered):
    for action in offered:
        assert read_action(json.dumps({"action": action}), offered).value == action


@given(st.permutations(ACTIONS), st.integers(2, 4))
def test_two_values_are_no_choice_in_whatever_structure(actions, n):
    first, second, *_ = actions
    several = [first] * (n - 1) + [second]
    for held in (
        several,
        {"id": first, "name": second},
        {"id": "?", "name": first},
        [[first, second]],
    ):
        assert read_action(json.dumps({"action": held}), ACTIONS).outcome == "unparsed"
    assert read_action(json.dumps({"action": first, "answer": second}), ACTIONS).value is None
    assert read_action(json.dumps({"action": True}), ACTIONS).value is None
    assert read_choice(json.dumps({"choice": True}), LABELS).value is None


@given(st.permutations(ACTIONS))
def test_reasons_contradict_only_another_action(actions):
    first, second, *_ = actions
    assert contradiction(f"I would {first}.", first, ACTIONS) == ""
    found = contradiction(f"I would {first}.", second, ACTIONS)
    assert first in found
    assert second in found


@given(st.sampled_from(ACTIONS))
def test_a_refusal_in_the_member_is_no_choice(action):
    said = f"I cannot help with that. {action}"
    assert read_action(json.dumps({"action": said}), ACTIONS).value is None


@given(
    st.sampled_from(
        ["Continue", "continue", "I would continue", "We should continue", "Keeps its speed"]
    ),
    st.sampled_from(["", ".", "!", ". The road ahead is clear."]),
)
def test_going_on_is_keeping_the_speed(said: str, end: str) -> None:
    assert read_action(f"{said}{end}").value == "keep_speed"


@pytest.mark.parametrize(
    "said",
    [
        "The truck should continue.",
        "Do not continue.",
        "I would stop and then continue.",
        "I would continue to brake.",
        "Continue?",
        "I cannot continue.",
        "The car ahead keeps its speed.",
        "The lorry will continue. I would stop.",
    ],
)
def test_going_on_is_no_answer_of_others_or_in_doubt(said: str) -> None:
    assert read_action(said).value is None


@pytest.mark.parametrize(
    "stated", ["8/10", "80 percent", "50/50", "certain", "fairly high", "Very-High", "~0.8", 1e-5, 0.9, 7, "7", None]
)  # fmt: skip
def test_a_confidence_may_stand_beside_any_answer(stated):
    said = json.dumps({"action": "stop", "confidence": stated})
    assert read_action(said, ACTIONS).value == "stop"
    if isinstance(stated, str):
        assert read_action(f"Action: stop\nConfidence: {stated}", ACTIONS).value == "stop"


@pytest.mark.parametrize("stated", ["keep_speed", "not stop", [0.9], True, {"value": 0.9}])
def test_what_is_no_confidence_is_another_member(stated):
    assert read_action(json.dumps({"action": "stop", "confidence": stated}), ACTIONS).value is None
    inner = {"name": "stop", "confidence": stated}
    assert read_action(json.dumps({"action": inner}), ACTIONS).value is None
