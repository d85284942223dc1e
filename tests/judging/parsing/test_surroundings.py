"""An object is an answer only as far as the words around it, and the members beside it, let it stand."""

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._episode import ACTIONS
from oodscen.judging._parsing import (
    Detected,
    ParsedAnswer,
    read_action,
    read_aspect,
    read_choice,
    read_named_aspect,
)
from oodscen.judging._parsing.surroundings import FEW, takes_back
from tests.judging.parsing.shapes import LEAVES

AGAINST = r"""
Anything except @|I won't say @|He said: @|e.g. @; my real answer follows|For my part I quote somebody, e.g. @
<!-- @ -->|<!-- Answer: @ -->|/* @ */|/* Answer:\n@ */|// @|# @|-- @|; @|~~@~~|!@|❌ @|@ ❌|@\n❌|@?
<example>@</example>|<example>\n@\n</example>|<quote>@</quote>|@\nThis is the unsafe one.|@\nThat kills somebody.
Draft: @|Old answer: @|Never @|Bad: @|NOT @|not(@)|Do not pick this:\n@|Do not choose this.\n@|Anything but\n\n@
Someone else answered:\n@|The truck: @|The other driver answers @|My instructor's answer: @|The user wants: @
According to the manual: @|The manual says:\n\n```json\n@\n```|Here is a wrong answer:\n```json\n@\n```|Format: @
Here is an example of the format:\n\n```json\n@\n```|For instance:\n@|Schema: @|Placeholder: @|Second best: @
If the road were clear: @|Suppose nobody is there: @|With more room: @|On a dry road: @|Perhaps @|I could say @
I should not say @|Instead of @ I do nothing|Rather than @|Contrary to @|Under no circumstances: @|I disagree with @
Nobody should answer like this.\n@|The answer is not @|The answer isn't\n\n@|What I'd never do:\n\n@|Is it @|Q: @
Is this your answer?\n@|Either @|Neither @ nor anything|As a joke: @|My answer would have been @|It can't be @
@ is what I'd never do|@\nJust kidding|@ (not my answer)|@ // wrong|@\nThe opposite is true|@\nI take it back.
@\n...is what the truck did|@\nsaid the other model.|@ - no|@ NOT|@\nNOT|@\nNot.|@. Not!|@ <- do not|@\n^ wrong
@\n\nThe above is false.|@\n\nIgnore that.|@\nP.S. This is false.|@\nThat was only a test.|@\nIt is dangerous.
@ or maybe not|@, unless the van is close|@ if there is room|@ when the deer moves|@\nOr something else.|@\nOops.
@\nI changed my mind.|@\nScratch that.|@\nForget that.|@\nLies.|@\nAll of what I answer here is a lie.|@\nI lied.
@\nDon't.|@\nDo the opposite.|@\nReverse that.|@ was my first guess|@ = wrong|@ => false|@ != my answer|if x: @
@\nReasoning: the road is free. Wait, no.|@ {"negated": true}|@ {"is_valid": false}|{"wrong": [@]}|{"not": @}
{"answer": @, "negated": true}|{"example": @}|~~My answer: @\nThe lane on the right is wide and dry.~~|Anything except\n\nmy answer: @
@\nIs the lane on the right of the ego wide and dry?
""".strip().replace("\n", "|").replace("\\n", "\n").split("|")  # fmt: skip
"""Answers that hold an object and do not give it as the answer."""

GIVEN = r"""
@|```json\n@\n```|```\n@\n```|~~~\n@\n~~~|Here is my answer: @|Here is my answer:\n\n```json\n@\n```|Answer: @
Final answer: @|**Final Answer:**\n\n@|## Answer\n\n@|**Answer**\n```json\n@\n```|Sure! @|Okay, here it is.\n@
<think>Or {"action": "keep_speed"}? No.</think>@|<answer>@</answer>|<final_answer>\n@\n</final_answer>|@<|im_end|>
The lane is not free, so a change is out of the question.\n\n@|There is no room.\n\nTherefore, the safest choice is:\n@
**Reasoning**\n- A deer is ahead\n- There is no room to the left, and no shoulder either\n\n@|What now? It is simple.\n@
1. A deer is ahead.\n2. There is no room.\n\nMy choice: @|Here is my answer in the requested JSON format:\n\n@
Based on the images, I choose: @|Given the analysis above, my final decision is:\n@|I would choose @ because it is safe.
@\n\nLet me know if you need anything else!|@\nHope this helps!|@\n\nThis action is the safest because the lane is wet.
@\n\nExplanation: the lane to the left is not free.|(@)|"@"|@.|**@**|On second thought: @|Wait, no. Corrected:\n@
""".strip().replace("@<|im_end|>", "@").replace("\n", "|").replace("\\n", "\n").split("|")  # fmt: skip
"""Answers that give an object as the answer, in ways in which models do."""

