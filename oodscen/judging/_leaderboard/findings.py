"""Plain-language findings of a leaderboard: which model to trust with which task, and how certainly."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar, Literal

from oodscen.data._base import Data
from oodscen.judging._leaderboard.scores import (
    Estimate,
    LeaderboardRow,
    ModelComparison,
    Rate,
    Task,
    missing_share,
    score,
    worst_score,
)

if TYPE_CHECKING:
    from oodscen.judging._leaderboard.board import Leaderboard

ALPHA = 0.05
MOST_MISSING = 0.2
"""The largest share of unanswered items with which a model can be recommended in a task, or called the best."""
_GAP = "\N{NO-BREAK SPACE}"
_TO = "\N{WORD JOINER}–\N{WORD JOINER}"
"""A dash without a line break around it."""

Grade = Literal["yes", "no", "unclear", "unknown", "incomplete"]


class Finding(Data):
    """The finding whether one model beats the references in one task."""

    noun: ClassVar[str] = "finding"

    model: str
    task: Literal["notice", "name", "act"]
    grade: Grade
    """`yes`: shown to be better; `no`: shown not to be; `unclear`: not shown, or not with missing answers counted
    as
    wrong; `unknown`: not measured; `incomplete`: more than `MOST_MISSING` unanswered.
    """
    text: str


def findings(board: "Leaderboard") -> list[Finding]:
    """Return three findings per model: it notices, it names, it acts."""
    return [
        finding
        for row in board.standings
        if row.kind == "model" and row.protocol == "ours"
        for finding in (_notices(board, row), _names(board, row), _acts(board, row))
    ]


def answer(board: "Leaderboard") -> list[str]:
    """Return a few sentences on which model to trust with what, and how certainly."""
    models = [row for row in board.standings if row.kind == "model" and row.protocol == "ours"]
    if not models:
        return _without_models(board)
    sentences = [_best(board, models, task) for task in ("detection", "open", "control")]
    sentences += [_unfinished(board, row) for row in models]
    sentences.append(
        f"This rests on {board.scenes} scenes of {board.paths} kinds. Brackets hold 95{_GAP}% intervals. "
        "What is “shown” would seldom come about by chance alone (p < 0.05 after correction for "
        "several comparisons)."
    )
    return [sentence for sentence in sentences if sentence]


def called(reference: str) -> str:
    """Return the description of a reference, given its short name."""
    name, _, action = reference.partition(":")
    if name == "constant" and action:
        return f"always answering the same (“{reference}”)"
    return {
        "random": "guessing at random",
        "blind": "answering without the pictures (“blind”)",
        "novelty": "measuring how unlike others a picture is (“novelty”)",
    }.get(reference, reference)


def is_shown(comparison: ModelComparison) -> bool:
    """Return whether a difference is significant after all corrections, with whole paths as the units."""
    return comparison.p_clustered_holm < ALPHA


def percent(value: float | None) -> str:
    """Return a share in whole per cent."""
    return "–" if value is None else f"{100 * value:.0f}{_GAP}%"


def spread(value: Rate | Estimate) -> str:
    """Return the interval of a share as text."""
    if value.interval is None:
        return ""
    low, high = 100 * value.interval.low, 100 * value.interval.high
    return f" [{low:.0f}{_TO}{high:.0f}{_GAP}%]"


_AIMS: dict[Task, str] = {
    "detection": "To notice that something is unusual",
    "open": "To say what is unusual",
    "closed": "To pick what is unusual from a list",
    "control": "To choose an action",
}


def _best(board: "Leaderboard", models: Sequence[LeaderboardRow], task: Task) -> str:
    """Return sentences on whether the best model in a task can be trusted with it, and whether it leads."""
    scored = [row for row in models if score(row, task) is not None]
    silent = [row for row in scored if missing_share(row, task) > MOST_MISSING]
    ranked = sorted(
        (row for row in scored if row not in silent),
        key=lambda row: -(worst_score(row, task) or 0.0),
    )
    left = "".join(
        f" {row.model} left {percent(missing_share(row, task))} unanswered and is not ranked."
        for row in silent
    )
    if not ranked:
        return (
            f"{_AIMS[task]}, no model gave enough answers to be recommended.{left}" if left else ""
        )
    best = ranked[0]
    grade = (
        _detection_grade(board, best) if task == "detection" else _floor_grade(board, best, task)
    )
    aim = _AIMS[task]
    verdict = {
        "yes": f"{aim}, trust {best.model}",
        "unclear": f"{aim}, no model is shown to be better than not looking; the best is {best.model}",
        "no": f"{aim}, trust none: even the best, {best.model}, is worse than not looking",
        "unknown": f"{aim}, the best is {best.model}",
        "incomplete": "",
    }[grade]
    if grade == "unclear" and _is_ahead_of_floor(board, best, task):
        verdict = (
            f"{aim}, {best.model} is better than not looking in what it answered, but not if what it left "
            "unanswered counts as wrong"
        )
    text = f"{verdict}. {_score(board, best, task)}{_at_worst(best, task)}"
    return f"{text}{_lead(board, ranked, task)}{left}"


def _is_ahead_of_floor(board: "Leaderboard", row: LeaderboardRow, task: Task) -> bool:
    """Return whether a model is shown to beat not looking, with missing answers left out."""
    if task == "detection" and row.detection.balanced_accuracy.interval is not None:
        return _against(row.detection.balanced_accuracy, 0.5) == "yes"
    found = _floor_comparison(board, row, task)
    return found is not None and is_shown(found) and found.test.difference > 0


def _at_worst(row: LeaderboardRow, task: Task) -> str:
    """Return the sentence on the score with every missing answer counted as wrong."""
    worst = worst_score(row, task)
    if not missing_share(row, task) or worst is None:
        return ""
    return f" It would be {percent(worst)} if its unanswered ones were wrong."


def _score(board: "Leaderboard", row: LeaderboardRow, task: Task) -> str:
    """Return the sentence on a model's score and the best score without looking."""
    if task == "detection":
        balanced = row.detection.balanced_accuracy
        return (
            f"It tells rare scenes from ordinary ones rightly in {percent(balanced.value)}{spread(balanced)}; "
            f"guessing would in {percent(0.5)}."
        )
    floor = board.floor(task)
    beside = [] if floor is None else [f"{called(floor.model)} in {percent(score(floor, task))}"]
    if task != "control":
        named = row.identification.open if task == "open" else row.identification.closed
        text = f"It is right in {percent(named.value)}{spread(named)} of the scenes"
        return f"{text}; {beside[0]}." if beside else f"{text}."
    if board.chance is not None:
        beside.append(f"a random action in {percent(board.chance)}")
    safe, needless = row.control.safe, row.control.needless
    text = f"What it does is safe in {percent(safe.value)}{spread(safe)} of the scenes"
    text += f"; {', '.join(beside)}." if beside else "."
    if needless.n:
        text += f" Its price: on ordinary roads it stops or brakes hard without need in {percent(needless.value)}."
    return text


