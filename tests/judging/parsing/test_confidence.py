"""A confidence beside prose is no part of the answer; a hedge is none of these."""

import json
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen._words.prose import tidy
from oodscen.data._episode import ACTIONS
from oodscen.judging._parsing import read_action, read_aspect, read_choice, read_named_aspect
from oodscen.judging._parsing.confidence import CONFIDENT, probability, without_confidence
from tests.judging.parsing.shapes import LEAVES

SHARES = st.sampled_from(["4/5", "80 %", "80%", "8/10", "8 out of 10", "80 percent"])
CLAUSES = st.one_of(
    st.tuples(
        st.sampled_from(
            ["Confidence: {}", "confidence {}", "My confidence is {}", "Certainty: {}", "I am {} sure",
             "I'm {} certain", "I'm about {} sure", "I am {} confident"]
        ),
        SHARES,
    ),
    st.tuples(
        st.sampled_from(["Confidence: {}", "**Confidence:** {}", "Confidence level: {}"]),
        st.sampled_from(["0.8", "high", "Very high", "9", "101", "0.2"]),
    ),
).map(lambda parts: parts[0].format(parts[1]))  # fmt: skip
ENDS = st.sampled_from(["", ".", "!"])
STATED = st.sampled_from(
    ["I would {}.", "{}.", "The safest action is to {}.", "The lane is blocked, so I would {}.",
     "I would {} because there is a cow on the road."]
)  # fmt: skip


def beside(answer, clause, end, place):
    """Return an answer with a confidence before or behind it."""
    if place == "before":
        return f"{clause}. {answer}"
    if place == "above":
        return f"{clause}\n{answer}"
    if place == "in brackets":
        return f"{answer.rstrip('.')} ({clause}){end}"
    if place == "below":
        return f"{answer}\n{clause}{end}"
    joint = ", " if place == "behind a comma" else ". "
    return f"{answer.rstrip('.')}{joint}{clause}{end}"


PLACES = st.sampled_from(["before", "above", "below", "behind", "behind a comma", "in brackets"])


@given(st.sampled_from(ACTIONS), STATED, CLAUSES, ENDS, PLACES, st.booleans())
def test_an_action_is_read_beside_a_confidence(action, form, clause, end, place, is_spaced):
    said = form.format(action.replace("_", " ") if is_spaced else action)
    assert read_action(beside(said, clause, end, place), ACTIONS).value == action


@given(st.integers(1, len(LEAVES)), st.booleans(), CLAUSES, ENDS, PLACES)
def test_a_choice_is_read_beside_a_confidence(number, is_label, clause, end, place):
    leaf = list(LEAVES)[number - 1]
    said = f"{LEAVES[leaf] if is_label else number}."
    assert read_choice(beside(said, clause, end, place), LEAVES).value == leaf


ASPECTS = st.sampled_from(["a deer", "a cow on the road", "an overturned lorry", "no driver in the car"])  # fmt: skip


@given(ASPECTS, st.sampled_from(["", "Yes, "]), CLAUSES, st.sampled_from(["", "."]), PLACES)
def test_a_confidence_is_no_part_of_an_aspect(aspect, yes, clause, end, place):
    said = beside(f"{yes}{aspect}.", clause, end, place)
    assert read_named_aspect(said).value == aspect
    if yes:
        found = read_aspect(said).value
        assert (found.is_ood, found.aspect) == (True, aspect)


@given(
    ASPECTS,
    st.tuples(st.sampled_from(["I am {} sure", "I'm about {} sure", "with {} certainty"]), SHARES),
    st.sampled_from(["behind", "behind a comma", "in brackets"]),
)
def test_a_confidence_inside_the_aspect_is_no_part_of_it(aspect, clause, place):
    words = beside(aspect, clause[0].format(clause[1]), "", place)
    for said in (json.dumps({"is_ood": True, "aspect": words}), f"OOD: yes\nAspect: {words}"):
        found = read_aspect(said).value
        assert (found.aspect, found.confidence) == (aspect, 0.8)
        two = f"{said}\nConfidence: 0.6" if "OOD" in said else f'{said[:-1]}, "confidence": 0.6}}'
        assert read_aspect(two).value.confidence is None
    for said in (json.dumps({"aspect": words}), f"Aspect: {words}"):
        assert read_named_aspect(said).value == aspect


