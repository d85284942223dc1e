"""Leads over answerers that see no picture, on the same scenes."""

from collections.abc import Sequence
from typing import Literal, get_args

import numpy as np

from oodscen.data._verdict import without_pictures
from oodscen.judging._items import Items, Ratio, Sheets
from oodscen.judging._leaderboard.figures import PairColumns
from oodscen.judging._leaderboard.rows import Estimate, Gain, LeaderboardRow
from oodscen.statistics._intervals import cluster_interval
from oodscen.statistics._resampling import Resampler

Figure = Literal["notice", "act"]
FIGURES: tuple[Figure, ...] = get_args(Figure)


def mean_of(resampler: Resampler, column: Ratio) -> Estimate:
    """Return a mean over some items, with its interval over whole paths."""
    n = int(column.is_there.sum())
    if not n:
        return Estimate()
    found = resampler.ratios(column.above[:, None], column.below[:, None])[:, 0]
    return Estimate(
        value=round(float(column.above.sum()) / n, 6),
        n=n,
        interval=cluster_interval(found, resampler.count(column.is_there)),
    )


def with_gains(
    items: Items, resampler: Resampler, rows: Sequence[LeaderboardRow], sheets: Sheets
) -> list[LeaderboardRow]:
    """Return the rows, with the leads of models over the best blind reference and over themselves blindfolded."""
    ours = [row for row in rows if row.protocol == "ours"]
    blind = [row for row in ours if row.is_blind]
    names = {row.model: row for row in ours}
    pairs = {row.model: PairColumns.of(items, sheets[row.model, "ours"]) for row in ours}

    def gain(row: LeaderboardRow, other: LeaderboardRow, figure: Figure) -> Gain:
        one, two = (getattr(pairs[name], figure) for name in (row.model, other.model))
        column = Ratio(one - two, pairs[row.model].mask)
        return Gain(against=other.model, figure=figure, difference=mean_of(resampler, column))

    def led(row: LeaderboardRow) -> LeaderboardRow:
        if row.kind == "reference" or row.protocol != "ours":
            return row
        best = [
            (max(blind, key=lambda leaderboard_row: _value(leaderboard_row, name)), name)
            for name in FIGURES
            if blind
        ]
        leads = {"over_blind": tuple(gain(row, other, name) for other, name in best)}
        if withheld := names.get(without_pictures(row.model)):
            leads["over_withheld"] = tuple(gain(row, withheld, name) for name in FIGURES)
        return row.model_copy(update={"paired": row.paired.model_copy(update=leads)})

    return [led(row) for row in rows]


def _value(row: LeaderboardRow, figure: Figure) -> float:
    value = getattr(row.paired, figure).value
    return -np.inf if value is None else float(value)
