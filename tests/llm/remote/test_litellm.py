"""LiteLLM against a server on this machine, through the real litellm."""

import json
import os
import pickle
import re
import sys
import traceback
from datetime import UTC, datetime, timedelta
from email.utils import format_datetime

import cv2
import numpy as np
import pytest

from oodscen import make_llm
from oodscen._words import redaction
from oodscen.data._messages import Image, Message
from oodscen.errors import (
    AnswerError,
    ContentFiltered,
    LLMError,
    LLMTimeout,
    MissingExtra,
    UnknownComponent,
    UsageError,
)
from oodscen.llm._ask import ask
from oodscen.llm._remote.call_bounds import CallBounds
from oodscen.llm._remote.failures import FailedAttempt, diagnose
from oodscen.llm._remote.failures import retry_after as seconds_to_wait
from oodscen.llm._remote.limits import Limits
from oodscen.llm._remote.litellm import LiteLLM
from oodscen.llm._remote.offline import is_loopback
from oodscen.llm._remote.sdk import load_litellm
from oodscen.llm._remote.wire import provider_seed, wire_message
from oodscen.prompts._judging.describe_frame import DescribeFrame
from oodscen.prompts._tree.imagine_scenario import ImagineScenario
from oodscen.protocols import LLM, Completion, Request
from oodscen.testing import AnsweringServer, ScriptedLLM
from tests.llm.rogue import answering, talking

KEY = "sk-test-planted-0123456789abcdef"
QUESTION = ImagineScenario(shown=("A deer crosses.",))
TEXT = "A grand piano lies across the ego vehicle's lane."


def request(prompt=QUESTION, sample=0):
    return Request(prompt, prompt.messages(), prompt.answer_schema(), sample)


def by_sample(asked):
    return {"text": f"{TEXT} ({asked.sample})"}


@pytest.fixture
def picture(tmp_path):
    pixels = np.random.default_rng(0).integers(0, 255, (48, 64, 3), dtype=np.uint8)
    file = tmp_path / "first.jpg"
    assert cv2.imwrite(str(file), pixels)
    return Image.from_file(file, "frames/x/first.jpg")


@pytest.fixture
def planted_key(monkeypatch):
    monkeypatch.setenv("OPENAI_API_KEY", KEY)


def serving(*faults):
    """Serve with the given faults, one per request, and none after them."""
    return AnsweringServer(
        ScriptedLLM(by_sample), faults=lambda i, _: faults[i] if i < len(faults) else None
    )


def test_a_question_is_answered_through_http():
    with serving() as server:
        llm = server.client("small-model", seed=3)
        assert isinstance(llm, LLM)
        assert llm.name == "small-model"
        assert ask(llm, QUESTION, sample=2).text == f"{TEXT} (2)"
    (received,) = server.received
    assert received.body["model"] == "small-model"
    assert received.body["seed"] == provider_seed(3, 2)
    assert [(m["role"], m["content"]) for m in received.messages] == [
        (message.role, message.text) for message in QUESTION.messages()
    ]
    assert received.body["response_format"] == {"type": "json_object"}


def test_ten_draws_stay_ten():
    with serving() as server:
        llm = server.client("m")
        texts = [ask(llm, QUESTION, sample).text for sample in range(10)]
    assert len(set(texts)) == 10
    assert len({received.body["seed"] for received in server.received}) == 10
    seeds = {provider_seed(seed, sample) for seed in range(5) for sample in range(200)}
    assert len(seeds) == 1_000
    assert all(0 <= seed < 2**31 for seed in seeds)


def test_pictures_arrive_as_jpeg_byte_for_byte(picture):
    prompt = DescribeFrame(frames=(picture, picture), descriptions=("A street.",))
    with AnsweringServer(ScriptedLLM(lambda asked: {"description": "A street."})) as server:
        ask(server.client("m"), prompt)
    (received,) = server.received
    assert received.images == (picture.read(), picture.read())
    decoded = cv2.imdecode(np.frombuffer(received.images[0], np.uint8), cv2.IMREAD_COLOR)
    assert decoded.shape == (48, 64, 3)
    content = received.messages[1]["content"]
    assert [part["type"] for part in content] == ["text", "image_url"]
    assert content[1]["image_url"]["url"].startswith("data:image/jpeg;base64,")


