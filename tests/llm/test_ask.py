"""Asking: every valid answer hidden in noise is found, and nothing but our errors comes out."""

import json
import pickle
import re
from contextlib import nullcontext

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.errors import AnswerError, Issue, LLMError
from oodscen.judging import read_action
from oodscen.llm._ask import ATTEMPTS, QUOTED, SHOWN_ISSUES, ask
from oodscen.llm._reading import MAX_ANSWER, read_answer
from oodscen.prompts import QUESTIONS
from oodscen.prompts._scenario.estimate_rarity import RarityEstimates
from oodscen.prompts._scenario.stage_scene import SceneDraft
from oodscen.prompts._tree.imagine_scenario import ImaginedScenario, ImagineScenario
from oodscen.protocols import Completion
from oodscen.testing import ScriptedLLM
from tests import strategies  # noqa: F401  # says how claims are drawn
from tests.prompts.samples import SAMPLES

BLANK = st.text(" \n\t", max_size=5)
QUESTION = ImagineScenario(shown=("A deer crosses.",))
GOOD = {"reasoning": "rare", "text": "A grand piano lies across the ego vehicle's lane."}

answer_types = [
    question.answer for question in QUESTIONS.values() if question.answer is not SceneDraft
]
answers = st.one_of(*map(st.from_type, answer_types))
prose = st.text(st.characters(exclude_characters="{}", exclude_categories=["Cs"]))
braces = st.sampled_from(["", "Sure! ", "The set {x} holds. ", "Open { and ", "f(x) = {1, 2}. "])

NOISE = {
    "nothing": "{answer}",
    "prose": "{before}{answer}{after}",
    "fence": "{before}\n```json\n{answer}\n```\n{after}",
    "bare fence": "```\n{answer}\n```",
    "thoughts": "<think>{before} {draft} {after}</think>\n{answer}",
    "twice": "{answer}\nIn a fence:\n```json\n{answer}\n```",
    "key": '{{"answer": {answer}}}',
    "comma": "{before}{comma}{after}",
    "string": "{string}",
}


def dumped(answer, indent=None):
    return json.dumps(answer.model_dump(), indent=indent, ensure_ascii=indent is None)


@given(
    answers,
    st.sampled_from(sorted(NOISE)),
    st.tuples(braces, prose).map("".join),
    st.tuples(prose, braces).map("".join),
    st.sampled_from([None, 2]),
    st.data(),
)
def test_every_valid_answer_hidden_in_noise_is_found(answer, noise, before, after, indent, data):
    text = dumped(answer, indent)
    raw = NOISE[noise].format(
        answer=text,
        before=before,
        after=after,
        draft=dumped(data.draw(st.from_type(type(answer)))),
        comma=f"{text[:-1]},}}",
        string=json.dumps(text),
    )
    assert read_answer(raw, type(answer)) == (answer, [])


@given(
    answers,
    st.data(),
    st.sampled_from(["{answer}\n\nThe form: {other}", "{other} {answer}", "[{answer}, {other}]"]),
)
def test_of_two_different_answers_none_is_taken(answer, data, shape):
    other = data.draw(st.from_type(type(answer)).filter(lambda one: one != answer))
    found, issues = read_answer(
        shape.format(answer=dumped(answer), other=dumped(other)), type(answer)
    )
    assert found is None
    assert "different" in issues[0].message


@pytest.mark.parametrize(
    ("told", "fault"),
    [
        ("10^6", "not valid JSON"),
        ("1 000 000", "not valid JSON"),
        ("60 or 100", "not valid JSON"),
        ("60%", "not valid JSON"),
        ("<60", "not valid JSON"),
        ("true", "must be a number"),
        ('60, "once_in_km": 70', "twice"),
    ],
)
def test_a_number_is_read_as_it_is_said_or_asked_again(told, fault):
    raw = json.dumps(GOOD)[:-1] + f', "once_in_km": {told}}}'
    found, issues = read_answer(raw, ImaginedScenario)
    assert found is None
    assert fault in issues[0].message


THOUGHTS = [
    ("<think>", "</think>"),
    ('<think effort="high">', "</think>"),
    ("<seed:think>", "</seed:think>"),
    ("[THINK]", "[/THINK]"),
    ("<|begin_of_thought|>", "<|end_of_thought|>"),
    ("<|channel|>analysis<|message|>", "<|end|><|start|>assistant<|channel|>final<|message|>"),
]


