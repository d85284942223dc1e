"""The stopping rules of red teaming: rounds, budget, novelty."""

from typing import ClassVar, Literal

from pydantic import Field

from oodscen.data._base import Data
from oodscen.llm._ask import ATTEMPTS
from oodscen.stages._redteam.rounds import NEW, Round
from oodscen.stages._redteam.saturation import Tally

Stop = Literal["rounds", "budget", "patience", "coverage"]
"""The rule that ended the red teaming."""

LEAST = 2
"""Minimum number of model calls per round: imagine and place."""
_MOST = 2 * ATTEMPTS


class Limits(Data):
    """The stopping rules; the first that holds ends the red teaming."""

    noun: ClassVar[str] = "stopping rules"

    rounds: int = Field(ge=0)
    """Maximum number of rounds."""
    budget: int | None = Field(default=None, ge=0)
    """Maximum number of model calls, including repairs; a round that might exceed it is not started."""
    patience: int | None = Field(default=None, ge=1)
    """Stop after this many rounds in a row without a new kind."""
    coverage: float | None = Field(default=None, gt=0.0, lt=1.0)
    """Stop when the Good-Turing coverage exceeds this. One extra kind counts as met once, so that a few lucky
    rounds do not end the red teaming: 1 - (f1 + 1) / (n + 1).
    """


class Progress:
    """The state that the stopping rules examine, updated round by round."""

    def __init__(self, limits: Limits) -> None:
        """Start before the first round."""
        self.limits = limits
        self.round = 0
        self.calls = 0
        self.idle = 0
        """Number of rounds in a row without a new kind."""
        self._tally = Tally()

    def add(self, item: Round) -> None:
        """Count a finished round; a round without an answer says nothing about novelty."""
        self.round = item.round
        self.calls += item.calls
        if item.decision in NEW:
            self.idle = 0
        elif item.decision is not None:
            self.idle += 1
        self._tally.add(item)

    @property
    def stop(self) -> Stop | None:
        """The rule that ends the red teaming now, or `None`."""
        return self._stop(0)

    def attempts(self, spent: int = 0) -> int:
        """Return how many calls the next question may take; the first question leaves one for the second.

        Args:
            spent: Calls that the round has used; above 0 for its second question.
        """
        if self.limits.budget is None:
            return ATTEMPTS
        left = self.limits.budget - self.calls - spent
        return min(ATTEMPTS, left if spent else left - 1)

    def is_certain(self, number: int) -> bool:
        """Return whether a later round will be played in full, whatever the rounds before it bring."""
        return self._stop(number - self.round - 1) is None

    def _stop(self, ahead: int) -> Stop | None:
        """Apply the rules as if `ahead` further rounds had been played with the worst outcome."""
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
