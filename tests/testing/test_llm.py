"""The doubles say what they are told."""

import json
from types import MappingProxyType

import pytest

from oodscen._parallel.threads import as_finished
from oodscen.errors import LLMError
from oodscen.prompts._tree.imagine_scenario import ImaginedScenario
from oodscen.protocols import LLM, Completion, Request, Usage
from oodscen.testing import ScriptedLLM
from tests.prompts.samples import SAMPLES

IMAGINE, DESCRIBE = (
    next(one for one in SAMPLES if one.purpose == purpose)
    for purpose in ("imagine-scenario", "describe-path")
)


def request(prompt=IMAGINE, sample=0):
    return Request(prompt, prompt.messages(), prompt.answer_schema(), sample)


def test_answers_come_in_order_in_any_form():
    model = ImaginedScenario(text="x")
    llm = ScriptedLLM(["plain", {"text": "ä"}, model, LLMError("gone"), "last"])
    assert isinstance(llm, LLM)
    assert llm.complete(request()).text == "plain"
    assert llm.complete(request(DESCRIBE)).text == '{"text": "ä"}'
    assert llm.complete(request()).text == model.model_dump_json()
    with pytest.raises(LLMError, match="gone"):
        llm.complete(request())
    assert llm.complete(request()).text == "last"
    assert [asked.prompt.purpose for asked in llm.requests].count("describe-path") == 1


def test_any_mapping_is_an_answer_and_may_hold_models():
    model = ImaginedScenario(text="x")
    llm = ScriptedLLM([MappingProxyType({"a": 1}), {"scenarios": [model]}])
    assert llm.complete(request()).text == '{"a": 1}'
    assert json.loads(llm.complete(request()).text) == {"scenarios": [model.model_dump()]}


def test_a_script_that_runs_out_is_a_model_that_fails():
    llm = ScriptedLLM(["once"], name="brief")
    llm.complete(request())
    with pytest.raises(LLMError) as caught:
        llm.complete(request())
    assert caught.value.model == "brief"
    assert len(llm.requests) == 2


def test_every_purpose_has_a_script_of_its_own():
    llm = ScriptedLLM({"imagine-scenario": ["one", "two"], "describe-path": {"texts": []}})
    assert llm.complete(request()).text == "one"
    assert llm.complete(request(DESCRIBE)).text == '{"texts": []}'
    assert llm.complete(request(DESCRIBE)).text == '{"texts": []}'
    assert llm.complete(request()).text == "two"
    for prompt in (IMAGINE, SAMPLES[0]):
        with pytest.raises(LLMError):
            llm.complete(request(prompt))


def test_threads_share_a_script():
    llm = ScriptedLLM([str(number) for number in range(200)])
    pairs = as_finished(lambda n: llm.complete(request(sample=n)).text, range(200), threads=8)
    assert {text for _, text in pairs} == {str(number) for number in range(200)}


def test_a_function_answers_requests():
    full = Completion(text="all", usage=Usage(input_tokens=3))
    answers = ["plain", {"a": 1}, full]
    llm = ScriptedLLM(lambda asked: answers[asked.sample], name="f")
    assert isinstance(llm, LLM)
    assert llm.name == "f"
    assert llm.complete(request(sample=0)).text == "plain"
    assert llm.complete(request(sample=1)).text == '{"a": 1}'
    assert llm.complete(request(sample=2)) is full
