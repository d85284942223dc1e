"""The limits that a user sets for all models of a run; a server's rate limit is kept by its `endpoint`."""

import math
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress

from oodscen._arguments import checked
from oodscen._display import Brief
from oodscen._numbers import finite_number, whole_number
from oodscen.errors import DataError, RunStopped, UsageError
from oodscen.llm._remote.budget import Budget, Caps, check_price
from oodscen.llm._remote.rate_limit import CONCURRENCY, PATIENCE_S, STRIKES, Endpoint

TIMEOUT_S = 120.0
"""Longest time for one attempt, from its start to the last byte, in seconds."""

GRACE_S = 2.0
"""Seconds that pending requests may still take after a run is interrupted."""

LONGEST_S = 1_000_000.0
"""Longest time that can be set, in seconds: eleven days. Sockets accept little more."""


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

    @checked
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
        self._patience_s = patience_s
        self._strikes = whole_number("strikes", strikes, 1)
        self._clock = clock
        self._leniency = 1.0
        self._closed = threading.Event()
        self._closed_at = math.inf
        self._endpoints: dict[str, Endpoint] = {}
        self._lock = threading.Lock()

    def endpoint(self, name: str) -> Endpoint:
        """Return the endpoint of this name, shared by every model there."""
        with self._lock:
            if name not in self._endpoints:
                self._endpoints[name] = Endpoint(
                    name,
                    concurrency=self.concurrency,
                    patience_s=self._patience_s,
                    strikes=self._strikes,
                    leniency=self._leniency,
                    clock=self._clock,
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
            self._closed_at = min(self._closed_at, self._clock())
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
        return self._clock() - self._closed_at >= GRACE_S

    def sleep(self, seconds: float) -> None:
        """Wait, at most until an interruption."""
        self._closed.wait(seconds)

    def _set_leniency(self, leniency: float) -> None:
        with self._lock:
            self._leniency = leniency
            for endpoint in self._endpoints.values():
                endpoint.leniency = leniency


def check_seconds(name: str, seconds: float) -> float:
    """Return a time limit, or raise `UsageError` if it is not positive, infinite, too long or NaN."""
    with suppress(UsageError):
        if finite_number(name, seconds, 0.0, LONGEST_S):
            return seconds
    raise UsageError(f"{name} must be above 0 and at most {LONGEST_S:,.0f} seconds")