def test_a_picture_that_cannot_be_read_is_an_error_of_this_item(tmp_path):
    gone = Image(name="gone.jpg", sha256="0" * 64, path=tmp_path / "gone.jpg")
    with serving() as server, pytest.raises(LLMError) as caught:
        ask(server.client("m"), DescribeFrame(frames=(gone,)))
    assert not caught.value.retryable
    assert "gone.jpg" in str(caught.value)
    assert not server.received


def test_a_png_is_called_a_png(tmp_path):
    file = tmp_path / "a.png"
    assert cv2.imwrite(str(file), np.zeros((2, 2, 3), np.uint8))
    message = Message(role="user", text="", images=(Image.from_file(file),))
    assert wire_message(message)["content"][1]["image_url"]["url"].startswith("data:image/png;")


def test_usage_and_a_known_price_are_reported():
    with serving() as server:
        known = server.client("gpt-4o").complete(request()).usage
        unknown = server.client("nobody-knows-it").complete(request()).usage
    assert known.input_tokens == unknown.input_tokens > 0
    assert known.output_tokens > 0
    assert known.cost_usd > 0
    assert unknown.cost_usd is None


def test_the_schema_is_sent_where_the_model_takes_one():
    with serving() as server:
        server.client("gpt-4o").complete(request())
    form = server.received[0].body["response_format"]
    assert form["type"] == "json_schema"
    assert form["json_schema"]["schema"] == QUESTION.answer_schema()


def test_a_server_that_refuses_the_format_is_asked_without_and_not_again():
    with serving("http400") as server:
        llm = server.client("gpt-4o")
        llm.complete(request())
        llm.complete(request(sample=1))
    assert ["response_format" in r.body for r in server.received] == [True, False, False]


def test_another_bad_request_does_not_change_the_format():
    with serving("http400", "http400") as server:
        llm = server.client("gpt-4o")
        with pytest.raises(LLMError):
            llm.complete(request())
        llm.complete(request())
    assert ["response_format" in r.body for r in server.received] == [True, False, True]


def test_temperature_and_options_are_passed_on():
    settings = {"temperature": 0.5, "max_tokens": 99, "options": {"top_p": 0.9}}
    with serving() as server:
        server.client("m", **settings).complete(request())
    body = server.received[0].body
    assert (body["temperature"], body["max_tokens"], body["top_p"]) == (0.5, 99, 0.9)


@pytest.mark.parametrize("fault", ["http429", "http500", "html", "empty", "cut", "reset"])
def test_passing_faults_are_retried_once_and_in_one_place(fault):
    waits = []
    with serving(fault, fault) as server:
        completion = server.client("m", sleep=waits.append).complete(request())
    assert json.loads(completion.text) == by_sample(request())
    assert len(server.received) == 3
    if fault == "http429":
        assert waits == [7.0, 7.0]
    else:
        assert 0.5 <= waits[0] <= 1.0 <= waits[1] <= 2.0


@pytest.mark.parametrize("fault", ["http429", "http500", "html", "empty", "cut", "reset"])
def test_lasting_faults_end_as_a_retryable_error(fault):
    with serving(*[fault] * 9) as server, pytest.raises(LLMError) as caught:
        server.client("m", retries=2).complete(request())
    assert (caught.value.model, caught.value.retryable) == ("m", True)
    assert len(server.received) == 3


def test_a_refused_key_is_not_retried():
    with serving("http401") as server, pytest.raises(LLMError) as caught:
        server.client("m").complete(request())
    assert not caught.value.retryable
    assert len(server.received) == 1


def test_the_wait_before_a_retry_is_capped_however_many_were_before():
    llm = LiteLLM("m", api_base="http://127.0.0.1:9/v1", retries=10_000, max_wait_s=3.0)
    failure = FailedAttempt("busy", "limit", retryable=True)
    for retries in (2, 40, 1_100, 9_999):
        assert 1.5 <= llm._wait(failure, retries, request()) <= 3.0


