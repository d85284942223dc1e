"""What all models of one run share: caps on what is spent, and how each endpoint is treated."""

import math
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import ClassVar, NamedTuple

from pydantic import Field

from oodscen._data import Data
from oodscen.errors import BudgetExceeded, EndpointDown
from oodscen.llms.failures import Failure

CONCURRENCY = 8
"""How many requests to one endpoint may be under way, unless told otherwise."""

PATIENCE_S = 40.0
"""How long an endpoint may give no response to anybody before the run ends; a server that is slow but
responds to other requests is waited for."""

STRIKES = 5
"""How many calls in a row may be given up before the run ends."""

ANSWER_TOKENS = 4_096
"""Answer that a call is expected to cost at most, where `max_tokens` does not say it."""


class Price(NamedTuple):
    """What a model costs."""

    input_usd: float
    """Per million tokens."""
    output_usd: float
    """Per million tokens."""

    def of(self, input_tokens: int, output_tokens: int) -> float:
        """Return the cost of one call in USD."""
        return (self.input_usd * input_tokens + self.output_usd * output_tokens) / 1e6


class Caps(Data):
    """What one run may spend; `None` is no cap."""

    noun: ClassVar[str] = "caps"

    requests: int | None = Field(default=None, ge=0)
    """HTTP requests, retries included."""
    tokens: int | None = Field(default=None, ge=0)
    """Input and output together."""
    cost_usd: float | None = Field(default=None, ge=0)
    seconds: float | None = Field(default=None, ge=0)
    """Since the run began; no request is begun afterwards."""


class Spent(NamedTuple):
    """What requests have used up, or may."""

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
    """Refuses a request that could exceed a cap, counting those under way at what they may cost."""

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
        """How long an answer may be expected to be: the longest so far, or the allowance."""
        return max(ANSWER_TOKENS, self._longest)

    def reserve(self, most: Spent) -> None:
        """Set aside what a request may cost, before it is sent.

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
        """Replace what was set aside by what was used."""
        with self._lock:
            self._reserved = self._reserved.plus(most, -1)
            self.spent = self.spent.plus(used)
            self._longest = max(self._longest, answer_tokens)


class Endpoint:
    """One server: how many requests it gets at once, and whether it is still worth asking.

    The number at once is halved when it says that there are too many, and grows by one with as many
    answers as are allowed at once, so it follows the rate that the server grants. The circuit opens for good when no
    request at all got a response for `patience_s`, when `strikes` calls in a row were given up, or when a key is
    refused; every further request raises `EndpointDown`. With `patience_s=None` it never opens.
    """

    def __init__(
        self,
        name: str,
        *,
        concurrency: int = CONCURRENCY,
        patience_s: float | None = PATIENCE_S,
        strikes: int = STRIKES,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.name = name
        self.concurrency = max(1, concurrency)
        self.window = float(self.concurrency)
        """How many may be under way at present."""
        self.patience_s = patience_s
        self.strikes = strikes
        self.silence_s = math.inf if patience_s is None else 0.75 * patience_s
        """After how long without a byte it is worth looking whether the server is still there."""
        self._clock = clock
        self._running = 0
        self._given_up = 0
        self._silent_since: float | None = None
        self._narrowed_at = -1.0
        self._not_before = 0.0
        self._down: EndpointDown | None = None
        self._free = threading.Condition()
        self._looking = threading.Lock()
        self._looked: tuple[float, bool] | None = None

    @contextmanager
    def slot(self) -> Iterator[float]:
        """Wait for a free place and yield the time at which it was taken.

        Raises:
            EndpointDown: When the circuit is open.
        """
        with self._free:
            self._free.wait_for(
                lambda: self._down is not None or self._running < max(1, int(self.window))
            )
            self.check()
            self._running += 1
        try:
            yield self._clock()
        finally:
            with self._free:
                self._running -= 1
                self._free.notify_all()

    def check(self) -> None:
        """Raise `EndpointDown` when the circuit is open."""
        if self._down is not None:
            raise EndpointDown(self._down.endpoint, self._down.reason)

    def pause(self) -> float:
        """Return how long nobody should ask, since the server said so."""
        with self._free:
            return max(0.0, self._not_before - self._clock())

    def is_alive(self, url: str, probe: Callable[[str, float], bool]) -> bool:
        """Look whether the server responds to anything; calls that wait together look once.

        Args:
            url: Where the call that waits was sent.
            probe: Told the address and the seconds that it may take.
        """
        if self.patience_s is None:
            return True
        with self._looking:
            if self._looked is None or self._clock() - self._looked[0] > 0.25 * self.patience_s:
                found = probe(url, 0.25 * self.patience_s)
                self._looked = (self._clock(), found)
            return self._looked[1]

    def succeeded(self) -> None:
        """Take note of an answer."""
        with self._free:
            self._given_up = 0
            self._silent_since = None
            self.window = min(float(self.concurrency), self.window + 1.0 / self.window)
            self._free.notify_all()

    def failed(self, failure: Failure, begun: float) -> None:
        """Take note of a try that failed.

        Args:
            failure: What went wrong.
            begun: When its place was taken.
        """
        with self._free:
            if failure.kind != "unreachable":
                self._silent_since = None
            if failure.kind == "limit":
                self._not_before = max(
                    self._not_before, self._clock() + (failure.retry_after or 0.0)
                )
                if begun > self._narrowed_at:
                    self.window = max(1.0, self.window / 2.0)
                    self._narrowed_at = self._clock()
            elif failure.kind == "denied":
                self._open(failure.message)
            elif failure.kind == "unreachable":
                since = begun if self._silent_since is None else self._silent_since
                self._silent_since = since
                if self.patience_s is not None and self._clock() - since >= self.patience_s:
                    self._open(f"no response for {self._clock() - since:.0f} s; {failure.message}")

    def given_up(self, failure: Failure) -> None:
        """Take note of a call that will not be tried again."""
        with self._free:
            if failure.kind in ("unreachable", "erring", "limit"):
                self._given_up += 1
                if self._given_up >= self.strikes:
                    self._open(f"{self._given_up} calls in a row failed; {failure.message}")

    def _open(self, reason: str) -> None:
        if self.patience_s is None:
            return
        self._down = self._down or EndpointDown(self.name, reason)
        self._free.notify_all()


class Traffic:
    """The budget, the prices and the endpoints of one run, shared by all its models.

    Args:
        caps: What the run may spend.
        prices: By model name, where litellm knows none or another.
        concurrency: Requests to one endpoint at once, at most.
        patience_s: As for `Endpoint`.
        strikes: As for `Endpoint`.
        clock: Monotonic seconds.
    """

    def __init__(
        self,
        caps: Caps | None = None,
        *,
        prices: Mapping[str, Price] | None = None,
        concurrency: int = CONCURRENCY,
        patience_s: float | None = PATIENCE_S,
        strikes: int = STRIKES,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.budget = Budget(caps, clock=clock)
        self.prices = dict(prices or {})
        self.concurrency = concurrency
        self._settings = (patience_s, strikes, clock)
        self._endpoints: dict[str, Endpoint] = {}
        self._lock = threading.Lock()

    def endpoint(self, name: str) -> Endpoint:
        """Return the endpoint of this name, the same one for every model that asks there."""
        patience_s, strikes, clock = self._settings
        with self._lock:
            if name not in self._endpoints:
                self._endpoints[name] = Endpoint(
                    name,
                    concurrency=self.concurrency,
                    patience_s=patience_s,
                    strikes=strikes,
                    clock=clock,
                )
            return self._endpoints[name]
