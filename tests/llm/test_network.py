"""Every byte of every exchange ends in time, and nothing goes where it must not."""

import asyncio
import base64
import json
import logging
import re
import socket
import threading
from concurrent.futures import ThreadPoolExecutor
from urllib.parse import quote

import httpcore
import httpx
import pytest

from oodscen.errors import LLMError, LLMTimeout
from oodscen.llm._ask import ask
from oodscen.llm._recording import Recorder
from oodscen.llm._remote.call_bounds import MAX_HEAD_BYTES, BoundReached, CallBounds, apply_bounds
from oodscen.llm._remote.limits import Limits
from oodscen.llm._remote.litellm import LiteLLM
from oodscen.llm._remote.offline import OutsideError, enforce, is_offline
from oodscen.llm._remote.transport import guard, responds
from oodscen.llm._replay import RecordingLLM
from oodscen.prompts._tree.imagine_scenario import ImagineScenario
from oodscen.protocols import Request
from oodscen.testing import AnsweringServer, ScriptedLLM
from tests.llm.rogue import BEGINNING, answering, dripping, redirecting, talking

PROMPT = ImagineScenario(shown=("A deer crosses.",))
REQUEST = Request(PROMPT, PROMPT.messages(), PROMPT.answer_schema())
PROXIES = ("HTTP_PROXY", "HTTPS_PROXY", "ALL_PROXY", "http_proxy", "https_proxy", "all_proxy")
KEYS = ("Zq7/x+9K", "k3y-0f-thirt!", "hV0f8m2Lr9wQb5Tz1Xc7Nn4Jd6Gk3Ps8Ya0Ue2Io")
PROCESSING = b"HTTP/1.1 102 Processing\r\n\r\n"


@pytest.fixture(scope="module", autouse=True)
def warm():
    """Let litellm load what it loads at the first call."""
    with AnsweringServer(ScriptedLLM(lambda asked: {"text": "A sofa."})) as server:
        server.client("m").complete(REQUEST)


def client(rogue, **settings):
    settings = {"retries": 0, "timeout_s": 20.0, "sleep": lambda seconds: None, **settings}
    return LiteLLM("m", api_base=rogue.address, **settings)


def in_a_loop(coroutine):
    """Run a coroutine in a thread of its own: litellm leaves a loop behind in this one."""
    with ThreadPoolExecutor(1) as pool:
        return pool.submit(asyncio.run, coroutine).result()


def refusal(llm):
    with pytest.raises(LLMError) as caught:
        llm.complete(REQUEST)
    return caught.value


# ------------------------------------------------------------------ time


DRIPS = {
    "responses that announce another": (b"", PROCESSING),
    "a status line": (b"HTTP/1.1 200 O", b"K"),
    "the name of a header": (b"HTTP/1.1 200 OK\r\nx", b"x"),
    "headers": (b"HTTP/1.1 200 OK\r\n", b"x-a: b\r\n"),
    "a body": (BEGINNING + b"content-length: 99999\r\n\r\n", b" "),
    "chunks": (BEGINNING + b"transfer-encoding: chunked\r\n\r\n", b"1\r\n \r\n"),
}


@pytest.mark.parametrize("what", DRIPS)
def test_whatever_drips_ends_in_time(what):
    with talking(dripping(*DRIPS[what])) as rogue:
        assert isinstance(refusal(client(rogue, timeout_s=0.1)), LLMTimeout)


@pytest.mark.parametrize("what", ["responses that announce another", "headers"])
def test_a_look_whether_a_server_is_there_ends_in_time(what):
    with talking(dripping(*DRIPS[what])) as rogue:
        assert not responds(rogue.address, 0.05)


def test_a_front_page_is_not_read():
    with talking(dripping(BEGINNING + b"content-encoding: gzip\r\n\r\n", b" ")) as rogue:
        assert responds(rogue.address.replace("//", "//me:hunter22hunter@"), 5.0)
    assert b"authorization" not in rogue.heard.lower()


def test_a_call_with_too_little_time_for_a_look_takes_none():
    looked = []
    endpoint = Limits(patience_s=40.0).endpoint("e")
    assert endpoint.is_alive("http://x", lambda url, seconds: looked.append(seconds), 9.0)
    assert not looked
    assert not endpoint.is_alive("http://x", lambda url, seconds: looked.append(seconds), 11.0)
    assert looked == [10.0]


def test_what_comes_before_a_body_has_an_end():
    with talking(dripping(b"", PROCESSING * 4_000, 0.0)) as rogue:
        assert "bytes" in str(refusal(client(rogue)))
    bounds = CallBounds(1.0, 10)
    bounds.note_request("http://x")
    with pytest.raises(BoundReached, match="1,000,000 bytes"):
        bounds.note_received(MAX_HEAD_BYTES + 1)