def test_a_server_that_asks_for_too_long_a_wait_is_given_up():
    waits = []
    with serving("http429") as server, pytest.raises(LLMError) as caught:
        server.client("m", max_wait_s=5, sleep=waits.append).complete(request())
    assert caught.value.retryable
    assert (len(server.received), waits) == (1, [])
    assert "asked to wait" in str(caught.value)
    assert "more than max_wait_s 5" in str(caught.value)


def test_nobody_listening_is_a_retryable_error():
    with serving() as server:
        llm = server.client("m", retries=1)
    with pytest.raises(LLMError) as caught:
        llm.complete(request())
    assert caught.value.retryable


@pytest.mark.parametrize("fault", ["filtered", "withheld", "flagged"])
def test_a_content_filter_is_a_refusal_and_not_asked_twice(fault):
    with serving(*[fault] * 9) as server, pytest.raises(ContentFiltered) as caught:
        server.client("m").complete(request())
    assert not caught.value.retryable
    assert len(server.received) == 1


@pytest.mark.parametrize(
    "words", ["ResponsibleAIPolicyViolation", "content_filter", "Azure's content management policy"]
)
def test_a_filter_is_known_by_its_words(words):
    load_litellm()
    error = Answered()
    error.status_code = 400
    error.args = (f"Error: {words}",)
    failure = diagnose("m", error, CallBounds(1, 1))
    assert (failure.kind, failure.retryable, failure.may_refuse_format) == (
        "filtered",
        False,
        False,
    )


@pytest.mark.parametrize(
    ("body", "kind"),
    [
        ({"error": {"message": "Declined.", "code": "content_filter"}}, "filtered"),
        ([{"error": {"innererror": {"code": "ResponsibleAIPolicyViolation"}}}], "filtered"),
        ({"error": {"type": "insufficient_quota"}}, "denied"),
        ({"error": {"code": 400, "message": "Declined."}}, "item"),
        ({"detail": [{"input": "a text about a content filter"}]}, "item"),
        ({}, "item"),
    ],
)
def test_an_error_is_known_by_the_code_of_its_body(body, kind):
    load_litellm()
    error, bounds = Answered(), CallBounds(1, 1)
    error.status_code, bounds.head = 400, json.dumps(body).encode()
    assert diagnose("m", error, bounds).kind == kind


def test_what_hangs_is_tried_once_more_and_no_oftener():
    with serving() as server:
        server.client("m").complete(request())  # The first call of all loads parts of litellm.
    with serving(*["slow"] * 9) as server, pytest.raises(LLMTimeout) as caught:
        server.client("m", timeout_s=0.3).complete(request())
    assert (caught.value.retryable, caught.value.requests) == (True, 2)
    assert len(server.received) == 2


def test_the_time_for_an_answer_is_that_of_the_run_unless_the_model_has_its_own():
    limits = Limits(timeout_s=7.0)
    with serving() as server:
        assert server.client("m", limits=limits).client.timeout_s == 7.0
        assert server.client("m", limits=limits, timeout_s=3.0).client.timeout_s == 3.0


class Answered(Exception):
    """What litellm raises, as far as headers go."""

    def __init__(self, **headers):
        self.litellm_response_headers = {k.replace("_", "-"): v for k, v in headers.items()}


def test_every_form_of_retry_after_is_understood():
    soon = datetime.now(UTC) + timedelta(seconds=40)
    assert seconds_to_wait(Answered(retry_after="3")) == 3.0
    assert seconds_to_wait(Answered(retry_after=" 1.5")) == 1.5
    assert seconds_to_wait(Answered(retry_after_ms="250", retry_after="1")) == 0.25
    assert 0 < seconds_to_wait(Answered(retry_after=format_datetime(soon))) <= 40
    assert seconds_to_wait(Answered(retry_after="Thu, 01 Jan 1970 00:00:00 GMT")) == 0.0
    assert seconds_to_wait(Answered(retry_after_ms="soon", retry_after="3")) == 3.0
    assert seconds_to_wait(ValueError()) is None


@pytest.mark.parametrize("header", ["retry_after", "retry_after_ms"])
@pytest.mark.parametrize(
    "value",
    [
        *("soon", "", "-1", "-inf", "1.2.3", "nan"),
        "Thu, 01 Jan 2024 00:00:00 +99999999999999",
    ],
)
def test_a_time_to_wait_that_cannot_be_meant_is_none(header, value):
    assert seconds_to_wait(Answered(**{header: value})) is None


