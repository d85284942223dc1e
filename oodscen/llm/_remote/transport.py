"""Guards that make litellm's HTTP clients obey the bounds of a call, for every provider.

Outside `bounded` nothing changes for other users of litellm in the same process.
"""

import socket
import ssl
import threading
import time
import zlib
from collections.abc import Iterable, Iterator
from contextlib import suppress
from contextvars import copy_context
from queue import Empty, SimpleQueue
from types import ModuleType
from typing import Any

import httpcore
import httpx

from oodscen._redaction import redact
from oodscen.llm._remote.call_bounds import (
    HEAD,
    KEPT,
    BoundReached,
    CallBounds,
    active,
    apply_bounds,
)
from oodscen.llm._remote.offline import is_loopback, is_offline

CONNECT_S = 10.0
"""Longest time to find and connect to a server, in seconds; the time to answer is bounded elsewhere."""

PIECE = 16_384
"""Bytes handed to a connection at once; a piece is sent whole within the time limit, or not at all."""

BEGINNING_S = 1.0
"""Longest time to read the beginning of a refused body, in seconds."""

_LONGEST_ADDRESS = 300
"""Number of characters of a redirect's address that are shown."""

_TOO_LONG = "the call took too long as a whole"


def responds(url: str, timeout_s: float) -> bool:
    """Return whether a server answers a request for its front page with anything, even an error.

    Nothing secret is sent, so its certificate is not verified, and the page itself is not read.
    """
    asked = httpx.URL(url)
    page = httpx.URL(scheme=asked.scheme, host=asked.host, port=asked.port, path="/")
    with apply_bounds(CallBounds(timeout_s, HEAD)) as bounds:
        try:
            with guard(httpx.Client(verify=False, timeout=timeout_s)) as client:
                client.send(client.build_request("GET", page), stream=True).close()
        except (httpx.HTTPError, BoundReached):
            pass
    return bounds.status is not None


def guard(client: httpx.Client) -> httpx.Client:
    """Make a client obey its caller's bounds, and return it."""
    transports: Iterable[Any] = (client._transport, *client._mounts.values())
    for transport in transports:
        # httpx has no setting for the network backend, but httpcore has.
        pool: Any = getattr(transport, "_pool", None)
        backend = getattr(pool, "_network_backend", None)
        if backend is not None and not isinstance(backend, _Backend):
            pool._network_backend = _Backend(backend)
    for pattern, proxy in client._mounts.items():
        if proxy is not None and not isinstance(proxy, _Tunnel):
            client._mounts[pattern] = _Tunnel(proxy, client._transport)
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
        bounds.note_request(str(request.url))
        # The size of compressed data is unknown until it is unpacked.
        request.headers["accept-encoding"] = "identity"


def _watch(response: httpx.Response) -> None:
    bounds = active()
    if bounds is None:
        return
    bounds.status = response.status_code
    if response.has_redirect_location:
        target = _target(response)
        bounds.stop("redirect", target)
        raise httpx.RemoteProtocolError(f"the server redirects to {target}")
    encoding = response.headers.get("content-encoding", "identity").strip().casefold()
    if encoding != "identity":
        bounds.head = _inflated(_beginning(response))
        bounds.stop("encoding")
        raise httpx.DecodingError("the response is compressed although plain text was asked for")
    announced = response.headers.get("content-length", "")
    size = int(announced) if announced.isdecimal() else 0
    if size > bounds.size:
        bounds.head = _beginning(response)
    bounds.refuse(size)
    if isinstance(response.stream, httpx.SyncByteStream):
        response.stream = _CountedStream(response.stream, bounds)


def _target(response: httpx.Response) -> str:
    """Return the address of a redirect without what may hold a credential: its user, password and query."""
    try:
        # Redacted first: a key in the place of a host is in lower case in the joined address.
        url = response.request.url.join(redact(response.headers["location"]))
        return redact(f"{url.scheme}://{url.netloc.decode('ascii')}{url.path}")[:_LONGEST_ADDRESS]
    except (httpx.InvalidURL, UnicodeError):
        return "a malformed address"


def _beginning(response: httpx.Response) -> bytes:
    """Return the beginning of a body that is about to be refused; a slow server does not delay the refusal."""
    beginning = CallBounds(BEGINNING_S, KEPT)
    with apply_bounds(beginning), suppress(httpx.HTTPError, BoundReached):
        for chunk in response.iter_raw():
            beginning.count(chunk)
    return beginning.head


