"""The limits shared by all models of a run: caps on spending, and rate limits of endpoints."""

import math
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import Any, ClassVar, NamedTuple

from pydantic import Field

from oodscen._display import Brief
from oodscen._numbers import finite_number, whole_number
from oodscen.data._base import Data
from oodscen.errors import BudgetExceeded, DataError, EndpointDown, RunStopped, UsageError
from oodscen.llm._remote.failures import FailedAttempt

CONCURRENCY = 8
"""Default number of concurrent requests to one endpoint."""

TIMEOUT_S = 120.0
"""Longest time for one attempt, from its start to the last byte, in seconds."""

PATIENCE_S = 40.0
"""Seconds without a response to any request after which an endpoint is given up.

A slow server that responds to other requests is waited for.
"""

STRIKES = 5
"""Number of consecutive failed calls after which a model is given up."""

JUDGING = 4.0
"""Leniency with judged models, for which a failed item says little about the next one."""

GRACE_S = 2.0
"""Seconds that pending requests may still take after a run is interrupted."""

LONGEST_S = 1_000_000.0
"""Longest time that can be set, in seconds: eleven days. Sockets accept little more."""

DEAREST_USD = 1e6
"""Highest price that is accepted, in USD per million tokens."""

ANSWER_TOKENS = 4_096
"""Assumed upper bound of an answer, in tokens, if `max_tokens` does not set one."""


class Price(NamedTuple):
    """The price of a model."""

    input_usd: float
    """USD per million input tokens."""
    output_usd: float
    """USD per million output tokens."""

    def of(self, input_tokens: int, output_tokens: int) -> float:
        """Return the cost of one call in USD."""
        return (self.input_usd * input_tokens + self.output_usd * output_tokens) / 1e6


def check_price(model: str, price: Any) -> Price:
    """Return a price, or raise `UsageError` if it is not a pair of numbers from 0 to `DEAREST_USD`."""
    try:
        asked, answered = (finite_number("a price", value, 0.0, DEAREST_USD) for value in price)
    except (UsageError, TypeError, ValueError):
        raise UsageError(
            f"{price!r:.80} is no price of {model!r}: give USD per million tokens of input "
            f"and output, each from 0 to {DEAREST_USD:,.0f}"
        ) from None
    return Price(asked, answered)


def check_seconds(name: str, seconds: float) -> float:
    """Return a time limit, or raise `UsageError` if it is not positive, infinite, too long or NaN."""
    with suppress(UsageError):
        if finite_number(name, seconds, 0.0, LONGEST_S):
            return seconds
    raise UsageError(f"{name} must be above 0 and at most {LONGEST_S:,.0f} seconds")


class Caps(Data):
    """The spending limits of one run; `None` means no limit."""

    noun: ClassVar[str] = "caps"

    requests: int | None = Field(default=None, ge=0)
    """HTTP requests, retries included."""
    tokens: int | None = Field(default=None, ge=0)
    """Input and output tokens together."""
    cost_usd: float | None = Field(default=None, ge=0)
    seconds: float | None = Field(default=None, ge=0)
    """Seconds since the run began; no request starts afterwards."""


class Spent(NamedTuple):
    """Resources used, or reserved, by requests."""

    requests: int = 0
    tokens: int = 0
    cost_usd: float = 0.0

    def plus(self, other: "Spent", sign: int = 1) -> "Spent":
        """Return the sum, or with `sign=-1` the difference."""
        return Spent(
            self.requests + sign * other.requests,
            self.tokens + sign * other.tokens,
            self.cost_usd + sign * other.cost_usd,
        )


