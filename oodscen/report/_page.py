"""Assembles the content of the page: plain values for the template, no markup."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from oodscen import _paper as paper
from oodscen._registry import is_builtin
from oodscen.data._episode import Episode
from oodscen.llm._accounting import Account, account, accounts
from oodscen.report import _gallery as gallery
from oodscen.report import _leaderboard as trust
from oodscen.report import _measures as measures
from oodscen.report import _phrasing as words
from oodscen.report import _sections as parts
from oodscen.report._charts import svg as charts
from oodscen.report._charts.outline import outline
from oodscen.report._load import Failure, Material, dig, mapping, number
from oodscen.stages._evaluate import OPTIONS
from oodscen.study import Study

_SHOWN_FAILURES = 200
_OPEN_FAILURES = 12
"""With more failures than this the list is folded."""
_STAGES = {
    "redteam": "rounds of red teaming",
    "pruned": "prunings",
    "scenarios": "texts",
    "scenes": "scenes",
    "episodes": "episodes",
    "verdicts": "judgements",
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


@dataclass(frozen=True)
class Followed:
    """Scenes with, or without, an actor close behind the ego."""

    is_followed: bool
    n: int
    safe: Mapping[str, int]
    """Number of scenes in which each way of braking is safe."""


@dataclass(frozen=True)
class CountRow:
    """One count beside the paper's."""

    what: str
    here: str
    paper: str


def context(study: Study, found: Material) -> dict[str, Any]:
    """Return the variables of the template."""
    episodes = [
        episode for episode in found.episodes if episode.status == "ok" and not episode.is_twin
    ]
    scenes = gallery.payload(found, study.folder)
    anchors = {f"path-{leaf}" for leaf in scenes["leaves"]} | {
        f"scene-{row['id']}" for row in scenes["scenes"]
    }
    counts = _counts(found, [gallery.choice(episode) for episode in episodes])
    return {
        "title": "Out-of-distribution driving scenarios",
        "status": str(found.info.get("status") or "unknown"),
        "stopped": str(found.info.get("stopped") or ""),
        "summary": _summary(found, counts),
        "authorship": _authorship(found),
        "key_figures": _key_figures(found, counts),
        "gaps": found.gaps,
        "count_rows": _count_rows(found, counts),
        "measure_rows": measures.rows(found.metrics),
        "margins": measures.margins(found.metrics),
        "measure_chart": measures.chart(found.metrics),
        "examples": measures.examples(
            found.metrics, {**found.texts, "simulatable": found.scenarios}
        ),
        "encoder": str(found.metrics.get("encoder") or ""),
        "baseline": mapping(found.metrics.get("baseline")),
        "batch": mapping(found.metrics.get("baseline_batch")),
        "trees": {
            name: {
                "size": len(tree),
                "paths": len(tree.leaves),
                "depth": tree.depth,
                "attested": sum(leaf.attested == "paper" for leaf in tree.leaves),
                "outline": outline(
                    tree,
                    found.decisions if name == "diverse" else (),
                    {f"path-{leaf}" for leaf in scenes["leaves"]} if name == "simulatable" else (),
                ),
            }
            for name, tree in found.trees.items()
        },
        "was_pruned": bool(found.decisions),
        "rounds": found.rounds,
        "round_tally": Counter(row.decision or row.status for row in found.rounds),
        "growth": _growth(found),
        **trust.context(found),
        "parts": parts.drawn(study, found),
        "action_words": {option.id: option.description for option in OPTIONS},
        "counts": counts,
        "followed": _followed(episodes),
        "payload": scenes,
        "paths": [
            {"anchor": f"path-{leaf}", "labels": one["path"], "scenes": tally}
            for leaf, one in scenes["leaves"].items()
            if (tally := sum(row["leaf"] == leaf for row in scenes["scenes"]))
        ],
        "anchors": anchors,
        "cards": len(scenes["scenes"]),
        "twins": sum(row["twin"] is not None for row in scenes["scenes"]),
        "filters": _filters(scenes),
        "config": sorted(found.config.items()),
        "facts": _facts(found.info),
        "call_rows": _call_rows(found.calls),
        "failures": found.failures[:_SHOWN_FAILURES],
        "is_many": len(found.failures) > _OPEN_FAILURES,
        "unshown_failures": max(len(found.failures) - _SHOWN_FAILURES, 0),
        "failure_tally": _tally(found.failures),
        "failure_links": {
            failure.id: anchor
            for failure in found.failures[:_SHOWN_FAILURES]
            if (anchor := f"scene-{failure.id.partition('@')[0].removesuffix('~twin')}") in anchors
        },
    }


def _followed(episodes: Sequence[Episode]) -> list[Followed]:
    """Return the outcomes of braking with and without an actor close behind."""
    rows = []
    for is_followed in (True, False):
        some = [one for one in episodes if bool(one.followers) is is_followed]
        if some:
            safe = {
                action: sum(one.actions[action].safe for one in some if action in one.actions)
                for action in ("slow_down", "stop", "emergency_brake")
            }
            rows.append(Followed(is_followed, len(some), safe))
    return rows


