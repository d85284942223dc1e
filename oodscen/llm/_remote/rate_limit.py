"""One server: its rate limit, and when it or a model on it is given up."""

import math
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager

from oodscen.errors import EndpointDown
from oodscen.llm._remote.failures import FailedAttempt

CONCURRENCY = 8
"""Default number of concurrent requests to one endpoint."""

PATIENCE_S = 40.0
"""Seconds without a response to any request after which an endpoint is given up.

A slow server that responds to other requests is waited for.
"""

STRIKES = 5
"""Number of consecutive failed calls after which a model is given up."""

JUDGING = 4.0
"""Leniency with judged models, for which a failed item says little about the next one."""

_LENIENCY: Mapping[str, float] = {
    "limit": 1.0,
    "unreachable": 2.0,
    "erring": math.inf,
    "late": math.inf,
}
"""Failures that count against a model, each with the maximum leniency for it."""


class Endpoint:
    """One server, with its rate limit and its circuit breakers.

    The number of concurrent requests is halved when the server reports too many, and grows by one after as
    many answers as are allowed at once, so it follows the rate that the server grants. The server is given up
    for good when no request got a response for `patience_s`, not counting time without any request. A
    model on it is given up when `strikes` of its calls in a row failed, or when a key is refused. Every later
    request then raises `EndpointDown`. With `patience_s=None` nothing is given up.

    `leniency` multiplies the strikes for failures that may be the item's own fault (server errors, timeouts).
    If it exceeds 1, a model that has used up its plain strikes is in doubt: each call gets one attempt, until
    an answer clears the model.
    """

    def __init__(
        self,
        name: str,
        *,
        concurrency: int = CONCURRENCY,
        patience_s: float | None = PATIENCE_S,
        strikes: int = STRIKES,
        leniency: float = 1.0,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.name = name
        self.concurrency = max(1, concurrency)
        self.window = float(self.concurrency)
        """Number of requests allowed at once at present."""
        self.patience_s = patience_s
        self.strikes = strikes
        self.leniency = leniency
        self.silence_s = math.inf if patience_s is None else 0.75 * patience_s
        """Seconds without a byte after which the server is probed."""
        self._clock = clock
        self._running = 0
        self._failed_calls: dict[str, Counter[str]] = {}
        """Calls of each model that failed since its last answer, by the kind of failure."""
        self._last_response_at = -math.inf
        self._silent_since: float | None = None
        self._idle_since: float | None = None
        """Time at which a call failed while no other request was under way; `None` once one failed later."""
        self._narrowed_at = -1.0
        self._not_before = 0.0
        self._refused_at = 0.0
        self._down: dict[str | None, EndpointDown] = {}
        """The models that are given up, and with the key `None` the server."""
        self._slot_free = threading.Condition()
        self._probe_lock = threading.Lock()
        self._last_probe: tuple[float, bool] | None = None
        """Time of the last probe, and whether the server responded."""

    @contextmanager
    def slot(self, model: str = "") -> Iterator[float]:
        """Wait for a free slot and yield the time at which it was taken.

        Args:
            model: The model that is asked; each model is given up separately.

        Raises:
            EndpointDown: When the server or the model is given up.
        """
        with self._slot_free:
            self._slot_free.wait_for(
                lambda: self._fault(model) is not None or self._running < max(1, int(self.window))
            )
            self.check(model)
            self._running += 1
        try:
            yield self._clock()
        finally:
            with self._slot_free:
                self._running -= 1
                self._slot_free.notify_all()

    def check(self, model: str = "") -> None:
        """Raise `EndpointDown` if the server or this model is given up."""
        if (fault := self._fault(model)) is not None:
            raise EndpointDown(fault.endpoint, fault.reason)

    def is_doubted(self, model: str = "") -> bool:
        """Return whether a model's recent failures limit each call to one attempt."""
        failed_calls = self._failed_calls.get(model, Counter())
        return self.leniency > 1 and failed_calls.total() >= self.strikes

    def pause(self, longest_s: float = math.inf) -> float:
        """Return the seconds to wait before the next request, as the server demanded.

        Args:
            longest_s: Longest wait after the last refusal, in seconds.
        """
        with self._slot_free:
            ends = min(self._not_before, self._refused_at + longest_s)
            return max(0.0, ends - self._clock())

    def is_alive(
        self, url: str, probe: Callable[[str, float], bool], within_s: float = math.inf
    ) -> bool:
        """Probe whether the server responds to anything; calls that wait together share one probe.

        Args:
            url: Address of the waiting call.
            probe: Takes the address and a time limit in seconds, and returns whether the server responds.
            within_s: Remaining seconds of the call; with too few for a probe, the server counts as alive.
        """
        if self.patience_s is None:
            return True
        seconds = 0.25 * self.patience_s
        if within_s < seconds or not self._probe_lock.acquire(timeout=seconds):
            return True
        try:
            if self._last_probe is None or self._clock() - self._last_probe[0] > seconds:
                is_responding = probe(url, seconds)
                self._last_probe = (self._clock(), is_responding)
            return self._last_probe[1]
        finally:
            self._probe_lock.release()

    def note_answer(self, model: str = "") -> None:
        """Record an answer."""
        with self._slot_free:
            self._failed_calls.pop(model, None)
            self._note_response()
            self.window = min(float(self.concurrency), self.window + 1.0 / self.window)
            self._slot_free.notify_all()

    def note_failed_attempt(self, failure: FailedAttempt, begun: float, model: str = "") -> None:
        """Record a failed attempt at asking a model, which took its slot at the time `begun`."""
        with self._slot_free:
            if failure.kind == "unreachable":
                self._note_silence(failure, begun)
                return
            self._note_response()
            if failure.kind == "limit":
                self._narrow(failure.retry_after or 0.0, begun)
            elif failure.kind == "denied":
                self._give_up(model, failure.message)

    def note_failed_call(self, failure: FailedAttempt, model: str = "") -> None:
        """Record a call that will not be retried."""
        if failure.kind not in _LENIENCY:
            return
        with self._slot_free:
            self._idle_since = None if self._running else self._clock()
            counts = self._failed_calls.setdefault(model, Counter())
            counts[failure.kind] += 1
            weights = {kind: max(1.0, min(self.leniency, most)) for kind, most in _LENIENCY.items()}
            if sum(counts[kind] / weights[kind] for kind in counts) >= self.strikes:
                count = counts.total()
                self._give_up(model, f"{count} calls in a row failed; {failure.message}")

    def _note_response(self) -> None:
        self._last_response_at = self._clock()
        self._silent_since = None

    def _note_silence(self, failure: FailedAttempt, begun: float) -> None:
        """Give the server up if no request got a response for `patience_s`."""
        if self._silent_since is None:
            self._silent_since = max(begun, self._last_response_at)
        elif self._idle_since is not None:
            self._silent_since += max(0.0, begun - self._idle_since)
        self._idle_since = None
        silence_s = self._clock() - self._silent_since
        if self.patience_s is not None and silence_s >= self.patience_s:
            self._give_up(None, f"no response for {silence_s:.0f} s; {failure.message}")

    def _narrow(self, wait_s: float, begun: float) -> None:
        """Halve the window, once for all requests that were under way, and wait as the server demands."""
        self._refused_at = self._clock()
        self._not_before = max(self._not_before, self._refused_at + wait_s)
        if begun > self._narrowed_at:
            self.window = max(1.0, self.window / 2.0)
            self._narrowed_at = self._clock()

    def _fault(self, model: str) -> EndpointDown | None:
        return self._down.get(None) or self._down.get(model)

    def _give_up(self, model: str | None, reason: str) -> None:
        if self.patience_s is None:
            return
        name = f"{model} at {self.name}" if model else self.name
        self._down.setdefault(model, EndpointDown(name, reason))
        self._slot_free.notify_all()
