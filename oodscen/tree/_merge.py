"""Merging of two trees that were grown separately."""

from typing import TYPE_CHECKING

from oodscen.protocols import Encoder
from oodscen.tree._edits import Node, TreeEdit, added, adding
from oodscen.tree._history import undone_edits
from oodscen.tree._labels import same_words
from oodscen.tree._matching import THRESHOLD, Match, match

if TYPE_CHECKING:
    from oodscen.tree._scenario_tree import ScenarioTree


def merge(
    first: "ScenarioTree",
    second: "ScenarioTree",
    *,
    encoder: Encoder | None = None,
    threshold: float = THRESHOLD,
    name: str | None = None,
) -> "ScenarioTree":
    """Return the first tree, with the nodes that only the second one has added; see `ScenarioTree.merge`.

    The log of the first tree stays as it is. A node of the second tree that the first also has (see
    `match`) adds a `keep` that records the second tree's label, model, prompt and text. Any other
    node is added below the counterpart of its parent, together with the decisions that shaped it,
    including stage, round, model, prompt, reason and text; a `keep` of stage `merge` then records
    that it came from a merge. Siblings whose labels have the same words become one. Each of these
    edits has the name of the second tree as its `origin`: `undo(round=3, origin=...)` undoes its
    round 3.

    Every path of either tree remains a path: if a leaf of one is a family of the other, the family
    gets a leaf with that label. Merging the second tree again changes nothing. The result depends
    on the arguments alone.
    """
    pairs = match(first, second, encoder=encoder, threshold=threshold)
    by_second = {pair.after: pair for pair in pairs}
    decisions = _decisions(second)
    leaves = {leaf.id for leaf in second.leaves}
    merging = _Merging(first, name or _free_name(first))
    for node in second.nodes:
        merging.add(node, by_second.get(node.id), decisions[node.id], is_path=node.id in leaves)
    return merging.tree


def _free_name(tree: "ScenarioTree") -> str:
    """Return `merge-1`, `merge-2` or the next name that no edit has as its origin."""
    taken = {edit.origin.partition("/")[0] for edit in tree.edits}
    number = 1
    while f"merge-{number}" in taken:
        number += 1
    return f"merge-{number}"


class _Merging:
    """A merge in progress: the first tree, with the nodes of the second one that were added so far."""

    def __init__(self, first: "ScenarioTree", name: str) -> None:
        self.tree = first
        self._name = name
        self._ids: dict[str, str] = {}
        """Ids in the merge, by id in the second tree."""
        self._nodes = dict(first.by_id)
        self._children: dict[str, dict[str, str]] = {}
        """Ids of the children by the words of their labels, for each parent."""
        for node in first.nodes:
            self._index(node)
        self._path_ends = {leaf.id for leaf in first.leaves}
        """Nodes that stand for a path, so a leaf must remain when they get children."""
        self._first_edits = set(first.edits)
        self._records = {(edit.node, edit.origin_node, *_grounds(edit)) for edit in first.edits}

    def add(self, node: Node, pair: Match | None, log: list[TreeEdit], *, is_path: bool) -> None:
        """Add a node of the second tree, or record it at the node that stands for it."""
        parent = self._ids[node.parent] if node.parent is not None else None
        merged = pair.before if pair is not None else self._child_like(node, parent)
        if is_path:
            # A path ends at a leaf: descend through families with the same label.
            while merged is not None and merged not in self._path_ends and merged in self._children:
                parent, merged, pair = merged, self._child_like(node, merged), None
        if merged is None:
            merged = self._add_new(node, parent, log)
        elif not self._is_recorded(merged, node, log[-1]):
            self.tree = self.tree.apply(_keep_edit(node, merged, pair, log[-1], self._name))
        self._ids[node.id] = merged
        if is_path:
            self._path_ends.add(merged)

    def _add_new(self, node: Node, parent: str | None, log: list[TreeEdit]) -> str:
        """Add a node; if its parent ended a path, a leaf below it goes on to do so: this one, or another."""
        if parent not in self._path_ends:
            return self._append(node, parent, log)
        self._path_ends.discard(parent)
        if same_words(self._nodes[parent].label) == same_words(node.label):
            new_id = self._append(node, parent, log)
            self._path_ends.add(new_id)
            return new_id
        self._keep_path(self._nodes[parent])
        return self._append(node, parent, log)

    def _append(self, node: Node, parent: str | None, log: list[TreeEdit]) -> str:
        new_id = self.tree.new_id(log[0].label or node.label)
        self._apply(_edits_of_new_node(node, new_id, parent, log, self._name))
        return new_id

    def _keep_path(self, family: Node) -> None:
        """Add a leaf below a former leaf that has become a family."""
        new_id = self.tree.new_id(family.label)
        leaf = family.model_copy(update={"id": new_id, "parent": family.id})
        reason = "a kind of its own, which is a family in the other tree"
        self._apply([adding(leaf, stage="merge", reason=reason, origin=self._name)])
        self._path_ends.add(new_id)

    def _apply(self, edits: list[TreeEdit]) -> None:
        """Apply the edits of a new node."""
        self.tree = self.tree.apply(*edits)
        # The last edit is the addition itself, or a `keep` with the final label.
        self._index(added(edits[0]).model_copy(update={"label": edits[-1].label}))

    def _index(self, node: Node) -> None:
        self._nodes[node.id] = node
        if node.parent is not None:
            self._children.setdefault(node.parent, {}).setdefault(same_words(node.label), node.id)

    def _child_like(self, node: Node, parent: str | None) -> str | None:
        """Return the child of a parent that has the same words as a node."""
        return self._children.get(parent or "", {}).get(same_words(node.label))

    def _is_recorded(self, merged: str, node: Node, last: TreeEdit) -> bool:
        """Return whether the log already records, for a node or a family of its label, who gave the label, and why."""
        if last.node == merged and last in self._first_edits:
            return True
        if (merged, node.id, *_grounds(last)) in self._records:
            return True
        family: str | None = merged
        while family is not None and same_words(self._nodes[family].label) == same_words(
            node.label
        ):
            if (family, node.id, *_grounds(last)) in self._records:
                return True
            family = self._nodes[family].parent
        return False