@pytest.mark.parametrize(("begin", "end"), THOUGHTS, ids=[begin for begin, _ in THOUGHTS])
def test_only_what_stands_after_reasoning_is_an_answer(begin, end):
    good, draft = json.dumps(GOOD), json.dumps({**GOOD, "text": "A draft of a text, long enough."})
    assert read_answer(f"{begin}perhaps {draft}", ImaginedScenario)[0] is None
    found, issues = read_answer(f"{begin}perhaps {draft}{end}{good}", ImaginedScenario)
    assert (found and found.text, issues) == (GOOD["text"], [])


def test_typographic_quotation_marks_are_read():
    raw = f"{{“reasoning”: “rare”, “text”: “{GOOD['text']}”, “once_in_km”: 9}}"
    wanted = ImaginedScenario(**GOOD, once_in_km=9)
    assert read_answer(raw, ImaginedScenario) == (wanted, [])


DENIED = [
    "It is not {}",
    "The answer is not: {}",
    "~~{}~~",
    "Bad example:\n```json\n{}\n```",
    "{}\nThis is wrong.",
    "{} is not the answer",
]
GRANTED = [
    "I am not sure, but:\n```json\n{}\n```",
    "Here it is, not too long:\n{}",
    "{}\nThis is not common on roads.",
]


@pytest.mark.parametrize("shape", [*DENIED, *GRANTED])
def test_an_object_that_the_words_beside_it_deny_is_no_answer(shape):
    found, issues = read_answer(shape.format(json.dumps(GOOD)), ImaginedScenario)
    assert (found is None) is (shape in DENIED)
    assert not issues or "words beside" in issues[0].message


@pytest.mark.parametrize(
    ("other", "is_taken"),
    [
        ('{"once_in_km": 10}', False),
        ('{"text": "Another."}', False),
        (json.dumps(GOOD), True),
        ('{"x": 1}', True),
    ],
)
def test_a_correction_beside_an_answer_is_not_passed_over(other, is_taken):
    raw = f"{json.dumps(GOOD)}\nCorrection: {other}"
    assert (read_answer(raw, ImaginedScenario)[0] is not None) is is_taken


def estimate(number, best):
    return {
        "number": number,
        "unit": "log10 km",
        "low": best - 1,
        "best": best,
        "high": best + 1,
        "problem": "none",
    }


ESTIMATES = RarityEstimates(estimates=[estimate(1, 6.0), estimate(2, 5.0)])


@pytest.mark.parametrize(
    ("other", "is_taken"),
    [
        ({"number": 1, "best": 3}, False),
        ({"best": 3}, False),
        (estimate(1, 3.0), False),
        ({"number": 3, "best": 5}, False),
        ({"number": 2, "best": 6}, False),
        (estimate(1, 6.0), True),
        ({"number": 2, "best": 5}, True),
        ({"best": 5}, True),
        ({"x": 1}, True),
    ],
)
@pytest.mark.parametrize(
    "shape", ["{answer}\nCorrection: {other}", "{other}\n{answer}", "{answer}\n[{other}]"]
)
def test_an_entry_beside_a_list_must_be_one_of_its_entries(other, is_taken, shape):
    raw = shape.format(answer=dumped(ESTIMATES), other=json.dumps(other))
    assert read_answer(raw, RarityEstimates)[0] == (ESTIMATES if is_taken else None)


TAKEN_BACK = [
    "Wait, actually 1 should be 3.",
    "Wait... no.",
    "Correction: text 1 is 3.",
    "```\n\n**Corrected estimate**: 3 for text 1.",
    "Sorry, that is wrong: the first should be 3, not 6.",
    "Sorry, text 1 should be 3.",
    "On second thought, 3 for text 1.",
    "Actually, best for 1 is 3.",
    "Scratch that.",
    "I made a mistake, 1 is 3.",
    "Hmm, no. Best of number 1: 3.",
    "Edit: 1 -> 3",
    "Oops, number 1 should be 3.",
    "These are rough. Number 1 should be 3.",
    "I misread text 1.",
    "Let me correct that: 3.",
    "Please disregard the above.",
]
LEFT_STANDING = [
    "I hope this helps! Let me know if you need more.",
    "Note: these estimates are rough, and I am not sure about text 2.",
    "Explanation:\n- 1: rare\n- 2: common, but no surprise",
    "Wait for the pedestrian, then go. Stop. Wait. Proceed.",
    "This is wrong-way driving, and it is not common.",
    "Corrected for winter. Actually rare events are hard to judge.",
    "The speed should be 30 km/h. Text 2 should be read as one event.",
    "No, there is nothing unusual. However, the driver made a mistake.",
    "Sorry that I cannot be more exact.",
    "I would correct the course by steering.",
]