def test_a_second_request_of_a_call_begins_anew():
    bounds = CallBounds(1.0, 10)
    bounds.note_request("http://x/token")
    bounds.note_chunk(b"a token")
    bounds.note_request("http://x/v1")
    bounds.note_chunk(b"an answer")
    assert (bounds.head, bounds.received) == (b"an answer", 9)


def test_a_handshake_ends_in_time():
    with socket.create_server(("127.0.0.1", 0)) as server:
        address = f"https://127.0.0.1:{server.getsockname()[1]}/v1"
        llm = LiteLLM("m", api_base=address, retries=0, timeout_s=0.1)
        assert isinstance(refusal(llm), LLMError)


def test_a_tunnel_ends_in_time(monkeypatch):
    monkeypatch.setenv("OODSCEN_OFFLINE", "0")
    with talking(dripping(b"HTTP/1.1 200 OK\r\n", b"x: y\r\n")) as proxy:
        monkeypatch.setenv("https_proxy", f"http://127.0.0.1:{proxy.port}")
        llm = LiteLLM("m", api_base="https://model.invalid/v1", retries=0, timeout_s=0.1)
        assert isinstance(refusal(llm), LLMTimeout)
    assert proxy.heard.startswith(b"CONNECT model.invalid:443")


def test_a_name_is_looked_up_in_time(monkeypatch):
    monkeypatch.setenv("OODSCEN_OFFLINE", "0")
    over = threading.Event()
    monkeypatch.setattr(socket, "getaddrinfo", lambda *a, **k: over.wait() and [])
    llm = LiteLLM("m", api_base="http://model.invalid/v1", retries=0, timeout_s=0.1)
    assert isinstance(refusal(llm), LLMError)
    over.set()


def test_the_addresses_of_a_name_share_the_time(monkeypatch):
    monkeypatch.setenv("OODSCEN_OFFLINE", "0")
    tried = []

    class Backend(httpcore.SyncBackend):
        def connect_tcp(self, host, port, timeout=None, *rest):
            tried.append((host, timeout))
            raise httpcore.ConnectTimeout

    def lines(host, port, **more):
        return [(2, 1, 6, "", (f"192.0.2.{number}", port)) for number in range(4)]

    monkeypatch.setattr(socket, "getaddrinfo", lines)
    plain = httpx.Client(trust_env=False)
    plain._transport._pool._network_backend = Backend()
    with (
        apply_bounds(CallBounds(8.0, 100)),
        guard(plain) as asked,
        pytest.raises(httpx.ConnectTimeout),
    ):
        asked.get("http://model.invalid")
    assert [host for host, _ in tried] == [f"192.0.2.{number}" for number in range(4)]
    assert tried[0][1] <= 2.0


# ------------------------------------------------------------------ where it goes


@pytest.fixture
def key(monkeypatch):
    monkeypatch.setenv("OPENAI_API_KEY", KEYS[2])
    return KEYS[2].encode()


@pytest.mark.parametrize(("switch", "status"), [("0", 301), ("1", 302), ("0", 303), ("1", 308)])
def test_a_redirect_to_another_server_is_refused(monkeypatch, key, switch, status):
    monkeypatch.setenv("OODSCEN_OFFLINE", switch)
    with (
        talking(answering("stolen")) as other,
        talking(redirecting(other.address, status)) as rogue,
    ):
        error = refusal(client(rogue, retries=3))
    assert (other.heard, error.retryable, error.requests) == (b"", False, 1)
    assert key in rogue.heard
    assert f"redirects to http://127.0.0.1:{other.port}" in str(error)


@pytest.mark.parametrize(
    "target",
    [
        "https://127.0.0.1:{port}/v1",
        "//localhost:{port}/x",
        "http://:80",
        "http://[",
        "ftp://x/y",
        "\\\\x",
    ],
)
def test_a_redirect_to_anything_is_refused(target):
    with talking(redirecting(target)) as rogue:
        assert "redirects to" in str(refusal(client(rogue)))
    assert rogue.heard.count(b"POST /") == 1


@pytest.mark.parametrize("status", [302, 307])
def test_a_redirect_within_a_server_is_refused_and_named_without_its_query(key, status):
    with talking(redirecting("//me:secret@127.0.0.1:{port}/moved?key=secret", status)) as rogue:
        error = refusal(client(rogue, retries=3))
        assert f"redirects to http://127.0.0.1:{rogue.port}/moved," in str(error)
    assert (error.retryable, error.requests) == (False, 1)
    assert "secret" not in str(error)