def _inflated(data: bytes) -> bytes:
    """Return the beginning of gzip or zlib data in plain, or any other data as it is."""
    try:
        return zlib.decompressobj(zlib.MAX_WBITS | 32).decompress(data, KEPT)
    except zlib.error:
        return data


class _Tunnel(httpx.BaseTransport):
    """A proxy that learns only the names of servers, and nothing while the network is forbidden.

    Unencrypted requests bypass it, since it could read their questions and keys.
    """

    def __init__(self, proxy: httpx.BaseTransport, direct: httpx.BaseTransport) -> None:
        self._proxy = proxy
        self._direct = direct

    def handle_request(self, request: httpx.Request) -> httpx.Response:
        if (bounds := active()) is None:
            return self._proxy.handle_request(request)
        url = request.url
        if is_offline() or url.scheme != "https" or is_loopback(str(url)):
            return self._direct.handle_request(request)
        asked = getattr(getattr(self._proxy, "_pool", None), "_proxy_url", None)
        if getattr(asked, "scheme", b"http") == b"https":
            # TLS within TLS is read in records, on which no time limit can be set.
            bounds.stop("proxy")
            raise httpx.ProxyError("a proxy is asked over http:// only")
        return self._proxy.handle_request(request)

    def close(self) -> None:
        self._proxy.close()


class _CountedStream(httpx.SyncByteStream):
    def __init__(self, inner: httpx.SyncByteStream, bounds: CallBounds) -> None:
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
            left = bounds.seconds_left(timeout)
            if left <= 0:
                raise httpcore.ReadTimeout(_TOO_LONG)
            try:
                data = self._inner.read(max_bytes, min(left, bounds.pace_s))
            except httpcore.ReadTimeout:
                if left > bounds.pace_s and not bounds.endure():
                    raise
            else:
                bounds.heard(len(data))
                return data

    def write(self, buffer: bytes, timeout: float | None = None) -> None:
        view = memoryview(buffer)
        for start in range(0, len(view), PIECE):
            self._inner.write(bytes(view[start : start + PIECE]), _left(timeout))

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
        if active() is None:
            return _Stream(
                self._inner.connect_tcp(host, port, timeout, local_address, socket_options)
            )
        ends = time.monotonic() + min(CONNECT_S, _left(timeout) or CONNECT_S)
        addresses = _addresses(host, port, ends - time.monotonic())
        failed: Exception = httpcore.ConnectTimeout(f"{host} was not reached in time")
        for number, address in enumerate(addresses):
            share = (ends - time.monotonic()) / (len(addresses) - number)
            if share <= 0:
                break
            try:
                return _Stream(
                    self._inner.connect_tcp(address, port, share, local_address, socket_options)
                )
            except (httpcore.ConnectError, httpcore.ConnectTimeout) as error:
                failed = error
        raise failed

    def connect_unix_socket(
        self, path: str, timeout: float | None = None, socket_options: Iterable[Any] | None = None
    ) -> httpcore.NetworkStream:
        return _Stream(self._inner.connect_unix_socket(path, _left(timeout), socket_options))

    def sleep(self, seconds: float) -> None:
        self._inner.sleep(seconds)


def _addresses(host: str, port: int, seconds: float) -> list[str]:
    """Return the addresses of a host within a time limit, which the system's look-up lacks."""
    found: SimpleQueue[list[str] | Exception] = SimpleQueue()

    def look() -> None:
        try:
            lines = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
            found.put(list(dict.fromkeys(str(line[4][0]) for line in lines)))
        except (OSError, UnicodeError) as error:
            found.put(error)

    threading.Thread(target=copy_context().run, args=(look,), daemon=True).start()
    try:
        result = found.get(timeout=seconds)
    except Empty:
        raise httpcore.ConnectTimeout(f"the address of {host} was not found in time") from None
    if isinstance(result, Exception):
        raise httpcore.ConnectError(str(result)) from result
    return result


def _left(timeout: float | None) -> float | None:
    bounds = active()
    if bounds is None:
        return timeout
    left = bounds.seconds_left(timeout)
    if left <= 0:
        raise httpcore.ReadTimeout(_TOO_LONG)
    return left