@pytest.mark.parametrize(
    "value", ["99999999", "1e23", "9" * 300, "9" * 400, "Fri, 31 Dec 9999 23:59:59 GMT"]
)
def test_a_time_to_wait_beyond_all_measure_fails_the_call_at_once(value):
    rogue = answering("no", status="429 Too Many Requests", headers=f"retry-after: {value}\r\n")
    waits = []
    with talking(rogue) as server, pytest.raises(LLMError) as caught:
        LiteLLM("m", api_base=server.address, sleep=waits.append).complete(request())
    assert (waits, caught.value.requests, caught.value.retryable) == ([], 1, True)
    assert re.search(r"asked to wait \S{3,14} s, more than max_wait_s 60$", str(caught.value))


@pytest.mark.parametrize(
    ("words", "kind"),
    [
        ("insufficient_quota", "denied"),
        ("Your credit balance is too low to access the Anthropic API.", "denied"),
        ("API key not valid. Please pass a valid API key.", "denied"),
        ("content management policy", "filtered"),
    ],
)
def test_a_failure_is_known_by_words_that_its_message_cuts_off(words, kind):
    error = Answered()
    error.args, error.status_code = (f"{'x' * 600} {words}",), 400
    failure = diagnose("m", error, CallBounds(1.0, 1))
    assert failure.kind == kind
    assert words not in failure.message


@pytest.mark.parametrize(
    ("status", "kind"), [(401, "denied"), (402, "denied"), (404, "erring"), (413, "item")]
)
def test_an_account_that_must_be_paid_is_refused_as_a_key_is(status, kind):
    error = Answered()
    error.args, error.status_code = ("Insufficient Balance",), status
    assert diagnose("m", error, CallBounds(1.0, 1)).kind == kind


@pytest.mark.parametrize("is_wrapped", [False, True])
def test_a_traceback_in_an_error_is_not_told(is_wrapped):
    error = ValueError('boom\nTraceback (most recent call last):\n  File "secret.py"')
    if is_wrapped:
        error, error.__cause__ = RuntimeError("it failed"), error
    message = diagnose("m", error, CallBounds(1.0, 1)).message
    assert message.endswith("RuntimeError: it failed (boom)" if is_wrapped else "ValueError: boom")


def test_a_long_error_is_not_told_twice():
    error = RuntimeError(f"litellm: {'x' * 600}")
    error.__cause__ = ValueError("x" * 600)
    message = diagnose("m", error, CallBounds(1.0, 1)).message
    assert message.endswith(f"RuntimeError: litellm: {'x' * 491} ...")


@pytest.mark.parametrize("fault", ["malformed", "truncated", "wrong_schema", "null"])
def test_a_bad_answer_is_repaired_or_ends_as_one_typed_error(fault):
    with serving(fault) as server:
        assert ask(server.client("m"), QUESTION).text == f"{TEXT} (0)"
    assert len({received.body["seed"] for received in server.received}) == 2
    with serving(*[fault] * 9) as server, pytest.raises(AnswerError) as caught:
        ask(server.client("m"), QUESTION)
    assert caught.value.attempts == len(server.received) == 3


@pytest.mark.parametrize("is_cut_off", [False, True])
@pytest.mark.parametrize(
    ("instead", "said"), [(None, ""), ("a tool call", "only a tool call"), ("reasoning", "only r")]
)
def test_an_answer_without_a_text_is_told_as_that(instead, said, is_cut_off, tmp_path):
    empty = Completion(text=" ", instead=instead, is_cut_off=is_cut_off)
    file = tmp_path / "answers.jsonl"
    with AnsweringServer(ScriptedLLM(lambda asked: empty)) as server:
        llm = make_llm(server.client("m"), record=file)
        with pytest.raises(AnswerError, match=f"the answer is empty.*{said}") as caught:
            ask(llm, QUESTION)
    again = server.received[-1].messages[-1]["content"]
    assert len(server.received) == 3
    assert all(str(issue) in again for issue in caught.value.issues)
    assert ("cut off" in again) == is_cut_off
    with pytest.raises(AnswerError) as replayed:
        ask(make_llm(f"replay:{file}"), QUESTION)
    assert replayed.value.issues == caught.value.issues


