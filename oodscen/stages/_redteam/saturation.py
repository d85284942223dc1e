"""Estimates of the kinds left to find: Good-Turing coverage and Chao1 over the rounds.

Each round that names a kind is an observation, like an animal's species in a survey. Kinds in the initial
tree are known; all others are new. `f1` and `f2` count the new kinds that were met once and twice.
"""

import math
from collections import Counter
from collections.abc import Iterable
from itertools import accumulate

from oodscen._arguments import checked
from oodscen._numbers import whole_number
from oodscen.data._base import Data
from oodscen.stages._redteam.rounds import NEW, Round
from oodscen.statistics._intervals import wilson

_Z = 1.959964
"""Normal quantile of a 95 % interval; its digits are part of the estimates of old studies."""


class SaturationPoint(Data):
    """The state after one round."""

    round: int
    calls: int
    """Model calls spent so far."""
    kinds: int
    """New kinds so far."""
    coverage: float
    """See `Saturation.coverage`."""
    unseen: float
    """See `Saturation.unseen`."""


class Saturation(Data):
    """Estimates, from the rounds of a red team, about the kinds that it has not met.

    The estimates assume that the rounds are independent draws from one source, which holds in the open loop.
    In the closed loop the red-LLM is steered away from what is covered: kinds are met only once more often
    than by chance, so `unseen` tends to be too high and `coverage` too low.
    """

    rounds: int
    calls: int
    observations: int
    """Rounds that named a kind: `n` in the formulas."""
    kinds: int
    """Number of new kinds met."""
    once: int
    """New kinds met once: `f1`."""
    twice: int
    """New kinds met twice: `f2`."""
    coverage: float
    """Good-Turing estimate of the probability that the next proposal is of a known or met kind: 1 - f1 / n (Good
    1953).
    """
    coverage_low: float
    """Lower 95 % bound (Esty 1983); `coverage_high` is the upper one."""
    coverage_high: float
    unseen: float
    """Chao1 estimate of the number of new kinds that this red-LLM would still bring, by construction a lower
    bound (Chao 1984; with the factor (n - 1) / n, and bias-corrected if no kind was met twice).
    """
    unseen_low: float
    """Lower 95 % bound, from the logarithm of the estimate (Chao 1987); `unseen_high` is the upper one."""
    unseen_high: float
    recent: float
    """Share of the last answered rounds that brought a new kind; valid in the closed loop too."""
    recent_low: float
    """Lower 95 % bound (Wilson 1927); `recent_high` is the upper one."""
    recent_high: float
    recent_rounds: int
    """Number of rounds behind `recent`."""
    patience: int
    """Number of consecutive answered rounds without a new kind that count as dry."""
    dry_from: int | None
    """First round of the first dry spell of `patience` rounds without a new kind; `None` if there was none."""
    last_new: int
    """Last round that brought a new kind; 0 if there was none."""
    curve: tuple[SaturationPoint, ...]
    """One point per round."""


@checked
def saturation(rounds: Iterable[Round], *, patience: int = 15) -> Saturation:
    """Estimate, from the log of a red team, the number of kinds left to find.

    Args:
        rounds: All rounds in order, from the first.
        patience: Number of rounds without a new kind that count as dry, and number of recent rounds; both leave
            out rounds without an answer, as the option `patience` of a red team does.
    """
    patience = whole_number("patience", patience, 1)
    played = tuple(rounds)
    tally = KindTally()
    curve = []
    for item, calls in zip(played, accumulate(item.calls for item in played), strict=True):
        tally.add(item)
        curve.append(
            SaturationPoint(
                round=item.round,
                calls=calls,
                kinds=tally.kinds,
                coverage=round(tally.coverage()[0], 6),
                unseen=round(tally.unseen()[0], 6),
            )
        )
    coverage, coverage_low, coverage_high = tally.coverage()
    unseen, low, high = tally.unseen()
    answered = [item for item in played if item.decision is not None]
    recent = answered[-patience:]
    news = sum(item.decision in NEW for item in recent)
    least, most = wilson(news, len(recent))
    return Saturation(
        rounds=len(played),
        calls=sum(item.calls for item in played),
        observations=tally.observations,
        kinds=tally.kinds,
        once=tally.once,
        twice=tally.twice,
        coverage=round(coverage, 6),
        coverage_low=round(coverage_low, 6),
        coverage_high=round(coverage_high, 6),
        unseen=round(unseen, 6),
        unseen_low=round(low, 6),
        unseen_high=round(high, 6),
        recent=round(news / len(recent), 6) if recent else 0.0,
        recent_low=round(least, 6),
        recent_high=round(most, 6),
        recent_rounds=len(recent),
        patience=patience,
        dry_from=_dry_from(answered, patience),
        last_new=max((item.round for item in played if item.decision in NEW), default=0),
        curve=tuple(curve),
    )


