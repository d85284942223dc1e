"""Scoring answers to published questions, as the leaderboard of a study does."""

from collections.abc import Iterable, Mapping
from typing import Any

from oodscen._arguments import checked
from oodscen.data._base import canonical_json
from oodscen.errors import DataError, Issue
from oodscen.judging._items import VALUES, AnswerColumns
from oodscen.judging._items import answer_values as values_of
from oodscen.judging._leaderboard.figures import rates
from oodscen.judging._scoring import AnswerKey, items_of
from oodscen.publish._question_rows import TASKS

FIGURES_OF_TASK: Mapping[str, tuple[str, ...]] = {
    "notice": ("notice-both", "notice", "alarms"),
    "name": ("name",),
    "choose": ("pick",),
    "act": ("act-both", "safe", "needless"),
}
"""The figures of each task; the paired one first."""


@checked
def answer_values(row: Mapping[str, Any], answer: str) -> dict[str, Any]:
    """Return the values of a model's answer to one row of a published data set.

    Args:
        row: The row, with its `purpose` and `key`.
        answer: The model's text, read by the same rules as in a study.

    Raises:
        DataError: If the key of the row is malformed.
    """
    key, purpose = _read(row)
    verdict = key.verdict(purpose, str(answer))
    return {
        "key": canonical_json(key.model_dump(mode="json")),
        "purpose": purpose,
        **values_of(verdict, key.episode),
    }


@checked
def figures_of(answers: Iterable[Mapping[str, Any]]) -> dict[str, float]:
    """Return the figures over the answers to one kind of question, as shares of the answers that score.

    Args:
        answers: What `answer_values` returned, for any of the rows.

    Raises:
        DataError: If one of them is malformed.
    """
    found = [(*_read(one), one) for one in answers]
    items = items_of([key for key, _, _ in found])
    values = {key.item: {name: one[name] for name in VALUES} for key, _, one in found}
    known = rates(items, AnswerColumns.of_values(items, values))
    return {
        figure: value
        for purpose in sorted({purpose for _, purpose, _ in found})
        for task in TASKS[purpose]
        for figure in FIGURES_OF_TASK[task]
        if (value := known[figure].value) is not None
    }


def _read(row: Mapping[str, Any]) -> tuple[AnswerKey, str]:
    """Return the key and the purpose of a row."""
    if not isinstance(row, Mapping) or not {"key", "purpose"} <= row.keys():
        raise DataError("question", [Issue("", "is not a row with a key and a purpose")])
    if row["purpose"] not in TASKS:
        raise DataError("question", [Issue("purpose", f"is none of {', '.join(TASKS)}")])
    return AnswerKey.parse(str(row["key"])), str(row["purpose"])
