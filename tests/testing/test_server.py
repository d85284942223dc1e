"""The answering server recognises what it was told of, and refuses the rest."""

import json
import threading
import urllib.error
import urllib.request
from contextlib import closing
from http.client import HTTPConnection
from urllib.parse import urlsplit

import cv2
import numpy as np
import pytest

from oodscen._parallel.threads import as_finished
from oodscen.data._messages import Image
from oodscen.errors import LLMError, UnknownComponent
from oodscen.llm._ask import ask
from oodscen.llm._remote.litellm import LiteLLM
from oodscen.prompts._judging.describe_frame import DescribeFrame
from oodscen.testing import AnsweringServer, ScriptedLLM
from tests.prompts.samples import SAMPLES

IMAGINE = SAMPLES[3]


def post(server, body, path="/chat/completions"):
    data = body if isinstance(body, bytes) else json.dumps(body).encode()
    request = urllib.request.Request(server.api_base + path, data)
    try:
        with urllib.request.urlopen(request, timeout=5.0) as answer:
            return answer.status, json.load(answer)
    except urllib.error.HTTPError as error:
        with error:
            return error.code, json.load(error)


def echo(asked):
    return {"text": f"{asked.prompt.shown[0]} Draw number {asked.sample}."}


def test_many_threads_get_their_own_answers():
    prompts = [IMAGINE.model_copy(update={"shown": (f"Example {n}.",)}) for n in range(12)]
    with AnsweringServer(ScriptedLLM(echo)) as server:
        llm = server.client("m")
        pairs = as_finished(lambda p: ask(llm, p, sample=3).text, prompts, threads=6)
        assert {p.shown[0]: text for p, text in pairs} == {
            p.shown[0]: f"{p.shown[0]} Draw number 3." for p in prompts
        }
    assert len(server.received) == 12


def test_the_same_words_with_other_pictures_are_another_question(tmp_path):
    images = []
    for level in (0, 255):
        file = tmp_path / f"{level}.jpg"
        assert cv2.imwrite(str(file), np.full((8, 8, 3), level, np.uint8))
        images.append(Image.from_file(file))
    with AnsweringServer(
        ScriptedLLM(lambda asked: {"description": asked.prompt.frames[0].name})
    ) as server:
        llm = server.client("m")
        for image in (*images, *images):
            assert ask(llm, DescribeFrame(frames=(image,))).description == image.name


def test_a_picture_that_changed_since_it_was_named_is_refused(tmp_path):
    file = tmp_path / "a.jpg"
    assert cv2.imwrite(str(file), np.zeros((8, 8, 3), np.uint8))
    image = Image.from_file(file)
    assert cv2.imwrite(str(file), np.full((8, 8, 3), 99, np.uint8))
    llm = ScriptedLLM(lambda asked: {"description": "x"})
    with AnsweringServer(llm) as server, pytest.raises(LLMError, match="changed"):
        ask(server.client("m"), DescribeFrame(frames=(image,)))


def test_what_was_not_announced_is_refused():
    with AnsweringServer(ScriptedLLM(echo)) as server:
        with pytest.raises(LLMError, match="announced"):
            ask(LiteLLM("m", api_base=server.api_base), IMAGINE)
        hello = {"model": "m", "messages": [{"role": "user", "content": "hello"}]}
        assert post(server, hello)[0] == 400
        assert post(server, hello, "/embeddings")[0] == 404


@pytest.mark.parametrize(
    "url", ["https://example.com/a.jpg", "data:image/jpeg;base64,AAAA", "data:text/plain,x", "!"]
)
def test_only_pictures_are_pictures(url):
    content = [{"type": "image_url", "image_url": {"url": url}}]
    with AnsweringServer(ScriptedLLM(echo)) as server:
        status, body = post(
            server, {"model": "m", "messages": [{"role": "user", "content": content}]}
        )
    assert status == 400
    assert "unreadable" in body["error"]["message"]


HELLO = {"role": "user", "content": "hello"}


