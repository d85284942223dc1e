"""The leaderboard as the page shows it."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from oodscen.data._verdict import NOTHING, Protocol
from oodscen.judging._aspects.labelled import agreement_in_words
from oodscen.judging._items import last_by
from oodscen.judging._leaderboard.board import Leaderboard
from oodscen.judging._leaderboard.leaderboard import leaderboard
from oodscen.judging._leaderboard.paper_example import paper_example
from oodscen.judging._leaderboard.requirements import ALPHA, Bar, requirements
from oodscen.judging._leaderboard.rows import PRIVILEGED, LeaderboardRow, Rate
from oodscen.judging._leaderboard.sentences import constants
from oodscen.report._charts import scores as charts
from oodscen.report._charts.canvas import Canvas
from oodscen.report._load import Material

_MOST_TYPES = 20
"""With more paths than this the charts group by family."""
_MOST_SERIES = 5
_TOP_CONFUSIONS = 8

_CONSTANT = "constant:"


@dataclass(frozen=True)
class PrintedRow:
    """One row of the leaderboard."""

    standing: LeaderboardRow
    role: str
    """`ceiling`, `floor` or empty."""


@dataclass(frozen=True)
class Confused:
    """The confusions of one model."""

    model: str
    chart: Canvas
    labels: tuple[str, ...]
    top: tuple[tuple[str, str, int], ...]

    @property
    def is_wide(self) -> bool:
        """True if the picture does not fit beside the table."""
        return len(self.labels) > charts.MOST_BESIDE


def board(found: Material) -> Leaderboard:
    """Return the leaderboard of a study."""
    return leaderboard(
        found.verdicts, found.episodes, found.scenarios, whole=found.whole, audit=found.audit
    )


def context(found: Material, board: Leaderboard, bars: Sequence[Bar] = ()) -> dict[str, Any]:
    """Return the template's variables about models; `bars` are a requirement to grade them by."""
    shown = _series(board)
    level = _level(board)
    rows = [*board.standings, *([board.shortcut] if board.shortcut else [])]
    return {
        "board": board,
        "constants": constants(board),
        "judge_agreement": agreement_in_words(found.info),
        "bars": ", ".join(map(str, bars)),
        "grades": requirements(
            found.verdicts, found.episodes, found.scenarios, bars, seed=board.seed
        )
        if bars and found.are_verdicts_whole
        else [],
        "alpha": ALPHA,
        "both": [_line(row, board.shortcut, _best_blind(board)) for row in rows],
        "lines": [_line(row, board.floor("control")) for row in board.standings],
        "noticing": [_line(row, board.floor("closed")) for row in _without_repeats(board)],
        "has_twins": any(row.detection.specificity.n for row in board.standings),
        "has_collisions": any(row.control.collision_free.n for row in board.standings),
        "has_closed": any(row.identification.closed.n for row in board.standings),
        "series": [row.model for row in shown],
        "type_level": level,
        "chart_named": _chart(shown, level, "open", "Aspect named"),
        "chart_safe": _chart(shown, level, "safe", "Safe action chosen"),
        "confused": _confusions(board, found),
        "example": paper_example(),
    }


def _without_repeats(board: Leaderboard) -> list[LeaderboardRow]:
    """Return the rows of task 1, with one row for all constants, which differ in their action only."""
    rows: list[LeaderboardRow] = []
    alike: list[LeaderboardRow] = []
    for row in board.standings:
        if row.model.startswith(_CONSTANT) and row.protocol == "ours":
            alike.append(row)
        else:
            rows.append(row)
    scores = {(row.detection.to_json(), row.identification.to_json()) for row in alike}
    if len(scores) > 1:
        return list(board.standings)
    if alike:
        name = alike[0].model if len(alike) == 1 else f"constant ({len(alike)} alike)"
        floor = board.floor("closed")
        kept = floor if floor in alike else alike[0]
        rows.append(kept.model_copy(update={"model": name}))
    return rows


def _best_blind(board: Leaderboard) -> LeaderboardRow | None:
    """Return the reference without pictures that most often acts rightly in both halves."""
    blind = [row for row in board.standings if row.is_blind and row.paired.act.value is not None]
    return max(blind, key=lambda row: row.paired.act.value or 0.0, default=None)


