"""Bounds on one call: wall-clock time and bytes.

A read timeout starts anew with every byte, so a server that sends a byte now and then is never timed
out by it; and a body without an end fills the memory. Both are stopped below the HTTP client.
"""

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Literal

LOOK_S = 0.5
"""How often a call that can be closed looks whether it is, in seconds."""

HEAD = 1_000_000
"""Most that is read before the body, in bytes: headers, and responses that announce another one."""

KEPT = 20_000
"""How much of a body is kept for the error that it may end in, in bytes."""


Break = Literal["time", "size", "encoding", "silence", "closed", "redirect", "proxy", "offline"]
"""Why a call was ended: it took too long, or its response was too large or compressed, or the server fell
silent, or nobody waits any more, or it would have gone where it must not."""


class BoundReached(Exception):
    """A response is larger than allowed; no caller sees it, the client reports `Bounds.broken`."""


class Bounds:
    """How long one call may take and how much it may receive; and what arrived.

    Args:
        seconds: Until the end of the body.
        size: Largest body, in bytes.
        clock: Monotonic seconds.
        silence_s: After how long without a byte the server is looked at.
        is_alive: Whether the server at an address still responds to anything, as far as can be found out
            in so many seconds.
        is_closed: Whether nobody waits for the answer any more.
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
        """Of the request that was sent last."""
        self.is_sent = False
        """Whether a request went through here at all; some providers have clients of their own."""
        self.status: int | None = None
        """Of the response; `None` while there is none."""
        self.head = b""
        """The beginning of the body."""
        self.received = 0
        """Bytes of the body so far."""
        self.broken: Break | None = None
        """Which bound was reached."""
        self.detail = ""
        """Where the call would have gone, or how many bytes were allowed."""
        self._is_alive = is_alive
        self._is_closed = is_closed
        self._silent_since = clock()
        self._read = 0
        self._clock = clock
        self._ends = clock() + seconds

    @property
    def is_over(self) -> bool:
        """Whether the time is up."""
        return self._clock() >= self._ends

    @property
    def pace_s(self) -> float:
        """Longest time to read before `endure` is asked, in seconds."""
        return self.silence_s if self._is_closed is None else min(self.silence_s, LOOK_S)

    def stop(self, broken: Break, detail: str = "") -> None:
        """Take note of the bound that ends the call."""
        self.broken, self.detail = broken, detail

    def sending(self, url: str) -> None:
        """Take note that a request is about to be sent."""
        self.is_sent, self.url, self.status, self._read = True, url, None, 0

    def heard(self, size: int) -> None:
        """Take note that the server sent something.

        Raises:
            BoundReached: When there is too much of it and still no response.
        """
        self._silent_since = self._clock()
        self._read += size
        if self.status is None and self._read > HEAD:
            self.stop("size", f"{HEAD:,}")
            raise BoundReached(f"more than {HEAD:,} bytes and no response")

    def left(self, timeout: float | None) -> float:
        """Return the seconds that the next read or write may take; 0 or less when time is up."""
        if self._is_closed is not None and self._is_closed():
            self.broken = "closed"
            return 0.0
        left = self._ends - self._clock()
        if left <= 0:
            self.broken = "time"
            return 0.0
        return left if timeout is None else min(timeout, left)

    def endure(self) -> bool:
        """Say whether to go on waiting for a server that has sent nothing for `pace_s`."""
        if self._clock() - self._silent_since < self.silence_s:
            return True
        if self._is_alive(self.url, self.left(None)):
            self._silent_since = self._clock()
            return True
        self.broken = "silence"
        return False

    def count(self, chunk: bytes) -> None:
        """Take note of a piece of the body.

        Raises:
            BoundReached: When the body is too large.
        """
        self.received += len(chunk)
        if len(self.head) < KEPT:
            self.head += chunk[: KEPT - len(self.head)]
        self.refuse(self.received)

    def refuse(self, size: int) -> None:
        """Raise `BoundReached` when a body of this size is too large."""
        if size > self.size:
            self.stop("size", f"{self.size:,}")
            raise BoundReached(f"the response has more than {self.size:,} bytes")


_bounds: ContextVar[Bounds | None] = ContextVar("bounds", default=None)


@contextmanager
def bounded(bounds: Bounds) -> Iterator[Bounds]:
    """Hold every request of this thread to these bounds while the context lasts."""
    token = _bounds.set(bounds)
    try:
        yield bounds
    finally:
        _bounds.reset(token)


def active() -> Bounds | None:
    """Return the bounds of this thread's call, if there is one."""
    return _bounds.get()
