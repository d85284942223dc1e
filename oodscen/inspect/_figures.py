"""The figures of a study's leaderboard as metrics of inspect_ai, with errors clustered by path."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from inspect_ai.scorer import Metric, SampleScore, Score, Value, metric, stderr

from oodscen.judging._items import AnswerColumns, Items, Ratio
from oodscen.judging._leaderboard.figures import figures, rates
from oodscen.judging._scoring import AnswerKey, items_of


@metric
def figure(name: str) -> Metric:
    """Return the metric of one figure: its share, clustered standard error, interval and counts.

    A share is over the answers that score, as on the leaderboard. With several epochs an answer counts by the mean
    of its values, and a paired figure by their product over the scene and its ordinary drives.

    Args:
        name: The figure, e.g. `act-both`.
    """

    def measure(scores: list[SampleScore]) -> Value:
        items, sheet = _columns(scores)
        column = figures(items, sheet)[name]
        rate = rates(items, sheet)[name]
        measured: dict[str, Any] = {
            name: rate.value,
            f"{name}_stderr": _clustered_error(items, column),
            f"{name}_low": rate.interval.low if rate.interval else None,
            f"{name}_high": rate.interval.high if rate.interval else None,
            f"{name}_n": rate.n,
            f"{name}_missing": rate.missing,
            f"{name}_missing_wrong": rate.with_missing_wrong,
        }
        return {key: value for key, value in measured.items() if value is not None}

    return measure


def _columns(scores: Sequence[SampleScore]) -> tuple[Items, AnswerColumns]:
    keys = [AnswerKey.parse((score.sample_metadata or {}).get("key")) for score in scores]
    items = items_of(keys)
    values = {
        key.item: {name: float(value) for name, value in score.score.as_dict().items()}
        for key, score in zip(keys, scores, strict=True)
    }
    return items, AnswerColumns.of_values(items, values)


def _clustered_error(items: Items, column: Ratio) -> float | None:
    """Return the standard error of a mean with whole paths as clusters; `None` if answers to fewer than two score."""
    rows = np.flatnonzero(column.is_there).tolist()
    if len({items.clusters[row] for row in rows}) < 2:
        return None
    scores = [
        SampleScore(
            score=Score(value=float(column.above[row])),
            sample_metadata={"path": items.clusters[row]},
        )
        for row in rows
    ]
    return float(stderr(cluster="path")(scores))
