"""What a leaderboard comes to in plain sentences: who can be trusted with what, and how surely."""

from collections.abc import Sequence
from typing import ClassVar, Literal

from oodscen._data import Data
from oodscen.judging.leaderboard import Comparison, Figure, Leaderboard, Rate, Standing, Task, score

ALPHA = 0.05
_GAP = "\N{NO-BREAK SPACE}"

Grade = Literal["yes", "no", "unclear", "unknown"]


class Finding(Data):
    """Whether one model does better in one task than can be had without looking."""

    noun: ClassVar[str] = "finding"

    model: str
    task: Literal["notice", "name", "act"]
    grade: Grade
    """`yes`: shown to be better; `no`: shown not to be; `unclear`: not shown; `unknown`: not measured."""
    text: str


def findings(board: Leaderboard) -> list[Finding]:
    """Return three findings per model: it notices, it names, it acts."""
    return [
        finding
        for row in board.standings
        if row.kind == "model" and row.protocol == "ours"
        for finding in (_notices(row), _names(board, row), _acts(board, row))
    ]


def answer(board: Leaderboard) -> list[str]:
    """Say in a few sentences which model to trust, with what, and how surely."""
    models = [row for row in board.standings if row.kind == "model" and row.protocol == "ours"]
    if not models:
        return _without_models(board)
    sentences = [_best(board, models, task) for task in ("detection", "open", "control")]
    floor = board.floor("control")
    if floor is not None and floor.control.safe.value is not None:
        beaten = [
            c.first
            for c in board.comparisons
            if c.task == "control"
            and c.against == "floor"
            and is_shown(c)
            and c.test.difference > 0
        ]
        who = f"Only {_listed(beaten)} can" if beaten else "No model here can"
        sentences.append(
            f"{who} be said to choose actions better than {floor.model}, which looks at nothing and is "
            f"safe in {percent(floor.control.safe.value)} of the scenes."
        )
    return [sentence for sentence in sentences if sentence]


def is_shown(comparison: Comparison) -> bool:
    """Whether a difference is significant after all corrections, with whole paths as the units."""
    return comparison.p_clustered_holm < ALPHA


def percent(value: float | None) -> str:
    """Write a share in whole per cent."""
    return "–" if value is None else f"{100 * value:.0f}{_GAP}%"


def spread(value: Rate | Figure) -> str:
    """Write an interval of a share."""
    if value.interval is None:
        return ""
    return f" [{100 * value.interval.low:.0f}–{100 * value.interval.high:.0f}{_GAP}%]"


def _best(board: Leaderboard, models: Sequence[Standing], task: Task) -> str:
    ranked = sorted(
        (row for row in models if score(row, task) is not None),
        key=lambda row: -(score(row, task) or 0.0),
    )
    if not ranked:
        return ""
    best = ranked[0]
    what = {
        "detection": "telling rare scenes from ordinary ones (balanced accuracy",
        "open": "naming what is unusual (right in",
        "closed": "picking what is unusual from a list (right in",
        "control": "choosing an action (safe in",
    }[task]
    figures: dict[Task, Rate | Figure] = {
        "detection": best.detection.balanced_accuracy,
        "open": best.identification.open,
        "closed": best.identification.closed,
        "control": best.control.safe,
    }
    figure = figures[task]
    text = f"Best at {what} {percent(figure.value)}{spread(figure)}): {best.model}"
    rivals = [
        c
        for c in board.comparisons
        if c.task == task and c.against == "model" and best.model in (c.first, c.second)
    ]
    open_ = [c.second if c.first == best.model else c.first for c in rivals if not is_shown(c)]
    if not rivals:
        return f"{text}."
    if open_:
        return f"{text}; that it beats {_listed(open_)} is not shown."
    return f"{text}; its lead over every other model is significant."


