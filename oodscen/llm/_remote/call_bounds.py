"""Bounds on one call: wall-clock time and bytes.

A read timeout restarts with every byte, so it never ends a call whose server sends a byte now and then; and
an endless body fills the memory. The bounds stop both below the HTTP client.
"""

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Literal

INTERRUPTION_CHECK_S = 0.5
"""Interval at which an interruptible call checks whether it was interrupted, in seconds."""

MAX_HEAD_BYTES = 1_000_000
"""Maximum number of bytes before the body: headers, and informational responses."""

KEPT_BYTES = 20_000
"""Number of bytes of a body that are kept for an error message."""


Break = Literal["time", "size", "encoding", "silence", "closed", "redirect", "proxy", "offline"]
"""The reason why a call was ended.

It took too long, its response was too large or compressed, the server fell silent, the caller stopped
waiting, or the request would have gone to a forbidden address.
"""


class BoundReached(Exception):
    """Raised when a response is too large; callers never see it, as the client reports `CallBounds.broken`."""


class CallBounds:
    """The time and size limits of one call, and a record of what arrived.

    Args:
        seconds: Time until the end of the body.
        size: Largest body, in bytes.
        clock: Returns monotonic seconds.
        silence_s: Seconds without a byte after which the server is probed.
        is_alive: Returns whether the server at an address responds to anything, as far as it can tell within
            the given seconds.
        is_closed: Returns whether the caller has stopped waiting for the answer.
    """

    def __init__(
        self,
        seconds: float,
        size: int,
        clock: Callable[[], float] = time.monotonic,
        *,
        silence_s: float = math.inf,
        is_alive: Callable[[str, float], bool] = lambda url, seconds: True,
        is_closed: Callable[[], bool] | None = None,
    ) -> None:
        self.size = size
        self.silence_s = silence_s
        self.url = ""
        """Address of the last request sent."""
        self.is_sent = False
        """True once a request has passed through these bounds; some providers have their own clients."""
        self.status: int | None = None
        """Status of the response; `None` before there is one."""
        self.head = b""
        """The beginning of the last body."""
        self.received = 0
        """Bytes of the last body received so far."""
        self.broken: Break | None = None
        """The bound that was reached."""
        self.detail = ""
        """The refused address, or the number of bytes allowed; empty for other bounds."""
        self._is_alive = is_alive
        self._is_closed = is_closed
        self._silent_since = clock()
        self._head_bytes = 0
        self._clock = clock
        self._ends = clock() + seconds

    @property
    def is_over(self) -> bool:
        """True once the time is up."""
        return self._clock() >= self._ends

    @property
    def pace_s(self) -> float:
        """Longest read before `keeps_waiting` is called, in seconds."""
        check_s = math.inf if self._is_closed is None else INTERRUPTION_CHECK_S
        return min(self.silence_s, check_s)

    def stop(self, broken: Break, detail: str = "") -> None:
        """Record the bound that ends the call."""
        self.broken, self.detail = broken, detail

    def note_request(self, url: str) -> None:
        """Record that a request is about to be sent; what an earlier one brought, such as a token, is forgotten."""
        self.is_sent = True
        self.url = url
        self.status = None
        self.head = b""
        self.received = 0
        self._head_bytes = 0

    def note_received(self, size: int) -> None:
        """Record that the server sent bytes.

        Raises:
            BoundReached: When it sent too many of them and still no response.
        """
        self._silent_since = self._clock()
        self._head_bytes += size
        if self.status is None:
            self._check(self._head_bytes, MAX_HEAD_BYTES)

    def seconds_left(self, timeout: float | None) -> float:
        """Return the seconds that the next read or write may take; 0 or less if time is up."""
        if self._is_closed is not None and self._is_closed():
            self.stop("closed")
            return 0.0
        left = self._ends - self._clock()
        if left <= 0:
            self.stop("time")
            return 0.0
        return left if timeout is None else min(timeout, left)

    def keeps_waiting(self) -> bool:
        """Return whether to keep waiting for a server that has sent nothing for `pace_s`."""
        if self._clock() - self._silent_since < self.silence_s:
            return True
        if self._is_alive(self.url, self.seconds_left(None)):
            self._silent_since = self._clock()
            return True
        self.stop("silence")
        return False

    def note_chunk(self, chunk: bytes) -> None:
        """Record a chunk of the body.

        Raises:
            BoundReached: When the body is too large.
        """
        self.received += len(chunk)
        if len(self.head) < KEPT_BYTES:
            self.head += chunk[: KEPT_BYTES - len(self.head)]
        self.check_size(self.received)

    def check_size(self, size: int) -> None:
        """Raise `BoundReached` if a body of this size is too large."""
        self._check(size, self.size)

    def _check(self, size: int, largest: int) -> None:
        if size > largest:
            self.stop("size", f"{largest:,}")
            raise BoundReached(f"more than {largest:,} bytes")


_bounds: ContextVar[CallBounds | None] = ContextVar("bounds", default=None)


@contextmanager
def apply_bounds(bounds: CallBounds) -> Iterator[CallBounds]:
    """Apply these bounds to every request of this thread while the context lasts."""
    token = _bounds.set(bounds)
    try:
        yield bounds
    finally:
        _bounds.reset(token)


def active() -> CallBounds | None:
    """Return the bounds of this thread's call, or `None`."""
    return _bounds.get()