def _line(row: LeaderboardRow, *floors: LeaderboardRow | None) -> PrintedRow:
    is_floor = any(
        (row.control, row.detection, row.identification)
        == (floor.control, floor.detection, floor.identification)
        for floor in floors
        if floor is not None
    )
    return PrintedRow(
        standing=row,
        role="ceiling" if row.model == PRIVILEGED else "floor" if is_floor else "",
    )


def _series(board: Leaderboard) -> list[LeaderboardRow]:
    """Return the rows that the charts show: the models, or without any the most different references."""
    models = [row for row in board.standings if row.is_judged]
    if models:
        return models[:_MOST_SERIES]
    names = ("oracle", "novelty", "blind", "random")
    references = [row for row in board.standings if row.model.startswith(names)]
    floor = board.floor("control")
    chosen = [*references, *([floor] if floor and floor not in references else [])]
    return chosen[:_MOST_SERIES]


def _level(board: Leaderboard) -> str:
    groups = board.standings[0].groups if board.standings else ()
    paths = sum(group.level == "path" for group in groups)
    families = sum(group.level == "family" for group in groups)
    return "family" if paths > _MOST_TYPES and families else "path"


def _chart(shown: Sequence[LeaderboardRow], level: str, field: str, what: str) -> Canvas | None:
    if not shown:
        return None
    found = [{group.name: group for group in row.groups if group.level == level} for row in shown]
    rows = []
    for name, group in found[0].items():
        rates: list[Rate | None] = [
            getattr(groups[name], field) if name in groups else None for groups in found
        ]
        rows.append(
            charts.ScoreRow(
                name, [_bar(rate) for rate in rates], group.chance if field == "safe" else None
            )
        )
    if not any(bar for row in rows for bar in row.bars):
        return None
    return charts.bars(rows, [row.model for row in shown], what)


def _bar(rate: Rate | None) -> charts.ScoreBar | None:
    if rate is None or not rate.n or rate.interval is None:
        return None
    return charts.ScoreBar(rate.hits, rate.n, rate.interval.low, rate.interval.high)


def _confusions(board: Leaderboard, found: Material) -> list[Confused]:
    """Return the confusions of the models, at the level of the charts."""
    level = _level(board)
    labels = {s.leaf: _label(s.path, level) for s in found.scenarios}
    names = {s.leaf: s.path[-1] if s.path else s.leaf for s in found.scenarios}
    order = list(dict.fromkeys(labels.values()))
    place = {label: index for index, label in enumerate(order)}
    right = _right_choices(found)
    rows = []
    for row in [row for row in board.standings if row.is_judged][:_MOST_SERIES]:
        counts: Counter[tuple[int, int]] = Counter()
        for leaf, count in right.get((row.model, row.protocol), {}).items():
            counts[place[labels[leaf]], place[labels[leaf]]] += count
        for confusion in row.confusions:
            if confusion.truth in labels:
                column = place.get(labels.get(confusion.chosen, ""), len(order))
                counts[place[labels[confusion.truth]], column] += confusion.count
        if counts:
            top = tuple(
                (
                    names.get(confusion.truth, confusion.truth),
                    "nothing unusual"
                    if confusion.chosen == NOTHING
                    else names.get(confusion.chosen, confusion.chosen),
                    confusion.count,
                )
                for confusion in row.confusions[:_TOP_CONFUSIONS]
            )
            rows.append(
                Confused(row.model, charts.confusion(order, counts, len(order)), tuple(order), top)
            )
    return rows


def _right_choices(found: Material) -> dict[tuple[str, Protocol], Counter[str]]:
    """Count the right closed choices of every answerer by the leaf of their scenes.

    An option may stand for several leaves, so it need not name the leaf. Of several answers to a question the last counts.
    """
    leaf_of = {s.id: s.leaf for s in found.scenarios}
    right: dict[tuple[str, Protocol], Counter[str]] = {}
    for verdict in last_by(found.verdicts, lambda one: (one.model, one.protocol, one.scene_id)):
        if verdict.choice_is_right and verdict.scene_id in leaf_of:
            counts = right.setdefault((verdict.model, verdict.protocol), Counter())
            counts[leaf_of[verdict.scene_id]] += 1
    return right


def _label(path: Sequence[str], level: str) -> str:
    if level == "family" and len(path) > 3:
        return path[2]
    return path[-1] if path else ""
