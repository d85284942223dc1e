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
    replicates = resampler.ratios(column.above[:, None], column.below[:, None])[:, 0]
    return Estimate(
        value=round(float(column.above.sum()) / n, 6),
        n=n,
        interval=cluster_interval(replicates, resampler.count(column.is_there)),
    )


def with_gains(
    items: Items, resampler: Resampler, rows: Sequence[LeaderboardRow], sheets: Sheets
) -> list[LeaderboardRow]:
    """Return the rows, with the leads of models over the best blind reference and over themselves blindfolded."""
    ours = [row for row in rows if row.protocol == "ours"]
    blind = [row for row in ours if row.is_blind]
    by_name = {row.model: row for row in ours}
    pairs = {row.model: PairColumns.of(items, sheets[row.model, "ours"]) for row in ours}

    def gain(row: LeaderboardRow, other: LeaderboardRow, figure: Figure) -> Gain:
        lead = getattr(pairs[row.model], figure) - getattr(pairs[other.model], figure)
        column = Ratio(lead, pairs[row.model].mask)
        return Gain(against=other.model, figure=figure, difference=mean_of(resampler, column))

    def with_leads(row: LeaderboardRow) -> LeaderboardRow:
        if row.kind == "reference" or row.protocol != "ours":
            return row
        leads: dict[str, tuple[Gain, ...]] = {"over_blind": ()}
        if blind:
            leads["over_blind"] = tuple(
                gain(row, _best(blind, figure), figure) for figure in FIGURES
            )
        if withheld := by_name.get(without_pictures(row.model)):
            leads["over_withheld"] = tuple(gain(row, withheld, figure) for figure in FIGURES)
        return row.model_copy(update={"paired": row.paired.model_copy(update=leads)})

    return [with_leads(row) for row in rows]


def _best(rows: Sequence[LeaderboardRow], figure: Figure) -> LeaderboardRow:
    """Return the row with the highest figure; one without it is lowest."""

    def value(row: LeaderboardRow) -> float:
        share = getattr(row.paired, figure).value
        return -np.inf if share is None else float(share)

    return max(rows, key=value)