class Budget:
    """Refuses requests that could exceed a cap, counting pending ones at their maximum cost."""

    def __init__(
        self, caps: Caps | None = None, *, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.caps = caps or Caps()
        self.spent = Spent()
        self._reserved = Spent()
        self._longest = 0
        self._clock = clock
        self._began = clock()
        self._lock = threading.Lock()

    @property
    def answer_tokens(self) -> int:
        """Expected length of an answer: the longest so far, or the allowance if that is longer."""
        return max(ANSWER_TOKENS, self._longest)

    def reserve(self, most: Spent) -> None:
        """Reserve the maximum cost of a request before it is sent.

        Raises:
            BudgetExceeded: When the request could exceed a cap.
        """
        with self._lock:
            wanted = self.spent.plus(self._reserved).plus(most)
            limits = (self.caps.requests, self.caps.tokens, self.caps.cost_usd)
            for name, limit, value in zip(Spent._fields, limits, wanted, strict=True):
                if limit is not None and value > limit * (1 + 1e-12):
                    raise BudgetExceeded(name, limit, self.spent._asdict()[name])
            elapsed = self._clock() - self._began
            if self.caps.seconds is not None and elapsed >= self.caps.seconds:
                raise BudgetExceeded("seconds", self.caps.seconds, round(elapsed, 1))
            self._reserved = self._reserved.plus(most)

    def settle(self, most: Spent, used: Spent, answer_tokens: int = 0) -> None:
        """Replace a reservation by what was actually used."""
        with self._lock:
            self._reserved = self._reserved.plus(most, -1)
            self.spent = self.spent.plus(used)
            self._longest = max(self._longest, answer_tokens)


class Endpoint:
    """One server, with its rate limit and its circuit breakers.

    The number of concurrent requests is halved when the server reports too many, and grows by one after as
    many answers as are allowed at once, so it follows the rate that the server grants. The server is given up
    for good when no request got a response for `patience_s`. A model on it is given up when `strikes` of its
    calls in a row failed, or when a key is refused. Every later request then raises `EndpointDown`. With
    `patience_s=None` nothing is given up.

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
        self._given_up: dict[str, Counter[str]] = {}
        self._heard = -math.inf
        self._silent_since: float | None = None
        self._narrowed_at = -1.0
        self._not_before = 0.0
        self._down: dict[str | None, EndpointDown] = {}
        self._free = threading.Condition()
        self._looking = threading.Lock()
        self._looked: tuple[float, bool] | None = None

    @contextmanager
    def slot(self, model: str = "") -> Iterator[float]:
        """Wait for a free slot and yield the time at which it was taken.

        Args:
            model: The model that is asked; each model is given up separately.

        Raises:
            EndpointDown: When the server or the model is given up.
        """
        with self._free:
            self._free.wait_for(
                lambda: self._fault(model) is not None or self._running < max(1, int(self.window))
            )
            self.check(model)
            self._running += 1
        try:
            yield self._clock()
        finally:
            with self._free:
                self._running -= 1
                self._free.notify_all()

    def check(self, model: str = "") -> None:
        """Raise `EndpointDown` if the server or this model is given up."""
        if (fault := self._fault(model)) is not None:
            raise EndpointDown(fault.endpoint, fault.reason)

    def is_doubted(self, model: str = "") -> bool:
        """Return whether a model's recent failures limit each call to one attempt."""
        failed = self._given_up.get(model)
        return self.leniency > 1 and failed is not None and failed.total() >= self.strikes

    def pause(self) -> float:
        """Return the seconds to wait before the next request, as the server demanded."""
        with self._free:
            return max(0.0, self._not_before - self._clock())

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
        if within_s < seconds or not self._looking.acquire(timeout=seconds):
            return True
        try:
            if self._looked is None or self._clock() - self._looked[0] > seconds:
                found = probe(url, seconds)
                self._looked = (self._clock(), found)
            return self._looked[1]
        finally:
            self._looking.release()

    def succeeded(self, model: str = "") -> None:
        """Record an answer."""
        with self._free:
            self._given_up.pop(model, None)
            self._hear()
            self.window = min(float(self.concurrency), self.window + 1.0 / self.window)
            self._free.notify_all()

    def failed(self, failure: FailedAttempt, begun: float, model: str = "") -> None:
        """Record a failed attempt.

        Args:
            failure: The failure.
            begun: Time at which the attempt took its slot.
            model: The model that was asked.
        """
        with self._free:
            if failure.kind != "unreachable":
                self._hear()
            if failure.kind == "limit":
                self._not_before = max(
                    self._not_before, self._clock() + (failure.retry_after or 0.0)
                )
                if begun > self._narrowed_at:
                    self.window = max(1.0, self.window / 2.0)
                    self._narrowed_at = self._clock()
            elif failure.kind == "denied":
                self._give_up(model, failure.message)
            elif failure.kind == "unreachable":
                since = (
                    max(begun, self._heard) if self._silent_since is None else self._silent_since
                )
                self._silent_since = since
                if self.patience_s is not None and self._clock() - since >= self.patience_s:
                    silence = self._clock() - since
                    self._give_up(None, f"no response for {silence:.0f} s; {failure.message}")

    def given_up(self, failure: FailedAttempt, model: str = "") -> None:
        """Record a call that will not be retried."""
        with self._free:
            if failure.kind in _LENIENCY:
                counts = self._given_up.setdefault(model, Counter())
                counts[failure.kind] += 1
                weights = {
                    kind: max(1.0, min(self.leniency, most)) for kind, most in _LENIENCY.items()
                }
                if sum(counts[kind] / weights[kind] for kind in counts) >= self.strikes:
                    count = counts.total()
                    self._give_up(model, f"{count} calls in a row failed; {failure.message}")

    def _hear(self) -> None:
        self._heard = self._clock()
        self._silent_since = None

    def _fault(self, model: str) -> EndpointDown | None:
        return self._down.get(None) or self._down.get(model)

    def _give_up(self, model: str | None, reason: str) -> None:
        if self.patience_s is None:
            return
        name = f"{model} at {self.name}" if model else self.name
        self._down.setdefault(model, EndpointDown(name, reason))
        self._free.notify_all()


_LENIENCY: Mapping[str, float] = {
    "limit": 1.0,
    "unreachable": 2.0,
    "erring": math.inf,
    "late": math.inf,
}
"""Failures that count against a model, each with the maximum leniency for it."""


class Limits(Brief):
    """The budget, prices and endpoints of one run, shared by all its models.

    Args:
        requests: Cap on HTTP requests, retries included; like all caps, `None` means no limit.
        tokens: Cap on input and output tokens together.
        cost_usd: Cap on the cost.
        seconds: Cap on the time since the run began; no request starts afterwards.
        prices: Prices by model name, USD per million tokens of input and of output; they override litellm's.
        concurrency: Maximum number of concurrent requests to one endpoint.
        patience_s: As for `Endpoint`.
        strikes: As for `Endpoint`.
        timeout_s: Longest time for one attempt, for models without a limit of their own.
        clock: Returns monotonic seconds.

    Raises:
        UsageError: When a cap, a price or a time is invalid.
    """

    _repr_fields = ("caps", "concurrency", "timeout_s")

    def __init__(
        self,
        *,
        requests: int | None = None,
        tokens: int | None = None,
        cost_usd: float | None = None,
        seconds: float | None = None,
        prices: Mapping[str, tuple[float, float]] | None = None,
        concurrency: int = CONCURRENCY,
        patience_s: float | None = PATIENCE_S,
        strikes: int = STRIKES,
        timeout_s: float = TIMEOUT_S,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.timeout_s = check_seconds("timeout_s", timeout_s)
        if patience_s is not None:
            check_seconds("patience_s", patience_s)
        caps = {"requests": requests, "tokens": tokens, "cost_usd": cost_usd, "seconds": seconds}
        try:
            self.budget = Budget(Caps.parse(caps), clock=clock)
        except DataError as error:
            raise UsageError(str(error)) from None
        self.caps = self.budget.caps
        self.prices = {model: check_price(model, price) for model, price in (prices or {}).items()}
        self.concurrency = whole_number("concurrency", concurrency, 1)
        self._settings = (patience_s, whole_number("strikes", strikes, 1), clock)
        self._leniency = 1.0
        self._closed = threading.Event()
        self._closed_at = math.inf
        self._endpoints: dict[str, Endpoint] = {}
        self._lock = threading.Lock()

    def endpoint(self, name: str) -> Endpoint:
        """Return the endpoint of this name, shared by every model there."""
        patience_s, strikes, clock = self._settings
        with self._lock:
            if name not in self._endpoints:
                self._endpoints[name] = Endpoint(
                    name,
                    concurrency=self.concurrency,
                    patience_s=patience_s,
                    strikes=strikes,
                    leniency=self._leniency,
                    clock=clock,
                )
            return self._endpoints[name]

    @contextmanager
    def lenient(self, leniency: float) -> Iterator[None]:
        """Apply a leniency to failures while the context lasts; see `Endpoint`."""
        before = self._leniency
        self._set_leniency(leniency)
        try:
            yield
        finally:
            self._set_leniency(before)

    def close(self) -> None:
        """Stop: start no request, end all waits, and abandon pending requests after `GRACE_S`."""
        with self._lock:
            self._closed_at = min(self._closed_at, self._settings[2]())
        self._closed.set()

    def reopen(self) -> None:
        """Allow requests again."""
        self._closed_at = math.inf
        self._closed.clear()

    def check(self) -> None:
        """Raise `RunStopped` if the run was interrupted."""
        if self._closed.is_set():
            raise RunStopped("the run was interrupted; the same command continues it")

    def is_over(self) -> bool:
        """Return whether pending requests are to be abandoned."""
        return self._settings[2]() - self._closed_at >= GRACE_S

    def sleep(self, seconds: float) -> None:
        """Wait, at most until an interruption."""
        self._closed.wait(seconds)

    def _set_leniency(self, leniency: float) -> None:
        with self._lock:
            self._leniency = leniency
            for endpoint in self._endpoints.values():
                endpoint.leniency = leniency
