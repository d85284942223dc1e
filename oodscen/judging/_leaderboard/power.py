"""Sample sizes for telling two success rates apart, and the power of a given number of scenes."""

import math
from dataclasses import dataclass, fields
from statistics import NormalDist

from oodscen._arguments import checked
from oodscen._numbers import finite_number, whole_number
from oodscen.data._base import Data
from oodscen.errors import UsageError
from oodscen.judging._rates_in_words import number_of

_NORMAL = NormalDist()
_LEAST = 1e-9
"""The smallest usable distance of a rate or level from 0 or 1, and of two rates from each other."""
_MOST_DIGITS = 9
"""Digits of a percentage that tell any two usable rates apart."""
_MOST_SCENES = 10**30
"""More than any two usable rates need."""
_ROUNDING = 1e-9
"""Excess over a whole number of scenes that counts as an error of rounding."""


class SampleSize(Data):
    """The number of scenes that a comparison needs."""

    first: float
    second: float
    is_paired: bool
    """True if both models judge the same scenes."""
    agreement: float
    """Paired only: the assumed correlation of their answers, the closest to the requested one that the rates
    allow.
    """
    discordant: float
    """Paired only: share of scenes on which exactly one of them is right."""
    alpha: float
    """Probability of a false positive, before division by the number of comparisons."""
    power: float
    """Probability of detecting the difference."""
    comparisons: int
    independent: int
    """Scenes per model if every scene were a path of its own."""
    per_path: int
    icc: float
    """Assumed intraclass correlation."""
    design_effect: float
    """Factor by which clustering inflates the number of scenes."""
    scenes: int
    """Scenes per model, in whole paths."""
    paths: int

    def power_of(self, scenes: int) -> float:
        """Return the probability that this many scenes per model show the difference."""
        design = _Design(**{field.name: getattr(self, field.name) for field in fields(_Design)})
        return design.power(scenes)

    def __str__(self) -> str:
        pairing = "each model on scenes of its own"
        if self.is_paired:
            pairing = (
                f"both models on the same scenes (their answers correlate by {self.agreement:.2g})"
            )
        first, second = distinct_percents(self.first, self.second, digits=1)
        (power,) = distinct_percents(self.power)
        several = f" over {self.comparisons} comparisons" if self.comparisons > 1 else ""
        lines = [
            f"To tell {first} from {second}, {pairing}, with power {power} at alpha {self.alpha:g}{several}:",
            f"  {number_of(self.independent, 'scene')} if all were independent",
        ]
        if self.per_path > 1:
            lines.append(
                f"  {self.scenes} scenes = {number_of(self.paths, 'path')} of {self.per_path} "
                f"(design effect {self.design_effect:.2f} at an intraclass correlation of {self.icc:g})"
            )
        return "\n".join(lines)


def distinct_percents(*shares: float, digits: int = 0) -> list[str]:
    """Return shares as percentages with as many digits as tell them from each other, from 0 and from 100 %.

    Args:
        shares: Shares in [0, 1].
        digits: The fewest digits after the point.
    """
    percents: list[str] = []
    for count in range(digits, _MOST_DIGITS + 1):
        percents = [f"{share:.{count}%}" for share in shares]
        ends = (f"{end:.{count}%}" for end in (0, 1))
        if len({*percents, *ends}) == len({*shares, 0.0, 1.0}):
            break
    return percents


@checked
def scenes_needed(
    first: float,
    second: float,
    *,
    paired: bool = True,
    agreement: float = 0.0,
    power: float = 0.8,
    alpha: float = 0.05,
    comparisons: int = 1,
    per_path: int = 1,
    icc: float = 0.0,
) -> SampleSize:
    """Return the number of scenes needed to tell two success rates apart.

    Paired (McNemar): R. J. Connor, Biometrics 43 (1987). Unpaired: J. L. Fleiss, Statistical
    Methods for Rates and Proportions (1981), without continuity correction. Clustering:
    L. Kish's design effect, 1 + (scenes per path - 1) times the intraclass correlation. For a
    paired comparison that correlation is the one of the *differences*, which is often smaller.

    Args:
        first: Success rate of one model, between 0 and 1.
        second: Success rate of the other model.
        paired: Whether both judge the same scenes.
        agreement: Correlation of right and wrong between the models on the same scenes. 0 takes them as
            independent, which needs the most scenes; models usually fail on the same ones.
        power: Probability of detecting the difference.
        alpha: Two-sided level.
        comparisons: Number of comparisons; alpha is divided by it (Holm's first step).
        per_path: Scenes per path.
        icc: Intraclass correlation within a path.

    Raises:
        UsageError: If no number of scenes suffices, or an argument is out of range.
    """
    design = _Design(first, second, paired, agreement, alpha, comparisons, per_path, icc)
    finite_number("power", power, _LEAST, 1 - _LEAST)
    under_null, under_truth = design.deviations
    z_power = _NORMAL.inv_cdf(power)
    # One scene has more power than so little that the sum is negative.
    reach = max(design.z_alpha * under_null + z_power * under_truth, 0.0)
    exact = (reach / abs(first - second)) ** 2
    effect = design.effect(per_path)
    paths = max(math.ceil(exact * effect / per_path - _ROUNDING), 1)
    return SampleSize(
        first=first,
        second=second,
        is_paired=paired,
        agreement=design.possible_agreement if paired else 0.0,
        discordant=design.discordant if paired else 0.0,
        alpha=alpha,
        power=power,
        comparisons=comparisons,
        independent=max(math.ceil(exact - _ROUNDING), 1),
        per_path=per_path,
        icc=icc,
        design_effect=effect,
        scenes=paths * per_path,
        paths=paths,
    )


