"""Guards that make litellm's HTTP clients obey the bounds of a call, for every provider.

Outside `apply_bounds` nothing changes for other users of litellm in the same process.
"""

import socket
import ssl
import threading
import time
import zlib
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from contextvars import copy_context
from queue import Empty, SimpleQueue
from types import ModuleType
from typing import Any, TypeVar

import httpcore
import httpx

from oodscen._words.redaction import redact
from oodscen.llm._remote.call_bounds import (
    KEPT_BYTES,
    MAX_HEAD_BYTES,
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

Result = TypeVar("Result")


def responds(url: str, timeout_s: float) -> bool:
    """Return whether a server answers a request for its front page with anything, even an error.

    Nothing secret is sent, so its certificate is not verified, and the page itself is not read.
    """
    server = httpx.URL(url)
    page = httpx.URL(scheme=server.scheme, host=server.host, port=server.port, path="/")
    with (
        apply_bounds(CallBounds(timeout_s, MAX_HEAD_BYTES)) as bounds,
        suppress(httpx.HTTPError, BoundReached),
        guard(httpx.Client(verify=False, timeout=timeout_s)) as client,
    ):
        client.send(client.build_request("GET", page), stream=True).close()
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
    if _check_response not in hooks["response"]:
        hooks["request"].append(_prepare_request)
        hooks["response"].append(_check_response)
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


def _prepare_request(request: httpx.Request) -> None:
    if (bounds := active()) is not None:
        bounds.note_request(str(request.url))
        # The size of compressed data is unknown until it is unpacked.
        request.headers["accept-encoding"] = "identity"


def _check_response(response: httpx.Response) -> None:
    bounds = active()
    if bounds is None:
        return
    bounds.status = response.status_code
    if response.has_redirect_location:
        address = _redirect_address(response)
        bounds.stop("redirect", address)
        raise httpx.RemoteProtocolError(f"the server redirects to {address}")
    encoding = response.headers.get("content-encoding", "identity").strip().casefold()
    if encoding != "identity":
        bounds.head = _inflated(_beginning(response))
        bounds.stop("encoding")
        raise httpx.DecodingError("the response is compressed although plain text was asked for")
    announced = response.headers.get("content-length", "")
    size = int(announced) if announced.isdecimal() else 0
    if size > bounds.size:
        bounds.head = _beginning(response)
    bounds.check_size(size)
    if isinstance(response.stream, httpx.SyncByteStream):
        response.stream = _CountedStream(response.stream, bounds)


def _redirect_address(response: httpx.Response) -> str:
    """Return the address of a redirect without what may hold a credential: its user, password and query."""
    try:
        # Redacted first: a key in the place of a host is in lower case in the joined address.
        url = response.request.url.join(redact(response.headers["location"]))
        return redact(f"{url.scheme}://{url.netloc.decode('ascii')}{url.path}")[:_LONGEST_ADDRESS]
    except (httpx.InvalidURL, UnicodeError):
        return "a malformed address"


def _beginning(response: httpx.Response) -> bytes:
    """Return the beginning of a body that is about to be refused; a slow server does not delay the refusal."""
    beginning = CallBounds(BEGINNING_S, KEPT_BYTES)
    with apply_bounds(beginning), suppress(httpx.HTTPError, BoundReached):
        for chunk in response.iter_raw():
            beginning.note_chunk(chunk)
    return beginning.head


def _inflated(data: bytes) -> bytes:
    """Return the beginning of gzip or zlib data in plain, or any other data as it is."""
    try:
        return zlib.decompressobj(zlib.MAX_WBITS | 32).decompress(data, KEPT_BYTES)
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
        proxy_url = getattr(getattr(self._proxy, "_pool", None), "_proxy_url", None)
        if getattr(proxy_url, "scheme", b"http") == b"https":
            # TLS within TLS is read in records, on which no time limit can be set.
            bounds.stop("proxy")
            raise httpx.ProxyError("a proxy is asked over http:// only")
        return self._proxy.handle_request(request)

    def close(self) -> None:
        self._proxy.close()


class _CountedStream(httpx.SyncByteStream):
    """A body whose bytes are counted against the bounds of its call."""

    def __init__(self, inner: httpx.SyncByteStream, bounds: CallBounds) -> None:
        self._inner = inner
        self._bounds = bounds

    def __iter__(self) -> Iterator[bytes]:
        for chunk in self._inner:
            self._bounds.note_chunk(chunk)
            yield chunk

    def close(self) -> None:
        self._inner.close()


class _Stream(httpcore.NetworkStream):
    """A connection whose reads and writes end when a bound of the call is reached."""

    def __init__(self, inner: httpcore.NetworkStream) -> None:
        self._inner = inner

    def read(self, max_bytes: int, timeout: float | None = None) -> bytes:
        bounds = active()
        if bounds is None:
            return self._inner.read(max_bytes, timeout)
        data = _waited(bounds, timeout, lambda seconds: self._inner.read(max_bytes, seconds))
        bounds.note_received(len(data))
        return data

    def write(self, buffer: bytes, timeout: float | None = None) -> None:
        view = memoryview(buffer)
        for start in range(0, len(view), PIECE):
            self._inner.write(bytes(view[start : start + PIECE]), _seconds_left(timeout))

    def close(self) -> None:
        self._inner.close()

    def start_tls(
        self,
        ssl_context: ssl.SSLContext,
        server_hostname: str | None = None,
        timeout: float | None = None,
    ) -> httpcore.NetworkStream:
        bounds = active()
        context = ssl_context if bounds is None else _Handshake(ssl_context, bounds, timeout)
        # httpcore only asks a context to wrap its socket.
        return _Stream(self._inner.start_tls(context, server_hostname, timeout))  # type: ignore[arg-type]

    def get_extra_info(self, info: str) -> Any:
        return self._inner.get_extra_info(info)


class _Handshake:
    """A context for TLS whose handshakes end when a bound of the call is reached."""

    def __init__(self, context: ssl.SSLContext, bounds: CallBounds, timeout: float | None) -> None:
        self._context = context
        self._bounds = bounds
        self._timeout = timeout

    def wrap_socket(self, sock: socket.socket, server_hostname: str | None) -> ssl.SSLSocket:
        wrapped = self._context.wrap_socket(
            sock, server_hostname=server_hostname, do_handshake_on_connect=False
        )

        def shake_hands(seconds: float) -> None:
            wrapped.settimeout(seconds)
            wrapped.do_handshake()

        try:
            _waited(self._bounds, self._timeout, shake_hands)
        except BaseException:
            wrapped.close()
            raise
        self._bounds.note_received(0)
        return wrapped


class _Backend(httpcore.NetworkBackend):
    """Opens connections, with a share of the time for each of a server's addresses."""

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
        ends = time.monotonic() + min(CONNECT_S, _seconds_left(timeout) or CONNECT_S)
        addresses = _addresses(host, port, ends - time.monotonic())
        failure: Exception = httpcore.ConnectTimeout(f"{host} was not reached in time")
        for index, address in enumerate(addresses):
            share_s = (ends - time.monotonic()) / (len(addresses) - index)
            if share_s <= 0:
                break
            try:
                return _Stream(
                    self._inner.connect_tcp(address, port, share_s, local_address, socket_options)
                )
            except (httpcore.ConnectError, httpcore.ConnectTimeout) as error:
                failure = error
        raise failure

    def connect_unix_socket(
        self, path: str, timeout: float | None = None, socket_options: Iterable[Any] | None = None
    ) -> httpcore.NetworkStream:
        return _Stream(
            self._inner.connect_unix_socket(path, _seconds_left(timeout), socket_options)
        )

    def sleep(self, seconds: float) -> None:
        self._inner.sleep(seconds)


def _addresses(host: str, port: int, seconds: float) -> list[str]:
    """Return the addresses of a host within a time limit, which the system's look-up lacks."""
    results: SimpleQueue[list[str] | Exception] = SimpleQueue()

    def look_up() -> None:
        try:
            lines = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
            results.put(list(dict.fromkeys(str(line[4][0]) for line in lines)))
        except (OSError, UnicodeError) as error:
            results.put(error)

    threading.Thread(target=copy_context().run, args=(look_up,), daemon=True).start()
    try:
        result = results.get(timeout=seconds)
    except Empty:
        raise httpcore.ConnectTimeout(f"the address of {host} was not found in time") from None
    if isinstance(result, Exception):
        raise httpcore.ConnectError(str(result)) from result
    return result


def _waited(bounds: CallBounds, timeout: float | None, step: Callable[[float], Result]) -> Result:
    """Return the result of a step that waits for the server, taken again while a silent server is waited for.

    Args:
        bounds: The bounds of the call.
        timeout: Seconds that the step may take at most.
        step: Takes the seconds until it is to raise a timeout.

    Raises:
        httpcore.ReadTimeout: If the time of the call is up.
    """
    while True:
        left = bounds.seconds_left(timeout)
        if left <= 0:
            raise httpcore.ReadTimeout(_TOO_LONG)
        try:
            return step(min(left, bounds.pace_s))
        except (TimeoutError, httpcore.TimeoutException):
            if left > bounds.pace_s and not bounds.keeps_waiting():
                raise


def _seconds_left(timeout: float | None) -> float | None:
    """Return the seconds that a step of the call may take; outside calls, the timeout itself.

    Raises:
        httpcore.ReadTimeout: If the time of the call is up.
    """
    bounds = active()
    if bounds is None:
        return timeout
    left = bounds.seconds_left(timeout)
    if left <= 0:
        raise httpcore.ReadTimeout(_TOO_LONG)
    return left
