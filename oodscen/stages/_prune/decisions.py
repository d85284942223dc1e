"""Decisions of pruning: one per node, and what follows from those on the leaves."""

from collections.abc import Iterable, Sequence
from typing import Any, ClassVar, Literal

from oodscen._arguments import checked
from oodscen._display import cut
from oodscen._paper import attestation
from oodscen.data._additions import Addition
from oodscen.data._base import Data, LeanData
from oodscen.errors import UsageError
from oodscen.tree._scenario_tree import Node, ScenarioTree, TreeEdit

MEANS = ("assets", "states", "behaviours", "weather", "traits")
"""Fields of a decision, and of an answer, that say what a branch is shown with."""

Match = Literal["full", "substitute", "part", "none"]
"""The quality of a match between a branch and a catalogue.

`full`: shown as it is. `substitute`: with assets that stand in for others. `part`: only a part of what the
label names, or below an inner node not every branch. `none`: not at all.
"""


class SubstitutedAsset(Data):
    """An asset that replaces something the catalogue lacks."""

    asset: str
    stands_for: str


class PruneDecision(LeanData):
    """The decision about one node, with its reason."""

    _left_out: ClassVar = ("instead", "made", "made_as")

    id: str
    """Id of the node."""
    path: tuple[str, ...]
    keep: bool
    status: Literal["ok", "failed"] = "ok"
    error: str | None = None
    retryable: bool = False
    """True if a failed question may succeed later."""
    reason: str = ""
    match: Match | None = None
    """`None` if the question failed; for an inner node, if one below it failed and nothing is kept."""
    label: str = ""
    """The node's narrower label, if only a part of it can be shown."""
    assets: tuple[str, ...] = ()
    """Ids of the assets that realise the node; for an inner node, those of all its kept branches."""
    states: tuple[str, ...] = ()
    """Required states, as `asset: state`."""
    behaviours: tuple[str, ...] = ()
    weather: tuple[str, ...] = ()
    """Required weather: `night`, `fog`, `rain`, `snow` or `ice`."""
    traits: tuple[str, ...] = ()
    """Required traits of the map."""
    substitutes: tuple[SubstitutedAsset, ...] = ()
    missing: tuple[str, ...] = ()
    """The additions in `lacks` in words."""
    lacks: tuple[Addition, ...] = ()
    """Additions to the catalogue: for a dropped leaf all that restore it, for a kept one those that would
    replace its substitutes or show the rest of its label.
    """
    instead: tuple[tuple[Addition, ...], ...] = ()
    """Other additions that restore a dropped leaf, each group by itself, as far as the model names them. Left out of
    the JSON text if empty."""
    made: tuple[str, ...] = ()
    """Ids of the things that were made to order for it: for a dropped leaf they did not suffice. Left out of the
    JSON text if empty."""
    made_as: tuple[Addition, ...] = ()
    """The additions that they were made as. Left out of the JSON text if empty."""
    same_as: tuple[str, ...] = ()
    """Ids of the other leaves that the simulator shows with exactly the same means."""
    catalogue: str = ""
    """The simulator and its version."""
    model: str = ""
    """Name of the model that judged; empty for inner nodes, which follow from their leaves."""
    prompt: str = ""
    """The question that the model was asked: `purpose@version`."""


@checked
def all_decisions(tree: ScenarioTree, judged: Iterable[PruneDecision]) -> list[PruneDecision]:
    """Extend the decisions on leaves to every node, in tree order.

    An inner node is kept exactly if one of its children is, and is realised by everything that realises
    these. The root always stays. Leaves that are realised by the same means name each other in `same_as`.

    Args:
        tree: The diverse tree.
        judged: Decisions on leaves, or on every node; those on inner nodes are ignored.

    Raises:
        UsageError: If there is no decision on some leaf.
    """
    decisions = decisions_on_nodes(tree, judged)
    groups: dict[tuple[frozenset[str], ...], list[str]] = {}
    for node in tree.nodes:
        decision = decisions[node.id]
        if decision.keep and not tree.children[node.id] and any(means := _means(decision)):
            groups.setdefault(means, []).append(node.id)
    same_as = {
        leaf: tuple(other for other in group if other != leaf)
        for group in groups.values()
        for leaf in group
    }
    return [
        decision.model_copy(update={"path": tree.path(name), "same_as": same_as.get(name, ())})
        for name, decision in decisions.items()
    ]


