"""Scoring answers to published questions, as the leaderboard of a study does."""

from collections.abc import Iterable, Mapping
from typing import Any

from oodscen.data._base import canonical_json
from oodscen.judging._items import AnswerColumns, Items
from oodscen.judging._items import answer_values as values_of
from oodscen.judging._leaderboard.figures import rates
from oodscen.judging._scoring import AnswerKey
from oodscen.publish._questions import TASKS

FIGURES_OF_TASK: Mapping[str, tuple[str, ...]] = {
    "notice": ("notice-both", "notice", "alarms"),
    "name": ("name",),
    "choose": ("pick",),
    "act": ("act-both", "safe", "needless"),
}
"""The figures of each task; the paired one first."""


def answer_values(row: Mapping[str, Any], answer: str) -> dict[str, Any]:
    """Return the values of a model's answer to one row of a published data set.

    Args:
        row: The row, with its `purpose` and `key`.
        answer: The model's text, read by the same rules as in a study.

    Raises:
        DataError: If the key of the row is malformed.
    """
    key = AnswerKey.parse(str(row["key"]))
    verdict = key.verdict(str(row["purpose"]), answer)
    return {
        "key": canonical_json(key.model_dump(mode="json")),
        "purpose": row["purpose"],
        **values_of(verdict, key.episode),
    }


def figures_of(answers: Iterable[Mapping[str, Any]]) -> dict[str, float]:
    """Return the figures over the answers to one kind of question, as shares of the answers that score.

    Args:
        answers: What `answer_values` returned, for any of the rows.
    """
    found = list(answers)
    keys = [AnswerKey.parse(str(one["key"])) for one in found]
    items = Items.of([key.episode for key in keys], [key.scenario for key in keys])
    values = {
        key.item: {name: float(one[name]) for name in one if name not in ("key", "purpose")}
        for key, one in zip(keys, found, strict=True)
    }
    purposes = {str(one["purpose"]) for one in found}
    wanted = [
        figure
        for purpose in sorted(purposes)
        for task in TASKS[purpose]
        for figure in FIGURES_OF_TASK[task]
    ]
    known = rates(items, AnswerColumns.of_values(items, values))
    return {name: value for name in wanted if (value := known[name].value) is not None}