@given(ASPECTS, SHARES, PLACES, ENDS)
def test_a_confidence_is_kept_wherever_it_stands(aspect, share, place, end):
    for clause in (f"I am {share} sure", f"Confidence: {share}"):
        found = read_aspect(beside(f"Yes, {aspect}.", clause, end, place)).value
        assert found.confidence == probability(share) == 0.8
        found = read_aspect(beside("No, nothing is unusual.", clause, end, place)).value
        assert (found.is_ood, found.confidence) == (False, 0.8)


HEDGES = [
    "I am 10 % sure", "I am 2/5 sure", "I am not 80 % sure", "I'm less than 50% sure", "I am not sure", "I doubt it",
]  # fmt: skip


@given(st.sampled_from(ACTIONS), STATED, st.sampled_from(HEDGES), ENDS, PLACES)
def test_a_hedge_leaves_an_action_and_a_choice_unreadable(action, form, hedge, end, place):
    assert read_action(beside(form.format(action), hedge, end, place), ACTIONS).value is None
    assert read_choice(beside("2.", hedge, end, place), LEAVES).value is None


@pytest.mark.parametrize(
    "said",
    [
        "Stop? I am 80 % sure.",
        "Not stop. I am 80 % sure.",
        "I would stop if I am 80 % sure.",
        "I would stop when 80 % sure.",
        "I am 80 % sure that the truck should stop.",
        "I would stop. Confidence: 80 % for slow_down.",
        "I would stop. I am 80 % sure. Wait, slow_down.",
        "I would stop. Confidence: 60 %, slow_down: 40 %",
        "I would stop. I am 80 % sure about keep_speed.",
        "stop (60 %), slow_down (40 %)",
        "stop (0.2)\nslow_down (0.8)",
        "!stop. I am 80 % sure.",
        "I am 80 % sure.",
        "Confidence: 4/5",
        "I would stop 80 % of the time.",
        "I am 90 % sure: nobody should stop.",
    ],
)
def test_a_confidence_that_is_taken_out_leaves_nothing_that_was_not_said(said):
    assert read_action(said).value is None


@pytest.mark.parametrize(
    "part", [" ", "\n", ". ", "sure ", "80 % ", "confidence ", "i am ", "(0.8) ", "1", "("]
)
def test_long_aspects_are_read_at_once(part):
    said = json.dumps({"is_ood": True, "aspect": f"a{part * (120_000 // len(part))}b"})
    begun = time.process_time()
    read_aspect(said)
    assert time.process_time() - begun < 4.0


@given(st.text(max_size=60), st.sampled_from([0.0, 0.5]))
def test_words_without_a_confidence_stay_as_they_are(said, least):
    said = tidy(said)
    assert without_confidence(said, least) == said or CONFIDENT.search(said)


@pytest.mark.parametrize("wrapper", ["answer", "result", "final_answer"])
@pytest.mark.parametrize("inside", [True, False])
def test_a_confidence_may_stand_beside_a_wrapper_or_inside(wrapper, inside):
    answer, sure = {"is_ood": True, "aspect": "sofa"}, {"confidence": 0.8}
    text = {wrapper: {**answer, **sure}} if inside else {**sure, "reasoning": "", wrapper: answer}
    found = read_aspect(json.dumps(text)).value
    assert (found.aspect, found.confidence) == ("sofa", 0.8)
    both = {"confidence": 0.6, wrapper: {**answer, **sure}}
    assert read_aspect(json.dumps(both)).value is None
