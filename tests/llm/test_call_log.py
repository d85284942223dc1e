"""Every call leaves one line."""

import threading
from datetime import datetime, timedelta

import pytest

from oodscen import make_llm
from oodscen._parallel.threads import as_finished
from oodscen.errors import EndpointDown, LLMError, RunStopped
from oodscen.judging._constant_answerers import ConstantAnswerer
from oodscen.llm._accounting import account
from oodscen.llm._ask import ask
from oodscen.llm._call_log import Call, LoggedLLM
from oodscen.prompts._tree.imagine_scenario import ImagineScenario
from oodscen.protocols import LLM, Completion, Usage
from oodscen.testing import ScriptedLLM

QUESTION = ImagineScenario(shown=("A deer crosses.",))
GOOD = {"text": "A grand piano lies across the ego vehicle's lane."}


def test_a_call_is_accounted_for():
    usage = Usage(input_tokens=7, output_tokens=3, cost_usd=0.25)
    calls = []
    text = '{"text": "A grand piano lies across the lane."}'
    llm = LoggedLLM(
        ScriptedLLM(lambda r: Completion(text=text, usage=usage), name="m"), calls.append
    )
    assert isinstance(llm, LLM)
    ask(llm, QUESTION, sample=4)
    (call,) = calls
    assert datetime.fromisoformat(call.time).utcoffset() == timedelta(0)
    assert call.model_dump(exclude={"seconds", "time"}) == {
        "stage": "",
        "purpose": "imagine-scenario",
        "prompt_version": ImagineScenario.version(),
        "model": "m",
        "sample": 4,
        "attempt": 1,
        "status": "ok",
        "error": None,
        "input_tokens": 7,
        "output_tokens": 3,
        "cached_tokens": 0,
        "cacheable_tokens": 0,
        "cost_usd": 0.25,
        "requests": 1,
    }
    assert call.seconds >= 0
    assert Call.parse(call.to_json()) == call


def test_repairs_are_calls_of_their_own():
    calls = []
    ask(LoggedLLM(ScriptedLLM(["no", "{}", GOOD]), calls.append), QUESTION)
    assert [(call.attempt, call.status) for call in calls] == [(1, "ok"), (2, "ok"), (3, "ok")]


class _Signal(KeyboardInterrupt):
    """The interruption of a command."""


@pytest.mark.parametrize(
    ("error", "status", "words"),
    [
        (LLMError("gone", model="m"), "failed", "LLMError: gone"),
        (LLMError("gone", model="m", requests=-1), "failed", "LLMError: gone"),
        (
            EndpointDown("m", "dead"),
            "failed",
            "EndpointDown: m is given up: dead; fix this and run",
        ),
        (KeyboardInterrupt(), "interrupted", "interrupted"),
        (_Signal(), "interrupted", "interrupted"),
        (RunStopped("the run was interrupted"), "interrupted", "interrupted"),
    ],
)
def test_a_failure_is_logged_and_passes_through(error, status, words):
    calls = []
    llm = LoggedLLM(ScriptedLLM([error]), calls.append)
    with pytest.raises(type(error)) as caught:
        ask(llm, QUESTION)
    assert caught.value is error
    (call,) = calls
    assert call.status == status
    assert call.error.startswith(words)
    assert call.requests == 0
    assert account(("m",), [call.model_dump()]).failed == (status == "failed")


def test_an_error_that_is_no_typed_one_is_logged_and_costs_the_question():
    calls = []
    with pytest.raises(LLMError, match="failed: KeyError: 'bug'"):
        ask(LoggedLLM(ScriptedLLM([KeyError("bug")]), calls.append), QUESTION)
    assert [call.error for call in calls] == ["LLMError: scripted failed: KeyError: 'bug'"]


@pytest.mark.parametrize("answer", [GOOD, LLMError("gone", model="m"), KeyError("bug")])
@pytest.mark.parametrize(
    "error", [KeyError("mine"), OSError(28, "full"), TimeoutError(), SystemExit(3)]
)
def test_what_the_log_raises_is_not_the_models_fault(tmp_path, answer, error):
    def log(call):
        raise error

    llm = make_llm(ScriptedLLM([answer]), log=log, record=tmp_path / "answers.jsonl")
    with pytest.raises(type(error)) as caught:
        ask(llm, QUESTION)
    assert caught.value is error


def test_what_the_model_is_shows_through():
    llm = LoggedLLM(ConstantAnswerer(), print)
    assert (llm.name, llm.kind) == ("constant:stop", "reference")
    assert not hasattr(LoggedLLM(ScriptedLLM([]), print), "kind")


def test_lines_are_written_one_at_a_time():
    busy = threading.Lock()
    calls = []

    def log(call):
        assert busy.acquire(blocking=False)
        calls.append(call)
        busy.release()

    llm = LoggedLLM(ScriptedLLM(lambda asked: GOOD), log)
    list(as_finished(lambda sample: ask(llm, QUESTION, sample), range(60), threads=8))
    assert sorted(call.sample for call in calls) == list(range(60))
