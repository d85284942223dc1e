"""The leaderboard as the page shows it."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from oodscen.data._pairing import kind_of
from oodscen.data._verdict import NOTHING, Protocol, Verdict
from oodscen.judging._aspects.labelled import agreement_in_words
from oodscen.judging._items import last_by
from oodscen.judging._leaderboard.board import Leaderboard
from oodscen.judging._leaderboard.leaderboard import leaderboard
from oodscen.judging._leaderboard.paper_example import paper_example
from oodscen.judging._leaderboard.requirements import (
    ALPHA,
    Bar,
    RequirementResult,
    requirements,
)
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


def study_board(material: Material) -> Leaderboard:
    """Return the leaderboard of a study."""
    return leaderboard(
        material.verdicts,
        material.episodes,
        material.scenarios,
        whole=material.whole,
        audit=material.audit,
        seed=material.seed,
    )


def leaderboard_variables(
    material: Material, board: Leaderboard, bars: Sequence[Bar]
) -> dict[str, Any]:
    """Return the template's variables about models; `bars` are a requirement to grade them by."""
    shown = _series(board)
    level = _level(board)
    grades: list[RequirementResult] = []
    if bars and material.are_verdicts_whole:
        grades = requirements(
            material.verdicts, material.episodes, material.scenarios, bars, seed=board.seed
        )
    return {
        "board": board,
        "constants": constants(board),
        "judge_agreement": agreement_in_words(material.info),
        "bars": ", ".join(map(str, bars)),
        "grades": grades,
        "alpha": ALPHA,
        "both": [_line(row, board.shortcut, _best_blind(board)) for row in board.rows],
        "lines": [_line(row, board.floor("control")) for row in board.standings],
        "noticing": [_line(row, board.floor("closed")) for row in _without_repeats(board)],
        "has_twins": any(row.detection.specificity.n for row in board.standings),
        "has_demands": any(kind_of(episode.scene_id) == "demand" for episode in material.episodes),
        "has_paper_rows": any(row.protocol == "paper" for row in board.rows),
        "has_collisions": any(row.control.collision_free.n for row in board.standings),
        "has_closed": any(row.identification.closed.n for row in board.standings),
        "series": [row.model for row in shown],
        "type_level": level,
        "chart_named": _chart(shown, level, "open", "Aspect named"),
        "chart_safe": _chart(shown, level, "safe", "Safe action chosen"),
        "confused": _confusions(material, board),
        "example": paper_example(),
    }


def _without_repeats(board: Leaderboard) -> list[LeaderboardRow]:
    """Return the rows of task 1, with one row for all constants, which differ in their action only."""
    alike = [
        row for row in board.standings if row.model.startswith(_CONSTANT) and row.protocol == "ours"
    ]
    scores = {(row.detection.to_json(), row.identification.to_json()) for row in alike}
    if len(alike) < 2 or len(scores) > 1:
        return list(board.standings)
    floor = board.floor("closed")
    shown = floor if floor in alike else alike[0]
    others = [row for row in board.standings if row not in alike]
    return [*others, shown.model_copy(update={"model": f"constant ({len(alike)} alike)"})]


def _best_blind(board: Leaderboard) -> LeaderboardRow | None:
    """Return the reference without pictures that most often acts rightly in both halves."""
    blind = [row for row in board.standings if row.is_blind and row.paired.act.value is not None]
    return max(blind, key=lambda row: row.paired.act.value or 0.0, default=None)


def _line(row: LeaderboardRow, *floors: LeaderboardRow | None) -> PrintedRow:
    is_floor = row.kind == "reference" and any(
        (row.control, row.detection, row.identification)
        == (floor.control, floor.detection, floor.identification)
        for floor in floors
        if floor is not None
    )
    if row.model == PRIVILEGED:
        return PrintedRow(row, "ceiling")
    return PrintedRow(row, "floor" if is_floor else "")


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


def _chart(shown: Sequence[LeaderboardRow], level: str, field: str, title: str) -> Canvas | None:
    """Draw one figure of every group of scenes, with a bar per model; `None` if no answer scores."""
    # All rows of a board have the same groups, in the same order.
    groups = ([group for group in row.groups if group.level == level] for row in shown)
    rows = [
        charts.ScoreRow(
            alike[0].name,
            [_bar(getattr(group, field)) for group in alike],
            alike[0].chance if field == "safe" else None,
        )
        for alike in zip(*groups, strict=True)
    ]
    if not any(bar for row in rows for bar in row.bars):
        return None
    return charts.bars(rows, [row.model for row in shown], title)


def _bar(rate: Rate) -> charts.ScoreBar | None:
    if not rate.n or rate.interval is None:
        return None
    return charts.ScoreBar(rate.hits, rate.n, rate.interval.low, rate.interval.high)


def _confusions(material: Material, board: Leaderboard) -> list[Confused]:
    """Return the confusions of the models, at the level of the charts."""
    level = _level(board)
    labels = {text.leaf: _label(text.path, level) for text in material.scenarios}
    names = {text.leaf: text.path[-1] if text.path else text.leaf for text in material.scenarios}
    names[NOTHING] = "nothing unusual"
    order = list(dict.fromkeys(labels.values()))
    index_of = {label: index for index, label in enumerate(order)}
    right_choices = _right_choices(material)
    models = [row for row in board.standings if row.is_judged][:_MOST_SERIES]
    confused = []
    for row in models:
        counts: Counter[tuple[int, int]] = Counter()
        for leaf, count in right_choices.get((row.model, row.protocol), {}).items():
            index = index_of[labels[leaf]]
            counts[index, index] += count
        for confusion in row.confusions:
            if confusion.truth in labels:
                column = index_of.get(labels.get(confusion.chosen, ""), len(order))
                counts[index_of[labels[confusion.truth]], column] += confusion.count
        if counts:
            top = tuple(
                (
                    names.get(confusion.truth, confusion.truth),
                    names.get(confusion.chosen, confusion.chosen),
                    confusion.count,
                )
                for confusion in row.confusions[:_TOP_CONFUSIONS]
            )
            chart = charts.confusion(order, counts)
            confused.append(Confused(row.model, chart, tuple(order), top))
    return confused


def _right_choices(material: Material) -> dict[tuple[str, Protocol], Counter[str]]:
    """Count the right closed choices of every answerer by the leaf of their scenes.

    An option may stand for several leaves, so it need not name the leaf. Of several answers to a question the last counts.
    """
    leaf_of = {text.id: text.leaf for text in material.scenarios}
    right: dict[tuple[str, Protocol], Counter[str]] = {}
    for verdict in last_by(material.verdicts, _question):
        if verdict.choice_is_right and verdict.scene_id in leaf_of:
            counts = right.setdefault((verdict.model, verdict.protocol), Counter())
            counts[leaf_of[verdict.scene_id]] += 1
    return right


def _question(verdict: Verdict) -> tuple[str, str, str]:
    return verdict.model, verdict.protocol, verdict.scene_id


def _label(path: Sequence[str], level: str) -> str:
    if level == "family" and len(path) > 3:
        return path[2]
    return path[-1] if path else ""
