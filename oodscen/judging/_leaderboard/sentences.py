"""A leaderboard in a few sentences: the main figures of every model beside the reference to beat."""

from typing import TYPE_CHECKING

from oodscen.judging._leaderboard.rows import Estimate, LeaderboardRow, PairedScores, Rate

if TYPE_CHECKING:
    from oodscen.judging._drive_board import DriveRate
    from oodscen.judging._leaderboard.board import Leaderboard

_GAP = "\N{NO-BREAK SPACE}"
_TO = "\N{WORD JOINER}–\N{WORD JOINER}"
"""A dash without a line break around it."""


def sentences(board: "Leaderboard") -> list[str]:
    """Return a few sentences: the main figures of every model beside the reference to beat."""
    models = [row for row in board.standings if row.is_judged and row.protocol == "ours"]
    if not models:
        return _without_models(board)
    found = [sentence for row in models for sentence in (_main(row), _unfinished(board, row))]
    rest = f"This rests on {board.scenes} scenes of {board.paths} kinds. Brackets hold 95{_GAP}% intervals."
    return [sentence for sentence in (*found, constants(board), rest) if sentence]


def constants(board: "Leaderboard") -> str:
    """Return the sentence on what the same action everywhere reaches; empty without ordinary drives."""
    parts = []
    for action in ("stop", "emergency_brake", "keep_speed"):
        row = board.standing(f"constant:{action}")
        if row is not None and row.paired.act.value is not None:
            kinds = ", ".join(
                f"{percent(found.value)} with a {kind}"
                for kind, found in row.paired.act_by_kind.items()
            )
            what = f"“{action.replace('_', ' ')}” {percent(row.paired.act.value)}"
            parts.append(f"{what}{spread(row.paired.act)} ({kinds})")
    if not parts:
        return ""
    return f"The same action everywhere, without looking, acts rightly in: {'; '.join(parts)}."


def percent(value: float | None) -> str:
    """Return a share in whole per cent."""
    return "–" if value is None else f"{100 * value:.0f}{_GAP}%"


def spread(value: "Rate | Estimate | DriveRate") -> str:
    """Return the interval of a share as text."""
    if value.interval is None:
        return ""
    low, high = 100 * value.interval.low, 100 * value.interval.high
    return f" [{low:.0f}{_TO}{high:.0f}{_GAP}%]"


def _main(row: LeaderboardRow) -> str:
    """Return the sentences on a model's main figures."""
    paired, parts = row.paired, []
    if paired.notice.n:
        parts.append(
            f"notices {percent(paired.notice.value)}{spread(paired.notice)} of the scenes and leaves their "
            f"ordinary drives alone{_gain(paired, 'notice')}"
        )
    elif row.detection.sensitivity.n:
        parts.append(
            f"calls {percent(row.detection.sensitivity.value)} of the scenes unusual, but was asked about no "
            "ordinary drive that goes with them, so whoever always says so scores as much"
        )
    if paired.act.n:
        parts.append(
            f"acts rightly in {percent(paired.act.value)}{spread(paired.act)} of the scenes and their ordinary "
            f"drives alike{_gain(paired, 'act')}"
        )
    if not parts:
        return f"{row.model} gave no answer that can be scored."
    found = f"{row.model} {', and '.join(parts)}."
    if not paired.notice.missing + paired.act.missing:
        return found
    return (
        f"{found} With its missing answers counted as wrong: {percent(paired.notice.with_missing_wrong)} and "
        f"{percent(paired.act.with_missing_wrong)}."
    )


def lead(difference: float, than: str) -> str:
    """Return a difference of two shares in words."""
    return (
        f"{abs(100 * difference):.0f} points {'more' if difference >= 0 else 'fewer'} than {than}"
    )


def _gain(scores: PairedScores, figure: str) -> str:
    """Return the leads in a figure over those who see no picture, in brackets."""
    against = [(one, f"“{one.against}” without the pictures") for one in scores.over_blind]
    against += [(one, "itself without the pictures") for one in scores.over_withheld]
    parts = []
    for one, whom in against:
        if one.figure == figure and one.difference.value is not None:
            scored = f"in the {one.difference.n} scenes that score for both"
            parts.append(f"{lead(one.difference.value, whom)}{_range(one.difference)} {scored}")
    return f" ({', '.join(parts)})" if parts else ""


def _range(difference: Estimate) -> str:
    """Return the interval of a difference of two shares as text, in points."""
    if difference.interval is None:
        return ""
    low, high = 100 * difference.interval.low, 100 * difference.interval.high
    return f" [{low:+.0f}{_TO}{high:+.0f}]".replace("-", "\N{MINUS SIGN}")


def _unfinished(board: "Leaderboard", row: LeaderboardRow) -> str:
    """Return the sentence on the items that stayed unanswered."""
    silent = sum(row.outcomes.values()) - sum(
        row.outcomes.get(name, 0) for name in ("answered", "unavailable")
    )
    most = max(one.asked for one in board.standings)
    parts = []
    if row.asked < most and row.detection.specificity.n:
        parts.append(f"was asked about {row.asked} of the {most} drives so far")
    if silent:
        parts.append(
            f"left a question unanswered in {silent} of {row.asked} drives, which its figures leave out"
        )
    return f"{row.model} {' and '.join(parts)}." if parts else ""


def _without_models(board: "Leaderboard") -> list[str]:
    found = ["No vision-language model was judged in this study."]
    floor = board.floor("control")
    if floor is not None and floor.control.safe.value is not None:
        what = f"“{floor.model}”"
        if floor.model.startswith("constant:"):
            action = floor.model.removeprefix("constant:").replace("_", " ")
            what = f"always choosing “{action}”, whatever is seen,"
        found.append(
            f"The bar to beat: {what} is safe in {percent(floor.control.safe.value)}"
            f"{spread(floor.control.safe)} of the {floor.control.safe.n} scenes in which it scores"
            + (
                ""
                if board.chance is None
                else f", a random action in {percent(board.chance)} of all"
            )
            + f". Brackets hold a 95{_GAP}% interval."
        )
    return found