@pytest.mark.parametrize("after", [*TAKEN_BACK, *LEFT_STANDING])
def test_an_answer_that_the_words_behind_it_correct_is_asked_again(after):
    answer = dumped(ESTIMATES)
    found, issues = read_answer(f"{answer}\n{after}", RarityEstimates)
    assert found == (None if after in TAKEN_BACK else ESTIMATES)
    assert not issues or "words after the object" in issues[0].message
    for raw in (f"{after}\n{answer}", f"{answer}\n{after}\n{answer}"):
        assert read_answer(raw, RarityEstimates) == (ESTIMATES, [])


@pytest.mark.parametrize("piece", ["\n", "- ", "-actually", "sorry. ", "no no ", "number 1 "])
def test_long_words_behind_an_answer_are_read_soon(piece):
    raw = dumped(ESTIMATES) + piece * ((MAX_ANSWER - 1_000) // len(piece))
    assert read_answer(raw, RarityEstimates) == (ESTIMATES, [])


@pytest.mark.parametrize(
    "raw",
    [
        "{'reasoning': 'rare', 'text': 'It is 5\" wide and lies on the road.', 'once_in_km': 9}",
        '{reasoning: "rare", text: "It is 5\\" wide and lies on the road.", "once_in_km": 9}',
        '{"reasoning": "rare", // why\n "text": "It is 5\\" wide and lies on the road.", "once_in_km": 9}',
        '{ # why\n"reasoning": "rare", # so\n "text": "It is 5\\" wide and lies on the road.", "once_in_km": 9,}',
        '{"once_in_km": 9, "reasoning": "rare", "text": "It is 5\\" wide and lies on the road."',
        '```json\n{"once_in_km": 9, "reasoning": "rare", "text": "It is 5\\" wide and lies on the road."\n```',
    ],
)
def test_small_faults_are_mended(raw):
    wanted = ImaginedScenario(
        reasoning="rare", text='It is 5" wide and lies on the road.', once_in_km=9
    )
    assert read_answer(raw, ImaginedScenario) == (wanted, [])


@given(answers, st.data())
def test_an_answer_that_is_cut_short_is_never_taken_for_a_shorter_one(answer, data):
    text = dumped(answer)
    end = data.draw(st.integers(0, len(text) - 1))
    assert read_answer(text[:end], type(answer))[0] in (None, answer)


@given(st.sampled_from(answer_types), st.integers(1, 30))
def test_a_cut_is_called_a_cut(kind, end):
    text = '{"unfinished": "' + "x" * end
    assert "cut off" in read_answer(text, kind)[1][0].message


shards = """{ } [ ] " ' , : \\ \n a 1e999 - null NaN </think> <think> ``` ```json "text" \\ud800" // /*"""
pieces = st.lists(st.sampled_from([*shards.split(" "), '{"text": "']), max_size=40).map("".join)
documents = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text() | st.just("text"), inner),
).map(json.dumps)


def answer_or_error(prompt, words):
    try:
        return ask(ScriptedLLM(lambda request: words), prompt, attempts=2)
    except AnswerError as error:
        return error


@given(st.sampled_from(SAMPLES), st.one_of(st.text(), pieces, documents))
def test_words_of_any_kind_end_as_an_answer_or_as_an_answer_error(prompt, text):
    outcome = answer_or_error(prompt, text)
    if isinstance(outcome, AnswerError):
        assert outcome.raw == text
        assert outcome.issues
    else:
        assert isinstance(outcome, prompt.answer)


@given(st.sampled_from([s for s in SAMPLES if s.answer is not SceneDraft]), st.data())
def test_answers_of_the_right_shape_are_checked_without_a_crash(prompt, data):
    answer = data.draw(st.from_type(prompt.answer))
    outcome = answer_or_error(prompt, answer)
    says_nothing = re.search(r'"\s*"|null', answer.model_dump_json())  # means left out
    if isinstance(outcome, AnswerError):
        assert outcome.issues if says_nothing else outcome.issues == tuple(prompt.check(answer))
    elif not says_nothing:
        assert outcome == answer
        assert not prompt.check(answer)


@pytest.mark.parametrize(
    "text",
    ['{"a":' * 9_000, "{{a:" * 9_000, '{"a":[' * 9_000, "{'" * 20_000, '{a:"' * 20_000],
    ids=lambda text: text[:6],
)
def test_hostile_lengths_end_soon(text):
    assert read_answer(text, ImaginedScenario)[0] is None


def test_an_endless_answer_is_not_read():
    _, issues = read_answer(json.dumps({**GOOD, "reasoning": "x" * MAX_ANSWER}), ImaginedScenario)
    assert len(issues) == 1


