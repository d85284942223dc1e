"""A reanalysis of the paper's table: what its numbers show, and what they cannot show."""

from itertools import combinations
from typing import Literal, get_args

from oodscen import _paper as paper
from oodscen.data._base import Data
from oodscen.judging._leaderboard.power import SampleSize, scenes_needed
from oodscen.statistics._answers import d_prime, two_proportions
from oodscen.statistics._intervals import wilson
from oodscen.statistics._significance import holm, mcnemar

N = paper.PATHS * paper.PER_PATH
"""Scenes of the paper, ten on each of 13 paths."""
ALPHA = 0.05

Task = Literal["aspect", "control"]
TASKS: tuple[Task, ...] = get_args(Task)


class PaperRow(Data):
    """One cell of the paper's table with its uncertainty."""

    model: str
    task: Task
    hits: int
    n: int = N
    value: float
    low: float
    """Wilson interval, 95 %, with all scenes taken as independent."""
    high: float
    clustered_low: float
    """Wilson interval with the effective number of scenes, at the assumed correlation within a path."""
    clustered_high: float


class PaperComparison(Data):
    """Two of the paper's models in one task.

    The paper prints totals and not the answers per scene, so the paired test that its design calls for
    cannot be computed. It lies between two extremes: either the weaker model was right only where the
    stronger was too, or the two disagree as often as the totals allow.
    """

    task: Task
    first: str
    second: str
    difference: float
    p: float
    """For two independent samples: accounts for neither pairing nor paths."""
    p_holm: float
    """Corrected for the three pairs of the task."""
    p_clustered: float
    """`p` with the effective number of scenes."""
    p_clustered_holm: float
    p_paired_least: float
    """McNemar's mid-p with as few disagreements as the totals allow."""
    p_paired_most: float
    """McNemar's mid-p with as many disagreements as the totals allow."""


class PaperExample(Data):
    """The paper's table of 130 scenes with intervals, comparisons and the baseline it lacks."""

    icc: float
    """Assumed intraclass correlation within a path."""
    design_effect: float
    effective_scenes: float
    rows: tuple[PaperRow, ...]
    comparisons: tuple[PaperComparison, ...]
    always_ood_accuracy: float
    """Detection accuracy without twins of an answerer that always says "out of the ordinary"."""
    always_ood_balanced: float
    """Balanced accuracy of the same answerer once every scene has a twin."""
    always_ood_d_prime: float
    independent: SampleSize
    """Scenes needed to tell 66 % from 51 %, if all are independent."""
    clustered: SampleSize
    """The same with scenes in paths of ten."""
    shows: tuple[str, ...]
    shows_not: tuple[str, ...]


def paper_example(*, icc: float = 0.2) -> PaperExample:
    """Return a reanalysis of the paper's table (section V-C, table II).

    Args:
        icc: Correlation of the ten scenes of a path, which the paper does not report; 0 takes them as
            independent. The paper's bar charts range from nearly none to all right between paths, which
            suggests a high one.

    Raises:
        UsageError: If `icc` lies outside 0 to 1.
    """
    independent = scenes_needed(0.66, 0.51)
    clustered = scenes_needed(0.66, 0.51, per_path=paper.PER_PATH, icc=icc)
    effect = clustered.design_effect
    rows = tuple(
        _row(model, task, hits[index], effect)
        for index, task in enumerate(TASKS)
        for model, hits in paper.VLM_SUCCESS.items()
    )
    comparisons = tuple(pair for task in TASKS for pair in _pairs(rows, task, effect))
    return PaperExample(
        icc=icc,
        design_effect=effect,
        effective_scenes=N / effect,
        rows=rows,
        comparisons=comparisons,
        always_ood_accuracy=1.0,
        always_ood_balanced=0.5,
        always_ood_d_prime=d_prime(N, N, N, N) or 0.0,
        independent=independent,
        clustered=clustered,
        shows=_shown(rows, comparisons),
        shows_not=_not_shown(comparisons, independent, clustered, effect),
    )


