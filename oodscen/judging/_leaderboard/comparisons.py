"""Paired comparisons of models with one another, and with the best reference that does not know the truth."""

from collections.abc import Sequence
from itertools import combinations
from typing import Literal, NamedTuple

import numpy as np

from oodscen.judging._items import Items, Sheets
from oodscen.judging._leaderboard.rows import (
    TASKS,
    LeaderboardRow,
    ModelComparison,
    Task,
    best_floor,
)
from oodscen.statistics._significance import PairedTest, holm, paired_test


class _Pair(NamedTuple):
    """The tests of two answerers on the items that both answered."""

    first: str
    second: str
    test: PairedTest
    missing: int
    """Items that the first answerer was asked about and did not answer."""
    worst: PairedTest
    """The test with those counted as wrong."""


def comparisons(
    items: Items,
    seed: int,
    standings: Sequence[LeaderboardRow],
    shortcut: LeaderboardRow | None,
    sheets: Sheets,
) -> list[ModelComparison]:
    """Return the models' comparisons with one another, and with the best reference or shortcut, by task."""
    ours = [row for row in standings if row.protocol == "ours"]
    models = [row for row in ours if row.is_judged]
    results: list[ModelComparison] = []
    for task in TASKS:
        pairs = [_pair(items, task, *both, sheets, seed=seed) for both in combinations(models, 2)]
        results += _family(task, "model", [pair for pair in pairs if pair.test.n])
        floor = best_floor([*ours, *([shortcut] if shortcut else [])], task)
        if floor is not None:
            pairs = [_pair(items, task, model, floor, sheets, seed=seed) for model in models]
            results += _family(task, "floor", [pair for pair in pairs if pair.test.n])
    return results


def _pair(
    items: Items,
    task: Task,
    first: LeaderboardRow,
    second: LeaderboardRow,
    sheets: Sheets,
    *,
    seed: int,
) -> _Pair:
    """Return the tests of two rows in one task; open aspects that different judges scored are left out."""
    sheet, other = (sheets[row.model, row.protocol] for row in (first, second))
    right, right_other = sheet.right(task, items), other.right(task, items)
    is_unlike = sheet.scored_unlike(other) & (task == "open")
    right = np.where(is_unlike, np.nan, right)
    # The figure of detection is balanced accuracy.
    classes = items.is_scene if task == "detection" else None
    test = paired_test(right, right_other, items.clusters, classes=classes, seed=seed)
    is_missing = sheet.unanswered(task, items) & ~is_unlike
    worst = test
    if test.n and is_missing.any():
        at_worst = np.where(is_missing, 0.0, right)
        worst = paired_test(at_worst, right_other, items.clusters, classes=classes, seed=seed)
    return _Pair(first.model, second.model, test, int(is_missing.sum()), worst)


def _family(
    task: Task, against: Literal["model", "floor"], pairs: Sequence[_Pair]
) -> list[ModelComparison]:
    """Return the comparisons of pairs in one task, with p-values corrected for all of them together."""
    p_holm = holm([pair.test.p_mcnemar for pair in pairs])
    p_clustered_holm = holm([pair.test.p_clustered for pair in pairs])
    p_worst_holm = holm([pair.worst.p_clustered for pair in pairs])
    is_floor = against == "floor"
    return [
        ModelComparison(
            task=task,
            against=against,
            first=pair.first,
            second=pair.second,
            test=pair.test,
            p_holm=p_holm[index],
            p_clustered_holm=p_clustered_holm[index],
            missing=pair.missing if is_floor else 0,
            worst_difference=pair.worst.difference if is_floor else None,
            p_worst_holm=p_worst_holm[index] if is_floor else None,
        )
        for index, pair in enumerate(pairs)
    ]