def power_of(
    first: float,
    second: float,
    scenes: int,
    *,
    paired: bool = True,
    agreement: float = 0.0,
    alpha: float = 0.05,
    comparisons: int = 1,
    per_path: int = 1,
    icc: float = 0.0,
) -> float:
    """Return the probability that a number of scenes shows the difference between two success rates.

    The arguments are those of `scenes_needed`.

    Raises:
        UsageError: If an argument is out of range.
    """
    design = _Design(first, second, paired, agreement, alpha, comparisons, per_path, icc)
    return design.power(scenes)


@dataclass(frozen=True)
class _Design:
    """A comparison of two success rates."""

    first: float
    second: float
    is_paired: bool
    agreement: float
    alpha: float
    comparisons: int
    per_path: int
    icc: float

    def __post_init__(self) -> None:
        finite_number("the first rate", self.first, _LEAST, 1 - _LEAST)
        finite_number("the second rate", self.second, _LEAST, 1 - _LEAST)
        finite_number("alpha", self.alpha, _LEAST, 1 - _LEAST)
        if abs(self.first - self.second) < _LEAST:
            raise UsageError("no number of scenes can tell equal rates apart")
        finite_number("agreement, a correlation,", self.agreement, -1, 1)
        finite_number("icc", self.icc, 0, 1)
        for name, words in (("comparisons", "comparisons"), ("per_path", "scenes per path")):
            object.__setattr__(self, name, whole_number(words, getattr(self, name), 1))

    @property
    def z_alpha(self) -> float:
        """The normal quantile of the two-sided level, after Holm's first step."""
        return -_NORMAL.inv_cdf(self.alpha / self.comparisons / 2)

    def effect(self, per_path: int) -> float:
        """Return Kish's design effect of paths with a number of scenes."""
        return 1 + (per_path - 1) * self.icc

    @property
    def _spread(self) -> float:
        first, second = self.first, self.second
        return math.sqrt(first * (1 - first) * second * (1 - second))

    @property
    def discordant(self) -> float:
        """The probability that exactly one of the models is right."""
        first, second = self.first, self.second
        both = first * second + self.agreement * self._spread
        both = min(max(both, first + second - 1, 0.0), first, second)
        return first + second - 2 * both

    @property
    def possible_agreement(self) -> float:
        """The correlation closest to the requested one that the rates allow."""
        first, second = self.first, self.second
        ends = (max(first + second - 1, 0.0), min(first, second))
        low, high = ((both - first * second) / self._spread for both in ends)
        return min(max(self.agreement, low), high)

    @property
    def deviations(self) -> tuple[float, float]:
        """The standard deviation of one scene's difference under no difference, and as it is."""
        first, second = self.first, self.second
        if self.is_paired:
            discordant = self.discordant
            return math.sqrt(discordant), math.sqrt(max(discordant - (first - second) ** 2, 0.0))
        pooled = (first + second) / 2
        variance = first * (1 - first) + second * (1 - second)
        return math.sqrt(2 * pooled * (1 - pooled)), math.sqrt(variance)

    def power(self, scenes: int) -> float:
        """Return the probability that a number of scenes shows the difference."""
        scenes = whole_number("scenes", scenes, 1, _MOST_SCENES)
        under_null, under_truth = self.deviations
        root = math.sqrt(scenes / self.effect(min(self.per_path, scenes)))
        reach = abs(self.first - self.second) * root - self.z_alpha * under_null
        return _NORMAL.cdf(reach / under_truth) if under_truth else float(reach > 0)