def _lead(board: "Leaderboard", ranked: Sequence[LeaderboardRow], task: Task) -> str:
    """Return the sentence on whether the first of the ranked models is shown to beat the others."""
    best, others = ranked[0].model, {row.model for row in ranked[1:]}
    open_, behind, ahead = list[str](), list[str](), list[str]()
    for one in board.comparisons:
        if one.task != task or one.against != "model" or best not in (one.first, one.second):
            continue
        is_first = one.first == best
        rival = one.second if is_first else one.first
        if rival not in others:
            continue
        is_better = (one.test.difference > 0) is is_first
        (open_ if not is_shown(one) else ahead if is_better else behind).append(rival)
    text = f" It is not shown to beat {_listed(open_)}." if open_ else ""
    if behind:
        text += f" On the items that both answered {_listed(behind)} does better."
    if ahead and not open_ and not behind:
        text = " It is shown to beat every other model that is ranked."
    return text


def _unfinished(board: "Leaderboard", row: LeaderboardRow) -> str:
    """Return the sentence on the items that stayed unanswered."""
    silent = sum(row.outcomes.values()) - sum(
        row.outcomes.get(name, 0) for name in ("answered", "unavailable")
    )
    items = board.scenes + board.twins
    parts = []
    if row.asked < items and row.detection.specificity.n:
        parts.append(f"was asked about {row.asked} of the {items} scenes and twins so far")
    if silent:
        parts.append(
            f"left a question unanswered in {silent} of {row.asked} scenes and twins, which its figures leave out"
        )
    return f"{row.model} {' and '.join(parts)}." if parts else ""


def _notices(board: "Leaderboard", row: LeaderboardRow) -> Finding:
    seen, quiet, balanced = (
        row.detection.sensitivity,
        row.detection.specificity,
        row.detection.balanced_accuracy,
    )
    if not seen.n:
        return Finding(model=row.model, task="notice", grade="unknown", text=_unanswered(seen))
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
        model=row.model,
        task="notice",
        grade=_detection_grade(board, row),
        text=f"{text}{_silent_in_detection(row)}",
    )