def _filters(scenes: Mapping[str, Any]) -> dict[str, list[str]]:
    """Return the options of each filter."""
    rows, paths = scenes["scenes"], [one["path"] for one in scenes["leaves"].values()]
    return {
        "class": sorted({path[0] for path in paths if path}),
        "family": sorted({path[1] for path in paths if len(path) > 2}),
        "map": sorted({row["map"] for row in rows if row["map"]}),
        "weather": sorted({word for row in rows for word in row["weather"]}),
        "model": [one["name"] for one in scenes["models"]],
    }


def _counts(found: Material, choices: Sequence[str]) -> Counts:
    tally = Counter(choices)
    return Counts(
        scenes=sum(not scene.is_twin for scene in found.scenes),
        ran=len(choices),
        failed=sum(failure.stage != "verdicts" for failure in found.failures),
        unanswered=sum(failure.stage == "verdicts" for failure in found.failures),
        mixed=tally["mixed"],
        all_safe=tally["all"],
        none_safe=tally["none"],
    )


def _summary(found: Material, counts: Counts) -> list[str]:
    """Return plain sentences about what was done and the results, as far as known."""
    sizes = {name: len(tree) for name, tree in found.trees.items()}
    sentences = []
    if "initial" in sizes:
        sentences.append(
            f"A tree of {sizes['initial']} nodes, each path one kind of rare driving situation, was grown first."
        )
    if "diverse" in sizes:
        sentences.append(
            f"{_plural(len(found.rounds), 'round')} of red teaming made it a tree of {sizes['diverse']} nodes."
        )
    if "simulatable" in sizes:
        simulator = found.config.get("simulator") or "the simulator"
        sentences.append(
            f"Of these, {sizes['simulatable']} nodes on {_plural(len(found.trees['simulatable'].leaves), 'path')} "
            f"can be shown in {simulator}."
        )
    if found.scenarios:
        used = len({scenario.leaf for scenario in found.scenarios})
        tree = found.trees.get("simulatable")
        those = f"{used} of those paths" if tree and used < len(tree.leaves) else "those paths"
        line = f"{_plural(len(found.scenarios), 'text')} along {those}"
        if counts.scenes:
            line += f" became {_plural(counts.scenes, 'scene')} and {_plural(counts.ran, 'simulated episode')}"
        else:
            line += f" {'is' if len(found.scenarios) == 1 else 'are'} written"
        sentences.append(f"{line}; {_failed(counts.failed)}.")
    if counts.ran:
        sentences.append(
            f"In {counts.mixed} of {_plural(counts.ran, 'scene')} the choice of action matters: at least one available action is safe and at least one is not."
        )
    looks = [one for one in found.episodes if one.sighting is not None]
    if looks:
        below = sum(one.is_below_floor for one in looks)
        sentences.append(
            f"At the decision a viewer can name the hazard in {len(looks) - below} of {_plural(len(looks), 'scene')} with an unusual actor"
            + (
                f"; the other {below}, too small, faint, dark or hidden, are not judged."
                if below
                else "."
            )
        )
    seconds = _seconds(found.info)
    seed = found.config.get("seed")
    if seconds is not None:
        sentences.append(f"The run took {words.duration(seconds)}, with seed {seed}.")
    elif seed is not None:
        sentences.append(f"The seed is {seed}.")
    return sentences or ["This study has not got anywhere yet."]


def _authorship(found: Material) -> list[str]:
    """Return sentences that name the authors of trees, texts and scenes, and the judged models."""
    config = found.config
    if not config:
        return ["Which model wrote the trees, texts and scenes is not recorded."]
    llm = str(config.get("llm") or "unknown")
    red = str(config.get("red_llm") or llm)
    sentences = []
    if is_builtin(llm):
        sentences.append(
            "No language model wrote the tree and the scenes: their author is “builtin”, a deterministic writer over a "
            "knowledge base of hazards that ships with oodscen."
        )
    else:
        sentences.append(
            f"The tree, the texts and the scenes were written by the language model “{llm}”."
        )
    if red != llm:
        what = "the built-in writer, not a language model" if is_builtin(red) else f"“{red}”"
        sentences.append(f"The situations of the red teaming were imagined by {what}.")
    models = list(dict.fromkeys(row.model for row in found.verdicts if row.kind == "model"))
    if models:
        sentences.append(f"Judged models: {', '.join(models)}.")
    elif found.verdicts:
        sentences.append("No vision-language model was judged.")
    if any(row.kind == "reference" for row in found.verdicts):
        sentences.append(
            "The reference answerers are shipped with oodscen: constants, chance and others that know or see less, and an oracle that is told the truth. They show what a score is worth."
        )
    return sentences


