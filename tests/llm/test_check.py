"""An answer that is longer than what is ever read is cut before anything else is done with it."""

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen._registry import make_llm
from oodscen._words import redaction
from oodscen.errors import AnswerError, LLMError, LLMTimeout
from oodscen.llm._ask import ask
from oodscen.llm._check import complete, shortened
from oodscen.llm._reading import MAX_ANSWER
from oodscen.llm._recording import Exchange
from oodscen.prompts._tree.imagine_scenario import ImagineScenario
from oodscen.protocols import Completion, Request
from oodscen.testing import AnsweringServer, ScriptedLLM

QUESTION = ImagineScenario(shown=("A deer crosses.",))
REQUEST = Request(QUESTION, QUESTION.messages(), QUESTION.answer_schema())
GOOD = json.dumps({"text": "A grand piano lies across the ego vehicle's lane."})
KEY = "Hq7-zXw93kLmPt5v-Rb2nYc8"


def saying(text):
    return ScriptedLLM(lambda request: Completion(text=text), name="m")


@pytest.fixture
def searched(monkeypatch):
    """Return the lengths of the texts that are searched for pieces of a key, as they come."""
    monkeypatch.setenv("OPENAI_API_KEY", KEY)
    lengths = []
    search = redaction._without_pieces
    monkeypatch.setattr(
        redaction,
        "_without_pieces",
        lambda text, values: lengths.append(len(text)) or search(text, values),
    )
    return lengths


@given(st.text(max_size=20))
def test_an_answer_of_ordinary_length_stays_as_it_is(text):
    completion = Completion(text=text)
    assert shortened(completion) is completion


@pytest.mark.parametrize("filling", [" ", "word ", "\\", GOOD])
def test_a_very_long_answer_is_cut_before_it_is_searched_and_recorded(filling, tmp_path, searched):
    text = GOOD + filling * (5_000_000 // len(filling))
    file = tmp_path / "recording.jsonl"
    calls = []
    with pytest.raises(AnswerError, match="cut off before its end"):
        ask(make_llm(saying(text), record=file, log=calls.append), QUESTION)
    assert max(searched) < 1.2 * MAX_ANSWER
    for line in file.read_bytes().splitlines():
        exchange = Exchange.parse(line)
        assert exchange.is_cut_off
        assert len(exchange.answer) <= MAX_ANSWER
        assert exchange.answer.startswith(GOOD)
        assert exchange.answer.endswith(f"[cut off: {len(text):,} characters]")
    with pytest.raises(AnswerError) as caught:
        ask(make_llm(f"replay:{file}"), QUESTION)
    assert caught.value.attempts == len(calls)


def test_a_server_and_a_class_are_cut_alike(monkeypatch):
    monkeypatch.setenv("OPENAI_API_KEY", KEY)
    text = GOOD + (f" and {KEY}" + "so on " * 1_000) * 50
    found = complete(saying(text), REQUEST)
    with AnsweringServer(saying(text)) as server:
        served = server.client("m").complete(REQUEST)
    assert (found.text, found.is_cut_off) == (served.text, served.is_cut_off)
    assert found.is_cut_off
    assert KEY not in found.text


@settings(max_examples=20)
@given(st.integers(-60, 60), st.integers(0, 30))
def test_a_key_that_the_cut_divides_leaves_nothing(before, end):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("OPENAI_API_KEY", KEY)
        text = "x" * (MAX_ANSWER + before - end) + KEY + "y" * 30_000
        answer = shortened(Completion(text=text))
    assert not any(KEY[i : i + 8] in answer.text for i in range(len(KEY) - 7))
    assert len(answer.text) <= MAX_ANSWER
    assert shortened(answer) == answer


@pytest.mark.parametrize("kind", [LLMError, LLMTimeout, RuntimeError])
def test_a_very_long_message_of_an_error_is_cut_before_it_is_searched(kind, searched):
    calls = []
    llm = make_llm(ScriptedLLM([kind(f"{KEY} " * 100_000)]), log=calls.append)
    with pytest.raises(LLMError) as caught:
        ask(llm, QUESTION)
    assert len(str(caught.value)) <= MAX_ANSWER
    assert KEY not in calls[0].error
    assert max(searched) < 1.2 * MAX_ANSWER