def _names(board: "Leaderboard", row: LeaderboardRow) -> Finding:
    named, chosen = row.identification.open, row.identification.closed
    if not named.n and not chosen.n:
        asked = named if named.missing else chosen
        return Finding(model=row.model, task="name", grade="unknown", text=_unanswered(asked))
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
        text += f"; {called(floor.model)} is right in {percent(score(floor, task))}"
    return Finding(
        model=row.model,
        task="name",
        grade=grade,
        text=f"{text}.{_silent(named if named.n else chosen)}",
    )


def _acts(board: "Leaderboard", row: LeaderboardRow) -> Finding:
    safe, needless = row.control.safe, row.control.needless
    if not safe.n:
        return Finding(model=row.model, task="act", grade="unknown", text=_unanswered(safe))
    text = f"Its action is safe in {percent(safe.value)}{spread(safe)} of the scenes"
    floor = board.floor("control")
    beside = [] if board.chance is None else [f"a random one in {percent(board.chance)}"]
    if floor is not None:
        beside.append(f"{called(floor.model)} in {percent(floor.control.safe.value)}")
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


def _floor_grade(board: "Leaderboard", row: LeaderboardRow, task: Task) -> Grade:
    """Return the grade of a model against the best reference, also with its missing answers counted as wrong."""
    if missing_share(row, task) > MOST_MISSING:
        return "incomplete"
    found = _floor_comparison(board, row, task)
    if found is None:
        return "unknown"
    if not is_shown(found):
        return "unclear"
    if found.test.difference <= 0:
        return "no"
    is_ahead = found.worst_difference is None or found.worst_difference > 0
    is_shown_at_worst = found.p_worst_holm is None or found.p_worst_holm < ALPHA
    return "yes" if is_ahead and is_shown_at_worst else "unclear"


def _floor_comparison(
    board: "Leaderboard", row: LeaderboardRow, task: Task
) -> ModelComparison | None:
    return next(
        (
            c
            for c in board.comparisons
            if c.task == task and c.against == "floor" and c.first == row.model
        ),
        None,
    )


def _detection_grade(board: "Leaderboard", row: LeaderboardRow) -> Grade:
    """Return the grade of a model's balanced accuracy against one half, the score of a guess.

    Without an interval (few paths, or equal scores everywhere), the comparison with the best reference decides.
    """
    if missing_share(row, "detection") > MOST_MISSING:
        return "incomplete"
    if row.detection.balanced_accuracy.interval is None:
        return _floor_grade(board, row, "detection")
    grade = _against(row.detection.balanced_accuracy, 0.5)
    if grade == "yes" and missing_share(row, "detection"):
        return "yes" if _against(row.detection.worst, 0.5) == "yes" else "unclear"
    return grade


def _against(value: Estimate, chance: float) -> Grade:
    if value.interval is None:
        return "unclear"
    if value.interval.low > chance:
        return "yes"
    return "no" if value.interval.high < chance else "unclear"


def _unanswered(rate: Rate) -> str:
    if not rate.missing:
        return "Was not asked."
    return f"Was asked {rate.missing} times and gave no usable answer."


def _silent(rate: Rate) -> str:
    if not rate.missing:
        return ""
    return (
        f" No usable answer for {rate.missing} more; {percent(rate.worst)} if these count as wrong."
    )


def _silent_in_detection(row: LeaderboardRow) -> str:
    missing = row.detection.sensitivity.missing + row.detection.specificity.missing
    if not missing:
        return ""
    return (
        f" No usable answer for {missing} more scenes and twins; it tells both apart in "
        f"{percent(row.detection.worst.value)} if these count as wrong."
    )


def _without_models(board: "Leaderboard") -> list[str]:
    sentences = [
        "No vision-language model was judged in this study, so there is none to trust yet."
    ]
    floor = board.floor("control")
    if floor is not None and floor.control.safe.value is not None:
        action = floor.model.removeprefix("constant:").replace("_", " ")
        what = called(floor.model)
        if floor.model.startswith("constant:"):
            what = f"always choosing “{action}”, whatever is seen,"
        sentences.append(
            f"What one must beat: {what} is safe in {percent(floor.control.safe.value)}"
            f"{spread(floor.control.safe)} of the scenes"
            + ("" if board.chance is None else f", a random action in {percent(board.chance)}")
            + f". Brackets hold a 95{_GAP}% interval."
        )
    return sentences


def _listed(names: Sequence[str]) -> str:
    if len(names) < 2:
        return "".join(names)
    return f"{', '.join(names[:-1])} or {names[-1]}"