def _key_figures(found: Material, counts: Counts) -> list[tuple[str, str]]:
    """Return labels and values of the key figures; an unknown value is a dash."""
    dash = "–"
    sizes = [
        str(len(found.trees[n])) if n in found.trees else dash
        for n in ("initial", "diverse", "simulatable")
    ]
    tree = found.trees.get("simulatable")
    seconds = _seconds(found.info)
    return [
        ("tree nodes: grown, diverse, simulatable", " → ".join(sizes)),
        ("paths", str(len(tree.leaves)) if tree else dash),
        ("texts", str(len(found.scenarios)) if found.scenarios else dash),
        ("scenes", str(counts.scenes) if counts.scenes else dash),
        ("episodes", str(counts.ran) if counts.ran else dash),
        ("failed items", str(counts.failed)),
        (
            "scenes in which the choice matters",
            str(counts.mixed) if counts.ran else dash,
        ),
        ("time", words.duration(seconds) if seconds is not None else dash),
        ("judgements without a usable answer", str(counts.unanswered))
        if counts.unanswered
        else ("seed", str(found.config.get("seed", dash))),
    ]


def _count_rows(found: Material, counts: Counts) -> list[CountRow]:
    def nodes(name: str) -> str:
        return str(len(found.trees[name])) if name in found.trees else ""

    tree = found.trees.get("simulatable")
    texts = paper.PATHS * paper.PER_PATH
    rows = [
        CountRow("Nodes of the initial tree", nodes("initial"), str(paper.NODES["initial"])),
        CountRow("Rounds of red teaming", str(len(found.rounds) or ""), str(paper.ITERATIONS)),
        CountRow("Nodes of the diverse tree", nodes("diverse"), str(paper.NODES["diverse"])),
        CountRow(
            "Nodes of the simulatable tree", nodes("simulatable"), str(paper.NODES["simulatable"])
        ),
        CountRow(
            "Paths of the simulatable tree", str(len(tree.leaves)) if tree else "", str(paper.PATHS)
        ),
    ]
    if tree:
        attested = sum(leaf.attested == "paper" for leaf in tree.leaves)
        rows.append(
            CountRow(
                "Paths whose scenario the paper simulated", str(attested), str(len(paper.ATTESTED))
            )
        )
    rows += [
        CountRow(
            f"Texts in the set of {size}",
            str(len(rows_) or ""),
            size if int(size) in paper.SETS else "",
        )
        for size, rows_ in found.texts.items()
    ]
    rows += [
        CountRow("Texts along the paths", str(len(found.scenarios) or ""), str(texts)),
        CountRow("Scenes staged", str(counts.scenes or ""), str(texts)),
        CountRow("Episodes simulated", str(counts.ran or ""), str(texts)),
    ]
    return rows


def _growth(found: Material) -> Any:
    """Draw the growth curve; empty without rounds."""
    if not found.rounds:
        return ""
    first = found.rounds[0]
    before = found.trees.get("initial")
    start = len(before) if before else first.nodes
    points = [charts.Point(row.round, row.nodes, row.decision or "failed") for row in found.rounds]
    is_papers = found.config.get("nodes") == paper.NODES["initial"]
    return charts.growth(points, start, paper.NODES["diverse"] if is_papers else None)


def _call_rows(calls: Sequence[Mapping[str, Any]]) -> list[Account]:
    """Return the totals of the calls per stage, purpose and model, and of all calls."""
    rows = sorted(accounts(calls, by=("stage", "purpose", "model")), key=lambda row: row.group)
    return [*rows, account(("all", "", ""), calls)] if len(rows) > 1 else rows


def _facts(info: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return the content of `study.json`, without the configuration, as flat pairs."""
    rows: list[tuple[str, str]] = []

    def add(prefix: str, value: object) -> None:
        if isinstance(value, Mapping):
            for key, item in value.items():
                add(f"{prefix}.{key}" if prefix else str(key), item)
        elif value is not None:
            rows.append((prefix, str(value)))

    add(
        "",
        {
            key: value
            for key, value in sorted(info.items())
            if key not in ("config", "paper", "counts", "usage")
        },
    )
    return rows


def _seconds(info: Mapping[str, Any]) -> float | None:
    """Return the duration of the run, s."""
    return (
        number(info, "seconds")
        if not mapping(dig(info, "seconds"))
        else number(info, "seconds", "total")
    )


def _tally(failures: Sequence[Failure]) -> list[tuple[str, int]]:
    tally = Counter(failure.stage for failure in failures)
    return sorted((_STAGES.get(stage, stage), count) for stage, count in tally.items())


def _failed(count: int) -> str:
    return (
        "nothing failed"
        if count == 0
        else f"{_plural(count, 'item')} failed and {'is' if count == 1 else 'are'} listed"
    )


def _plural(count: int, noun: str) -> str:
    return f"{count} {noun}{'' if count == 1 else 's'}"
