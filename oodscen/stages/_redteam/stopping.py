"""When red teaming ends: rounds, budget, novelty."""

from typing import ClassVar, Literal

from pydantic import Field

from oodscen.data._base import Data
from oodscen.llm._ask import ATTEMPTS
from oodscen.stages._redteam.rounds import NEW, Round
from oodscen.stages._redteam.saturation import Tally

Stop = Literal["rounds", "budget", "patience", "coverage"]
"""Which rule ended the red teaming."""

LEAST = 2
"""Model calls that a round needs at least: imagine and place."""
_MOST = 2 * ATTEMPTS


class Limits(Data):
    """The stopping rules; the first that holds ends the red teaming."""

    noun: ClassVar[str] = "stopping rules"

    rounds: int = Field(ge=0)
    """At most this many rounds."""
    budget: int | None = Field(default=None, ge=0)
    """At most this many model calls, repair turns included; a round that could not be finished is not
    begun."""
    patience: int | None = Field(default=None, ge=1)
    """Stop after so many rounds in a row without a new kind."""
    coverage: float | None = Field(default=None, gt=0.0, lt=1.0)
    """Stop when the Good-Turing coverage is above this. One more kind is taken for met once than there
    are, so that a few lucky rounds end nothing: 1 - (f1 + 1) / (n + 1)."""


class Progress:
    """What the stopping rules look at, kept round by round."""

    def __init__(self, limits: Limits) -> None:
        """Start before the first round."""
        self.limits = limits
        self.round = 0
        self.calls = 0
        self.idle = 0
        """Rounds in a row without a new kind."""
        self._tally = Tally()

    def add(self, item: Round) -> None:
        """Count a finished round; one to which no answer came says nothing about novelty."""
        self.round = item.round
        self.calls += item.calls
        if item.decision in NEW:
            self.idle = 0
        elif item.decision is not None:
            self.idle += 1
        self._tally.add(item)

    @property
    def stop(self) -> Stop | None:
        """The rule that ends the red teaming now, if one does."""
        return self._stop(0)

    def attempts(self, spent: int = 0) -> int:
        """Return how often the next question may be put, one call being kept for a second one.

        Args:
            spent: Calls that the round has used; above 0 it is the second question.
        """
        if self.limits.budget is None:
            return ATTEMPTS
        left = self.limits.budget - self.calls - spent
        return min(ATTEMPTS, left if spent else left - 1)

    def is_certain(self, number: int) -> bool:
        """Whether a later round will be played in full, whatever becomes of the rounds before it."""
        return self._stop(number - self.round - 1) is None

    def _stop(self, ahead: int) -> Stop | None:
        """Judge as if so many further rounds had been played, each as badly as can be."""
        limits = self.limits
        if self.round + ahead >= limits.rounds:
            return "rounds"
        needed = LEAST if ahead == 0 else _MOST * (ahead + 1)
        if limits.budget is not None and self.calls + needed > limits.budget:
            return "budget"
        if limits.patience is not None and self.idle + ahead >= limits.patience:
            return "patience"
        if limits.coverage is not None and any(
            self._covered(more) > limits.coverage for more in range(ahead + 1)
        ):
            return "coverage"
        return None

    def _covered(self, more: int) -> float:
        once = max(self._tally.once - more, 0)
        return 1.0 - (once + 1) / (self._tally.observations + more + 1)
