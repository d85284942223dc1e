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

    Answers are read by the same rules as in a study. Figures of questions of other kinds are left out. The rows may
    come from several data sets: a scene is paired with the ordinary drives of its own.

    Args:
        answers: Pairs of a row of a data set, of which `purpose`, `pair` and `key` are used, and the model's text.

    Raises:
        DataError: If a row lacks one of these, or its key is malformed.
        UsageError: If there is something else than pairs with a text, or a question is answered twice.
    """
    asked: dict[str, dict[str, tuple[AnswerKey, dict[str, float]]]] = {}
    for pair in answers:
        if not isinstance(pair, Sequence) or isinstance(pair, str) or len(pair) != 2:
            raise UsageError(f"answers must be pairs of a row and a text, not {pair!r:.80}")
        if not isinstance(pair[1], str):
            raise UsageError(f"an answer must be a text, not {pair[1]!r:.80}")
        key, purpose = _read(pair[0])
        found = asked.setdefault(purpose, {})
        if key.item in found:
            item = key.item.partition("/")[2]
            fault = f"the question {purpose} about {item} is answered twice"
            raise UsageError(
                f"{fault}; give one answer to each question, and score every repetition by itself"
            )
        verdict = key.verdict(purpose, pair[1])
        found[key.item] = key, answer_values(verdict, key.episode)
    figures: dict[str, float] = {}
    for purpose, found in sorted(asked.items()):
        items = items_of([key for key, _ in found.values()])
        values = {item: one for item, (_, one) in found.items()}
        known = rates(items, AnswerColumns.of_values(items, values))
        for figure in (name for task in TASKS[purpose] for name in FIGURES_OF_TASK[task]):
            if (value := known[figure].value) is not None:
                figures[figure] = value
    return figures


def _read(row: Mapping[str, Any]) -> tuple[AnswerKey, str]:
    """Return the key and the purpose of a row.

    The item of the key is below the name of its pair, since scenes of different data sets share ids.
    """
    if not isinstance(row, Mapping) or not {"key", "pair", "purpose"} <= row.keys():
        raise DataError("question", [Issue("", "is not a row with a key, a pair and a purpose")])
    purpose, pair = row["purpose"], row["pair"]
    if not isinstance(purpose, str) or purpose not in TASKS:
        raise DataError("question", [Issue("purpose", f"is none of {', '.join(TASKS)}")])
    if not isinstance(pair, str):
        raise DataError("question", [Issue("pair", "must be a text")])
    key = AnswerKey.parse(str(row["key"]))
    return key.model_copy(update={"item": f"{pair}/{key.item}"}), purpose