def decisions_on_nodes(
    tree: ScenarioTree, judged: Iterable[PruneDecision]
) -> dict[str, PruneDecision]:
    """Return the decisions on all nodes by their ids, in tree order; inner nodes get no path.

    Raises:
        UsageError: If there is no decision on some leaf.
    """
    given = {decision.id: decision for decision in judged}
    leaves = [leaf.id for leaf in tree.leaves]
    if missing := [leaf for leaf in leaves if leaf not in given]:
        raise UsageError(
            f"no decision on {len(missing)} of {len(leaves)} leaves: {cut(', '.join(missing))}"
        )
    by_id = {leaf: given[leaf] for leaf in leaves}
    nodes = [node for node, _ in tree.walk()]
    for node in reversed(nodes):
        if node.id not in by_id:
            children = [by_id[child] for child in tree.children[node.id]]
            by_id[node.id] = _of_inner(node, children)
    return {node.id: by_id[node.id] for node in nodes}


def _of_inner(node: Node, children: Sequence[PruneDecision]) -> PruneDecision:
    """Return the decision on a node that is no leaf, which follows from those on its children."""
    kept = [child for child in children if child.keep]
    unjudged = sum(child.match is None and not child.keep for child in children)
    matches = {child.match for child in children}
    match: Match | None = "part" if kept else None if unjudged else "none"
    if kept and matches <= {"full", "substitute"}:
        match = "substitute" if "substitute" in matches else "full"
    reason = f"{len(kept)} of {len(children)} branches can be shown"
    if unjudged:
        reason += f", and {unjudged} could not be judged"
    return PruneDecision(
        id=node.id,
        path=(),
        keep=bool(kept) or node.parent is None,
        reason=reason if children else "nothing lies below it",
        match=match,
        **{name: _united(kept, name) for name in (*MEANS, "substitutes")},
        catalogue=children[0].catalogue if children else "",
    )


@checked
def apply_decisions(tree: ScenarioTree, judged: Iterable[PruneDecision]) -> ScenarioTree:
    """Return the tree after decisions on its leaves: one `keep`, `narrow` or `remove` per node, children first.

    A narrowed leaf stays attested only if its new label still names what the paper simulated.

    Args:
        tree: The diverse tree.
        judged: Decisions on leaves, or on every node; those on inner nodes are ignored.

    Raises:
        UsageError: If there is no decision on some leaf.
    """
    return tree.apply(*map(_edit, reversed(decisions_on_nodes(tree, judged).values())))


def _edit(decision: PruneDecision) -> TreeEdit:
    op: Literal["keep", "narrow", "remove"] = "keep" if decision.keep else "remove"
    label = attested = None
    if decision.keep and decision.label:
        op, label, attested = "narrow", decision.label, attestation(decision.label)
    return TreeEdit(
        op=op,
        node=decision.id,
        label=label,
        attested=attested,
        stage="prune",
        reason=decision.reason or decision.error or "",
        model=decision.model,
        prompt=decision.prompt,
    )


def _means(decision: PruneDecision) -> tuple[frozenset[str], ...]:
    return tuple(frozenset(getattr(decision, name)) for name in MEANS)


def _united(decisions: Sequence[PruneDecision], field: str) -> tuple[Any, ...]:
    """Return the entries of a field of all decisions, each once."""
    return tuple(
        dict.fromkeys(entry for decision in decisions for entry in getattr(decision, field))
    )
