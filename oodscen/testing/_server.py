"""A local OpenAI-compatible server that answers with any language model."""

import base64
import gzip
import hashlib
import json
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from email.message import Message
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, Literal, Self, get_args

from oodscen._display import Brief
from oodscen._words.redaction import secrets_in
from oodscen.errors import LLMError, UnknownComponent
from oodscen.llm._remote.litellm import LiteLLM
from oodscen.llm._remote.wire import provider_seed
from oodscen.protocols import LLM, Completion, Request

ResponseFault = Literal[
    "http400",
    "http401",
    "http429",
    "http500",
    "http503",
    "html",
    "empty",
    "reset",
    "slow",
    "slow_head",
    "processing",
    "huge",
    "packed",
    "redirect",
    "filtered",
]
"""The faults that replace the whole response."""

Fault = Literal[
    "malformed", "truncated", "wrong_schema", "null", "cut", "withheld", "flagged", ResponseFault
]
"""The faults that the server can produce.

In the answer: `malformed` sends prose, `truncated` half of the answer, `wrong_schema` another object, `null`
nothing. In the response: an HTTP status with the usual error body (`http429` with `Retry-After: 7`), a web page,
an empty body, a body shorter than announced, a connection closed without a response, a body or header sent byte
by byte without end (`slow`, `slow_head`), endless responses that announce another (`processing`), an endless
body (`huge`), a compressed one (`packed`), or a redirect to this server under another name (`redirect`).
The content filter: the question is refused with status 400 (`filtered`), the answer is left out (`withheld`), or
it is whole and marked as cut by the filter (`flagged`).
"""

_SIGNATURES = {"data:image/jpeg;base64": b"\xff\xd8\xff", "data:image/png;base64": b"\x89PNG"}
"""First bytes of a picture by the head of its data URL."""
_JSON_HEAD = b"HTTP/1.1 200 OK\r\ncontent-type: application/json\r\n\r\n"
_PAUSE_S = 0.02
"""Seconds between two bytes of a slow server."""

Faults = Callable[[int, Request | None], Fault | None]
"""Called with the index of the request, from 0, and the recognised question."""


@dataclass(frozen=True, repr=False)
class Received(Brief):
    """One received request."""

    body: dict[str, Any]
    """The request body as JSON."""
    headers: dict[str, str]
    """Headers by lower-case name, without credentials."""
    images: tuple[bytes, ...]
    """Pictures in the messages, decoded from their data URLs."""

    @property
    def messages(self) -> list[dict[str, Any]]:
        """The conversation in OpenAI's format."""
        messages: list[dict[str, Any]] = self.body["messages"]
        return messages


class AnsweringServer(Brief):
    """Serves `/v1/chat/completions` on 127.0.0.1 while the context is active.

    A chat request carries text and pictures but not the typed question that `llm` needs. So `client` returns
    a `LiteLLM` that announces every question to the server just before sending it. The server recognises the
    question by the request's roles, texts, picture hashes and seed. A request that was altered on its way is not
    recognised and is refused with status 400. Where `llm` or `faults` raises anything but an `LLMError`, or a fault
    is unknown, that request is refused likewise, and the with block ends with the exception.

    Args:
        llm: The model that answers.
        faults: Decides which requests fail, and how.

    Example:
        >>> with AnsweringServer(ConstantAnswerer()) as server:
        ...     evaluate(episodes, server.client("gpt-4o"))
    """

    _repr_fields = ("llm",)

    def __init__(self, llm: LLM, *, faults: Faults | None = None) -> None:
        self.llm = llm
        self.received: list[Received] = []
        """All chat requests so far, in order of arrival."""
        self._faults = faults
        self._questions: dict[str, Request] = {}
        self._lock = threading.Lock()
        self._http: ThreadingHTTPServer | None = None
        self._failure: Exception | None = None
        """The first exception of `llm` or `faults` that is no `LLMError`."""

    def __enter__(self) -> Self:
        self._http = _Server(self)
        threading.Thread(target=self._http.serve_forever, args=(0.02,), daemon=True).start()
        return self

    def __exit__(self, *error: object) -> None:
        if self._http is not None:
            self._http.shutdown()
            self._http.server_close()
            self._http = None
        failure, self._failure = self._failure, None
        if failure is not None:
            raise failure

    @property
    def api_base(self) -> str:
        """The address for `--api-base`, e.g. `http://127.0.0.1:40123/v1`."""
        if self._http is None:
            raise RuntimeError("the server runs only inside its with block")
        return f"http://127.0.0.1:{self._http.server_port}/v1"

    def client(self, model: str = "served", *, seed: int = 0, **settings: Any) -> LLM:
        """Return a model that litellm reaches through this server.

        Args:
            model: The model name, as for `LiteLLM`.
            seed: As for `LiteLLM`.
            settings: Further arguments of `LiteLLM`; by default retries do not wait.
        """
        settings = {"sleep": lambda seconds: None, "api_base": self.api_base, **settings}
        return _Announcing(self, LiteLLM(model, seed=seed, **settings))

    def _announce(self, request: Request, seed: int) -> None:
        """Register a question that a client is about to send with a provider seed."""
        turns = [
            (message.role, message.text, [image.sha256 for image in message.images])
            for message in request.messages
        ]
        with self._lock:
            self._questions[_key(turns, seed)] = request

    def _recognise(self, received: Received) -> Request | None:
        """Return the announced question that a conversation asks, or `None`."""
        turns = []
        for message in received.messages:
            texts, images = _content(message)
            turns.append((message["role"], texts, [hashlib.sha256(i).hexdigest() for i in images]))
        with self._lock:
            return self._questions.get(_key(turns, received.body.get("seed")))

    def _answer(self, received: Received) -> tuple[Fault | None, Completion | None]:
        """Store a request, and return the fault to produce and the model's answer.

        There is no answer where the fault replaces the response, or the question is not recognised.
        """
        with self._lock:
            index = len(self.received)
            self.received.append(received)
        request = self._recognise(received)
        fault = self._fault(index, request)
        if request is None or fault in get_args(ResponseFault):
            return fault, None
        return fault, self.llm.complete(request)

    def _fault(self, index: int, request: Request | None) -> Fault | None:
        """Return the fault to produce for a request, or `None`.

        Raises:
            UnknownComponent: If `faults` returns something else.
        """
        fault = self._faults(index, request) if self._faults else None
        if fault is not None and fault not in get_args(Fault):
            raise UnknownComponent("fault", str(fault), get_args(Fault))
        return fault

    def _fail(self, error: Exception) -> None:
        """Keep an exception for the end of the with block."""
        with self._lock:
            self._failure = self._failure or error


