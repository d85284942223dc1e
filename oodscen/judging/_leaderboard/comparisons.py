"""Paired comparisons of models with one another, and with the best reference that does not know the truth."""

from collections.abc import Sequence
from itertools import combinations
from typing import Literal

import numpy as np

from oodscen.judging._items import Items, Sheets
from oodscen.judging._leaderboard.rows import (
    TASKS,
    LeaderboardRow,
    ModelComparison,
    Task,
    best_floor,
)
from oodscen.statistics._significance import holm, paired_test


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
    model_comparisons: list[ModelComparison] = []
    for task in TASKS:
        floor = best_floor([*ours, *([shortcut] if shortcut else [])], task)
        model_comparisons += _family(
            items, seed, task, "model", list(combinations(models, 2)), sheets
        )
        if floor is not None:
            model_comparisons += _family(
                items, seed, task, "floor", [(m, floor) for m in models], sheets
            )
    return model_comparisons


def _family(
    items: Items,
    seed: int,
    task: Task,
    against: Literal["model", "floor"],
    pairs: Sequence[tuple[LeaderboardRow, LeaderboardRow]],
    sheets: Sheets,
) -> list[ModelComparison]:
    """Return the comparisons of pairs in one task, with p-values corrected for all of them together."""
    tests, worst = [], []
    for first, second in pairs:
        sheet, other = (sheets[row.model, row.protocol] for row in (first, second))
        one, two = sheet.right(task, items), other.right(task, items)
        unlike = sheet.scored_unlike(other) & (task == "open")
        one = np.where(unlike, np.nan, one)
        test = paired_test(one, two, items.clusters, seed=seed)
        if not test.n:
            continue
        silent = sheet.unanswered(task, items) & ~unlike
        tests.append((first.model, second.model, test, int(silent.sum())))
        filled = np.where(silent, 0.0, one)
        worst.append(paired_test(filled, two, items.clusters, seed=seed) if silent.any() else test)
    plain = holm([test.p_mcnemar for _, _, test, _ in tests])
    clustered = holm([test.p_clustered for _, _, test, _ in tests])
    at_worst = holm([test.p_clustered for test in worst])
    is_floor = against == "floor"
    return [
        ModelComparison(
            task=task,
            against=against,
            first=first,
            second=second,
            test=test,
            p_holm=p,
            p_clustered_holm=q,
            missing=silent if is_floor else 0,
            worst_difference=least.difference if is_floor else None,
            p_worst_holm=r if is_floor else None,
        )
        for (first, second, test, silent), least, p, q, r in zip(
            tests, worst, plain, clustered, at_worst, strict=True
        )
    ]