def test_the_server_says_that_an_answer_was_cut_off():
    said = [Completion(text=TEXT, is_cut_off=True), Completion(text=TEXT)]
    with AnsweringServer(ScriptedLLM(lambda asked: said[asked.sample])) as server:
        llm = server.client("m")
        assert [llm.complete(request(sample=n)).is_cut_off for n in (0, 1)] == [True, False]


@pytest.mark.parametrize("fault", ["http401", "http400", "http500", "html", "reset"])
def test_no_key_is_in_any_error(planted_key, fault):
    with serving(*[fault] * 9) as server, pytest.raises(LLMError) as caught:
        server.client("m").complete(request())
    error = caught.value
    shown = "".join(traceback.format_exception(error)) + repr(vars(error)) + str(error)
    assert KEY not in shown
    assert KEY.encode() not in pickle.dumps(error)
    assert error.__context__ is None
    assert KEY not in repr([received.headers for received in server.received])


def test_nothing_but_credentials_is_taken_for_one(monkeypatch) -> None:
    sdk = load_litellm()
    monkeypatch.setattr(sdk, "groq_key", "set-by-hand")
    monkeypatch.setattr(sdk, "headers", {"X-Api-Key": "in-a-header"})
    monkeypatch.setattr("oodscen._words.redaction._told", set())
    LiteLLM("gpt-4o", api_base="http://127.0.0.1:9/v1", options={"api_key": KEY})
    assert redaction._told >= {"set-by-hand", "in-a-header", KEY}
    assert not redaction._told & {"max_tokens", "Optional[str]", "<|begin_of_text|>"}


def test_a_key_that_the_server_repeats_is_hidden(planted_key):
    def repeat(asked):
        raise LLMError(f"Incorrect API key provided: {KEY}; also Bearer abcdefghijkl")

    with AnsweringServer(ScriptedLLM(repeat)) as server, pytest.raises(LLMError) as caught:
        server.client("m").complete(request())
    assert KEY not in str(caught.value)
    assert "abcdefghijkl" not in str(caught.value)
    assert "Incorrect API key" in str(caught.value)


def test_huge_error_pages_are_cut():
    def shout(asked):
        raise LLMError("x" * 50_000)

    with AnsweringServer(ScriptedLLM(shout)) as server, pytest.raises(LLMError) as caught:
        server.client("m").complete(request())
    assert len(str(caught.value)) < 1_000


def test_names_that_litellm_does_not_know_come_with_matches():
    for name, match in {
        "gpt-4oo": "gpt-4o",
        "opnai/gpt-4o": "openai/gpt-4o",
        "olama/llama3": "ollama/llama3",
    }.items():
        with pytest.raises(UnknownComponent) as caught:
            LiteLLM(name)
        assert match in caught.value.matches


def test_with_an_address_any_name_is_openai_compatible():
    address = "http://127.0.0.1:9/v1"
    assert LiteLLM("meta-llama/Llama-3", api_base=address)._model == "openai/meta-llama/Llama-3"
    assert LiteLLM("claude-like", api_base=address)._model == "openai/claude-like"
    assert LiteLLM("ollama/llama3", api_base=address)._model == "ollama/llama3"


@pytest.mark.parametrize(
    "name", ["api_base", "max_tokens", "messages", "model", "seed", "stream", "timeout"]
)
def test_options_hold_nothing_that_has_an_argument_or_is_set_by_the_call(name):
    with pytest.raises(UsageError, match=f"options must not hold {name}"):
        LiteLLM("gpt-4o", api_base="http://127.0.0.1:9/v1", options={name: 1})


@pytest.mark.parametrize("end", ["#", "#part"])
def test_an_address_with_a_fragment_is_refused(end):
    with pytest.raises(UsageError, match="is not the address of a server"):
        LiteLLM("m", api_base=f"http://127.0.0.1:9/v1{end}")