def _grounds(edit: TreeEdit) -> tuple[int | None, str, str, str]:
    """Return what led to an edit."""
    return edit.round, edit.source, edit.model, edit.prompt


def _decisions(tree: "ScenarioTree") -> dict[str, list[TreeEdit]]:
    """Return, per node, the edit that added it and the later edits in force that relabelled or confirmed it."""
    undone = undone_edits(tree.edits)
    decisions: dict[str, list[TreeEdit]] = {}
    for index, edit in enumerate(tree.edits):
        is_in_force = edit.undoes is None and index not in undone
        if edit.op == "add" and (edit.undoes is None or edit.node not in decisions):
            decisions[edit.node] = [edit]
        elif edit.op in ("broaden", "narrow", "keep") and is_in_force:
            decisions[edit.node].append(edit)
    return decisions


def _keep_edit(node: Node, merged: str, pair: Match | None, last: TreeEdit, name: str) -> TreeEdit:
    """Return the edit that records at a node of the merge that the second tree has it as well."""
    criterion: str = pair.by if pair is not None else "label"
    if pair is not None and pair.similarity is not None:
        criterion += f", similarity {pair.similarity:.2f}"
    return TreeEdit(
        op="keep",
        node=merged,
        label=node.label,
        stage="merge",
        round=last.round,
        reason=f"the other tree has it as “{node.label}” (same {criterion})",
        source=last.source,
        model=last.model,
        prompt=last.prompt,
        origin=_origin(name, last),
        origin_node=node.id,
    )


def _origin(name: str, edit: TreeEdit) -> str:
    """Return the name of the tree that an edit comes from; for an edit of an earlier merge, both names."""
    return f"{name}/{edit.origin}" if edit.origin else name


def _edits_of_new_node(
    node: Node, new_id: str, parent: str | None, log: list[TreeEdit], name: str
) -> list[TreeEdit]:
    """Return the edits that add a node of the second tree to the merge and repeat the decisions about it."""
    edits = [
        edit.model_copy(
            update={
                "node": new_id,
                "parent": parent if edit.op == "add" else None,
                "attested": node.attested and edit.attested,
                "undoes": None,
                "origin": _origin(name, edit),
                "origin_node": node.id,
            }
        )
        for edit in log
    ]
    fields = {"node": new_id, "label": node.label, "stage": "merge", "origin": name}
    fields["origin_node"] = node.id
    labels = [edit.label for edit in edits if edit.op != "keep"]
    if labels[-1] != node.label or node.attested not in {edit.attested for edit in edits}:
        reason = "its label in the other tree"
        edits.append(TreeEdit(op="broaden", attested=node.attested, reason=reason, **fields))
    reason = f"merged in from another tree, where its id was {node.id}"
    return [*edits, TreeEdit(op="keep", reason=reason, **fields)]
