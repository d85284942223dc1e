"""Results in words, as the commands print them."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from oodscen.data._verdict import Verdict
    from oodscen.judging._leaderboard.board import Leaderboard
    from oodscen.judging._leaderboard.requirements import RequirementResult
    from oodscen.judging._leaderboard.rows import Estimate, LeaderboardRow, Rate
    from oodscen.llm._accounting import Account, Ledger
    from oodscen.stages._redteam.saturation import Saturation


def summary(info: dict[str, Any]) -> str:
    """Summarise the results of a study in a few lines."""
    counts = info["counts"]
    nodes = counts["nodes"]
    writers = [info["authors"][role] for role in ("llm", "fallback") if role in info["authors"]]
    lines = [
        f"{info['status']} in {info['seconds']['total']:.0f} s (seed {info['config']['seed']}); "
        f"texts by {', else by '.join(writers)}",
        f"trees: {nodes['initial']} -> {nodes['diverse']} -> {nodes['simulatable']} nodes, "
        f"{counts['paths']} paths, {counts['attested']} of them attested by the paper",
        f"{counts['scenarios']} scenarios, {counts['scenes']} scenes, {counts['episodes']} episodes, "
        f"{counts['verdicts']} verdicts",
    ]
    if "fallback" in info["authors"] and (answered := _answered(info["usage"])):
        lines.append(f"answered calls: {answered}")
    if not counts["paths"]:
        lines.append("no path is left to be shown, so there is no scene: pruned.jsonl tells why")
    if outside := counts.get("outside_band"):
        low, high = info["config"]["band"]
        lines.append(
            f"{outside} texts are not staged: their OOD-ness lies outside the band from {low} to {high}"
        )
    if below := counts.get("below_floor"):
        lines.append(
            f"{below} scenes are not judged: at the decision their hazard is too small, faint, dark or hidden to "
            "be named"
        )
    failures = {name: number for name, number in info["failures"].items() if number}
    if failures:
        listed = ", ".join(f"{number} in {name}" for name, number in failures.items())
        lines.append(
            f"failed items (the report lists them): {listed}; the same command does those again that "
            "a model or process may yet answer (limits, no connection, a death), --retry-failed all of them"
        )
    return "\n".join(lines)


def _answered(usage: Iterable[Mapping[str, Any]]) -> str:
    """Return how many calls each model that writes a study answered, from the lines of its usage."""
    calls: Counter[str] = Counter()
    failed: Counter[str] = Counter()
    for row in usage:
        stage, model = row["group"]
        if stage != "evaluate":
            calls[model] += row["calls"]
            failed[model] += row["failed"]
    return ", ".join(f"{name} {total - failed[name]} of {total}" for name, total in calls.items())


def estimated(rows: Sequence["Account"]) -> str:
    """List the model calls that a run would make, one line per stage and model."""
    if not rows:
        return "nothing is left to be asked of a model"
    lines = []
    for row in rows:
        cost = "price not known" if row.cost_usd is None else f"${row.cost_usd:.2f}"
        lines.append(
            f"{row.group[0]:10} {row.group[1]:28} {row.calls:6} calls  about {row.input_tokens:9,} tokens "
            f"in {row.output_tokens:8,} out  {cost}  {_cacheable([row])} cacheable"
        )
    costs = [row.cost_usd for row in rows]
    known = sum(cost for cost in costs if cost is not None)
    rest = "" if None not in costs else " and what has no known price (give one with --price)"
    total = f"{sum(row.calls for row in rows)} calls, about ${known:.2f}{rest}"
    return "\n".join(
        [
            *lines,
            f"together {total}; repairs and retries come on top",
            f"{_cacheable(rows)} of the input tokens are a prefix that other calls share, which providers with a "
            "prompt cache charge less for; the cost above is without a cache",
        ]
    )


def _cacheable(rows: Sequence["Account"]) -> str:
    asked = sum(row.input_tokens for row in rows)
    return f"{sum(row.cacheable_tokens for row in rows) / asked:.0%}" if asked else "0%"


def standings(board: "Leaderboard") -> str:
    """Tabulate the results, one line per model and protocol, with the floor and ceiling references below."""
    head = ("", "notices, both", "acts, both", "safe", "false alarms", "names it", "incomplete")
    rows = [head, *(_cells(row) for row in board.standings if _is_listed(row))]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ["  ".join(map(str.ljust, row, widths)).rstrip() for row in rows]
    chance = "" if board.chance is None else f"; a random action is safe in {board.chance:.0%}"
    return "\n".join(
        [f"{board.scenes} scenes of {board.paths} paths{chance}", *lines, *_notes(board)]
    )


def _is_listed(row: "LeaderboardRow") -> bool:
    """Return whether a row is a model's, or one of the references to compare it with."""
    if row.kind != "reference":
        return True
    return row.protocol != "paper" and row.model in _LISTED_REFERENCES