def _shown(rows: tuple[PaperRow, ...], comparisons: tuple[PaperComparison, ...]) -> tuple[str, ...]:
    lowest = min(row.low for row in rows if row.task == "aspect")
    leader, p = _lead(comparisons, "p_holm")
    sentences = [
        "Each model named the aspect in most scenes: the lowest of the lower bounds is "
        f"{lowest:.0%}."
    ]
    if p < ALPHA:
        sentences.append(
            f"Taking every scene as independent, {leader} chose a safe action more often than both "
            f"others (Holm-corrected p at most {p:.3f})."
        )
    return tuple(sentences)


def _not_shown(
    comparisons: tuple[PaperComparison, ...],
    independent: SampleSize,
    clustered: SampleSize,
    effect: float,
) -> tuple[str, ...]:
    leader, p = _lead(comparisons, "p_clustered_holm")
    sentences = [
        "No ordinary scene was shown, so always answering “out of the ordinary” is right in 100 % "
        "of them: whether a model tells rare from ordinary is not measured.",
        "How often a random or a constant action would have been safe is not reported, so whether "
        "66 % is more than chance, or than always braking, cannot be said.",
        "Who was right in which scene is not reported, so the paired test that the design calls "
        "for can only be bracketed.",
        "Taking the answers of the models as independent, none named the aspect significantly more often "
        "than another.",
        f"Telling 66 % from 51 % with power 80 % takes {independent.scenes} independent scenes"
        + (f", or {clustered.scenes} in paths of {clustered.per_path}" if effect > 1 else "")
        + f"; the paper has {N}.",
    ]
    if p >= ALPHA:
        sentences.insert(
            0,
            f"If scenes of one path are alike (intraclass correlation {clustered.icc:g}), {N} of them "
            f"count as {N / effect:.0f}, and the lead of {leader} in choosing an action is no longer "
            f"significant (Holm-corrected p up to {p:.2f}).",
        )
    return tuple(sentences)


def _lead(
    comparisons: tuple[PaperComparison, ...], field: Literal["p_holm", "p_clustered_holm"]
) -> tuple[str, float]:
    """Return the leader in choosing an action, and the largest p of that lead."""
    control = [comparison for comparison in comparisons if comparison.task == "control"]
    leader = control[0].first
    lead = [comparison for comparison in control if comparison.first == leader]
    return leader, max(getattr(comparison, field) for comparison in lead)


def _row(model: str, task: Task, hits: int, effect: float) -> PaperRow:
    low, high = wilson(hits, N)
    wide_low, wide_high = wilson(hits / effect, N / effect)
    return PaperRow(
        model=model,
        task=task,
        hits=hits,
        value=hits / N,
        low=low,
        high=high,
        clustered_low=wide_low,
        clustered_high=wide_high,
    )


def _pairs(rows: tuple[PaperRow, ...], task: Task, effect: float) -> list[PaperComparison]:
    """Return the comparisons of every two models in a task, in the order of the paper's table."""
    pairs = list(combinations([row for row in rows if row.task == task], 2))
    plain = [two_proportions(a.hits, N, b.hits, N) for a, b in pairs]
    wide = [
        two_proportions(a.hits / effect, N / effect, b.hits / effect, N / effect) for a, b in pairs
    ]
    plain_holm, wide_holm = holm(plain), holm(wide)
    comparisons = []
    for index, (a, b) in enumerate(pairs):
        fewest, most = _disagreements(a.hits, b.hits)
        comparisons.append(
            PaperComparison(
                task=task,
                first=a.model,
                second=b.model,
                difference=(a.hits - b.hits) / N,
                p=plain[index],
                p_holm=plain_holm[index],
                p_clustered=wide[index],
                p_clustered_holm=wide_holm[index],
                p_paired_least=mcnemar(*fewest)[1],
                p_paired_most=mcnemar(*most)[1],
            )
        )
    return comparisons


def _disagreements(first: int, second: int) -> tuple[tuple[int, int], tuple[int, int]]:
    """Return the fewest and the most scenes on which exactly one of two models can be right."""
    least_both, most_both = max(first + second - N, 0), min(first, second)
    return (
        (first - most_both, second - most_both),
        (first - least_both, second - least_both),
    )