SHAPES = ("bare", "reasoned", "wide", "confident")


def held(shape: str, **answer: object) -> str:
    if shape == "bare":
        return json.dumps(answer)
    if shape == "confident":
        return json.dumps({**answer, "confidence": 0.9})
    reasoned = {"reasoning": "The lane on the left is not free, if it is a lane.", **answer}
    return json.dumps(reasoned, indent=2 if shape == "wide" else None)


def readings(wrapper: str, shape: str, action: str, leaf: int) -> dict[str, ParsedAnswer[Any]]:
    return {
        "action": read_action(wrapper.replace("@", held(shape, action=action)), ACTIONS),
        "choice": read_choice(wrapper.replace("@", held(shape, choice=leaf)), LEAVES),
        "aspect": read_aspect(wrapper.replace("@", held(shape, is_ood=True, aspect="a deer"))),
        "named": read_named_aspect(wrapper.replace("@", held(shape, aspect="a deer"))),
    }


def are_right(found: dict[str, ParsedAnswer[Any]], action: str, leaf: int) -> bool:
    return [one.value for one in found.values()] == [
        action,
        list(LEAVES)[leaf - 1],
        Detected(True, "a deer", found["aspect"].value and found["aspect"].value.confidence),
        "a deer",
    ]


def test_no_wrapper_is_overlooked():
    for shape in SHAPES:
        assert [
            (one, name)
            for one in AGAINST
            for name, reading in readings(one, shape, "stop", 2).items()
            if reading.outcome != "unparsed"
        ] == []
        assert [w for w in GIVEN if not are_right(readings(w, shape, "stop", 2), "stop", 2)] == []


ASKED = (st.sampled_from(SHAPES), st.sampled_from(ACTIONS), st.integers(1, len(LEAVES)))


@given(st.sampled_from(AGAINST), *ASKED)
def test_an_object_that_the_words_around_it_do_not_give_is_no_answer(wrapper, shape, action, leaf):
    for said in (wrapper, wrapper.replace("@", "```json\n@\n```")):
        found = readings(said, shape, action, leaf).values()
        assert {(one.value, one.outcome) for one in found} == {(None, "unparsed")}


@given(st.sampled_from(GIVEN), *ASKED)
def test_an_object_in_the_wrapping_of_a_model_is_its_answer(wrapper, shape, action, leaf):
    assert are_right(readings(wrapper, shape, action, leaf), action, leaf)


ANNULS = st.sampled_from(
    [
        {"negated": True}, {"valid": False}, {"is_answer": False}, {"not": 1}, {"status": "rejected"},
        {"truth": "false"}, {"verdict": "wrong"}, {"comment": "just kidding"}, {"note": "This is not my answer."},
        {"remark": "The road is wet. I would not pick this."}, {"meta": {"negated": True}}, {"flags": [True]},
        {"kind": ["an example"]}, {"meta": [{"deep": {"valid": False}}]}, {"lists": [["a"]]},
    ]
)  # fmt: skip
ADDS = st.sampled_from(
    [
        {"confidence": 1}, {"risk": "high"}, {"step_by_step_reasoning": "The left lane is not free."}, {"id": 7},
        {"notes": 2.5 * 2}, {"scene": "There is no traffic in the lane to the left of the ego vehicle."},
        {"thoughts": ["I could keep the speed", "or wait?"]}, {"details": {"gap": 3.0, "why": "near"}},
    ]
)  # fmt: skip


@given(ANNULS, st.sampled_from(ACTIONS), st.booleans())
def test_a_member_that_puts_the_answer_in_doubt_makes_it_none(beside, action, is_first):
    for answer in ({"action": action}, {"answer": {"action": action}}, {"action": {"id": action}}):
        said = {**beside, **answer} if is_first else {**answer, **beside}
        assert read_action(json.dumps(said), ACTIONS).outcome == "unparsed"
    inner = {"action": {"name": action, **beside}}
    assert read_action(json.dumps(inner), ACTIONS).outcome == "unparsed"
    assert read_action(json.dumps({"answer": {"action": action, **beside}}), ACTIONS).value is None
    detected = {"is_ood": True, "aspect": "a deer", **beside}
    assert read_aspect(json.dumps(detected)).outcome == "unparsed"


@given(ADDS, st.sampled_from(ACTIONS))
def test_other_members_change_nothing(beside, action):
    if "notes" not in beside:
        assert read_action(json.dumps({**beside, "action": action}), ACTIONS).value == action
        found = read_aspect(json.dumps({**beside, "is_ood": False})).value
        assert found is not None
        assert not found.is_ood


