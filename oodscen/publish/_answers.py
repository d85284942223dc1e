"""Scoring answers to published questions, as the leaderboard of a study does."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from oodscen._arguments import checked
from oodscen.errors import DataError, Issue, UsageError
from oodscen.judging._items import AnswerColumns, answer_values
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
def score_answers(answers: Iterable[tuple[Mapping[str, Any], str]]) -> dict[str, float]:
    """Return the figures over a model's answers to published questions, as shares of the answers that score.

    Answers are read by the same rules as in a study. Figures of questions of other kinds are left out.

    Args:
        answers: Pairs of a row of the data set, of which `purpose` and `key` are used, and the model's text.

    Raises:
        DataError: If the key of a row is malformed.
        UsageError: If there is something else than pairs.
    """
    asked: dict[str, list[tuple[AnswerKey, dict[str, float]]]] = {}
    for pair in answers:
        if not isinstance(pair, Sequence) or isinstance(pair, str) or len(pair) != 2:
            raise UsageError(f"answers must be pairs of a row and a text, not {pair!r:.80}")
        key, purpose = _read(pair[0])
        verdict = key.verdict(purpose, str(pair[1]))
        asked.setdefault(purpose, []).append((key, answer_values(verdict, key.episode)))
    figures: dict[str, float] = {}
    for purpose, found in sorted(asked.items()):
        items = items_of([key for key, _ in found])
        known = rates(items, AnswerColumns.of_values(items, {key.item: one for key, one in found}))
        for figure in (name for task in TASKS[purpose] for name in FIGURES_OF_TASK[task]):
            if (value := known[figure].value) is not None:
                figures[figure] = value
    return figures


def _read(row: Mapping[str, Any]) -> tuple[AnswerKey, str]:
    """Return the key and the purpose of a row."""
    if not isinstance(row, Mapping) or not {"key", "purpose"} <= row.keys():
        raise DataError("question", [Issue("", "is not a row with a key and a purpose")])
    if row["purpose"] not in TASKS:
        raise DataError("question", [Issue("purpose", f"is none of {', '.join(TASKS)}")])
    return AnswerKey.parse(str(row["key"])), str(row["purpose"])
