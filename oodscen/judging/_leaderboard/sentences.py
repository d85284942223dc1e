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
    about_models = [text for row in models for text in (_main(row), _unfinished(board, row))]
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
            what = f"“{action.replace('_', ' ')}” {percent(row.paired.act.value)}"
            parts.append(f"{what}{bracketed(row.paired.act)} ({kinds})")
    if not parts:
        return ""
    return f"Choosing the same action everywhere, without looking, is right in: {'; '.join(parts)}."


def _main(row: LeaderboardRow) -> str:
    """Return the sentences on a model's main figures."""
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
    told = f"{percent(rate.value)}{bracketed(rate)}"
    if not rate.missing:
        return told
    return f"{told} (with its missing answers counted as wrong: {percent(rate.with_missing_wrong)})"


def _gain(scores: PairedScores, figure: str) -> str:
    """Return the leads in a figure over those who see no picture, in brackets."""
    against = [(gain, f"“{gain.against}” without the pictures") for gain in scores.over_blind]
    against += [(gain, "itself without the pictures") for gain in scores.over_withheld]
    parts = []
    for one, whom in against:
        if one.figure == figure and one.difference.value is not None:
            scored = f"in the {number_of(one.difference.n, 'scene')} scored for both"
            parts.append(
                f"{lead(one.difference.value, whom)}{bracketed_points(one.difference)} {scored}"
            )
    return f" ({', '.join(parts)})" if parts else ""


def _unfinished(board: "Leaderboard", row: LeaderboardRow) -> str:
    """Return the sentence on the items that stayed unanswered."""
    silent = sum(row.outcomes.values()) - sum(
        row.outcomes.get(name, 0) for name in ("answered", "unavailable")
    )
    most = max(standing.asked for standing in board.standings)
    parts = []
    if row.asked < most and row.detection.specificity.n:
        parts.append(f"was asked about {row.asked} of the {most} drives so far")
    if silent:
        parts.append(
            f"left a question unanswered in {silent} of {row.asked} drives, which its figures leave out"
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
    who = f"“{floor.model}”"
    if floor.model.startswith("constant:"):
        action = floor.model.removeprefix("constant:").replace("_", " ")
        who = f"always choosing “{action}”, whatever is seen,"
    safe = floor.control.safe
    chance = "" if board.chance is None else f", a random action in {percent(board.chance)} of all"
    return [
        f"The bar to beat: {who} is safe in {percent(safe.value)}{bracketed(safe)} of the "
        f"{number_of(safe.n, 'scene')} in which it scores{chance}.",
        f"Brackets hold a {percent(board.level)} interval.",
    ]
