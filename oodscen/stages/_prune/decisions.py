"""Decisions of pruning: one per node, and what follows from those on the leaves."""

from collections.abc import Iterable, Sequence
from typing import Any, Literal

from pydantic import SerializerFunctionWrapHandler, model_serializer

from oodscen._arguments import checked
from oodscen._paper import attestation
from oodscen.data._additions import Addition
from oodscen.data._base import Data
from oodscen.tree._scenario_tree import ScenarioTree, TreeEdit

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


class PruneDecision(Data):
    """The decision about one node, with its reason."""

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
    """`None` if the question failed."""
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

    @model_serializer(mode="wrap")
    def _lean(self, serialise: SerializerFunctionWrapHandler) -> dict[str, Any]:
        value: dict[str, Any] = serialise(self)
        for name in ("made", "made_as"):
            if not value.get(name):
                value.pop(name, None)
        return value


@checked
def all_decisions(tree: ScenarioTree, judged: Iterable[PruneDecision]) -> list[PruneDecision]:
    """Extend the decisions on leaves to every node, in tree order.

    An inner node is kept exactly if one of its children is, and is realised by everything that realises
    these. The root always stays. Leaves that are realised by the same means name each other in `same_as`.
    """
    judged = alike(tree, judged)
    leaves = {decision.id for decision in judged}
    return [
        decision
        if decision.id in leaves
        else decision.model_copy(update={"path": tree.path(decision.id)})
        for decision in decisions_on_nodes(tree, judged)
    ]


def decisions_on_nodes(tree: ScenarioTree, judged: Iterable[PruneDecision]) -> list[PruneDecision]:
    """Extend the decisions on leaves to every node; inner nodes get no path."""
    by_id = {decision.id: decision for decision in judged}
    for node, _ in reversed(list(tree.walk())):
        if node.id in by_id:
            continue
        children = [by_id[child] for child in tree.children[node.id]]
        kept = [child for child in children if child.keep]
        match: Match = "part" if kept else "none"
        if children and all(child.match == "full" for child in children):
            match = "full"
        reason = f"{len(kept)} of {len(children)} branches can be shown"
        by_id[node.id] = PruneDecision(
            id=node.id,
            path=(),
            keep=bool(kept) or node.parent is None,
            reason=reason if children else "nothing lies below it",
            match=match,
            **{name: _united(kept, name) for name in (*MEANS, "substitutes")},
            catalogue=children[0].catalogue if children else "",
        )
    return [by_id[node.id] for node, _ in tree.walk()]


def alike(tree: ScenarioTree, judged: Iterable[PruneDecision]) -> list[PruneDecision]:
    """Set `same_as` of kept leaves that the simulator shows by the same means; keep the given order."""
    judged = list(judged)
    order = {node.id: number for number, node in enumerate(tree.nodes)}
    groups: dict[tuple[frozenset[str], ...], list[str]] = {}
    for decision in sorted(judged, key=lambda decision: order.get(decision.id, len(order))):
        if decision.keep and any(means := _means(decision)):
            groups.setdefault(means, []).append(decision.id)
    marked = []
    for decision in judged:
        group = groups.get(_means(decision), []) if decision.keep else []
        same_as = tuple(leaf for leaf in group if leaf != decision.id)
        marked.append(decision.model_copy(update={"same_as": same_as}))
    return marked


@checked
def apply_decisions(tree: ScenarioTree, judged: Iterable[PruneDecision]) -> ScenarioTree:
    """Return the tree after decisions on its leaves: one `keep`, `narrow` or `remove` per node, children first.

    A narrowed leaf stays attested only if its new label still names what the paper simulated.
    """
    return tree.apply(*map(_edit, reversed(decisions_on_nodes(tree, judged))))


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
