"""Providers that speak their own wire format, through the real litellm: text, pictures, faults."""

import json

import cv2
import numpy as np
import pytest

from oodscen.data._messages import Image
from oodscen.errors import LLMError
from oodscen.llm._ask import ask
from oodscen.llm._remote.budget import Price
from oodscen.llm._remote.limits import Limits
from oodscen.llm._remote.litellm import LiteLLM
from oodscen.prompts._judging.describe_frame import DescribeFrame
from oodscen.prompts._tree.imagine_scenario import ImagineScenario
from tests.llm.wires import serving

KEY = "sk-test-planted-0123456789abcdef"
MODELS = {
    "anthropic": "anthropic/claude-3-5-sonnet-20241022",
    "gemini": "gemini/gemini-1.5-pro",
    "ollama_chat": "ollama_chat/llama3",
}
QUESTION = ImagineScenario(shown=("A deer crosses.",))
TEXT = "A grand piano lies across the ego vehicle's lane."


@pytest.fixture(autouse=True)
def planted_keys(monkeypatch):
    monkeypatch.setenv("ANTHROPIC_API_KEY", KEY)
    monkeypatch.setenv("GEMINI_API_KEY", KEY)
    monkeypatch.setenv("OLLAMA_API_KEY", KEY)


def client(provider, wire, **settings):
    settings = {"sleep": lambda seconds: None, **settings}
    address = wire.address
    if provider == "gemini":
        address += "/v1beta/models/gemini-1.5-pro"
    return LiteLLM(MODELS[provider], api_base=address, **settings)


@pytest.mark.parametrize("provider", MODELS)
def test_a_question_is_answered_and_accounted_for(provider):
    with serving(provider, lambda texts, images: json.dumps({"text": TEXT})) as wire:
        llm = client(provider, wire)
        assert ask(llm, QUESTION).text == TEXT
        ((_, _, texts, images),) = wire.seen
    asked = "\n".join(texts)
    for message in QUESTION.messages():
        assert message.text in asked
    assert images == []


@pytest.mark.parametrize("provider", MODELS)
def test_usage_arrives(provider):
    prompt = QUESTION
    with serving(provider, lambda texts, images: json.dumps({"text": TEXT})) as wire:
        seen = []
        llm = client(provider, wire)
        inner = llm.complete

        def complete(request):
            seen.append(inner(request))
            return seen[-1]

        llm.complete = complete
        ask(llm, prompt)
    assert (seen[0].usage.input_tokens, seen[0].usage.output_tokens) == (120, 30)
    assert seen[0].requests == 1


@pytest.mark.parametrize("provider", MODELS)
def test_pictures_arrive_byte_for_byte(provider, tmp_path):
    pixels = np.random.default_rng(0).integers(0, 255, (48, 64, 3), dtype=np.uint8)
    file = tmp_path / "first.jpg"
    assert cv2.imwrite(str(file), pixels)
    prompt = DescribeFrame(frames=(Image.from_file(file, "frames/x/first.jpg"),))
    with serving(provider, lambda texts, images: json.dumps({"description": "A street."})) as wire:
        assert ask(client(provider, wire), prompt).description == "A street."
    ((_, _, _, images),) = wire.seen
    assert images == [file.read_bytes()]


@pytest.mark.parametrize("provider", MODELS)
@pytest.mark.parametrize("code", [429, 500, 503])
def test_passing_faults_are_retried_in_one_place(provider, code):
    def status(index):
        return code if index < 2 else 200

    with serving(provider, lambda texts, images: json.dumps({"text": TEXT}), status) as wire:
        assert ask(client(provider, wire), QUESTION).text == TEXT
    assert len(wire.seen) == 3


@pytest.mark.parametrize("provider", MODELS)
def test_a_malformed_answer_is_mended_in_the_same_conversation(provider):
    def answer(texts, images):
        is_repair = any("cannot be used" in text for text in texts)
        return json.dumps({"text": TEXT} if is_repair else {"txt": 1})

    with serving(provider, answer) as wire:
        assert ask(client(provider, wire), QUESTION).text == TEXT
    assert len(wire.seen) == 2


@pytest.mark.parametrize("provider", MODELS)
def test_no_key_is_in_an_error_and_the_key_is_sent(provider):
    with (
        serving(provider, lambda texts, images: "", status=lambda index: 401) as wire,
        pytest.raises(LLMError) as caught,
    ):
        ask(client(provider, wire), QUESTION)
    assert KEY not in str(caught.value) + repr(vars(caught.value))
    assert len(wire.seen) == 1
    if provider != "ollama_chat":
        assert any(KEY in key for key in wire.keys) or KEY in wire.seen[0][0]


@pytest.mark.parametrize("provider", MODELS)
def test_caps_hold_for_every_provider(provider):
    name = MODELS[provider]
    limits = Limits(requests=2, cost_usd=1.0, prices={name: Price(0, 0)}, patience_s=None)
    with (
        serving(provider, lambda texts, images: "prose") as wire,
        pytest.raises(Exception, match="cap of 2 requests"),
    ):
        ask(client(provider, wire, limits=limits), QUESTION)
    assert len(wire.seen) == 2
