"""Makes the HTTP clients of litellm heed the bounds of a call, whatever provider is asked.

Outside `bounded` nothing changes for whoever else uses litellm in the same process.
"""

import ssl
from collections.abc import Iterable, Iterator
from types import ModuleType
from typing import Any

import httpcore
import httpx

from oodscen.llms.bounds import Bounds, active

CONNECT_S = 10.0
"""Longest time to reach a server, in seconds; what it takes to answer is another matter."""

_TOO_LONG = "the call took too long as a whole"


def responds(url: str, timeout_s: float) -> bool:
    """Whether a server says anything at all, be it an error, when its front page is asked for.

    Nothing secret is sent, so its certificate does not matter.
    """
    try:
        httpx.get(httpx.URL(url).join("/"), timeout=timeout_s, verify=False)
    except httpx.TransportError:
        return False
    return True


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
    if (bounds := active()) is not None:
        bounds.is_sent = True
        bounds.url = str(request.url)
        # What is compressed has no size before it is unpacked.
        request.headers["accept-encoding"] = "identity"


def _watch(response: httpx.Response) -> None:
    bounds = active()
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
        bounds = active()
        if bounds is None:
            return self._inner.read(max_bytes, timeout)
        while True:
            left = bounds.left(timeout)
            if left <= 0:
                raise httpcore.ReadTimeout(_TOO_LONG)
            try:
                data = self._inner.read(max_bytes, min(left, bounds.pace_s))
            except httpcore.ReadTimeout:
                if left > bounds.pace_s and not bounds.endure():
                    raise
            else:
                bounds.heard()
                return data

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
        left = _left(timeout)
        if active() is not None and left is not None:
            left = min(left, CONNECT_S)
        return _Stream(self._inner.connect_tcp(host, port, left, local_address, socket_options))

    def connect_unix_socket(
        self, path: str, timeout: float | None = None, socket_options: Iterable[Any] | None = None
    ) -> httpcore.NetworkStream:
        return _Stream(self._inner.connect_unix_socket(path, _left(timeout), socket_options))

    def sleep(self, seconds: float) -> None:
        self._inner.sleep(seconds)


def _left(timeout: float | None) -> float | None:
    bounds = active()
    if bounds is None:
        return timeout
    left = bounds.left(timeout)
    if left <= 0:
        raise httpcore.ReadTimeout(_TOO_LONG)
    return left