@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"{",
        b"\xff",
        b"[" * 100_000,
        [],
        None,
        {},
        {"messages": [HELLO]},
        {"messages": [HELLO], "model": None},
        {"messages": 1, "model": "m"},
        {"messages": ["hello"], "model": "m"},
        {"messages": [{"content": "hello"}], "model": "m"},
        {"messages": [{"role": [], "content": "hello"}], "model": "m"},
        {"messages": [{"role": "user", "content": [{}]}], "model": "m"},
        {"messages": [{"role": "user", "content": [{"type": "text", "text": 1}]}], "model": "m"},
        {
            "messages": [{"role": "user", "content": [{"type": "x", "image_url": "y"}]}],
            "model": "m",
        },
        {
            "messages": [{"role": "user", "content": [{"image_url": {"url": 1}, "type": 0}]}],
            "model": "m",
        },
    ],
)
def test_what_is_no_chat_request_is_refused_in_words(body):
    with AnsweringServer(ScriptedLLM(echo)) as server:
        status, answer = post(server, body)
        assert server.received == []
    assert status == 400
    assert answer["error"]["message"].startswith("unreadable request: ")


@pytest.mark.parametrize("length", ["", "x", "-1", "1e3"])
def test_an_unreadable_length_is_refused_in_words(length):
    with AnsweringServer(ScriptedLLM(echo)) as server:
        connection = HTTPConnection(urlsplit(server.api_base).netloc, timeout=5.0)
        with closing(connection):
            path = "/v1/chat/completions"
            connection.request("POST", path, headers={"content-length": length})
            response = connection.getresponse()
            assert response.status == 400
            assert b"unreadable request: " in response.read()


def test_a_client_that_leaves_is_no_failure(capfd):
    left = threading.Event()

    def wait(asked):
        assert left.wait(5.0)
        return {"text": "late" * 500_000}

    with AnsweringServer(ScriptedLLM(wait)) as server:
        try:
            with pytest.raises(LLMError):
                ask(server.client("m", timeout_s=0.2), IMAGINE)
        finally:
            left.set()
        for thread in threading.enumerate():
            if "process_request_thread" in thread.name:
                thread.join(5.0)
    assert "Traceback" not in capfd.readouterr().err


def test_faults_are_chosen_by_number_and_question():
    seen = []

    def faults(index, asked):
        seen.append((index, asked.prompt.purpose))
        return "malformed" if index == 0 else None

    with AnsweringServer(ScriptedLLM(echo), faults=faults) as server:
        ask(server.client("m"), IMAGINE)
    assert seen == [(0, "imagine-scenario"), (1, "imagine-scenario")]


def test_a_failure_of_the_model_is_an_error_of_the_server():
    def fail(asked):
        raise LLMError("the author is out")

    server = AnsweringServer(ScriptedLLM(fail))
    with server, pytest.raises(LLMError, match="the author is out"):
        ask(server.client("m"), IMAGINE)


def test_an_exception_of_the_double_is_told_and_ends_the_with_block():
    def fail(asked):
        raise FileNotFoundError("no answers.json")

    server = AnsweringServer(ScriptedLLM(fail))
    told = pytest.raises(LLMError, match="FileNotFoundError: no answers")
    with pytest.raises(FileNotFoundError, match="no answers"), server, told:
        ask(server.client("m"), IMAGINE)


def test_an_unknown_fault_is_refused_with_the_known_ones():
    server = AnsweringServer(ScriptedLLM(echo), faults=lambda index, asked: "truncate")
    told = pytest.raises(LLMError, match="unknown fault 'truncate'")
    refused = pytest.raises(UnknownComponent, match=r"did you mean truncated.*http500")
    with refused, server, told:
        ask(server.client("m"), IMAGINE)
    server = AnsweringServer(ScriptedLLM(echo), faults=lambda index, asked: 1 // 0)
    with pytest.raises(ZeroDivisionError), server, pytest.raises(LLMError):
        ask(server.client("m"), IMAGINE)


def test_received_headers_hold_no_credentials():
    names = "authorization api-key x-api-key x-goog-api-key proxy-authorization cookie".split()
    sent = {"x-team": "roads", **dict.fromkeys(names, "Bearer hunter2hunter2")}
    with AnsweringServer(ScriptedLLM(echo)) as server:
        data = json.dumps({"model": "m", "messages": [HELLO]}).encode()
        request = urllib.request.Request(f"{server.api_base}/chat/completions", data, sent)
        with pytest.raises(urllib.error.HTTPError) as caught:
            urllib.request.urlopen(request, timeout=5.0)
        caught.value.close()
    assert server.received[0].headers["x-team"] == "roads"
    assert not {*names} & {*server.received[0].headers}


def test_the_address_is_gone_with_the_context():
    threads = threading.active_count()
    with AnsweringServer(ScriptedLLM(echo)) as server:
        address = server.api_base
        assert address.startswith("http://127.0.0.1:")
    with pytest.raises(RuntimeError):
        server.api_base  # noqa: B018
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(address)
    assert threading.active_count() <= threads + 1
