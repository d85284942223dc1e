"""Assembles the content of the page: plain values for the template, no markup."""

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from oodscen import _paper as paper
from oodscen._entry_points import is_builtin
from oodscen.data._episode import Episode
from oodscen.data._pairing import scene_of
from oodscen.data._reactions import REACTIONS_S, drivers_in_words
from oodscen.judging._leaderboard.requirements import Bar
from oodscen.judging._questions import OPTIONS
from oodscen.llm._accounting import Account, account, accounts
from oodscen.report._charts.canvas import Canvas
from oodscen.report._charts.outline import outline
from oodscen.report._charts.rounds import Point, growth
from oodscen.report._gallery import choice, payload
from oodscen.report._leaderboard import leaderboard_variables, study_board
from oodscen.report._load import Material, number
from oodscen.report._opening import opening
from oodscen.report._sections import collect_parts
from oodscen.report._text_metrics import text_metric_variables
from oodscen.study._study import Study

_SHOWN_FAILURES = 200
_OPEN_FAILURES = 12
"""With more failures than this the list is folded."""
_STAGES = {
    "redteam": "rounds of red teaming",
    "pruned": "prunings",
    "scenarios": "texts",
    "texts": "texts of the sets",
    "ordinary": "ordinary texts",
    "rarity": "rarities",
    "scenes": "scenes",
    "episodes": "episodes",
    "verdicts": "judgements",
    "opinions": "opinions of the judge",
}


@dataclass(frozen=True)
class Counts:
    """The numbers behind the summary."""

    scenes: int
    ran: int
    """Episodes that ended."""
    failed: int
    """Items of any stage that failed; a model without an answer does not count."""
    unanswered: int
    """Items that a model left without a usable answer."""
    mixed: int
    """Scenes in which one available action is safe and another is not."""
    all_safe: int
    none_safe: int
    sighted: int
    """Scenes with an unusual actor, seen at the decision."""
    below_floor: int
    """Scenes whose hazard cannot be named at the decision."""


@dataclass(frozen=True)
class Followed:
    """Scenes with, or without, an actor close behind the ego."""

    is_followed: bool
    n: int
    safe: Mapping[str, int]
    """Number of scenes in which each way of braking is safe."""


def page_variables(study: Study, material: Material, bars: Sequence[Bar] = ()) -> dict[str, Any]:
    """Return the variables of the template."""
    episodes = [
        episode
        for episode in material.episodes
        if episode.status == "ok" and not episode.is_ordinary
    ]
    scenes = payload(material, study.folder)
    board = study_board(material)
    return {
        "title": "Out-of-distribution driving scenarios",
        "status": str(material.info.get("status") or "unknown"),
        "stopped": str(material.info.get("stopped") or ""),
        "material": material,
        "paper": paper,
        "is_builtin": is_builtin,
        "seconds": number(material.info, "seconds", "total"),
        "gaps": material.gaps,
        "opening": opening(material, board),
        "counts": _counts(material, [choice(episode) for episode in episodes]),
        "followed": _followed(episodes),
        "drivers": _drivers(material, episodes),
        "action_words": {option.id: option.description for option in OPTIONS},
        "trees": _trees(material, scenes["leaves"]),
        "round_tally": Counter(row.decision or row.status for row in material.rounds),
        "growth": _growth(material),
        "parts": collect_parts(study, material),
        "facts": _facts(material.info),
        "call_rows": _call_rows(material.calls),
        **_scenes(scenes),
        **_failures(material, {f"scene-{row['id']}" for row in scenes["scenes"]}),
        **text_metric_variables(material),
        **leaderboard_variables(material, board, bars),
    }


def _drivers(material: Material, episodes: Sequence[Episode]) -> str:
    """Return who tried every action."""
    times_s = {time for episode in episodes for time in episode.reaction_s} or REACTIONS_S
    rehearses = bool(material.info.get("rehearses", True))
    return drivers_in_words(times_s, rehearses=rehearses)


def _trees(material: Material, leaves: Iterable[str]) -> dict[str, dict[str, Any]]:
    """Return sizes and outlines; leaves with scenes are linked to them."""
    return {
        name: {
            "size": len(tree),
            "paths": len(tree.leaves),
            "attested": sum(leaf.attested == "paper" for leaf in tree.leaves),
            "outline": outline(
                tree,
                material.decisions if name == "diverse" else (),
                {f"path-{leaf}" for leaf in leaves} if name == "simulatable" else (),
            ),
        }
        for name, tree in material.trees.items()
    }


