"""Answers are read as a person would read them, whatever their shape; none raises."""

import json
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.episode import ACTIONS
from oodscen.judging.answers import (
    contradiction,
    is_refusal,
    read_action,
    read_aspect,
    read_choice,
    read_description,
)
from oodscen.judging.wording import Mention, longest
from tests.judging.shapes import (
    ACTIONS_SAID,
    CHOICES_SAID,
    DETECTIONS_SAID,
    LEAVES,
    REFUSED,
)


def test_the_table_has_real_variety():
    texts = {text for text, *_ in (*ACTIONS_SAID, *DETECTIONS_SAID, *CHOICES_SAID)}
    assert len(texts) >= 500
    assert len({text for text, _ in ACTIONS_SAID}) == len(ACTIONS_SAID)


@pytest.mark.parametrize(("text", "expected"), ACTIONS_SAID, ids=lambda value: repr(value)[:40])
def test_an_action_is_read_as_a_person_would(text, expected):
    reading = read_action(text, ACTIONS)
    assert (REFUSED if reading.outcome == "refused" else reading.value) == expected, reading.note
    assert (reading.value is not None) == (reading.outcome == "answered")
    assert reading.note


@pytest.mark.parametrize(("text", "is_ood", "aspect", "confidence"), DETECTIONS_SAID)
def test_a_detection_is_read_as_a_person_would(text, is_ood, aspect, confidence):
    reading = read_aspect(text)
    if reading.value is None:
        assert (REFUSED if reading.outcome == "refused" else None) == is_ood
    else:
        assert reading.value.is_ood is is_ood
        assert aspect in reading.value.aspect
        assert reading.value.confidence == pytest.approx(confidence) or confidence is None


@pytest.mark.parametrize(("text", "expected"), CHOICES_SAID)
def test_a_choice_is_read_as_a_person_would(text, expected):
    reading = read_choice(text, LEAVES)
    assert (REFUSED if reading.outcome == "refused" else reading.value) == expected, reading.note


def test_a_description_may_be_prose_but_not_a_refusal():
    assert read_description('{"description": "A road."}').value == "A road."
    assert read_description("<think>hm</think>A wet road at night.").value == "A wet road at night."
    assert read_description("I'm sorry, I can't help.").outcome == "refused"
    assert read_description("...").outcome == "unparsed"


@pytest.mark.parametrize(
    ("reasoning", "action", "found"),
    [
        ("The lane is blocked, so I would stop.", "keep_speed", "settles on stop"),
        ("Stopping is too late. Therefore emergency_brake.", "emergency_brake", ""),
        ("I would not stop here.", "stop", "rejects stop"),
        ("The van may stop. Or the deer may run.", "slow_down", ""),
        ("", "stop", ""),
    ],
)
def test_reasoning_that_settles_on_something_else_is_noted(reasoning, action, found):
    note = contradiction(reasoning, action, ACTIONS)
    assert (found in note) if found else not note


WORDS = st.sampled_from(
    'stop not or { } "action" : , <think> </think> answer slow_down wait, 3 A. yes no unusual ``` \n ? sorry [ ] is'.split(
        " "
    )
)
MESS = st.one_of(
    st.text(max_size=200),
    st.lists(WORDS, max_size=30).map(" ".join),
    st.recursive(
        st.none() | st.booleans() | st.floats() | st.text(max_size=8) | st.integers(),
        lambda inner: (
            st.lists(inner, max_size=3)
            | st.dictionaries(
                st.sampled_from(["action", "choice", "is_ood", "x"]), inner, max_size=3
            )
        ),
        max_leaves=6,
    ).map(json.dumps),
)


@settings(max_examples=150, deadline=None)
@given(MESS)
def test_no_answer_raises_and_what_is_read_was_offered(text):
    action = read_action(text, ACTIONS)
    assert action.value is None or action.value in ACTIONS
    choice = read_choice(text, LEAVES)
    assert choice.value is None or choice.value in LEAVES
    seen = read_aspect(text).value
    assert seen is None or seen.confidence is None or 0 <= seen.confidence <= 1
    read_description(text)
    contradiction(text, "stop", ACTIONS)
    is_refusal(text)


@given(
    st.sampled_from(ACTIONS), st.sampled_from(["{}", "**{}**", "Answer: {}", '{{"action": "{}"}}'])
)
def test_every_action_is_read_by_its_id(action, shape):
    assert read_action(shape.format(action), ACTIONS).value == action


def test_a_megabyte_is_no_answer_and_costs_nothing():
    for text in ("stop " * 250_000, "{" * 1_000_000, '{"action": "' + "a" * 1_000_000):
        assert read_action(text, ACTIONS).outcome == "unparsed"
    assert read_action("not " * 40_000 + "stop", ACTIONS).outcome in ("answered", "unparsed")


SPANS = st.lists(
    st.builds(
        lambda start, width, option: Mention(start, start + width, option),
        st.integers(0, 40),
        st.integers(1, 9),
        st.sampled_from("abc"),
    ),
    max_size=12,
)


@given(SPANS)
def test_of_mentions_that_overlap_the_longest_stays(found):
    kept = longest(found)
    assert kept == sorted(kept)
    assert all(one.end <= other.start for one, other in pairwise(kept))
    for one in found:
        over = [o for o in kept if o.start < one.end and one.start < o.end]
        assert any(o.end - o.start >= one.end - one.start for o in over)