RULED_OUT = [
    "I must not {0}.", "We should not {0} here.", "I would never {0}.", "It is wrong to {0}.", "I refuse to {0}.",
    "{0} is not the answer.", "{0} would be unsafe.", "The lane is wet. I cannot {0}.", "{0} I will not.",
]  # fmt: skip
WEIGHED = [
    "If I do not {0}, I hit the deer.", "The truck must not {0} there.", "Unless I {0}, it does not end well.",
    "It will not {0}.", "Waiting is not safe because a van is near, so I {0}.", "I choose to {0}.",
]  # fmt: skip


@given(st.sampled_from(RULED_OUT), st.sampled_from(ACTIONS), st.sampled_from(["_", " "]))
def test_an_answer_that_its_own_reasons_rule_out_is_none(form, action, space):
    reasons = form.format(action.replace("_", space))
    for said in ({"action": action, "reasoning": reasons}, {"answer": {"reasons": reasons, "action": action}}):  # fmt: skip
        assert read_action(json.dumps(said), ACTIONS).outcome == "unparsed"
    said = f"{json.dumps({'action': action})}\n\nExplanation: {reasons}"
    assert read_action(said, ACTIONS).outcome == "unparsed"


@given(st.sampled_from(RULED_OUT), st.sampled_from(WEIGHED), st.permutations(ACTIONS))
def test_reasons_may_rule_out_other_options_and_weigh_this_one(out, weighed, actions):
    action, other, *_ = actions
    reasons = f"{out.format(other)} {weighed.format(action)}"
    said = json.dumps({"reasoning": reasons, "action": action})
    assert read_action(said, ACTIONS).value == action


STATED = ["I would {}.", "{}.", "The safest action is {}.", "Answer: {}.", "The lane is blocked, so I would {}."]  # fmt: skip
UNSAID = [
    "I would {} not.", "I would not {}.", "{} I will not.", "I would {} never.", "I would not.", "Psych!",
    "That's a lie.", "This is the unsafe one.", "That would be dangerous.", "It is not what I do.", "Yet I do not.",
    "Still, I don't.", "Forget it.", "I would do no such thing.", "I'd do anything else.", "Anything else.",
    "Never.", "Alas, no room.", "I changed my mind.", "Just kidding.",
]  # fmt: skip


@given(
    st.sampled_from(STATED),
    st.sampled_from(UNSAID),
    st.sampled_from(ACTIONS),
    st.sampled_from(" \n"),
)
def test_a_statement_that_is_unsaid_is_no_answer(stated, unsaid, action, space):  # fmt: skip
    name = action.replace("_", " ")
    assert read_action(stated.format(name), ACTIONS).value == action
    said = f"{stated.format(name)}{space}{unsaid.format(name)}"
    assert read_action(said, ACTIONS).outcome == "unparsed"


@pytest.mark.parametrize(
    "said",
    [
        "I would slow down to a stop.",
        "Slow to a stop.",
        "I would stop. I would stop not.",
        "e.g. stop",
        "For example:\nstop",
        '{"action": "slow down to a stop"}',
        '{"action": {"name": "stop", "negated": true}}',
        '{"action": "stop", "reasoning": "I must not stop"}',
        '{"action": "stop"} {"action": "slow_down"} and neither counts',
        '<!-- {"action": "slow_down"} {"action": "stop"} -->',
        'First of all: no.\n<example>{"action": "slow_down"} {"action": "stop"}</example>',
    ],
)
def test_what_names_two_or_takes_one_back_is_asked_again(said):
    assert read_action(said, ACTIONS).outcome == "unparsed"


@pytest.mark.parametrize(
    "said",
    [
        "**Stop**", "(c) stop", "(C) Stop", "c) stop", "3. stop", "Final answer: stop", "**Final Answer:** stop",
        '<!-- note -->{"action": "stop"}', '/* note */\n{"action": "stop"}', '<b>So</b>: {"action": "stop"}',
        "~~slow_down~~ I would stop.", '~~x~~ {"action": "stop"}',
    ],
)  # fmt: skip
def test_marks_that_have_ended_change_nothing(said):
    assert read_action(said, ACTIONS).value == "stop"


@given(st.integers(1, 2 * FEW))
def test_a_short_remark_may_be_about_the_answer_and_a_long_one_must_deny_it(n):
    assert takes_back(" ".join(["word"] * n)) is (n <= FEW)
    assert takes_back(" ".join(["word"] * n) + " not so")
    assert not takes_back("")
    before = " ".join(["word"] * n)
    said = f'{before} not.\n{{"action": "stop"}}'
    assert (read_action(said, ACTIONS).value is None) is (n < FEW)
