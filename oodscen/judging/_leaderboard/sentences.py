"""A leaderboard in a few sentences."""

from typing import TYPE_CHECKING

from oodscen.judging._leaderboard.rows import LeaderboardRow, PairedScores, Rate
from oodscen.judging._rates_in_words import bracketed, bracketed_points, lead, number_of, percent

if TYPE_CHECKING:
    from oodscen.judging._leaderboard.board import Leaderboard

_ONLY_THE_PAPERS = (
    "Models were judged under the paper's protocol only, which asks about no ordinary drives: it cannot tell "
    "those that notice from those that always say so."
)


def sentences(board: "Leaderboard") -> list[str]:
    """Return a few sentences: the main figures of every model beside the reference to beat."""
    judged = [row for row in board.standings if row.is_judged]
    models = [row for row in judged if row.protocol == "ours"]
    if not models:
        return [_ONLY_THE_PAPERS if judged else _no_models(board), *_bar(board)]
    about_models = [
        text for row in models for text in (_main_figures(row), _unfinished(board, row))
    ]
    basis = f"{number_of(board.scenes, 'scene')} of {number_of(board.paths, 'path')}"
    rest = f"This rests on {basis}. Brackets hold {percent(board.level)} intervals."
    return [text for text in (*about_models, constants(board), rest) if text]


def constants(board: "Leaderboard") -> str:
    """Return the sentence on what the same action everywhere reaches; empty without ordinary drives."""
    parts = []
    for action in ("stop", "emergency_brake", "keep_speed"):
        row = board.standing(f"constant:{action}")
        if row is not None and row.paired.act.value is not None:
            kinds = ", ".join(
                f"{percent(rate.value)} with a {kind}"
                for kind, rate in row.paired.act_by_kind.items()
            )
            share = f"{percent(row.paired.act.value)}{bracketed(row.paired.act)}"
            parts.append(f"“{action.replace('_', ' ')}” {share} ({kinds})")
    if not parts:
        return ""
    return f"Choosing the same action everywhere, without looking, is right in: {'; '.join(parts)}."


def _main_figures(row: LeaderboardRow) -> str:
    """Return the sentence on a model's main figures."""
    paired, parts = row.paired, []
    if paired.notice.n:
        parts.append(
            f"notices {_share(paired.notice)} of the scenes and leaves their ordinary drives "
            f"alone{_gain(paired, 'notice')}"
        )
    elif row.detection.sensitivity.n:
        parts.append(
            f"calls {percent(row.detection.sensitivity.value)} of the scenes unusual, but was asked about no "
            "ordinary drive that goes with them, so whoever always says so scores as much"
        )
    if paired.act.n:
        parts.append(
            f"acts rightly in {_share(paired.act)} of the scenes and their ordinary drives "
            f"alike{_gain(paired, 'act')}"
        )
    if not parts:
        return f"{row.model} gave no answer that can be scored."
    return f"{row.model} {', and '.join(parts)}."


def _share(rate: Rate) -> str:
    """Return a share with its interval, and what it is with every missing answer counted as wrong."""
    share = f"{percent(rate.value)}{bracketed(rate)}"
    if not rate.missing:
        return share
    return (
        f"{share} (with its missing answers counted as wrong: {percent(rate.with_missing_wrong)})"
    )


def _gain(scores: PairedScores, figure: str) -> str:
    """Return the leads in a figure over those who see no picture, in brackets."""
    gains = [(gain, f"“{gain.against}” without the pictures") for gain in scores.over_blind]
    gains += [(gain, "itself without the pictures") for gain in scores.over_withheld]
    parts = []
    for gain, other in gains:
        difference = gain.difference
        if gain.figure == figure and difference.value is not None:
            points = f"{lead(difference.value, other)}{bracketed_points(difference)}"
            parts.append(f"{points} in the {number_of(difference.n, 'scene')} scored for both")
    return f" ({', '.join(parts)})" if parts else ""


def _unfinished(board: "Leaderboard", row: LeaderboardRow) -> str:
    """Return the sentence on the items that stayed unanswered; empty if none did."""
    answered = sum(row.outcomes.get(name, 0) for name in ("answered", "unavailable"))
    unanswered = sum(row.outcomes.values()) - answered
    most = max(standing.asked for standing in board.standings)
    parts = []
    if row.asked < most and row.detection.specificity.n:
        parts.append(f"was asked about {row.asked} of the {most} drives so far")
    if unanswered:
        parts.append(
            f"left a question unanswered in {unanswered} of {row.asked} drives, which its figures leave out"
        )
    return f"{row.model} {' and '.join(parts)}." if parts else ""


def _no_models(board: "Leaderboard") -> str:
    """Return the sentence on a study without a model that saw the pictures."""
    if any(row.kind == "model" for row in board.standings):
        return "No model was judged with the pictures in this study."
    return "No vision-language model was judged in this study."


def _bar(board: "Leaderboard") -> list[str]:
    """Return the sentences on the reference to beat; none without one."""
    floor = board.floor("control")
    if floor is None or floor.control.safe.value is None:
        return []
    answerer = f"“{floor.model}”"
    if floor.model.startswith("constant:"):
        action = floor.model.removeprefix("constant:").replace("_", " ")
        answerer = f"always choosing “{action}”, whatever is seen,"
    safe = floor.control.safe
    chance = "" if board.chance is None else f", a random action in {percent(board.chance)} of all"
    return [
        f"The bar to beat: {answerer} is safe in {percent(safe.value)}{bracketed(safe)} of the "
        f"{number_of(safe.n, 'scene')} in which it scores{chance}.",
        f"Brackets hold a {percent(board.level)} interval.",
    ]