def _cells(row: "LeaderboardRow") -> tuple[str, ...]:
    is_ours = row.protocol == "ours"
    complete = row.outcomes.get("answered", 0) + row.outcomes.get("unavailable", 0)
    return (
        f"{row.model} (paper)" if row.protocol == "paper" else row.model,
        _share(row.paired.notice),
        _share(row.paired.act),
        _share(row.control.safe if is_ours else row.control.collision_free),
        _share(row.detection.alarms),
        _share(row.identification.open),
        f"{row.asked - complete} of {row.asked}",
    )


def graded(grades: "Sequence[RequirementResult]") -> str:
    """List the grade of every model against a requirement."""
    return "\n".join(map(str, grades)) or "no model was judged, so none can meet the requirement"


def exit_code(grades: Sequence["RequirementResult"]) -> int:
    """Return 0 if all models meet, 4 if one fails, and 5 if that is unknown or there is no model."""
    outcomes = {grade.grade for grade in grades}
    if "fails" in outcomes:
        return 4
    return 0 if outcomes == {"meets"} else 5


def _notes(board: "Leaderboard") -> list[str]:
    """State what "both" means, who scored the open aspects, and in how many of the paper's items the hazard is visible."""
    notes = ["both: right about the scene and about every ordinary drive that goes with it"]
    for row in board.standings:
        gains = [
            f"{_points(gain.difference)} {_FIGURES[gain.figure]}"
            for gain in row.paired.over_withheld
            if gain.difference.value is not None
        ]
        if gains:
            notes.append(f"{row.model} over itself without pictures: {', '.join(gains)}")
    if board.judge:
        judge = board.judge.rpartition("@")[0]
        unjudged = sum(row.identification.unjudged for row in board.standings)
        note = f"names it: judged by {judge}, in every row"
        if not any(row.identification.judged for row in board.standings):
            note = f"names it: scored by the matcher, as {judge} judged nothing"
        rest = f"; it gave no usable answer about {unjudged}, which the matcher scored"
        notes.append(note + (rest if unjudged else ""))
    if board.whole:
        notes.append(
            f"paper: the hazard can be seen in a frame of {board.whole_shown} of {board.whole} scenes"
        )
    return notes


def left_out(verdicts: "Sequence[Verdict]") -> list[str]:
    """State, one line per model and cause, how many items have no whole answer, and how to ask again.

    The last line is about the judge, if it gave no usable answer about an open aspect.
    """
    groups: dict[tuple[str, str], list[Verdict]] = {}
    for verdict in verdicts:
        if verdict.outcome in _INCOMPLETE:
            groups.setdefault((verdict.model, verdict.outcome), []).append(verdict)
    lines = []
    for (model, outcome), group in groups.items():
        command = "the same command" if all(one.retryable for one in group) else "--retry-failed"
        told = _INCOMPLETE[outcome].format(error=group[0].error, model=model, command=command)
        lines.append(f"{model}: {len(group)} items {told}")
    if reasons := [verdict.judge_error for verdict in verdicts if verdict.judge_error]:
        lines.append(
            f"the judge: no usable answer about {len(reasons)} open aspects, which the matcher scored, e.g. "
            f"{reasons[0]}; --retry-failed asks again"
        )
    return lines