def _scenes(scenes: Mapping[str, Any]) -> dict[str, Any]:
    """Return the variables of the list of scenes."""
    rows, leaves = scenes["scenes"], scenes["leaves"]
    tally = Counter(row["leaf"] for row in rows)
    return {
        "payload": scenes,
        "paths": [
            {"anchor": f"path-{leaf}", "labels": about["path"], "scenes": tally[leaf]}
            for leaf, about in leaves.items()
            if tally[leaf]
        ],
        "cards": len(rows),
        "cards_failed": sum(bool(row["error"]) for row in rows),
        "twins": sum(row["twin"] is not None for row in rows),
        "filters": _filters(scenes),
    }


def _failures(material: Material, anchors: Collection[str]) -> dict[str, Any]:
    """Return the variables of the list of failures, each linked to its scene."""
    shown = material.failures[:_SHOWN_FAILURES]
    tally = Counter(_STAGES.get(failure.stage, failure.stage) for failure in material.failures)
    return {
        "failures": shown,
        "is_many": len(material.failures) > _OPEN_FAILURES,
        "unshown_failures": max(len(material.failures) - _SHOWN_FAILURES, 0),
        "failure_tally": sorted(tally.items()),
        "failure_links": {
            failure.id: anchor
            for failure in shown
            if (anchor := f"scene-{scene_of(failure.id.partition('@')[0])}") in anchors
        },
    }


def _followed(episodes: Sequence[Episode]) -> list[Followed]:
    """Return the outcomes of braking with and without an actor close behind."""
    rows = []
    for is_followed in (True, False):
        alike = [episode for episode in episodes if bool(episode.followers) is is_followed]
        if alike:
            safe = {
                action: sum(
                    episode.actions[action].safe for episode in alike if action in episode.actions
                )
                for action in ("slow_down", "stop", "emergency_brake")
            }
            rows.append(Followed(is_followed, len(alike), safe))
    return rows


def _filters(scenes: Mapping[str, Any]) -> dict[str, list[str]]:
    rows, paths = scenes["scenes"], [leaf["path"] for leaf in scenes["leaves"].values()]
    return {
        "class": sorted({path[0] for path in paths if path}),
        "family": sorted({path[1] for path in paths if len(path) > 2}),
        "map": sorted({row["map"] for row in rows if row["map"]}),
        "weather": sorted({word for row in rows for word in row["weather"]}),
        "model": [model["name"] for model in scenes["models"]],
    }


def _counts(material: Material, choices: Sequence[str]) -> Counts:
    tally = Counter(choices)
    return Counts(
        scenes=len(material.scenes),
        ran=len(choices),
        failed=sum(failure.stage != "verdicts" for failure in material.failures),
        unanswered=sum(failure.stage == "verdicts" for failure in material.failures),
        mixed=tally["mixed"],
        all_safe=tally["all"],
        none_safe=tally["none"],
        sighted=sum(episode.sighting is not None for episode in material.episodes),
        below_floor=sum(episode.is_below_floor for episode in material.episodes),
    )


def _growth(material: Material) -> Canvas | None:
    """Draw the growth curve, if there are rounds."""
    if not material.rounds:
        return None
    first = material.rounds[0]
    before = material.trees.get("initial")
    start = len(before) if before else first.nodes
    points = [Point(row.round, row.nodes, row.decision or "failed") for row in material.rounds]
    is_grown = material.config.get("tree") is None
    is_papers = is_grown and material.config.get("nodes") == paper.NODES["initial"]
    return growth(points, start, paper.NODES["diverse"] if is_papers else None)


def _call_rows(calls: Sequence[Mapping[str, Any]]) -> list[Account]:
    """Return the totals of the calls per stage, purpose and model, and of all calls."""
    rows = sorted(accounts(calls, by=("stage", "purpose", "model")), key=lambda row: row.group)
    return [*rows, account(("all", "", ""), calls)] if len(rows) > 1 else rows


def _facts(info: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return what only `study.json` tells, without the configuration, as flat pairs."""
    shown = {
        name: value
        for name, value in sorted(info.items())
        if name not in ("config", "paper", "counts", "usage")
    }
    return list(_flat("", shown))


def _flat(prefix: str, value: object) -> Iterator[tuple[str, str]]:
    """Yield the values of nested mappings as text, each with the names that lead to it joined by dots."""
    if isinstance(value, Mapping):
        for key, item in value.items():
            yield from _flat(f"{prefix}.{key}" if prefix else str(key), item)
    elif value is not None:
        yield prefix, str(value)