class _Server(ThreadingHTTPServer):
    request_queue_size = 128

    def __init__(self, answering: AnsweringServer) -> None:
        self.answering = answering
        super().__init__(("127.0.0.1", 0), _Handler)


class _Announcing:
    """Announces each question to the server before the client sends it."""

    def __init__(self, server: AnsweringServer, client: LiteLLM) -> None:
        self.name = client.name
        self.client = client
        self.limits = client.limits
        self._server = server

    def complete(self, request: Request) -> Completion:
        seed = provider_seed(self.client.seed, request.sample, request.attempt, request.repeat)
        self._server._announce(request, seed)
        return self.client.complete(request)


def _key(turns: Sequence[tuple[str, str, Sequence[str]]], seed: object) -> str:
    return hashlib.sha256(json.dumps([turns, seed]).encode()).hexdigest()


def _content(message: dict[str, Any]) -> tuple[str, list[bytes]]:
    """Split a message in OpenAI's format into its text and its pictures.

    Raises:
        ValueError: If a picture is not a base64 data URL of a JPEG or PNG file.
    """
    content = message["content"]
    if isinstance(content, str):
        return content, []
    texts, images = [], []
    for part in content:
        if part["type"] == "text":
            texts.append(part["text"])
            continue
        head, _, data = part["image_url"]["url"].partition(",")
        image = base64.b64decode(data, validate=True)
        if head not in _SIGNATURES or not image.startswith(_SIGNATURES[head]):
            raise ValueError(f"not a picture as a data URL: {head[:40]}")
        images.append(image)
    return "\n".join(texts), images


def _parsed(body: bytes, headers: Message) -> Received:
    """Return a request's content, without credentials.

    Raises:
        ValueError, KeyError, TypeError, AttributeError, RecursionError: If it is not a chat request.
    """
    document = json.loads(body)
    pictures: list[bytes] = []
    for message in document["messages"]:
        _, images = _content(message)
        pictures += images
        if not isinstance(message["role"], str):
            raise TypeError("a role is not text")
    if not isinstance(document["model"], str):
        raise TypeError("the model is not text")
    named = {name.lower(): value for name, value in headers.items()}
    kept = {k: v for k, v in named.items() if k != "cookie" and not secrets_in({k: v})}
    return Received(document, kept, tuple(pictures))