def _notices(row: Standing) -> Finding:
    seen, quiet, balanced = (
        row.detection.sensitivity,
        row.detection.specificity,
        row.detection.balanced_accuracy,
    )
    if not seen.n:
        return Finding(model=row.model, task="notice", grade="unknown", text="Was not asked.")
    text = f"Calls {percent(seen.value)}{spread(seen)} of the rare scenes unusual"
    if not quiet.n or balanced.value is None:
        return Finding(
            model=row.model,
            task="notice",
            grade="unknown",
            text=f"{text}. Ordinary twins were not asked about, so whoever always says so scores 100 %.",
        )
    alarms = 1 - (quiet.value or 0.0)
    text += f", and {percent(alarms)} of their ordinary twins as well."
    return Finding(
        model=row.model, task="notice", grade=_against(balanced, 0.5), text=f"{text}{_silent(seen)}"
    )


def _names(board: Leaderboard, row: Standing) -> Finding:
    named, chosen = row.identification.open, row.identification.closed
    if not named.n and not chosen.n:
        return Finding(model=row.model, task="name", grade="unknown", text="Was not asked.")
    parts = []
    if named.n:
        parts.append(
            f"Names what is unusual in {percent(named.value)}{spread(named)} of the scenes"
        )
    if chosen.n:
        parts.append(f"picks it from a list in {percent(chosen.value)}{spread(chosen)}")
    task: Task = "closed" if chosen.n else "open"
    floor, grade = board.floor(task), _floor_grade(board, row, task)
    text = ", ".join(parts)
    if floor is not None:
        text += f"; {floor.model}, which does not know, {percent(score(floor, task))}"
    return Finding(
        model=row.model,
        task="name",
        grade=grade,
        text=f"{text}.{_silent(named if named.n else chosen)}",
    )


def _acts(board: Leaderboard, row: Standing) -> Finding:
    safe, needless = row.control.safe, row.control.needless
    if not safe.n:
        return Finding(model=row.model, task="act", grade="unknown", text="Was not asked.")
    text = f"Its action is safe in {percent(safe.value)}{spread(safe)} of the scenes"
    floor = board.floor("control")
    beside = [] if board.chance is None else [f"a random one in {percent(board.chance)}"]
    if floor is not None:
        beside.append(f"{floor.model} in {percent(floor.control.safe.value)}")
    text += f" ({', '.join(beside)})." if beside else "."
    if needless.n:
        text += (
            f" On ordinary roads it stops or brakes hard without need in {percent(needless.value)}."
        )
    return Finding(
        model=row.model,
        task="act",
        grade=_floor_grade(board, row, "control"),
        text=f"{text}{_silent(safe)}",
    )


def _floor_grade(board: Leaderboard, row: Standing, task: Task) -> Grade:
    """Grade a model by its comparison with the best reference."""
    found = next(
        (
            c
            for c in board.comparisons
            if c.task == task and c.against == "floor" and c.first == row.model
        ),
        None,
    )
    if found is None:
        return "unknown"
    if not is_shown(found):
        return "unclear"
    return "yes" if found.test.difference > 0 else "no"


def _against(value: Figure, chance: float) -> Grade:
    if value.interval is None:
        return "unclear"
    if value.interval.low > chance:
        return "yes"
    return "no" if value.interval.high < chance else "unclear"


def _silent(rate: Rate) -> str:
    return f" No usable answer for {rate.missing} more." if rate.missing else ""


def _without_models(board: Leaderboard) -> list[str]:
    sentences = [
        "No vision-language model was judged in this study, so there is none to trust yet."
    ]
    floor = board.floor("control")
    if floor is not None and floor.control.safe.value is not None:
        sentences.append(
            f"What one must beat: {floor.model}, which looks at nothing, is safe in "
            f"{percent(floor.control.safe.value)}{spread(floor.control.safe)} of the scenes"
            + ("" if board.chance is None else f", a random action in {percent(board.chance)}")
            + "."
        )
    return sentences


def _listed(names: Sequence[str]) -> str:
    if len(names) < 2:
        return "".join(names)
    return f"{', '.join(names[:-1])} or {names[-1]}"