def kept_verdicts(vlms: Iterable[str], ledger: "Ledger", asked_at: Mapping[str, str]) -> list[str]:
    """State, one line per model judged again, how many of its verdicts are kept from when, and how to ask again.

    Args:
        vlms: The models to judge, as they are named in the configuration.
        ledger: The totals of the run.
        asked_at: When each model was last asked before the run, by its name in verdicts; empty if not recorded.
    """
    lines = []
    for vlm in dict.fromkeys(vlms):
        name, count = ledger.kept_verdicts.get(vlm, ("", 0))
        if count:
            time = asked_at.get(name, "").replace("T", " ").replace("+00:00", " UTC")
            last_asked = f", last asked {time}" if time else ""
            lines.append(
                f"{vlm}: {count} verdicts are kept as they were{last_asked}, whatever has changed in the model since; "
                f"to ask again, add --drop {vlm} --retry-failed"
            )
    return lines


_INCOMPLETE = {
    "unasked": "{error}; the same command asks them, --drop {model} takes the model out of the study",
    "timeout": "got no answer in time, e.g. {error}; {command} asks them again",
    "error": "failed, e.g. {error}; {command} asks them again",
    "unparsed": "got an answer that cannot be read, e.g. {error}; {command} asks them again",
    "refused": "got a refusal, e.g. {error}; {command} asks them again",
}
"""Words about items without a whole answer, by their outcome."""

_FIGURES = {"notice": "noticing (both halves)", "act": "acting (both halves)"}


_LISTED_REFERENCES = (
    "constant:stop",
    "constant:emergency_brake",
    "constant:keep_speed",
    "random",
    "blind",
    "novelty",
    "oracle",
)
"""References that are listed beside the models."""


def _points(difference: "Estimate") -> str:
    """Return a difference of shares in points, with its interval."""
    interval = difference.interval
    spread = f" [{100 * interval.low:+.0f}, {100 * interval.high:+.0f}]" if interval else ""
    return f"{100 * (difference.value or 0.0):+.0f}{spread} points in"


def _share(share: "Rate | Estimate") -> str:
    if share.value is None:
        return "-"
    interval = share.interval
    return f"{share.value:.0%}" + (
        f" [{interval.low:.0%}, {interval.high:.0%}]" if interval else ""
    )


def rounds_in_words(saturation: "Saturation", stop: str | None, *, closed: bool = False) -> str:
    """Summarise the results of red teaming, and how much it has left to find, in a few lines.

    Args:
        saturation: The saturation of its rounds.
        stop: The rule that ended it.
        closed: True if the loop was closed, in which case the estimates are biased.
    """
    rule = {
        "rounds": "all rounds are played",
        "budget": "the budget is spent",
        "patience": "nothing new came for too long",
        "coverage": "the coverage is reached",
    }
    last = f"the last in round {saturation.last_new}" if saturation.kinds else "none"
    lines = [
        f"{saturation.rounds} rounds, {saturation.calls} model calls; {rule.get(stop or '', 'stopped')}",
        f"{saturation.kinds} new kinds, {last}; of the last {saturation.recent_rounds} rounds {saturation.recent:.0%} "
        f"brought one [{saturation.recent_low:.0%}, {saturation.recent_high:.0%}]",
        f"Good-Turing coverage {saturation.coverage:.2f} [{saturation.coverage_low:.2f}, {saturation.coverage_high:.2f}]; "
        f"unseen kinds (Chao1) about {saturation.unseen:.0f} [{saturation.unseen_low:.0f}, {saturation.unseen_high:.0f}]",
    ]
    if closed:
        lines.append(
            "in a closed loop kinds are seldom met twice: that coverage is too low, the unseen too many; "
            "go by the share of new kinds"
        )
    return "\n".join(lines)
