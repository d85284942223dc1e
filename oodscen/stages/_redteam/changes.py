"""Translation of the tree-LLM's decisions into edits of the tree."""

from typing import Any

from oodscen._paper import attestation
from oodscen._text import one_line
from oodscen.errors import Issue
from oodscen.prompts._tree.place_scenario import MOST_ALSO, PlacedScenario, label_issues
from oodscen.stages._redteam.rounds import RunnerUp
from oodscen.tree._scenario_tree import ROOT, ScenarioTree, TreeEdit


def edits_of(
    tree: ScenarioTree, placed: PlacedScenario, **why: Any
) -> tuple[tuple[TreeEdit, ...], str | None]:
    """Translate a decision that fits the tree into edits.

    An addition may bring a new family together with its leaf, and move leaves into that family; a family left
    empty is removed. A split widens a leaf's label, makes it a family and puts two leaves below it: the first
    has the old label, the second is new.

    Args:
        tree: The current tree.
        placed: The decision.
        why: Provenance, as fields of `TreeEdit`.

    Returns:
        The edits, and the id of the leaf that stands for the text; no edits and `None` for a refused text.
    """
    if placed.decision in ("not-ood", "off-topic") or placed.node is None:
        return (), None
    if placed.decision == "covered":
        return (TreeEdit(op="keep", node=placed.node, **why),), placed.node
    label = one_line(placed.label or "")
    if placed.decision == "broaden":
        edit = TreeEdit(
            op="broaden", node=placed.node, label=label, attested=attestation(label), **why
        )
        return (edit,), None if tree.children[placed.node] else placed.node
    edits: list[TreeEdit] = []

    def add(parent: str, name: str) -> str:
        node = tree.apply(*edits).new_id(name)
        mark = attestation(name)
        edits.append(TreeEdit(op="add", node=node, parent=parent, label=name, attested=mark, **why))
        return node

    parent = placed.node
    if placed.decision == "split":
        old = tree.by_id[parent].label
        edits.append(
            TreeEdit(op="broaden", node=parent, label=one_line(placed.category or ""), **why)
        )
        add(parent, old)
        leaf = add(parent, label)
        return tuple(edits), leaf
    if placed.category:
        parent = add(parent, one_line(placed.category or ""))
    leaf = add(parent, label)
    if placed.category:
        edits += _moves(tree, placed, parent, why)
    return tuple(edits), leaf


def misfits(tree: ScenarioTree, placed: PlacedScenario) -> list[Issue]:
    """Return the faults of an answer that only the whole tree reveals, if just a part of it was shown."""
    issues = label_issues(placed, tree.nodes)
    if placed.decision == "add" and placed.category and placed.node in tree.by_id:
        own = _class_of(tree, placed.node)
        for place, name in enumerate(placed.members):
            if name not in tree.by_id or tree.children[name]:
                issues.append(Issue(f"members[{place}]", f"{name!r} is not a leaf of the tree"))
            elif tree.by_id[name].parent in (None, ROOT) or _class_of(tree, name) != own:
                issues.append(Issue(f"members[{place}]", f"{name!r} is of another class"))
    return issues


def runners_up(tree: ScenarioTree, placed: PlacedScenario) -> tuple[RunnerUp, ...]:
    """Return the other leaves that the text would also fit; ids of anything else are dropped."""
    leaves = {leaf.id for leaf in tree.leaves} - {placed.node}
    found: dict[str, RunnerUp] = {}
    for also in placed.also:
        if also.node in leaves:
            why = one_line(also.why)[:300]
            found.setdefault(also.node, RunnerUp(node=also.node, why=why))
    return tuple(found.values())[:MOST_ALSO]


def _moves(
    tree: ScenarioTree, placed: PlacedScenario, family: str, why: dict[str, Any]
) -> list[TreeEdit]:
    members = dict.fromkeys(placed.members)
    edits = [TreeEdit(op="move", node=name, parent=family, **why) for name in members]
    left = {name: len(children) for name, children in tree.children.items()}
    if placed.node in left:
        left[placed.node] += 1  # the new family
    for name in members:
        emptied = tree.by_id[name].parent
        while emptied is not None:
            left[emptied] -= 1
            if left[emptied] or tree.by_id[emptied].parent in (None, ROOT):
                break
            edits.append(TreeEdit(op="remove", node=emptied, **why))
            emptied = tree.by_id[emptied].parent
    return edits


def _class_of(tree: ScenarioTree, node_id: str) -> str:
    while (parent := tree.by_id[node_id].parent) not in (None, ROOT):
        node_id = str(parent)
    return node_id
