"""Paired comparisons of models with one another, and with the best reference that does not know the truth."""

from collections.abc import Iterable, Sequence
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
    """Items that the first answerer was asked about and did not answer; 0 between models."""
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
        results += _family(items, seed, task, "model", combinations(models, 2), sheets)
        floor = best_floor([*ours, *([shortcut] if shortcut else [])], task)
        if floor is not None:
            against_floor = [(model, floor) for model in models]
            results += _family(items, seed, task, "floor", against_floor, sheets)
    return results


def _family(
    items: Items,
    seed: int,
    task: Task,
    against: Literal["model", "floor"],
    rows: Iterable[tuple[LeaderboardRow, LeaderboardRow]],
    sheets: Sheets,
) -> list[ModelComparison]:
    """Return the comparisons of pairs of rows in one task, with p-values corrected for all of them together."""
    is_floor = against == "floor"
    tested = [_pair(items, seed, task, *pair, sheets, counts_missing=is_floor) for pair in rows]
    pairs = [pair for pair in tested if pair.test.n]
    p_holm = holm([pair.test.p_mcnemar for pair in pairs])
    p_clustered_holm = holm([pair.test.p_clustered for pair in pairs])
    p_worst_holm = holm([pair.worst.p_clustered for pair in pairs])
    return [
        ModelComparison(
            task=task,
            against=against,
            first=pair.first,
            second=pair.second,
            test=pair.test,
            p_holm=p_holm[index],
            p_clustered_holm=p_clustered_holm[index],
            missing=pair.missing,
            worst_difference=pair.worst.difference if is_floor else None,
            p_worst_holm=p_worst_holm[index] if is_floor else None,
        )
        for index, pair in enumerate(pairs)
    ]


def _pair(
    items: Items,
    seed: int,
    task: Task,
    first: LeaderboardRow,
    second: LeaderboardRow,
    sheets: Sheets,
    *,
    counts_missing: bool,
) -> _Pair:
    """Return the tests of two rows in one task; open aspects that different judges scored are left out."""
    sheet, other = (sheets[row.model, row.protocol] for row in (first, second))
    right, right_other = sheet.right(task, items), other.right(task, items)
    is_unlike = sheet.scored_unlike(other) & (task == "open")
    right = np.where(is_unlike, np.nan, right)
    # The figure of detection is balanced accuracy.
    classes = items.is_scene if task == "detection" else None
    test = paired_test(right, right_other, items.clusters, classes=classes, seed=seed)
    is_missing = sheet.unanswered(task, items) & ~is_unlike & counts_missing
    worst = test
    if test.n and is_missing.any():
        at_worst = np.where(is_missing, 0.0, right)
        worst = paired_test(at_worst, right_other, items.clusters, classes=classes, seed=seed)
    return _Pair(first.model, second.model, test, int(is_missing.sum()), worst)
