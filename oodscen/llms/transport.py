"""Bounds on one call: wall-clock time and bytes, for every provider that litellm asks through httpx.

A read timeout starts anew with every byte, so a server that sends a byte now and then is never timed
out by it; and a body without an end fills the memory. Both are stopped below the HTTP client, whatever
provider is asked. Outside `bounded` nothing changes for whoever else uses litellm in the same process.
"""

import ssl
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from types import ModuleType
from typing import Any, Literal

import httpcore
import httpx

KEPT = 20_000
"""How much of a body is kept for the error that it may end in, in bytes."""


class Bounds:
    """How long one call may take and how much it may receive; and what arrived.

    Args:
        seconds: Until the end of the body.
        size: Largest body, in bytes.
        clock: Monotonic seconds.
    """

    def __init__(
        self, seconds: float, size: int, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.size = size
        self.is_sent = False
        """Whether a request went through here at all; some providers have clients of their own."""
        self.status: int | None = None
        """Of the response; `None` while there is none."""
        self.head = b""
        """The beginning of the body."""
        self.received = 0
        """Bytes of the body so far."""
        self.broken: Literal["time", "size", "encoding"] | None = None
        """Which bound was reached."""
        self._clock = clock
        self._ends = clock() + seconds

    @property
    def is_over(self) -> bool:
        """Whether the time is up."""
        return self._clock() >= self._ends

    def left(self, timeout: float | None) -> float:
        """Return the seconds that the next read or write may take.

        Raises:
            httpcore.ReadTimeout: When there are none left.
        """
        left = self._ends - self._clock()
        if left <= 0:
            self.broken = "time"
            raise httpcore.ReadTimeout("the call took too long as a whole")
        return left if timeout is None else min(timeout, left)

    def count(self, chunk: bytes) -> None:
        """Take note of a piece of the body.

        Raises:
            httpx.ReadError: When the body is too large.
        """
        self.received += len(chunk)
        if len(self.head) < KEPT:
            self.head += chunk[: KEPT - len(self.head)]
        self.refuse(self.received)

    def refuse(self, size: int) -> None:
        """Raise `httpx.ReadError` when a body of this size is too large."""
        if size > self.size:
            self.broken = "size"
            raise httpx.ReadError(f"the response has more than {self.size:,} bytes")


_bounds: ContextVar[Bounds | None] = ContextVar("bounds", default=None)


@contextmanager
def bounded(bounds: Bounds) -> Iterator[Bounds]:
    """Hold every request of this thread to these bounds while the context lasts."""
    token = _bounds.set(bounds)
    try:
        yield bounds
    finally:
        _bounds.reset(token)


def guard(client: httpx.Client) -> httpx.Client:
    """Make a client heed the bounds of whoever calls it; return it."""
    transports: Iterable[Any] = (client._transport, *client._mounts.values())
    for transport in transports:
        # httpx takes no network backend, httpcore does.
        pool: Any = getattr(transport, "_pool", None)
        backend = getattr(pool, "_network_backend", None)
        if backend is not None and not isinstance(backend, _Backend):
            pool._network_backend = _Backend(backend)
    hooks = client.event_hooks
    if _watch not in hooks["response"]:
        hooks["request"].append(_ask_for_plain_text)
        hooks["response"].append(_watch)
        client.event_hooks = hooks
    return client


def install(handlers: ModuleType, openai: ModuleType) -> None:
    """Guard every client that litellm makes from now on.

    Args:
        handlers: `litellm.llms.custom_httpx.http_handler`.
        openai: `litellm.llms.openai.common_utils`.
    """
    create = handlers.HTTPHandler.create_client
    if getattr(create, "is_guarded", False):
        return

    def create_client(self: Any) -> httpx.Client:
        return guard(create(self))

    session = openai.BaseOpenAILLM._get_sync_http_client

    def get_sync_http_client() -> httpx.Client | None:
        client = session()
        return None if client is None else guard(client)

    create_client.is_guarded = True  # type: ignore[attr-defined]  # a mark on a function
    handlers.HTTPHandler.create_client = create_client
    openai.BaseOpenAILLM._get_sync_http_client = staticmethod(get_sync_http_client)


def _ask_for_plain_text(request: httpx.Request) -> None:
    if (bounds := _bounds.get()) is not None:
        bounds.is_sent = True
        # What is compressed has no size before it is unpacked.
        request.headers["accept-encoding"] = "identity"


def _watch(response: httpx.Response) -> None:
    bounds = _bounds.get()
    if bounds is None:
        return
    bounds.status = response.status_code
    if response.headers.get("content-encoding", "identity").strip().casefold() != "identity":
        bounds.broken = "encoding"
        raise httpx.DecodingError("the response is compressed although plain text was asked for")
    announced = response.headers.get("content-length", "")
    bounds.refuse(int(announced) if announced.isdecimal() else 0)
    if isinstance(response.stream, httpx.SyncByteStream):
        response.stream = _Counted(response.stream, bounds)


class _Counted(httpx.SyncByteStream):
    def __init__(self, inner: httpx.SyncByteStream, bounds: Bounds) -> None:
        self._inner = inner
        self._bounds = bounds

    def __iter__(self) -> Iterator[bytes]:
        for chunk in self._inner:
            self._bounds.count(chunk)
            yield chunk

    def close(self) -> None:
        self._inner.close()


class _Stream(httpcore.NetworkStream):
    def __init__(self, inner: httpcore.NetworkStream) -> None:
        self._inner = inner

    def read(self, max_bytes: int, timeout: float | None = None) -> bytes:
        return self._inner.read(max_bytes, _left(timeout))

    def write(self, buffer: bytes, timeout: float | None = None) -> None:
        self._inner.write(buffer, _left(timeout))

    def close(self) -> None:
        self._inner.close()

    def start_tls(
        self,
        ssl_context: ssl.SSLContext,
        server_hostname: str | None = None,
        timeout: float | None = None,
    ) -> httpcore.NetworkStream:
        return _Stream(self._inner.start_tls(ssl_context, server_hostname, _left(timeout)))

    def get_extra_info(self, info: str) -> Any:
        return self._inner.get_extra_info(info)


class _Backend(httpcore.NetworkBackend):
    def __init__(self, inner: httpcore.NetworkBackend) -> None:
        self._inner = inner

    def connect_tcp(
        self,
        host: str,
        port: int,
        timeout: float | None = None,
        local_address: str | None = None,
        socket_options: Iterable[Any] | None = None,
    ) -> httpcore.NetworkStream:
        return _Stream(
            self._inner.connect_tcp(host, port, _left(timeout), local_address, socket_options)
        )

    def connect_unix_socket(
        self, path: str, timeout: float | None = None, socket_options: Iterable[Any] | None = None
    ) -> httpcore.NetworkStream:
        return _Stream(self._inner.connect_unix_socket(path, _left(timeout), socket_options))

    def sleep(self, seconds: float) -> None:
        self._inner.sleep(seconds)


def _left(timeout: float | None) -> float | None:
    bounds = _bounds.get()
    return timeout if bounds is None else bounds.left(timeout)