@pytest.mark.parametrize("variable", PROXIES)
@pytest.mark.parametrize("switch", ["0", "1"])
def test_no_proxy_learns_a_question_or_a_key(monkeypatch, key, variable, switch):
    monkeypatch.setenv("OODSCEN_OFFLINE", switch)
    with talking(answering("proxied")) as proxy, talking(answering("direct")) as rogue:
        monkeypatch.setenv(variable, f"http://127.0.0.1:{proxy.port}")
        assert client(rogue).complete(REQUEST).text == "direct"
    assert proxy.heard == b""


def test_a_proxy_that_is_asked_encrypted_is_refused(monkeypatch):
    monkeypatch.setenv("OODSCEN_OFFLINE", "0")
    monkeypatch.setenv("https_proxy", "https://127.0.0.1:9")
    error = refusal(LiteLLM("m", api_base="https://model.invalid/v1", retries=0))
    assert "http:// only" in str(error)


def test_a_name_that_leads_elsewhere_is_refused_offline(monkeypatch):
    def elsewhere(host, port, *rest, **more):
        return [(socket.AF_INET, socket.SOCK_STREAM, 6, "", ("192.0.2.1", port))]

    monkeypatch.setattr(socket, "getaddrinfo", elsewhere)
    error = refusal(LiteLLM("m", api_base="http://localhost:1/v1", retries=0))
    assert "192.0.2.1 is not this machine" in str(error)
    assert not error.retryable


def test_offline_holds_for_every_socket(monkeypatch):
    def send():
        with socket.socket(type=socket.SOCK_DGRAM) as outside:
            outside.sendto(b"x", ("192.0.2.1", 53))

    enforce()
    assert is_offline()
    for contact in (
        lambda: socket.create_connection(("192.0.2.1", 80), timeout=0.01),
        lambda: socket.create_connection(("2001:db8::1", 80), timeout=0.01),
        lambda: socket.getaddrinfo("model.invalid", 80),
        lambda: socket.gethostbyname("model.invalid"),
        lambda: socket.gethostbyaddr("192.0.2.1"),
        lambda: socket.getnameinfo(("192.0.2.1", 53), 0),
        send,
        lambda: in_a_loop(asyncio.open_connection("192.0.2.1", 80)),
    ):
        with pytest.raises(OutsideError, match="is not this machine"):
            contact()
    assert socket.getaddrinfo("localhost", 80)
    assert socket.getaddrinfo(None, 0, flags=socket.AI_PASSIVE)
    here, there = socket.socketpair()
    here.close()
    there.close()
    monkeypatch.setenv("OODSCEN_OFFLINE", "")
    with socket.socket(type=socket.SOCK_DGRAM) as asked:
        asked.connect(("192.0.2.1", 9))


def test_a_call_within_a_running_loop_is_like_any_other():
    async def call():
        with AnsweringServer(
            ScriptedLLM(lambda asked: {"text": "A sofa lies on the road."})
        ) as server:
            return ask(server.client("m"), PROMPT).text

    assert in_a_loop(call()) == "A sofa lies on the road."


# ------------------------------------------------------------------ keys


def written(key):
    """Return how a key may turn up in what a server says."""
    data = key.encode()
    pair = base64.b64encode(b"user:" + data).decode()
    return (
        *(key, json.dumps(key)[1:-1], quote(key, safe=""), pair, data.hex(), data.hex(" ").upper()),
        *("".join(f"{mark}{byte:{form}}" for byte in data) for mark, form in BYTES),
        "".join(f"&#{byte};" for byte in data),
        key.replace("-", "&hyphen;").replace("!", "&excl;").replace("/", "&sol;"),
        str(list(data)),
    )


BYTES = (("\\", "03o"), ("=", "02X"), ("\\x", "02x"), ("%25", "02x"))
"""Marks of an escaped byte, each with the format of the number after it."""