def test_without_a_key_an_own_server_still_gets_one(monkeypatch):
    monkeypatch.delenv("OPENAI_API_KEY", raising=False)
    with serving() as server:
        assert server.client("m").complete(request()).text


def test_offline_means_this_machine_only(monkeypatch):
    monkeypatch.setenv("OODSCEN_OFFLINE", "1")
    for name, address in [
        ("gpt-4o", None),
        ("anthropic/claude-x", None),
        ("m", "http://example.com/v1"),
        ("m", "http://127.0.0.1.example.com/v1"),
        ("m", "http://10.0.0.1/v1"),
        ("m", "http://nonsense"),
    ]:
        with pytest.raises(UsageError, match="OODSCEN_OFFLINE"):
            LiteLLM(name, api_base=address)
    LiteLLM("m", api_base="http://localhost:1/v1")
    monkeypatch.setenv("OODSCEN_OFFLINE", "0")
    LiteLLM("m", api_base="http://example.com/v1")


def test_an_address_with_a_password_is_not_shown(monkeypatch):
    monkeypatch.setenv("OODSCEN_OFFLINE", "1")
    with pytest.raises(UsageError) as caught:
        LiteLLM("m", api_base="http://me:hunter22@example.com/v1")
    assert "hunter22" not in str(caught.value)


@pytest.mark.parametrize(
    ("address", "wanted"),
    [
        ("http://127.0.0.1:1/v1", True),
        ("http://127.8.9.1", True),
        ("http://[::1]:1/v1", True),
        ("https://localhost", True),
        ("http://localhost.example.com", False),
        ("http://192.168.0.1", False),
        ("", False),
        (None, False),
        ("http://[", False),
    ],
)
def test_loopback_addresses_are_told_from_others(address, wanted):
    assert is_loopback(address) is wanted


def test_a_missing_litellm_is_a_missing_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "litellm", None)
    with pytest.raises(MissingExtra) as caught:
        LiteLLM("gpt-4o")
    assert caught.value.pip == "pip install 'oodscen[llm]'"


def test_litellm_is_silent_and_asks_for_no_price_list():
    assert load_litellm().suppress_debug_info
    assert os.environ["LITELLM_LOCAL_MODEL_COST_MAP"] == "True"


def test_a_model_shows_neither_its_key_nor_the_password_in_its_address() -> None:
    shown = repr(
        LiteLLM(
            "gpt-4o",
            api_base="http://me:swordfish1@127.0.0.1:9/v1",
            options={"api_key": KEY, "extra_headers": {"Authorization": f"Bearer {KEY}"}},
        )
    )
    assert shown.startswith("LiteLLM(name='gpt-4o', api_base='http://")
    assert "swordfish" not in shown
    assert KEY not in shown


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("ALL_PROXY", "socks5h://127.0.0.1:9"),
        ("ALL_PROXY", "garbage:::/"),
        ("HTTPS_PROXY", "http://[::1"),
        *(("HTTPS_PROXY", f"http://127.0.0.1:{port}") for port in (-1, 0, 65_536, 99_999)),
        ("HTTP_PROXY", "127.0.0.1:70000"),
        ("SSL_CERT_FILE", "/nowhere/certificates.pem"),
    ],
)
def test_an_environment_that_httpx_cannot_use_is_named(monkeypatch, name, value):
    monkeypatch.setitem(sys.modules, "socksio", None)
    monkeypatch.setenv(name, value)
    with pytest.raises(UsageError, match=name):
        LiteLLM("openai/m", api_base="http://127.0.0.1:1/v1")


@pytest.mark.parametrize("key", ["sk-line-break-12\n", "sk-\u00e4\u00f6\u00fc-not-ascii"])
def test_a_key_that_no_request_can_carry_is_named(monkeypatch, key):
    monkeypatch.setenv("OPENAI_API_KEY", key)
    with serving() as server, pytest.raises(LLMError, match="cannot carry") as caught:
        server.client("openai/m", retries=0).complete(request())
    assert key.strip() not in str(caught.value)
    assert not server.received


def test_a_connection_that_is_refused_is_called_that():
    llm = LiteLLM("openai/m", api_base="http://127.0.0.1:1/v1", retries=0)
    with pytest.raises(LLMError, match="refused"):
        llm.complete(request())