class _Handler(BaseHTTPRequestHandler):
    """Answers one request, or produces the fault that replaces the response."""

    server: _Server

    def do_POST(self) -> None:
        try:
            body = self._body()
            if self.path != "/v1/chat/completions":
                return self._error(404, f"there is no {self.path} here")
            received = _parsed(body, self.headers)
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
            return self._error(400, f"unreadable request: {error!r:.200}")
        try:
            fault, completion = self.server.answering._answer(received)
        except LLMError as error:
            return self._error(400, str(error))
        except Exception as error:
            self.server.answering._fail(error)
            return self._error(400, f"{type(error).__name__}: {error}")
        if fault is not None and fault in get_args(ResponseFault):
            return self._misbehave(fault)
        if completion is None:
            return self._error(400, "this conversation was not announced, or arrived changed")
        document = _chat_completion(received, completion, fault)
        return self._send(200, document, missing=999 if fault == "cut" else 0)

    def _body(self) -> bytes:
        length = int(self.headers.get("content-length", 0))
        if length < 0:
            raise ValueError(f"a body of {length} bytes")
        return self.rfile.read(length)

    def _misbehave(self, fault: str) -> None:
        if fault == "http429":
            self._error(429, "slow down", {"retry-after": "7"})
        elif fault.startswith("http"):
            self._error(int(fault[4:]), "injected fault")
        elif fault == "filtered":
            self._error(400, "rejected by our safety system", code="content_policy_violation")
        elif fault == "html":
            self._send(200, b"<!doctype html><html><body>Bad gateway</body></html>")
        elif fault == "empty":
            self._send(200, b"")
        elif fault == "packed":
            self._send(200, gzip.compress(b" " * 50_000_000), {"content-encoding": "gzip"})
        elif fault == "redirect":
            elsewhere = self.server.answering.api_base.replace("127.0.0.1", "localhost")
            self._send(307, b"", {"location": f"{elsewhere}/chat/completions"})
        elif fault == "processing":
            self._pour(b"", b"HTTP/1.1 102 Processing\r\n\r\n", _PAUSE_S)
        elif fault == "slow_head":
            self._pour(b"HTTP/1.1 200 OK\r\nx-slow: ", b"a", _PAUSE_S)
        elif fault == "slow":
            self._pour(_JSON_HEAD, b" ", _PAUSE_S)
        elif fault == "huge":
            self._pour(_JSON_HEAD, b" " * 65_536, 0.0)
        self.close_connection = True  # Which is all that `reset` does.

    def _pour(self, head: bytes, piece: bytes, pause_s: float) -> None:
        """Send pieces until the client disconnects."""
        try:
            self.wfile.write(head)
            while True:
                self.wfile.write(piece)
                time.sleep(pause_s)
        except OSError:
            return

    def _error(
        self,
        status: int,
        message: str,
        headers: dict[str, str] | None = None,
        code: str | None = None,
    ) -> None:
        document = {"error": {"message": message, "type": "injected", "code": code or status}}
        self._send(status, json.dumps(document).encode(), headers)

    def _send(
        self,
        status: int,
        body: bytes,
        headers: dict[str, str] | None = None,
        missing: int = 0,
    ) -> None:
        """Send a response whose announced length exceeds the body by the missing bytes."""
        self.send_response(status)
        for name, value in (headers or {}).items():
            self.send_header(name, value)
        self.send_header("content-type", "application/json")
        self.send_header("content-length", str(len(body) + missing))
        with suppress(ConnectionError):  # The client may have left.
            self.end_headers()
            self.wfile.write(body)

    def log_message(self, format: str, *args: Any) -> None:
        """Suppress the log."""


def _finish_reason(completion: Completion, fault: Fault | None) -> str:
    if fault in ("withheld", "flagged"):
        return "content_filter"
    return "length" if completion.is_cut_off or fault == "truncated" else "stop"


def _faulty_text(text: str, fault: Fault | None) -> str | None:
    if fault == "malformed":
        return "I would rather describe this in prose, without any structure."
    if fault == "truncated":
        return text[: len(text) // 2]
    if fault == "wrong_schema":
        return json.dumps({"unexpected": [1, 2, 3]})
    return None if fault in ("null", "withheld") else text


def _message(text: str | None, instead: str | None) -> dict[str, Any]:
    """Return the turn of an assistant, with a part that stands in place of its text."""
    message: dict[str, Any] = {"role": "assistant", "content": text}
    if instead == "a tool call":
        call = {"name": "answer", "arguments": "{}"}
        message["tool_calls"] = [{"id": "call-0", "type": "function", "function": call}]
    elif instead == "reasoning":
        message["reasoning_content"] = "The lane may be blocked."
    return message


def _chat_completion(received: Received, completion: Completion, fault: Fault | None) -> bytes:
    message = _message(_faulty_text(completion.text, fault), completion.instead)
    finish_reason = _finish_reason(completion, fault)
    prompt_tokens = sum(len(_content(turn)[0]) for turn in received.messages) // 4
    completion_tokens = -(-len(message["content"] or "") // 4)
    document = {
        "id": "chatcmpl-0",
        "object": "chat.completion",
        "created": 0,
        "model": received.body["model"],
        "choices": [{"index": 0, "finish_reason": finish_reason, "message": message}],
        "usage": {
            "prompt_tokens": prompt_tokens,
            "completion_tokens": completion_tokens,
            "total_tokens": prompt_tokens + completion_tokens,
        },
    }
    return json.dumps(document).encode()
