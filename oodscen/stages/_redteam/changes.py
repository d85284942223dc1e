"""Translation of the tree-LLM's decisions into edits of the tree."""

from collections.abc import Sequence
from typing import Any

from oodscen._paper import attestation
from oodscen._words.text import one_line
from oodscen.errors import Issue
from oodscen.prompts._tree.kind_labels import parts_of
from oodscen.prompts._tree.place_scenario import MOST_ALSO, PlacedScenario, label_issues
from oodscen.stages._redteam.rounds import Decision, RunnerUp
from oodscen.stages._redteam.shared_words import shared_word_scores, stems
from oodscen.tree._labels import label_fault, same_words
from oodscen.tree._scenario_tree import ROOT, ScenarioTree, TreeEdit

_LONGEST_REASON = 300
"""Number of characters of a runner-up's reason that are kept."""


def edits_of(
    tree: ScenarioTree, placed: PlacedScenario, *, splits_lists: bool = False, **why: Any
) -> tuple[tuple[TreeEdit, ...], str | None]:
    """Translate a decision that fits the tree into edits.

    An addition may bring a new family together with its leaf, and move leaves into that family; a family left
    empty is removed. A split widens a leaf's label, makes it a family and puts two leaves below it: the first
    has the old label, the second is new.

    A label may list several kinds: "A or B doing C". A new leaf with such a label becomes one leaf per kind, of
    which the one that shares the most words with the text stands for it. A leaf that such a label would only
    lengthen keeps its own label, and the other kinds become leaves beside it.

    Returns:
        The edits, and the id of the leaf that stands for the text; no edits and `None` for a refused text.
    """
    if placed.decision in ("not-ood", "off-topic") or placed.node is None:
        return (), None
    if placed.decision == "covered":
        return (TreeEdit(op="keep", node=placed.node, **why),), placed.node
    label, category = one_line(placed.label or ""), one_line(placed.category or "")
    if placed.decision == "broaden":
        others = _others(tree, placed, label) if splits_lists else ()
        if not others:
            mark = attestation(label)
            edit = TreeEdit(op="broaden", node=placed.node, label=label, attested=mark, **why)
            return (edit,), None if tree.children[placed.node] else placed.node
        draft = _Draft(tree, why)
        leaf = draft.add_leaves(str(tree.by_id[placed.node].parent), others)
        return tuple(draft.edits), leaf
    kinds = _kinds(tree, label, placed.category) if splits_lists else (label,)
    draft = _Draft(tree, why)
    if placed.decision == "split":
        widened = TreeEdit(op="broaden", node=placed.node, label=category, **why)
        draft.edits.append(widened)
        draft.add(placed.node, tree.by_id[placed.node].label)
        leaf = draft.add_leaves(placed.node, kinds)
    elif placed.category:
        family = draft.add(placed.node, category)
        leaf = draft.add_leaves(family, kinds)
        draft.edits += _moves(tree, placed, family, why)
    else:
        leaf = draft.add_leaves(placed.node, kinds)
    return tuple(draft.edits), leaf


class _Draft:
    """Edits under construction, which may add nodes below nodes that they added."""

    def __init__(self, tree: ScenarioTree, why: dict[str, Any]) -> None:
        self._tree = tree
        self._why = why
        self.edits: list[TreeEdit] = []

    def add(self, parent: str, label: str) -> str:
        node = self._tree.apply(*self.edits).new_id(label)
        mark = attestation(label)
        edit = TreeEdit(op="add", node=node, parent=parent, label=label, attested=mark, **self._why)
        self.edits.append(edit)
        return node

    def add_leaves(self, parent: str, labels: Sequence[str]) -> str:
        """Add a leaf per label and return the id of the one that shares the most words with the text."""
        leaves = [self.add(parent, label) for label in labels]
        shared = shared_word_scores(str(self._why.get("source") or ""), labels)
        return leaves[shared.index(max(shared))]


def resolve_decision(placed: PlacedScenario, edits: Sequence[TreeEdit]) -> Decision:
    """Return what a decision came to: a leaf that was to be lengthened by another kind is an addition."""
    is_new = any(edit.op == "add" for edit in edits)
    return "add" if placed.decision == "broaden" and is_new else placed.decision


def _kinds(tree: ScenarioTree, label: str, family: str | None = None) -> tuple[str, ...]:
    """Return the kinds that a label lists, without those that a node or the new family names; itself if none."""
    taken = {same_words(node.label) for node in tree.nodes} | {same_words(family or "")}
    parts = parts_of(label)
    if any(label_fault(part) for part in parts):
        return (label,)
    return tuple(part for part in parts if same_words(part) not in taken) or (label,)


def _others(tree: ScenarioTree, placed: PlacedScenario, label: str) -> tuple[str, ...]:
    """Return the new kinds of a list that a leaf's label is to become, if one of the list is the leaf's own."""
    if placed.decision != "broaden" or placed.node is None or tree.children[placed.node]:
        return ()
    words = stems(tree.by_id[placed.node].label)
    parts = parts_of(label)
    leaf_parts = [part for part in parts if stems(part) <= words]
    others = [part for part in parts if part not in leaf_parts]
    if len(leaf_parts) != 1 or not others:
        return ()
    kinds = _kinds(tree, label)
    return tuple(part for part in others if part in kinds)


def misfits(tree: ScenarioTree, placed: PlacedScenario) -> list[Issue]:
    """Return the faults of an answer that only the whole tree reveals, if just a part of it was shown."""
    issues = label_issues(placed, tree.nodes)
    node = placed.node
    if placed.decision == "add" and placed.category and node is not None and node in tree.by_id:
        node_class = _class_of(tree, node)
        for index, name in enumerate(placed.members):
            if name not in tree.by_id or tree.children[name]:
                issues.append(Issue(f"members[{index}]", f"{name!r} is not a leaf of the tree"))
            elif tree.by_id[name].parent in (None, ROOT) or _class_of(tree, name) != node_class:
                issues.append(Issue(f"members[{index}]", f"{name!r} is of another class"))
    return issues


def runners_up(tree: ScenarioTree, placed: PlacedScenario) -> tuple[RunnerUp, ...]:
    """Return the other leaves that the text would also fit; ids of anything else are dropped."""
    leaves = {leaf.id for leaf in tree.leaves} - {placed.node}
    by_node: dict[str, RunnerUp] = {}
    for also in placed.also:
        if also.node in leaves:
            why = one_line(also.why)[:_LONGEST_REASON]
            by_node.setdefault(also.node, RunnerUp(node=also.node, why=why))
    return tuple(by_node.values())[:MOST_ALSO]


def _moves(
    tree: ScenarioTree, placed: PlacedScenario, family: str, why: dict[str, Any]
) -> list[TreeEdit]:
    """Return the moves of leaves into a new family, and the removals of the families that they empty."""
    members = dict.fromkeys(placed.members)
    edits = [TreeEdit(op="move", node=name, parent=family, **why) for name in members]
    child_counts = {name: len(children) for name, children in tree.children.items()}
    if placed.node in child_counts:
        child_counts[placed.node] += 1  # the new family
    for name in members:
        parent = tree.by_id[name].parent
        while parent is not None:
            child_counts[parent] -= 1
            if child_counts[parent] or tree.by_id[parent].parent in (None, ROOT):
                break
            edits.append(TreeEdit(op="remove", node=parent, **why))
            parent = tree.by_id[parent].parent
    return edits


def _class_of(tree: ScenarioTree, node_id: str) -> str:
    while (parent := tree.by_id[node_id].parent) not in (None, ROOT):
        node_id = str(parent)
    return node_id
