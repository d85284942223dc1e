"""Scoring answers to published questions, as the leaderboard of a study does."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

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
    answers_by_purpose: dict[str, dict[str, _ScoredAnswer]] = {}
    for pair in answers:
        row, text = _checked_pair(pair)
        key, purpose = _key_and_purpose(row)
        scored = answers_by_purpose.setdefault(purpose, {})
        if key.item in scored:
            item = key.item.partition("/")[2]
            raise UsageError(
                f"the question {purpose} about {item} is answered twice; give one answer to each question, and score "
                "every repetition by itself"
            )
        values = answer_values(key.verdict(purpose, text), key.episode)
        scored[key.item] = _ScoredAnswer(key, values)
    figures: dict[str, float] = {}
    for purpose, scored in sorted(answers_by_purpose.items()):
        figures |= _figures(purpose, scored)
    return figures


class _ScoredAnswer(NamedTuple):
    """One answer as the figures count it."""

    key: AnswerKey
    values: dict[str, float]


def _figures(purpose: str, scored: Mapping[str, _ScoredAnswer]) -> dict[str, float]:
    """Return the figures of the tasks of one purpose that have a value; answers are given by item."""
    items = items_of([answer.key for answer in scored.values()])
    values = {item: answer.values for item, answer in scored.items()}
    rate_of_figure = rates(items, AnswerColumns.of_values(items, values))
    figures = {}
    for task in TASKS[purpose]:
        for figure in FIGURES_OF_TASK[task]:
            value = rate_of_figure[figure].value
            if value is not None:
                figures[figure] = value
    return figures


def _checked_pair(pair: Any) -> tuple[Any, str]:
    if not isinstance(pair, Sequence) or isinstance(pair, str) or len(pair) != 2:
        raise UsageError(f"answers must be pairs of a row and a text, not {pair!r:.80}")
    if not isinstance(pair[1], str):
        raise UsageError(f"an answer must be a text, not {pair[1]!r:.80}")
    return pair[0], pair[1]


def _key_and_purpose(row: Any) -> tuple[AnswerKey, str]:
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
