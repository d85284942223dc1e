"""How much is left to be found: Good-Turing coverage and Chao's estimate over the rounds.

Each round that names a kind is an observation, as of an animal's species in a survey. Kinds that the
tree had from the start are known; the others are new. `f1` and `f2` count the new kinds that were met
once and twice.
"""

import math
from collections import Counter
from collections.abc import Iterable
from typing import ClassVar

from oodscen.data._base import Data
from oodscen.stages._redteam.rounds import NEW, Round
from oodscen.statistics._resampling import wilson

Z = 1.959964
"""Of a 95 % interval."""


class SaturationPoint(Data):
    """The state after one round."""

    noun: ClassVar[str] = "saturation point"

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
    """What the rounds of a red team say about the kinds that they have not met.

    The estimates take the rounds for independent draws from one source, which those of the open loop
    are. In the closed loop the red-LLM is led away from what is covered: kinds are met once more often
    than by chance, so `unseen` is then rather too high and `coverage` too low.
    """

    noun: ClassVar[str] = "saturation"

    rounds: int
    calls: int
    observations: int
    """Rounds that named a kind: `n` of the formulas."""
    kinds: int
    """New kinds that were met."""
    once: int
    """New kinds that were met once: `f1`."""
    twice: int
    """New kinds that were met twice: `f2`."""
    coverage: float
    """Good-Turing estimate of the chance that the next proposal is of a kind that was met or known:
    1 - f1 / n (Good 1953)."""
    coverage_low: float
    """95 % bounds (Esty 1983)."""
    coverage_high: float
    unseen: float
    """Chao1 estimate of how many new kinds this red-LLM would still bring, a lower bound by nature
    (Chao 1984; with the factor (n - 1) / n, and in its bias-corrected form where no kind was met
    twice)."""
    unseen_low: float
    """95 % bounds, from the logarithm of the estimate (Chao 1987)."""
    unseen_high: float
    recent: float
    """Share of the last rounds that brought a new kind; holds in the closed loop too."""
    recent_low: float
    """95 % bounds (Wilson 1927)."""
    recent_high: float
    recent_rounds: int
    """Over how many rounds `recent` is taken."""
    patience: int
    """So many rounds without a new kind count as dry."""
    dry_from: int | None
    """First round of the first spell of that many rounds without a new kind; `None` if there was
    none."""
    last_new: int
    """Last round that brought a new kind; 0 if none did."""
    curve: tuple[SaturationPoint, ...]
    """One point per round."""


def saturation(rounds: Iterable[Round], *, patience: int = 15) -> Saturation:
    """Estimate from the log of a red team how much it has left to find.

    Args:
        rounds: In order, from the first on.
        patience: So many rounds without a new kind count as dry; the last so many rounds are the
            recent ones.
    """
    played = tuple(rounds)
    tally = Tally()
    curve, calls, dry_from, last_new = [], 0, None, 0
    for item in played:
        tally.add(item)
        calls += item.calls
        if item.decision in NEW:
            last_new = item.round
        elif dry_from is None and item.round - last_new >= patience:
            dry_from = last_new + 1
        unseen = chao1(tally.observations, tally.kinds, tally.once, tally.twice)[0]
        curve.append(
            SaturationPoint(
                round=item.round,
                calls=calls,
                kinds=tally.kinds,
                coverage=round(tally.coverage, 6),
                unseen=round(unseen, 6),
            )
        )
    n, once, twice = tally.observations, tally.once, tally.twice
    spread = Z * math.sqrt(max(once + 2 * twice - once * once / n, 0.0)) / n if n else 0.0
    unseen, low, high = chao1(n, tally.kinds, once, twice)
    recent = played[-patience:]
    news = sum(item.decision in NEW for item in recent)
    least, most = wilson(news, len(recent))
    return Saturation(
        rounds=len(played),
        calls=calls,
        observations=n,
        kinds=tally.kinds,
        once=once,
        twice=twice,
        coverage=round(tally.coverage, 6),
        coverage_low=round(max(tally.coverage - spread, 0.0), 6),
        coverage_high=round(min(tally.coverage + spread, 1.0), 6),
        unseen=round(unseen, 6),
        unseen_low=round(low, 6),
        unseen_high=round(high, 6),
        recent=round(news / len(recent), 6) if recent else 0.0,
        recent_low=round(least, 6),
        recent_high=round(most, 6),
        recent_rounds=len(recent),
        patience=patience,
        dry_from=dry_from,
        last_new=last_new,
        curve=tuple(curve),
    )


class Tally:
    """How often each new kind was met; grows round by round."""

    def __init__(self) -> None:
        """Start with nothing."""
        self.observations = 0
        self.once = 0
        self.twice = 0
        self._met: Counter[str] = Counter()

    @property
    def kinds(self) -> int:
        """New kinds so far."""
        return len(self._met)

    @property
    def coverage(self) -> float:
        """1 - f1 / n, and 0 before the first observation."""
        return 1.0 - self.once / self.observations if self.observations else 0.0

    def add(self, item: Round) -> None:
        """Count a round, if it named a kind."""
        if item.kind is None:
            return
        self.observations += 1
        if item.decision == "split":
            whole, old = item.edits[0].node, item.edits[1].node
            if whole in self._met:
                self._met[old] = self._met.pop(whole)
        if item.decision in NEW or item.kind in self._met:
            self._met[item.kind] += 1
            met = self._met[item.kind]
            self.once += (met == 1) - (met == 2)
            self.twice += (met == 2) - (met == 3)


def chao1(n: int, seen: int, once: int, twice: int) -> tuple[float, float, float]:
    """Estimate the number of unseen kinds, with its 95 % interval.

    Args:
        n: Observations.
        seen: Kinds that were met.
        once: Kinds that were met once.
        twice: Kinds that were met twice.

    Returns:
        Estimate, lower and upper bound; three zeros where every kind was met again.
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
    factor = math.exp(Z * math.sqrt(math.log1p(max(variance, 0.0) / unseen**2)))
    return unseen, unseen / factor, unseen * factor
