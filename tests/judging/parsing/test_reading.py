"""What counts as said: JSON before prose, nothing from reasoning, nothing that is cut off or disputed."""

import json
import re
from dataclasses import FrozenInstanceError

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from oodscen.data._episode import ACTIONS
from oodscen.errors import UsageError
from oodscen.judging._parsing import (
    contradiction,
    is_refusal,
    read_action,
    read_aspect,
    read_choice,
    read_description,
    read_named_aspect,
)
from oodscen.judging._parsing.members import (
    CONFIDENCE,
    REASON,
    WRAPPERS,
    is_placeholder,
    members,
    spelt,
    unwrap,
    words_in,
)
from oodscen.judging._parsing.reading import ParsedAnswer, Question
from oodscen.judging._parsing.unusable import LONGEST, UnusableError
from oodscen.llm._json_objects import Members
from oodscen.llm._reading import EMPTY, UNSPOKEN
from tests.judging.parsing.shapes import LEAVES

WORDS = st.sampled_from(
    'stop not or { } "action" : , <think> </think> answer slow_down wait, 3 A. yes no unusual ``` \n ? sorry [ ] is \ue003'.split(
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


@given(MESS)
def test_no_answer_raises_and_what_is_read_was_offered(text):
    for reading, known in (
        (read_action(text, ACTIONS), ACTIONS),
        (read_choice(text, LEAVES), LEAVES),
    ):
        assert (reading.value is None) == (reading.outcome != "answered")
        assert reading.value is None or reading.value in known
        assert reading.note
    seen = read_aspect(text).value
    assert seen is None or seen.confidence is None or 0 <= seen.confidence <= 1
    read_named_aspect(text)
    read_description(text)
    contradiction(text, "stop", ACTIONS)
    is_refusal(text)


@pytest.mark.parametrize(
    ("said", "note"),
    [
        ("", EMPTY.message),
        (" \n", EMPTY.message),
        ("<think>I would stop.</think>", UNSPOKEN.message),
        ("Hm.", "no answer is named plainly"),
        ("<think>I would stop.</think> Hm.", "no answer is named plainly"),
    ],
)
def test_the_note_says_if_nothing_was_said(said, note):
    reading = read_action(said, ACTIONS)
    assert (reading.outcome, reading.note) == ("unparsed", note)


@pytest.mark.parametrize("said", [None, 3, b"stop", ["stop"]])
def test_an_answer_that_is_no_text_is_refused(said):
    for read in (read_aspect, read_description, lambda text: read_action(text, ACTIONS)):
        with pytest.raises(UsageError):
            read(said)


@pytest.mark.parametrize(
    "said",
    [
        '{"reasoning": "two signs, “, ”ahead: ", "action": "stop"}',
        "{“reasoning”: “It's // wet”, “action”: “stop”}",
    ],
)
def test_curly_quotation_marks_stand_for_straight_ones_only_where_there_are_none(said):
    found = read_action(said, ACTIONS)
    assert (found.value, found.note) == ("stop", "JSON")


def test_a_list_of_reasons_holds_texts_only():
    for reasons, value in ((["It is wet.", "Stop."], "stop"), (["It is wet.", 3], None)):
        said = json.dumps({"reasoning": reasons, "action": "stop"})
        assert read_action(said, ACTIONS).value == value


NOISE = st.text(
    st.characters(codec="utf-8", categories=["L", "N", "Zs"]) | st.sampled_from("\n.,!"),
    max_size=80,
)


@given(st.sampled_from(ACTIONS), NOISE, NOISE, st.sampled_from(["{}", "\n```json\n{}\n```\n"]))
def test_noise_around_an_object_changes_nothing(action, before, after, fence):
    said = json.dumps({"reasoning": "x", "action": action})
    reading = read_action(f"{before}.\n{fence.format(said)}\n.{after}", ACTIONS)
    assert (reading.value, reading.note) in ((action, "JSON"), (None, reading.note))
    assert reading.value == action or reading.note != "no answer is named plainly"


@settings(max_examples=25)
@given(st.sampled_from(ACTIONS), st.sampled_from(ACTIONS), st.sampled_from(["think", "reasoning"]))
def test_an_answer_in_the_reasoning_is_not_the_answer(thought, action, tag):
    for said in (thought, f'{{"action": "{thought}"}}', f"I would {thought}."):
        thinking = f"<{tag}>{said}</{tag}>"
        assert read_action(thinking, ACTIONS).outcome == "unparsed"
        assert read_action(f"<{tag}>{said}", ACTIONS).outcome == "unparsed"
        assert read_action(f"{thinking}\n{action}", ACTIONS).value == action
        assert read_action(f'{thinking}{{"action": "{action}"}}', ACTIONS).value == action
        assert read_action(f'{{"action": "{action}"}}{thinking}', ACTIONS).value is None
        assert read_action(f"{action}{thinking}", ACTIONS).value is None
        assert read_action(f"{said}</{tag}>{action}", ACTIONS).value == action
        assert read_action(f"{said}{thinking}{said}</{tag}>{action}", ACTIONS).value is None
        assert read_action(f"{thinking}{said}</{tag}>{action}", ACTIONS).value == action
        quoted = json.dumps(f'{thinking}{{"action": "{action}"}}')
        for one in (quoted, quoted.replace("<", "\\u003c")):
            assert read_action(one, ACTIONS).value == action


@given(
    st.sampled_from(["stop", "I would slow_down.", "Not stop.", "If wet, stop.", '{"action": "pull_over"}']),
    st.sampled_from(["", " ", "\n", "\t\n ", "\u200b"]),
    st.sampled_from([str, str.upper, str.title]),
)  # fmt: skip
def test_case_and_white_space_change_nothing(said, space, cased):
    read = read_action(f"{space}{cased(said)}{space}", ACTIONS)
    assert (read.value, read.outcome) == (read_action(said, ACTIONS).value, read_action(said, ACTIONS).outcome)  # fmt: skip


@pytest.mark.parametrize(
    ("said", "value"),
    [
        ('{"action": "stop"}', "stop"),
        ('"{\\"action\\": \\"stop\\"}"', "stop"),
        ('{"result": {"action": ["stop"]}}', "stop"),
        ('{"action": "stop"}<|im_end|>', "stop"),
        ("stop<|im_end|>", "stop"),
        ('{"action": "stop", "action": "stop"}', "stop"),
        ('"{\\"action\\":\n\\"stop\\"}"', "stop"),
        ('{action: "stop", reasoning: "die Straße ist glätter"}', "stop"),
        # two objects, two values, a value that is none, an end that is missing: prose does not help
        ('{"action": "stop"} {"action": "stop"}', None),
        ('{"reasoning": "no room"}\nAnswer: stop', None),
        ('{"action": "stop", "action": "slow_down"}', None),
        ('{"action": "stop", "reasoning": "wet", "reasoning": "dry"}', None),
        ('{"action": "stop", "speed": 1, "action": "slow_down", "speed": 2}', None),
        ('{"action": "stop"} {"action": "slow_down"}', None),
        ('{"action": "stop"} {"action": "slow_down"} {"action": "stop"}', None),
        ('{"action": "stop"} {"action": ""}', None),
        ('{"action": ""}\nAnswer: stop', None),
        ('{"action": "stop"', None),
        ('{"action": "stop"} {"action": "slow', None),
        ('{"action": "stop" or "slow_down"}', None),
        ('{"action": "stop"}\nWait, that is wrong.', None),
        ('Not {"action": "stop"}.', None),
    ],
)
def test_the_only_whole_object_counts_with_the_member_that_was_asked_for(said, value):
    assert read_action(said, ACTIONS).value == value


def test_long_prose_is_read_to_its_end():
    for seen in ("It is dark.", "It is foggy and it is night.", "It is snowing."):
        assert read_action(f"{seen} I would stop.", ACTIONS).value == "stop"
    assert read_action("It is dark, so I would stop.", ACTIONS).value == "stop"
    assert read_action("The road is wet. " * 5_000 + "I would stop.", ACTIONS).value == "stop"
    assert read_action("stop. " + "The road is wet. " * 5_000 + "Wait, no.", ACTIONS).value is None


HARD = [
    "stop ", "{", "not ", "i would ", "the best ", "(", "so ", "1. ", "<think>", "<a>", "</think>", "~", "$", "\n",
    "stop\n", "a:\n", "reason: \n", "'", '"', "if ", "\\text{", "stop. ", "0", "answer: 1 ", "yes ", "aspect: ",
    "no anything ", "{a:", "so " * 120 + "stop x. ", "confidence ", "stop would ", "keep the lane and ", "given ", "answer\n", "{'a':1}",
    '{"action":"stop"}', '{"action":"stop" ', "slow down to a ", "deer on the road ", "\ud800",
]  # fmt: skip


@pytest.mark.parametrize("part", HARD)
def test_no_answer_takes_long(part):
    text = (part * LONGEST)[: LONGEST // 16]
    read_action(text, ACTIONS)
    shorter = f"{text[: LONGEST // 80]}stop."
    read_choice(shorter, LEAVES)
    read_aspect(shorter)
    read_named_aspect(shorter)
    read_description(shorter)
    contradiction(shorter, "stop", ACTIONS)


def test_longer_answers_are_not_read():
    assert read_action("stop" + " " * (LONGEST - 4), ACTIONS).value == "stop"
    assert read_action("stop" + " " * (LONGEST - 3), ACTIONS).outcome == "unparsed"


@given(st.permutations(ACTIONS), st.integers(1, 9))
def test_wrappers_are_opened_and_hide_nothing(actions, depth):
    first, second, *_ = actions
    one, two = {"action": first}, {"action": second}
    assert read_action(json.dumps({"answer": one}), ACTIONS).value == first
    for said in (
        {"answer": one, "result": two},
        {"result": two, "answer": one},
        {**one, "data": two},
    ):
        assert read_action(json.dumps(said), ACTIONS).outcome == "unparsed"
    hidden = nested({"negated": True}, depth)
    assert read_action(json.dumps({**one, **hidden}), ACTIONS).outcome == "unparsed"


@given(st.permutations(ACTIONS))
def test_words_and_objects_beside_an_object_make_it_unreadable(actions):
    first, second, *_ = actions
    said = json.dumps({"action": first})
    names = second.replace("_", " ")
    for after in (f"{said}\nThe driver behind the ego will {names} as well.", f"{said} {said}"):
        assert read_action(after, ACTIONS).outcome == "unparsed"


@pytest.mark.parametrize(
    ("said", "is_one"),
    [
        ("I cannot help with that.", True),
        ("I'm sorry, but I can\u2019t assist with this request.", True),
        ("As an AI language model, I am not able to make driving decisions.", True),
        ("I must decline.", True),
        ("I cannot view images.", True),
        ("I don't see any images attached.", True),
        ("I refuse to stop.", False),
        ("I would not choose that option.", False),
        ("I do not recommend stopping.", False),
        ("I cannot help but stop.", False),
        ("I cannot see the end of the queue in these frames.", False),
        ("I do not know the answer.", False),
        ("<think>I cannot help with that.</think>stop", False),
    ],
)
def test_a_refusal_is_told_from_a_denial(said, is_one):
    assert is_refusal(said) is is_one
    assert (read_action(said, ACTIONS).outcome == "refused") is is_one


@pytest.mark.parametrize(
    "name", ["reasoning", "reason", "Explanation", "step_by_step_reasoning", "why"]
)
@pytest.mark.parametrize(
    "form",
    [
        '{{"action": "stop", "{}": "It is wet."}}',
        '<think>x</think>{{"{}": ["It is wet."], "action": "stop"}}',
        '{{"answer": {{"action": "stop", "{}": "It is wet."}}}}',
        '{{"answer": {{"action": "stop"}}, "{}": "It is wet."}}',
        "{}: It is wet\nAction: stop",
        "Action: stop. {}: It is wet",
    ],
)  # fmt: skip
def test_reasons_are_given_however_they_are_named(form, name):
    assert read_action(form.format(name), ACTIONS).reasons.strip(".") == "It is wet"


def test_reasons_are_all_that_is_said_in_a_sentence_and_none_in_a_bare_object():
    assert read_action("<think>x</think>I would stop.").reasons == "I would stop."
    assert read_action('{"action": "stop"}').reasons == ""
    assert read_action("Hm.").reasons == ""


@pytest.mark.parametrize(
    ("reasoning", "action", "found"),
    [
        ("The lane is blocked, so I would stop.", "keep_speed", "settles on stop"),
        ("Stopping is too late. Therefore emergency_brake.", "emergency_brake", ""),
        ("The van may stop. Or the deer may run.", "slow_down", ""),
        ("", "stop", ""),
    ],
)
def test_reasoning_that_settles_on_something_else_is_noted(reasoning, action, found):
    note = contradiction(reasoning, action, ACTIONS)
    assert (found in note) if found else not note


def nested(value, depth, name="meta"):
    """Wrap a value in so many objects."""
    for _ in range(depth):
        value = {name: value}
    return value


ASKED = re.compile("action")


@pytest.mark.parametrize("depth", range(9))
def test_objects_are_looked_into_to_a_depth(depth):
    held = nested({"action": "stop", "reasoning": "wet"}, depth, "answer")
    assert unwrap(held, ASKED) == ({"action": "stop"}, "wet", ())
    assert words_in(nested(" wet ", depth)) == ("wet" if depth <= 3 else "")


SHEETS = {
    "action": (lambda said: read_action(said, ACTIONS), {"action": "stop"}),
    "choice": (lambda said: read_choice(said, LEAVES), {"choice": "1"}),
    "aspect": (read_aspect, {"is_ood": True, "aspect": "a deer"}),
    "named": (read_named_aspect, {"aspect": "a deer"}),
    "description": (read_description, {"description": "A deer on the road."}),
}


@given(
    st.sampled_from(sorted(SHEETS)),
    st.lists(st.sampled_from(["answer", "result", "output", "data", "final_answer"]), max_size=9),
)
def test_up_to_four_wrappers_are_opened_in_every_question(question, names):
    read, held = SHEETS[question]
    plain = read(json.dumps(held)).value
    for name in names:
        held = {name: held}
    found = read(json.dumps(held))
    assert found.value == (plain if len(names) <= 4 else None)
    assert len(names) <= 4 or "deep" in found.note


@given(st.lists(st.sampled_from(["answer", "value", "id", "result", "action", ""]), max_size=9))
def test_a_choice_may_stand_in_four_lists_and_objects(names):
    held = "stop"
    for name in names:
        held = {name: held} if name else [held]
    found = read_action(json.dumps({"action": held}), ACTIONS).value
    assert found is None or (found == "stop" and len(names) <= 4)


COMMENTS = st.sampled_from(["// {}\n", "# {}\n", "/* {} */"])
HARMLESS = [
    "safest",
    "a cow ahead",
    "it's wet",
    "because the lane is blocked",
    "my choice",
    "short",
    "Strasse nass",
]
DISPUTING = [
    "not", "wrong", "or rather wait", "anything but", "maybe", "no!", "the opposite of", "except", "never", "a lie",
    "just kidding", "draft", "rejected", "example", "old answer", "is this true?", "false", "in doubt", "instead:",
]  # fmt: skip


def commented(held, form, words, at):
    """Return an object as JSON with a comment before, behind or between its members."""
    parts = re.split(r"(?<=[{,:])|(?=[},])", json.dumps(held))
    at = min(at, len(parts) - 2)
    return "".join([*parts[: at + 1], " ", form.format(words), *parts[at + 1 :]])


@given(
    st.sampled_from(sorted(SHEETS)),
    COMMENTS,
    st.sampled_from(HARMLESS),
    st.integers(0, 9),
)
def test_comments_in_an_object_are_dropped(question, form, words, at):
    read, held = SHEETS[question]
    said = commented({**held, "reasoning": "x"}, form, words, at)
    assert read(said).value == read(json.dumps(held)).value


@given(
    st.sampled_from(sorted(SHEETS)),
    COMMENTS,
    st.sampled_from(DISPUTING),
    st.integers(0, 9),
)
def test_a_comment_that_may_be_against_the_answer_makes_it_unreadable(question, form, words, at):
    read, held = SHEETS[question]
    assert read(commented({**held, "reasoning": "x"}, form, words, at)).value is None


@given(
    st.permutations(ACTIONS),
    COMMENTS,
    st.sampled_from(["{}", "I would {}", "{} fits as well", '"action": "{}",']),
    st.booleans(),
)
def test_a_comment_may_name_the_answer_and_no_other(actions, form, words, is_spaced):
    first, second, *_ = (name.replace("_", " ") if is_spaced else name for name in actions)
    for name, value in ((first, actions[0]), (second, None)):
        said = commented({"action": actions[0]}, form, words.format(name), 4)
        assert read_action(said, ACTIONS).value == value


@given(st.integers(1, 7), st.sampled_from(["{}", "{}: as listed", "it is {}", "{} fits best"]))
def test_a_comment_may_hold_the_number_of_the_choice_and_no_other(number, words):
    said = f'{{"choice": 4 // {words.format(number)}\n}}'
    assert read_choice(said, LEAVES).value == ("wrong-way" if number == 4 else None)


@pytest.mark.parametrize("words", ["is dangerous", "too risky", "would be fatal", "is forbidden"])
def test_a_comment_that_condemns_the_action_is_against_it(words):
    assert read_action(f'{{"action": "stop" /* {words} */}}', ACTIONS).value is None


CONFIDENT = [8, "8", 101, -1, "-3", "12/10", "0/0", "80-90 %", 1e999, "very high indeed", "banana", "N/A", "...", None, 0.8, "4/5"]  # fmt: skip
NOT_CONFIDENT = [True, [0.9], {"value": 0.9}, "not that", "yes or no", "or false"]


@pytest.mark.parametrize("question", sorted({*SHEETS} - {"description"}))
@pytest.mark.parametrize("name", ["confidence", "Certainty", "probability"])
def test_a_confidence_that_cannot_be_read_counts_as_none_in_every_question(question, name):
    read, held = SHEETS[question]
    plain = read(json.dumps(held)).value
    for stated in CONFIDENT:
        for said in ({**held, name: stated}, {"answer": {**held, name: stated}}):
            assert read(json.dumps(said)).value == plain or stated in (0.8, "4/5"), stated
            assert read(json.dumps(said)).outcome == "answered", stated
    for stated in NOT_CONFIDENT:
        assert read(json.dumps({**held, name: stated})).value is None, stated


@pytest.mark.parametrize(
    ("beside", "inside", "confidence"),
    [
        ({"confidence": None}, {"confidence": 0.8}, 0.8),
        ({"confidence": 0.8}, {"confidence": None}, 0.8),
        ({"confidence": 0.8}, {"confidence": "banana"}, 0.8),
        ({"confidence": 0.8}, {"confidence": "80 %"}, 0.8),
        ({"Certainty": 0.8}, {"confidence": 0.8}, 0.8),
        ({"confidence": 0.9}, {"confidence": 0.8}, "two answers"),
        ({"Confidence": 0.9}, {"confidence": 0.8}, "two answers"),
    ],
)
def test_a_confidence_beside_a_wrapper_is_that_in_it(beside, inside, confidence):
    said = {**beside, "answer": {"is_ood": True, "aspect": "a deer", **inside}}
    answer = read_aspect(json.dumps(said))
    assert (answer.value.confidence if answer.value else answer.note) == confidence


NEUTRAL = [
    {"confidence": 1}, {"confidence": 0.8}, {"certainty": "80 %"}, {"confidence": "Very high"}, {"confidence": None},
    {"reasoning": "wet"}, {"step_by_step_reasoning": "wet"}, {"Thoughts": ["wet", "dark"]}, {"why": ""}, {"analysis": None},
]  # fmt: skip


@pytest.mark.parametrize("beside", NEUTRAL)
@pytest.mark.parametrize("action", ACTIONS)
def test_reasons_and_a_confidence_may_stand_beside_an_answer(beside, action):
    for said in ({**beside, "action": action}, {"answer": {"action": action}, **beside}):
        assert read_action(json.dumps(said), ACTIONS).value == action


@given(
    st.text(min_size=1, max_size=12), st.sampled_from([True, 0, "yes", "", None, ["a"], {"a": 1}])
)
def test_any_other_member_makes_it_unreadable(name, held):
    assume(not any(one.fullmatch(spelt(name)) for one in (REASON, CONFIDENCE, WRAPPERS)))
    assume(not any(word in spelt(name) for word in ("action", "answer", "choice", "option")))
    for said in ({name: held, "action": "stop"}, {"answer": {"action": "stop"}, name: held}):
        assert read_action(json.dumps(said), ACTIONS).outcome == "unparsed"
    detected = {"is_ood": True, "aspect": "a deer", name: held}
    assume(not re.search("ood|aspect|what|label|unusual|anomal|normal", spelt(name)))
    assert read_aspect(json.dumps(detected)).outcome == "unparsed"


def test_reasons_are_those_of_the_object_and_of_what_it_wraps():
    value = {"reasons": ["wet", "icy"], "answer": {"rationale": "dark", "action": "stop"}}
    assert unwrap(value, ASKED) == ({"action": "stop"}, "wet\nicy\ndark", ())
    assert words_in((" a ", "", 3, ["b"])) == "a; b"
    assert words_in(3) == ""


def test_members_are_found_however_they_are_spelt_and_once():
    assert members({"The Action": 1, "ACTION_": 2, "x": 3}, re.compile("(the)?action")) == [1, 2]
    repeated = Members(action=1)
    repeated.repeated = frozenset({"x"})
    both = {"answer": {"action": "a"}, "result": {"action": "b"}}
    for value in (
        repeated,
        both,
        {"answer": {"action": "a"}, "action": "b"},
        {"answer": {"speed": 3}},
    ):
        with pytest.raises(UnusableError):
            unwrap(value, ASKED)


@pytest.mark.parametrize(
    ("said", "value"),
    [
        ("Action: stop", "stop"),
        ("- Reasoning: The van may stop.\n- Action: slow_down", "slow_down"),
        ("Action: stop. Reason: wet", "stop"),
        ("Reasoning:\nThe deer is near.\nIt runs.\n\nFinal answer = pull_over", "pull_over"),
        ("# Reasoning\nThe deer is near.\n# Action\nstop", "stop"),
        ("<reasoning>The deer is near.</reasoning>\n<action>stop</action>", "stop"),
        ("**Answer**\n\n- **Action**: stop", "stop"),
        ("The wrong answer\n- Action: stop", None),
        ("Action: stop\nAction: slow_down", None),
        ("Action: stop\nNegated: yes", None),
        ("Reasoning: stop", None),
        ("Action: stop\nReason: I must not stop.", None),
    ],
)
def test_labelled_lines_are_read_like_an_object(said, value):
    assert read_action(said, ACTIONS).value == value


@pytest.mark.parametrize(
    "aspect", ["a clock that shows, 10:30 in the tunnel", "a sign. ROAD: closed", "a bus; line = 5"]
)
def test_marks_inside_a_labelled_value_are_kept(aspect):
    assert read_aspect(f"is_ood: yes, aspect: {aspect}. Confidence: 0.8").value.aspect == aspect
    assert read_named_aspect(f"aspect: {aspect}").value == aspect


@pytest.mark.parametrize(
    ("value", "found"),
    [("...", True), (" \u2026\n", True), ("<action>", True), ("stop", False), (3, False), (None, False)],
)  # fmt: skip
def test_placeholders_are_those_of_an_example(value, found):
    assert is_placeholder(value) is found


def test_a_refusal_is_looked_for_in_the_first_twenty_thousand_characters():
    refusal = "I must decline"
    assert is_refusal("x " * 9_993 + refusal)
    assert not is_refusal("x " * 9_993 + " " + refusal)


def test_what_is_read_never_changes():
    question = Question(dict.get, str, ASKED)
    assert question.denies is None
    for one, name in ((ParsedAnswer(None, "refused", "no"), "note"), (question, "members")):
        with pytest.raises(FrozenInstanceError):
            setattr(one, name, "")
