"""A call ends in time and in bounded memory, whatever the server sends."""

import gzip
import json
import logging
import socket
import ssl
import threading
import time
import tracemalloc
import zlib
from contextlib import contextmanager, suppress

import httpx
import pytest

from oodscen.errors import EndpointDown, LLMError, LLMTimeout, ResponseError, RunStopped
from oodscen.llm._remote.call_bounds import CallBounds, apply_bounds
from oodscen.llm._remote.limits import Limits
from oodscen.llm._remote.litellm import LiteLLM
from oodscen.llm._remote.transport import guard
from oodscen.prompts._tree.imagine_scenario import ImagineScenario
from oodscen.protocols import Request
from oodscen.testing import AnsweringServer, ScriptedLLM
from tests.llm.rogue import saying, talking

PROMPT = ImagineScenario(shown=("A deer crosses.",))
REQUEST = Request(PROMPT, PROMPT.messages(), PROMPT.answer_schema())


@pytest.fixture(scope="module", autouse=True)
def warm():
    """Let litellm load what it loads at the first call."""
    with AnsweringServer(ScriptedLLM(lambda asked: {"text": "A sofa."})) as server:
        server.client("m").complete(REQUEST)


def failing(fault, **settings):
    author = ScriptedLLM(lambda asked: {"text": "A sofa."})
    with (
        AnsweringServer(author, faults=lambda index, asked: fault) as server,
        pytest.raises(LLMError) as caught,
    ):
        server.client("m", retries=0, **settings).complete(REQUEST)
    return caught.value


@pytest.mark.parametrize("fault", ["slow", "slow_head"])
def test_a_server_that_sends_a_byte_now_and_then_is_left(fault):
    began = time.monotonic()
    error = failing(fault, timeout_s=0.15)
    assert time.monotonic() - began < 2.0
    assert error.retryable
    assert "in time" in str(error)


def test_a_body_without_an_end_is_left_in_bounded_memory():
    tracemalloc.start()
    try:
        error = failing("huge", max_bytes=10_000_000)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert isinstance(error, ResponseError)
    assert "10,000,000" in str(error)
    assert peak < 40_000_000


def test_a_compressed_body_is_not_unpacked():
    error = failing("packed")
    assert isinstance(error, ResponseError)
    assert "compressed" in str(error)


@pytest.mark.parametrize(
    ("headers", "body"),
    [
        ("", b"<html>" + b" " * 12_000_000),
        ("content-length: 12000000\r\n", b"<html>" + b" " * 12_000_000),
        ("content-length: 12000000\r\n", b"<html>"),
        ("content-encoding: gzip\r\n", gzip.compress(b"<html>" * 100, mtime=0)),
        ("content-encoding: gzip\r\n", gzip.compress(b"<html>" + bytes(20_000_000), mtime=0)),
        ("content-encoding: deflate\r\n", zlib.compress(b"<html>" * 100)),
        ("content-encoding: br\r\n", b"<html> this is not packed at all"),
    ],
)
def test_the_beginning_of_a_refused_response_is_kept(monkeypatch, headers, body):
    monkeypatch.setattr("oodscen.llm._remote.transport.BEGINNING_S", 0.1)
    head = f"HTTP/1.1 200 OK\r\nconnection: close\r\n{headers}\r\n".encode()
    with talking(saying(head + body)) as rogue, pytest.raises(ResponseError) as caught:
        LiteLLM("m", api_base=rogue.address, retries=0).complete(REQUEST)
    assert caught.value.raw.startswith("<html>")
    assert len(caught.value.raw) <= 4_000


USAGE = {"prompt_tokens": "many", "completion_tokens": -3.5, "total_tokens": [1]}
MESSAGE = {"role": "assistant", "content": [{"type": "text", "text": "A sofa."}]}