def _dry_from(answered: Iterable[Round], patience: int) -> int | None:
    """Return the first of so many consecutive rounds without a new kind."""
    spell: list[int] = []
    for item in answered:
        spell = [] if item.decision in NEW else [*spell, item.round]
        if len(spell) == patience:
            return spell[0]
    return None


class KindTally:
    """Counts of the encounters with each new kind, updated round by round."""

    def __init__(self) -> None:
        self.observations = 0
        self._met: Counter[str] = Counter()
        self._kinds_met: Counter[int] = Counter()

    @property
    def kinds(self) -> int:
        return len(self._met)

    @property
    def once(self) -> int:
        return self._kinds_met[1]

    @property
    def twice(self) -> int:
        return self._kinds_met[2]

    def coverage(self) -> tuple[float, float, float]:
        """Return `good_turing` of the encounters."""
        return good_turing(self.observations, self.once, self.twice)

    def unseen(self) -> tuple[float, float, float]:
        """Return `chao1` of the encounters."""
        return chao1(self.observations, self.kinds, self.once, self.twice)

    def add(self, item: Round) -> None:
        """Count a round that named a kind."""
        if item.kind is None:
            return
        self.observations += 1
        if item.decision == "split":
            whole, old = item.edits[0].node, item.edits[1].node
            if whole in self._met:
                self._met[old] = self._met.pop(whole)
        if item.decision in NEW or item.kind in self._met:
            self._met[item.kind] += 1
            times = self._met[item.kind]
            self._kinds_met[times] += 1
            self._kinds_met[times - 1] -= 1


def good_turing(n: int, once: int, twice: int) -> tuple[float, float, float]:
    """Estimate the probability that the next observation is of a known or met kind, with its 95 % interval.

    Source: I. J. Good, Biometrika 40 (1953); the variance is that of W. W. Esty, Annals of Statistics 11 (1983).

    Returns:
        Estimate, lower and upper bound; three zeros before the first of the `n` observations.
    """
    if not n:
        return 0.0, 0.0, 0.0
    coverage = 1.0 - once / n
    spread = _Z * math.sqrt(max(once + 2 * twice - once * once / n, 0.0)) / n
    return coverage, max(coverage - spread, 0.0), min(coverage + spread, 1.0)


def chao1(n: int, seen: int, once: int, twice: int) -> tuple[float, float, float]:
    """Estimate the number of unseen kinds after `n` observations of `seen` kinds, with its 95 % interval.

    Returns:
        Estimate, lower and upper bound; three zeros if the estimate is 0.
    """
    scale = (n - 1) / n if n else 0.0
    if twice:
        ratio = once / twice
        unseen = scale * once * ratio / 2
        parts = scale / 2 * ratio**2, scale**2 * ratio**3, scale**2 / 4 * ratio**4
        variance = twice * math.fsum(parts)
    else:
        unseen = scale * once * (once - 1) / 2
        bulk = scale**2 * once * (2 * once - 1) ** 2 / 4
        variance = unseen + bulk - scale**2 * once**4 / (4 * max(seen + unseen, 1.0))
    if unseen <= 0.0:
        return 0.0, 0.0, 0.0
    factor = math.exp(_Z * math.sqrt(math.log1p(max(variance, 0.0) / unseen**2)))
    return unseen, unseen / factor, unseen * factor
