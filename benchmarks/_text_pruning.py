"""Measures pruning: whether every decision is explained, and whether additions restore what they promise."""

from collections.abc import Iterator, Sequence

from oodscen import Pruner, RedTeamer, ScenarioTree, TreeGrower, make_llm
from oodscen._doctor import examine_knowledge
from oodscen._registry import make_catalogue
from oodscen.data._additions import extend
from oodscen.data._catalogue import Catalogue
from oodscen.stages._prune.decisions import PruneDecision, all_decisions, apply_decisions
from oodscen.stages._prune.restoration import Unlocked, restoration
from oodscen.stages._prune.side_by_side import compare

CATALOGUES = ("pybullet", "carla-0.9.16")
TRIED = 5
"""Number of top-ranked additions that are made and checked."""
WITHOUT = {"snow": ("snow",), "animal": ("deer", "dog", "moose", "horse", "cow")}
"""Capabilities that CARLA lacks, and the words of labels that need them."""

Row = dict[str, object]


def row(name: str, value: object, unit: str, target: str, holds: bool | None) -> Row:
    return {"name": name, "value": value, "unit": unit, "target": target, "holds": holds}


def rows(llm: str = "builtin", seed: int = 0) -> Iterator[Row]:
    """Prune one diverse tree for two simulators and evaluate the decisions.

    Args:
        llm: The model that grows, red-teams and judges.
        seed: Seed of the model.
    """
    model = make_llm(llm, seed=seed)
    tree = RedTeamer(model).run(TreeGrower(model).run())
    catalogues = {name: make_catalogue(name) for name in CATALOGUES}
    judged = {
        name: list(Pruner(model, one, threads=8).decisions(tree))
        for name, one in catalogues.items()
    }
    for name, decisions in judged.items():
        yield from _explained(name, tree, decisions, is_builtin=llm == "builtin")
        yield from _promised(name, catalogues[name], tree, decisions, llm, seed)
    found = compare(tree, catalogues, judged)
    kept = {tally.catalogue: tally.kept for tally in found.tallies}
    yield row("branches shown", kept, "leaves", "shown side by side", len(kept) == 2)
    yield from _lacking(judged["carla-0.9.16"])
    if llm == "builtin":
        yield from _knowledge()


def _explained(
    name: str, tree: ScenarioTree, judged: Sequence[PruneDecision], *, is_builtin: bool
) -> Iterator[Row]:
    decisions = all_decisions(tree, judged)
    told = {decision.id for decision in decisions if decision.reason and decision.match}
    share = len(told) / len(tree.nodes)
    text = "every node has a decision with a reason"
    yield row(f"{name}: nodes with a reason", share, "share", text, share == 1.0)
    result = apply_decisions(tree, judged)
    inner = [node.id for node in tree.nodes if tree.children[node.id] and node.parent]
    agree = all(
        (node in result.by_id) == any(child in result.by_id for child in tree.children[node])
        for node in inner
    )
    yield row(f"{name}: parents survive exactly with a child", agree, "", "true", agree)
    attested = sum(one.keep and tree.by_id[one.id].attested is not None for one in judged)
    marked = sum(one.match in ("substitute", "part") for one in judged)
    yield row(f"{name}: partly shown branches, marked", marked, "leaves", "marked", None)
    holds = attested >= 9 if is_builtin else None
    yield row(f"{name}: paths attested by the paper", attested, "leaves", "at least 9", holds)


def _promised(
    name: str,
    catalogue: Catalogue,
    tree: ScenarioTree,
    judged: Sequence[PruneDecision],
    llm: str,
    seed: int,
) -> Iterator[Row]:
    """Make the top-ranked additions, judge again and compare the result with the promise."""
    found = restoration(judged)
    before = {one.id for one in judged if one.keep}
    tried: list[Unlocked] = [one for one in found.single if one.paths][:TRIED]
    tried += [category for category in found.categories if category.paths][:1]
    kept_word = 0
    for one in tried:
        model = make_llm(llm, seed=seed)
        richer = extend(catalogue, one.additions)
        after = {d.id for d in Pruner(model, richer, threads=8).decisions(tree) if d.keep}
        kept_word += after - before == set(one.paths)
    share = kept_word / max(1, len(tried))
    best = f"{tried[0].words}: {len(tried[0].paths)}" if tried else "nothing to add"
    yield row(f"{name}: first on the list, paths it restores", best, "", "listed", bool(tried))
    text = f"1: each of {len(tried)} additions restores exactly what it promised"
    yield row(f"{name}: promises that are kept", share, "share", text, share == 1.0)
    restorable = found.sequence[-1].total if found.sequence else 0
    accounted = restorable + len(found.beyond) + len(found.unknown) == found.dropped
    yield row(
        f"{name}: dropped paths on a way back or beyond one", accounted, "", "true", accounted
    )


def _lacking(judged: Sequence[PruneDecision]) -> Iterator[Row]:
    for what, words in WITHOUT.items():
        asked = [
            one
            for one in judged
            if any(word in one.path[-1].casefold().split() for word in words)
            or (what == "snow" and "snow" in one.path[-1].casefold())
        ]
        gone = [one for one in asked if not one.keep and _names(what, one)]
        value = f"{len(gone)} of {len(asked)}"
        holds = bool(asked) and len(gone) == len(asked)
        yield row(f"carla-0.9.16: branches with {what} dropped for it", value, "", "all", holds)


def _names(what: str, decision: PruneDecision) -> bool:
    if what == "animal":
        return any(lack.category == "animal" for lack in decision.lacks)
    return any(what in lack.name for lack in decision.lacks)


def _knowledge() -> Iterator[Row]:
    findings = examine_knowledge()
    faults = sum(not finding.is_ok for finding in findings)
    yield row("knowledge base", findings[0].detail, "", "at least 220, 30, 90", findings[0].is_ok)
    yield row("faults in the knowledge base", faults, "", "0", faults == 0)