@pytest.mark.parametrize(
    "response",
    [
        {"choices": []},
        {"choices": ["A sofa."]},
        {"choices": [{"message": MESSAGE}], "usage": USAGE},
        {"choices": [{"message": MESSAGE}], "usage": "none"},
    ],
)
def test_a_response_of_another_form_is_one_error_without_warnings(response, recwarn):
    body = json.dumps({"id": "1", "object": "chat.completion", "model": "m", **response})
    head = f"HTTP/1.1 200 OK\r\ncontent-length: {len(body)}\r\nconnection: close\r\n\r\n"
    with (
        talking(saying(f"{head}{body}".encode())) as rogue,
        pytest.raises(ResponseError) as caught,
    ):
        LiteLLM("m", api_base=rogue.address, retries=0).complete(REQUEST)
    assert "IndexError" not in str(caught.value)
    assert not [one for one in recwarn if issubclass(one.category, UserWarning)]


@pytest.mark.parametrize(("fault", "raw"), [("html", "<!doctype html>"), ("empty", "")])
def test_a_response_that_is_none_is_kept_for_reading(fault, raw):
    error = failing(fault)
    assert isinstance(error, ResponseError)
    assert (error.status, error.requests, error.retryable) == (200, 1, True)
    assert error.raw.startswith(raw)
    assert bool(error.raw) == bool(raw)


@contextmanager
def silent(scheme="http"):
    """Accept connections and say nothing."""
    with socket.create_server(("127.0.0.1", 0), backlog=16) as server:
        yield f"{scheme}://127.0.0.1:{server.getsockname()[1]}/v1"


@pytest.mark.parametrize("scheme", ["http", "https"])
def test_a_server_that_says_nothing_ends_the_run_long_before_the_timeout(scheme):
    limits = Limits(patience_s=0.2)
    with silent(scheme) as address:
        llm = LiteLLM("m", api_base=address, timeout_s=20, limits=limits, sleep=lambda s: None)
        with pytest.raises(EndpointDown, match="says nothing"):
            llm.complete(REQUEST)


def test_a_server_behind_a_proxy_that_says_nothing_ends_the_run_as_well(monkeypatch):
    monkeypatch.setenv("OODSCEN_OFFLINE", "0")

    def connecting(rogue, connection, head):
        connection.sendall(b"HTTP/1.1 200 Connection established\r\n\r\n")
        rogue.over.wait()

    with talking(connecting) as proxy:
        monkeypatch.setenv("https_proxy", f"http://127.0.0.1:{proxy.port}")
        llm = LiteLLM(
            "m",
            api_base="https://model.invalid/v1",
            timeout_s=20,
            limits=Limits(patience_s=0.2),
            sleep=lambda s: None,
        )
        with pytest.raises(EndpointDown, match="says nothing"):
            llm.complete(REQUEST)
    assert b"\r\n\r\nCONNECT model.invalid:443" in proxy.heard


ANONYMOUS = "AECDH-AES128-SHA:@SECLEVEL=0"
"""Encryption without a certificate."""


def anonymous(protocol):
    context = ssl.SSLContext(protocol)
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    context.maximum_version = ssl.TLSVersion.TLSv1_2
    context.set_ciphers(ANONYMOUS)
    return context


def asked_with_a_slow_handshake(answers):
    """Ask a server that waits with its handshake for the last of `answers`, which looks for it find in turn."""
    looks = list(answers)
    hello = threading.Event()

    def serve(listener):
        connection, _ = listener.accept()
        with connection, suppress(OSError):
            hello.wait(5)
            with anonymous(ssl.PROTOCOL_TLS_SERVER).wrap_socket(
                connection, server_side=True
            ) as tls:
                tls.recv(65_536)
                tls.sendall(b"HTTP/1.1 200 OK\r\ncontent-length: 0\r\n\r\n")

    def is_alive(url, seconds):
        if len(looks) > 1:
            return looks.pop(0)
        hello.set()
        return looks[0]

    bounds = CallBounds(20.0, 100, silence_s=0.05, is_alive=is_alive)
    with socket.create_server(("127.0.0.1", 0)) as listener, apply_bounds(bounds):
        threading.Thread(target=serve, args=(listener,), daemon=True).start()
        client = guard(httpx.Client(verify=anonymous(ssl.PROTOCOL_TLS_CLIENT)))
        with client, suppress(httpx.TransportError):
            client.get(f"https://127.0.0.1:{listener.getsockname()[1]}/")
    return bounds


