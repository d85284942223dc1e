"""The stopping rules of red teaming: rounds, budget, novelty."""

from typing import Literal

from oodscen.llm._ask import ATTEMPTS
from oodscen.stages._options import RedTeamOptions
from oodscen.stages._redteam.rounds import NEW, Round
from oodscen.stages._redteam.saturation import KindTally

Stop = Literal["rounds", "budget", "patience", "coverage"]
"""The rule that ended the red teaming."""

LEAST = 2
"""Minimum number of model calls per round: imagine and place."""
_MOST = 2 * ATTEMPTS
"""Maximum number of model calls per round."""


class Stopping:
    """The state that the stopping rules examine, updated round by round."""

    def __init__(self, options: RedTeamOptions) -> None:
        self.options = options
        self.round = 0
        self.calls = 0
        self.idle = 0
        """Number of rounds in a row without a new kind."""
        self._tally = KindTally()

    def add(self, item: Round) -> None:
        """Count a finished round; a round without an answer does not affect `patience`."""
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
        """Return how many calls the next question may take, after those that the round has spent.

        The first question of a round leaves one for the second.
        """
        if self.options.budget is None:
            return ATTEMPTS
        left = self.options.budget - self.calls - spent
        return min(ATTEMPTS, left if spent else left - 1)

    def is_certain(self, number: int) -> bool:
        """Return whether a later round will be played in full, regardless of the rounds before it."""
        return self._stop(number - self.round - 1) is None

    def _stop(self, ahead: int) -> Stop | None:
        """Apply the rules as if `ahead` further rounds had been played with the worst outcome."""
        options = self.options
        if self.round + ahead >= options.iterations:
            return "rounds"
        needed = LEAST if ahead == 0 else _MOST * (ahead + 1)
        if options.budget is not None and self.calls + needed > options.budget:
            return "budget"
        if options.patience is not None and self.idle + ahead >= options.patience:
            return "patience"
        if options.coverage is not None and self._covered(ahead) > options.coverage:
            return "coverage"
        return None

    def _covered(self, more: int) -> float:
        """Return the greatest coverage that `more` rounds can bring; one extra kind counts as met once."""
        once = max(self._tally.once - more, 0)
        return 1.0 - (once + 1) / (self._tally.observations + more + 1)