def test_faults_are_fed_back_until_the_answer_is_valid():
    llm = ScriptedLLM(["I would rather not.", {"text": "too short"}, GOOD])
    assert ask(llm, QUESTION, sample=4).text == GOOD["text"]
    first, second, third = llm.requests
    assert [r.attempt for r in llm.requests] == [1, 2, 3]
    assert {r.sample for r in llm.requests} == {4}
    assert first.messages == QUESTION.messages()
    assert first.schema == ImaginedScenario.model_json_schema()
    assert second.messages[:-2] == third.messages[:-2] == first.messages
    assert second.messages[-2].role == "assistant"
    assert second.messages[-2].text == "I would rather not."
    assert "no JSON object" in second.messages[-1].text
    assert "text: write one or two sentences" in third.messages[-1].text


def test_an_answer_error_keeps_the_last_words_and_their_faults():
    llm = ScriptedLLM(["nothing", "{}", '{"text": "short"}'])
    with pytest.raises(AnswerError) as caught:
        ask(llm, QUESTION)
    error = pickle.loads(pickle.dumps(caught.value))
    assert (error.model, error.purpose, error.attempts) == ("scripted", "imagine-scenario", 3)
    assert error.raw == '{"text": "short"}'
    assert [issue.path for issue in error.issues] == ["text"]


def test_further_checks_are_fed_back_as_well():
    def no_pianos(answer):
        return [Issue("text", "no pianos")] if "piano" in answer.text else []

    other = {**GOOD, "text": "A sofa lies across the ego vehicle's lane."}
    llm = ScriptedLLM([GOOD, other])
    assert ask(llm, QUESTION, check=no_pianos).text == other["text"]
    assert "text: no pianos" in llm.requests[1].messages[-1].text


def test_the_repair_turn_is_bounded():
    def many(answer):
        return [Issue(f"text[{i}]", "wrong") for i in range(50)]

    llm = ScriptedLLM([{**GOOD, "reasoning": "x" * 50_000}, GOOD])
    with pytest.raises(AnswerError) as caught:
        ask(llm, QUESTION, check=many, attempts=2)
    assert len(caught.value.issues) == 50
    *_, said, told = llm.requests[1].messages
    assert len(said.text) < QUOTED + 10
    assert told.text.count("wrong") == SHOWN_ISSUES


def test_an_empty_answer_leaves_no_empty_turn():
    llm = ScriptedLLM(["", GOOD])
    ask(llm, QUESTION)
    assert all(message.text for message in llm.requests[1].messages)


def test_failures_of_the_model_pass_through():
    failure = LLMError("gone", model="m", retryable=True)
    with pytest.raises(LLMError) as caught:
        ask(ScriptedLLM([failure]), QUESTION)
    assert caught.value is failure


@pytest.mark.parametrize(
    ("raised", "is_retryable"),
    [(TimeoutError("late"), True), (ConnectionError("gone"), True), (KeyError("choices"), False)],
)
def test_whatever_a_models_object_raises_is_a_model_that_failed(raised, is_retryable):
    def answer(request):
        raise raised

    with pytest.raises(LLMError, match=type(raised).__name__) as caught:
        ask(ScriptedLLM(answer), QUESTION)
    assert caught.value.__cause__ is raised
    assert caught.value.retryable is is_retryable


def read_prose(raw):
    return ImaginedScenario(text=raw), []


@pytest.mark.parametrize(
    ("text", "is_taken"),
    [
        (json.dumps(GOOD), True),
        (f"{json.dumps(GOOD)}\n\n\n", True),
        (f"First: {json.dumps(GOOD)}. No, better: ", False),
        ("I would slow down", False),
        ("", False),
    ],
)
@pytest.mark.parametrize("read", [None, read_prose])
def test_an_answer_that_the_model_did_not_end_is_not_taken_for_a_shorter_one(text, is_taken, read):
    llm = ScriptedLLM(lambda asked: Completion(text=text, is_cut_off=True))
    with nullcontext() if is_taken else pytest.raises(AnswerError, match="cut off before its end"):
        ask(llm, QUESTION, read=read)
    assert len(llm.requests) == (1 if is_taken else ATTEMPTS)


@given(BLANK, st.sampled_from(["", "<think>A deer?</think>", "<think>A deer?"]), BLANK)
def test_nothing_is_told_from_an_answer_that_cannot_be_read(before, thoughts, after):
    raw = before + thoughts + after
    fault = "no answer after its reasoning" if thoughts else "the answer is empty"
    with pytest.raises(AnswerError, match=fault):
        ask(ScriptedLLM(lambda asked: Completion(text=raw)), QUESTION)
    assert fault in str(read_answer(raw, ImaginedScenario)[1])
    assert fault in read_action(raw).note