def test_a_server_with_a_slow_handshake_that_responds_to_others_is_waited_for():
    bounds = asked_with_a_slow_handshake([True, True])
    assert (bounds.status, bounds.broken) == (200, None)


def test_a_server_that_falls_silent_during_a_handshake_is_left():
    bounds = asked_with_a_slow_handshake([True, False])
    assert (bounds.status, bounds.broken) == (None, "silence")


def test_a_late_answer_of_a_server_that_is_there_is_no_silence():
    limits = Limits(patience_s=20.0)
    author = ScriptedLLM(lambda asked: {"text": "A sofa."})
    with AnsweringServer(author, faults=lambda index, asked: "slow_head") as server:
        llm = server.client("m", limits=limits, timeout_s=0.05, retries=0)
        with pytest.raises(LLMTimeout):
            llm.complete(REQUEST)
    with silent() as address:
        llm = LiteLLM(
            "m", api_base=address, timeout_s=0.05, retries=0, limits=Limits(patience_s=2.0)
        )
        with pytest.raises(LLMError) as caught:
            llm.complete(REQUEST)
    assert type(caught.value) is LLMError


def test_an_interruption_ends_what_is_under_way(monkeypatch):
    monkeypatch.setattr("oodscen.llm._remote.call_bounds.INTERRUPTION_CHECK_S", 0.01)
    now = [0.0]
    limits = Limits(clock=lambda: now[0])

    def faults(index, asked):
        limits.close()
        now[0] += 60.0
        return "slow"

    author = ScriptedLLM(lambda asked: {"text": "A sofa."})
    with AnsweringServer(author, faults=faults) as server, pytest.raises(RunStopped):
        server.client("m", limits=limits, timeout_s=600).complete(REQUEST)
    assert len(server.received) == 1


def test_a_slow_server_that_responds_to_others_is_waited_for():
    def answer(asked):
        time.sleep(0.3)
        return {"text": "A sofa."}

    limits = Limits(patience_s=20.0)
    with AnsweringServer(ScriptedLLM(answer)) as server:
        limits.endpoint(server.api_base).silence_s = 0.1
        llm = server.client("m", limits=limits)
        assert "A sofa." in llm.complete(REQUEST).text
    assert len(server.received) == 1


def test_what_is_kept_is_bounded():
    assert len(failing("huge", max_bytes=1_000_000).raw) <= 4_000


def test_time_is_counted_from_the_beginning_and_not_from_the_last_byte():
    now = 0.0
    bounds = CallBounds(10.0, 100, clock=lambda: now)
    assert bounds.seconds_left(3.0) == 3.0
    now = 8.0
    assert bounds.seconds_left(3.0) == 2.0
    assert bounds.seconds_left(None) == 2.0
    now = 10.0
    assert bounds.seconds_left(3.0) == 0.0
    assert bounds.broken == "time"


@pytest.mark.parametrize("reason", ["sk-echoed-0123456789", "\x1b[31mzap", "nonsense"])
def test_what_a_server_sends_is_not_logged(monkeypatch, capfd, reason):
    monkeypatch.setenv("OPENAI_API_KEY", "sk-echoed-0123456789")
    answer = {"choices": [{"finish_reason": reason, "message": {"content": '{"text": "A sofa."}'}}]}
    body = json.dumps(answer).encode()
    head = f"HTTP/1.1 200 OK\r\nconnection: close\r\ncontent-length: {len(body)}\r\n\r\n".encode()
    with talking(saying(head + body)) as rogue:
        LiteLLM("openai/m", api_base=rogue.address, retries=0).complete(REQUEST)
    assert capfd.readouterr().err == ""
    logging.getLogger("LiteLLM").error("outside of a call: %s", reason)
    logged = capfd.readouterr().err
    assert "outside of a call" in logged
    assert "sk-echoed" not in logged.replace("\n", "")
    assert "\x1b[31m" not in logged


def test_a_log_line_that_cannot_be_put_together_fails_no_call(caplog):
    logging.getLogger("openai").warning("%s and %s", "one")
    assert "%s and %s" in caplog.text
