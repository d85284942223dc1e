"""Prices, and caps on what the requests of a run may spend."""

import threading
import time
from collections.abc import Callable
from typing import Any, ClassVar, NamedTuple

from pydantic import Field

from oodscen._numbers import finite_number
from oodscen.data._base import Data
from oodscen.errors import BudgetExceeded, UsageError

DEAREST_USD = 1e6
"""Highest price that is accepted, in USD per million tokens."""

ANSWER_TOKENS = 4_096
"""Assumed upper bound of an answer, in tokens, if `max_tokens` does not set one."""
_ROUNDING = 1e-12
"""Share of a cap by which a sum may exceed it through rounding."""


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
        input_usd, output_usd = (
            finite_number("a price", value, 0.0, DEAREST_USD) for value in price
        )
    except (UsageError, TypeError, ValueError):
        raise UsageError(
            f"{price!r:.80} is not a price of {model!r}: give USD per million tokens of input "
            f"and output, each from 0 to {DEAREST_USD:,.0f}"
        ) from None
    return Price(input_usd, output_usd)


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

    def plus(self, other: "Spent") -> "Spent":
        """Return the sum."""
        return Spent(
            self.requests + other.requests,
            self.tokens + other.tokens,
            self.cost_usd + other.cost_usd,
        )

    def minus(self, other: "Spent") -> "Spent":
        """Return the difference."""
        return Spent(
            self.requests - other.requests,
            self.tokens - other.tokens,
            self.cost_usd - other.cost_usd,
        )


class Budget:
    """Refuses requests that could exceed a cap, counting pending ones at their maximum cost."""

    def __init__(
        self, caps: Caps | None = None, *, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.caps = caps or Caps()
        self.spent = Spent()
        self._reserved = Spent()
        self._longest_answer_tokens = 0
        self._clock = clock
        self._began = clock()
        self._lock = threading.Lock()

    @property
    def answer_tokens(self) -> int:
        """Expected length of an answer: the longest so far, or the allowance if that is longer."""
        return max(ANSWER_TOKENS, self._longest_answer_tokens)

    def reserve(self, most: Spent) -> None:
        """Reserve the maximum cost of a request before it is sent.

        Raises:
            BudgetExceeded: When the request could exceed a cap.
        """
        with self._lock:
            under_way = self.spent.plus(self._reserved)
            limits = (self.caps.requests, self.caps.tokens, self.caps.cost_usd)
            for name, limit, before, after in zip(
                Spent._fields, limits, under_way, under_way.plus(most), strict=True
            ):
                if limit is not None and after > limit * (1 + _ROUNDING):
                    raise BudgetExceeded(name, limit, before)
            elapsed = self._clock() - self._began
            if self.caps.seconds is not None and elapsed >= self.caps.seconds:
                raise BudgetExceeded("seconds", self.caps.seconds, round(elapsed, 1))
            self._reserved = self._reserved.plus(most)

    def settle(self, most: Spent, used: Spent, answer_tokens: int) -> None:
        """Replace the reservation of a request by what it used, its answer's tokens among it."""
        with self._lock:
            self._reserved = self._reserved.minus(most)
            self.spent = self.spent.plus(used)
            self._longest_answer_tokens = max(self._longest_answer_tokens, answer_tokens)