@pytest.mark.parametrize("key", KEYS, ids=len)
@pytest.mark.parametrize(
    ("place", "status"), [("environment", 400), ("argument", 401), ("address", 403)]
)
def test_an_echoed_key_is_in_no_file_output_or_foreign_request(
    monkeypatch, tmp_path, capfd, key, place, status
):
    settings = {}
    echo = " ".join(json.dumps(form)[1:-1] for form in written(key))
    words = json.dumps(json.dumps({"text": f"A sofa lies there. {' '.join(written(key))}"}))[1:-1]
    with (
        talking(answering(words)) as other,
        talking(answering(words)) as good,
        talking(
            answering(echo, f"{status} {quote(key, safe='/+!')}", f"x-key: {key}\r\n")
        ) as denying,
        talking(redirecting(other.address)) as rogue,
    ):
        for variable in PROXIES:
            monkeypatch.setenv(variable, f"http://127.0.0.1:{other.port}")
        if place == "environment":
            monkeypatch.setenv("OPENAI_API_KEY", key)
        elif place == "argument":
            monkeypatch.delenv("OPENAI_API_KEY", raising=False)
            settings["options"] = {"api_key": key}
        else:
            settings["options"] = {"extra_headers": {"X-Api-Key": key}}
        llm = RecordingLLM(client(good, **settings), Recorder.at(tmp_path / "answers.jsonl"))
        said = ask(llm, PROMPT).text
        errors = [refusal(client(server, **settings)) for server in (denying, rogue)]
    assert key.encode() in good.heard
    assert other.heard == b""
    out, err = capfd.readouterr()
    files = "".join(file.read_text() for file in tmp_path.rglob("*") if file.is_file())
    for form in written(key):
        for text in (said, out, err, files, *(str(e) + repr(vars(e)) for e in errors)):
            assert form not in text
    assert re.fullmatch(r"A sofa lies there\.( \S*\[redacted\]\S*)+", said)


def test_a_model_of_ones_own_leaves_no_key_either(monkeypatch):
    monkeypatch.setenv("MY_TOKEN", KEYS[0])

    def fail(asked):
        raise ValueError("x" * 495 + KEYS[0])

    with pytest.raises(LLMError) as caught:
        ask(ScriptedLLM(fail), PROMPT)
    assert KEYS[0][:5] not in str(caught.value)
    llm = ScriptedLLM(lambda asked: {"text": f"{KEYS[0]} lies on the road there."})
    assert ask(llm, PROMPT).text == "[redacted] lies on the road there."


@pytest.mark.parametrize("key", KEYS, ids=len)
def test_no_logger_of_a_client_tells_a_key(monkeypatch, caplog, key):
    monkeypatch.setenv("OPENAI_API_KEY", key)
    with (
        talking(
            answering(f"Your key is {json.dumps(key)[1:-1]}.", headers=f"x-key: {key}\r\n")
        ) as rogue,
        caplog.at_level(logging.DEBUG),
    ):
        for name in ("openai", "httpx", "httpcore"):
            caplog.set_level(logging.DEBUG, name)
        client(rogue).complete(REQUEST)
    assert {record.name.partition(".")[0] for record in caplog.records} >= {"openai", "httpcore"}
    assert "[redacted]" in caplog.text
    assert key not in caplog.text


@pytest.mark.parametrize("key", KEYS[:2], ids=len)
def test_a_key_in_place_of_a_host_is_told_in_no_spelling(monkeypatch, key):
    key = key.replace("/", "-").replace("+", "-").rstrip("!")
    monkeypatch.setenv("OPENAI_API_KEY", key)
    with talking(redirecting(f"http://{key}.example.com/v1")) as rogue:
        assert key.casefold() not in str(refusal(client(rogue))).casefold()


@pytest.mark.parametrize("key", ["schl\u00fcssel-17", "line\nbreak-17"])
def test_a_key_that_cannot_be_sent_is_tried_once(monkeypatch, key):
    monkeypatch.setenv("OPENAI_API_KEY", key)
    waits = []
    with talking(answering("A sofa.")) as rogue:
        error = refusal(client(rogue, retries=5, sleep=waits.append))
    assert (waits, rogue.heard, error.retryable) == ([], b"", False)
    assert "characters that a request cannot carry" in str(error)
    assert "\\xfc" not in str(error)


# ------------------------------------------------------------------ endings


@pytest.mark.parametrize("ending", ["length", "max_tokens", "model_length", "error", "abort"])
def test_an_answer_that_its_server_calls_unfinished_is_no_shorter_one(ending):
    with talking(answering("I would stop", ending=ending)) as rogue:
        assert client(rogue).complete(REQUEST).is_cut_off


@pytest.mark.parametrize("ending", ["stop", "eos", "end_turn", "stop_sequence", "COMPLETE"])
def test_an_answer_that_ended_is_whole(ending):
    with talking(answering("I would stop", ending=ending)) as rogue:
        assert not client(rogue).complete(REQUEST).is_cut_off


def test_a_refusal_in_a_field_of_its_own_is_heard():
    declined = "I'm sorry, I can't assist with that."
    with talking(answering(f'", "refusal": "{declined}')) as rogue:
        assert client(rogue).complete(REQUEST).text == declined
