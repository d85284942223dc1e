"""Sample sizes for telling two success rates apart, and the power of a given number of scenes."""

import math
from statistics import NormalDist

from oodscen._arguments import checked
from oodscen._numbers import finite_number, whole_number
from oodscen.data._base import Data
from oodscen.errors import UsageError

_NORMAL = NormalDist()
_LEAST = 1e-9
"""The smallest usable distance of a rate or level from 0 or 1, and of two rates from each other."""


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
        return power_of(
            self.first,
            self.second,
            scenes,
            paired=self.is_paired,
            agreement=self.agreement,
            alpha=self.alpha,
            comparisons=self.comparisons,
            per_path=self.per_path,
            icc=self.icc,
        )

    def __str__(self) -> str:
        how = (
            f"both models on the same scenes (their answers correlate by {self.agreement:.2g})"
            if self.is_paired
            else "each model on scenes of its own"
        )
        lines = [
            f"To tell {self.first:.1%} from {self.second:.1%}, {how}, with power {self.power:.0%} at "
            f"alpha {self.alpha:g}"
            + (f" over {self.comparisons} comparisons" if self.comparisons > 1 else "")
            + ":",
            f"  {self.independent} scenes if all were independent",
        ]
        if self.per_path > 1:
            lines.append(
                f"  {self.scenes} scenes = {self.paths} paths of {self.per_path} "
                f"(design effect {self.design_effect:.2f} at an intraclass correlation of {self.icc:g})"
            )
        return "\n".join(lines)


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
    _check(first, second, agreement, alpha, comparisons, per_path, icc)
    finite_number("power", power, _LEAST, 1 - _LEAST)
    discordant = _discordant(first, second, agreement)
    z_alpha = -_NORMAL.inv_cdf(alpha / comparisons / 2)
    z_power = _NORMAL.inv_cdf(power)
    gap = abs(first - second)
    under_null, under_truth = _spreads(first, second, paired, discordant)
    exact = ((z_alpha * under_null + z_power * under_truth) / gap) ** 2
    independent = math.ceil(exact - 1e-9)
    effect = 1 + (per_path - 1) * icc
    paths = math.ceil(exact * effect / per_path - 1e-9)
    return SampleSize(
        first=first,
        second=second,
        is_paired=paired,
        agreement=round(_possible(first, second, agreement), 6) if paired else 0.0,
        discordant=round(discordant, 6) if paired else 0.0,
        alpha=alpha,
        power=power,
        comparisons=comparisons,
        independent=independent,
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
    _check(first, second, agreement, alpha, comparisons, per_path, icc)
    whole_number("scenes", scenes, 1)
    under_null, under_truth = _spreads(first, second, paired, _discordant(first, second, agreement))
    effective = scenes / (1 + (per_path - 1) * icc)
    z_alpha = -_NORMAL.inv_cdf(alpha / comparisons / 2)
    reach = abs(first - second) * math.sqrt(effective) - z_alpha * under_null
    return _NORMAL.cdf(reach / under_truth) if under_truth else float(reach > 0)


def _spreads(first: float, second: float, paired: bool, discordant: float) -> tuple[float, float]:
    """Return the standard deviation of one scene's difference under no difference, and as it is."""
    if paired:
        return math.sqrt(discordant), math.sqrt(max(discordant - (first - second) ** 2, 0.0))
    pooled = (first + second) / 2
    return (
        math.sqrt(2 * pooled * (1 - pooled)),
        math.sqrt(first * (1 - first) + second * (1 - second)),
    )


def _discordant(first: float, second: float, agreement: float) -> float:
    """Return the probability that exactly one of two models is right, at a given agreement."""
    both = first * second + agreement * _spread(first, second)
    both = min(max(both, first + second - 1, 0.0), first, second)
    return first + second - 2 * both


def _possible(first: float, second: float, agreement: float) -> float:
    """Return the correlation closest to the requested one that two rates allow."""
    ends = (max(first + second - 1, 0.0), min(first, second))
    low, high = ((both - first * second) / _spread(first, second) for both in ends)
    return min(max(agreement, low), high)


def _spread(first: float, second: float) -> float:
    return math.sqrt(first * (1 - first) * second * (1 - second))


def _check(
    first: float,
    second: float,
    agreement: float,
    alpha: float,
    comparisons: int,
    per_path: int,
    icc: float,
) -> None:
    for name, rate in (("the first rate", first), ("the second rate", second), ("alpha", alpha)):
        finite_number(name, rate, _LEAST, 1 - _LEAST)
    if abs(first - second) < _LEAST:
        raise UsageError("no number of scenes can tell equal rates apart")
    finite_number("agreement, a correlation,", agreement, -1, 1)
    finite_number("icc", icc, 0, 1)
    whole_number("comparisons", comparisons, 1)
    whole_number("scenes per path", per_path, 1)
