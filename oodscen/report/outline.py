"""Trees as nested outlines: where each node came from, and what became of it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from oodscen.prune import PruneDecision
from oodscen.tree import ScenarioTree, TreeEdit


@dataclass(frozen=True)
class Branch:
    """One node with everything below it."""

    id: str
    label: str
    depth: int
    attested: bool
    origin: str
    """`new in round 12`, `broadened in round 3 from ...`, or empty."""
    fate: str
    """`kept`, `dropped`, `failed`, or empty where the tree was not pruned."""
    reason: str
    uses: tuple[str, ...]
    """Assets and behaviours that realise it."""
    missing: tuple[str, ...]
    leaves: int
    """How many paths end at or below it."""
    children: tuple["Branch", ...]


def outline(tree: ScenarioTree, decisions: Sequence[PruneDecision] = ()) -> tuple[Branch, ...]:
    """Return the roots of a tree.

    Args:
        tree: Any tree.
        decisions: What pruning decided about its nodes, where that is to be shown.
    """
    fates = {decision.id: decision for decision in decisions}
    origins = _origins(tree.edits)

    def grow(node_id: str, depth: int) -> Branch:
        node = tree.by_id[node_id]
        children = tuple(grow(child, depth + 1) for child in tree.children[node_id])
        decision = fates.get(node_id)
        return Branch(
            id=node.id,
            label=node.label,
            depth=depth,
            attested=node.attested == "paper" and not children,
            origin=origins.get(node.id, ""),
            fate=_fate(decision),
            reason=(decision.reason or decision.error or "") if decision and not children else "",
            uses=(*decision.assets, *decision.behaviours) if decision else (),
            missing=decision.missing if decision else (),
            leaves=sum(child.leaves for child in children) if children else int(depth >= 2),
            children=children,
        )

    return tuple(grow(node.id, 0) for node in tree.nodes if node.parent is None)


def _fate(decision: PruneDecision | None) -> str:
    if decision is None:
        return ""
    if decision.status == "failed":
        return "failed"
    return "kept" if decision.keep else "dropped"


def _origins(edits: Sequence[TreeEdit]) -> Mapping[str, str]:
    """Say for nodes that red teaming added or changed when that was, and what they were called."""
    labels: dict[str, str] = {}
    born: dict[str, int | None] = {}
    changed: dict[str, list[str]] = {}
    for edit in edits:
        if edit.op == "add":
            labels[edit.node] = edit.label or ""
            if edit.stage == "redteam":
                born[edit.node] = edit.round
        elif edit.op == "broaden":
            changed.setdefault(edit.node, []).append("?" if edit.round is None else str(edit.round))
    found = {name: f"new in round {moment}" for name, moment in born.items()}
    for name, moments in changed.items():
        when = f"broadened in round{'s' if len(moments) > 1 else ''} {', '.join(moments)}"
        first = f"{found[name]}, " if name in found else ""
        found[name] = f"{first}{when}, at first “{labels.get(name, '')}”"
    return found
