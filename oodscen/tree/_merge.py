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
    one: "ScenarioTree",
    other: "ScenarioTree",
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
    paired = {pair.after: pair for pair in match(one, other, encoder=encoder, threshold=threshold)}
    decisions = _decisions(other)
    leaves = {leaf.id for leaf in other.leaves}
    merging = _Merging(one, name or _free_name(one))
    for node in other.nodes:
        merging.take(node, paired.get(node.id), decisions[node.id], is_path=node.id in leaves)
    return merging.tree


def _free_name(tree: "ScenarioTree") -> str:
    taken = {edit.origin.partition("/")[0] for edit in tree.edits}
    number = 1
    while f"merge-{number}" in taken:
        number += 1
    return f"merge-{number}"


class _Merging:
    def __init__(self, one: "ScenarioTree", name: str) -> None:
        self.tree = one
        self._name = name
        self._ids: dict[str, str] = {}
        """Ids in the merge, by id in the second tree."""
        self._nodes = dict(one.by_id)
        self._below: dict[str, dict[str, str]] = {}
        """Children by their words, for each parent."""
        for node in one.nodes:
            self._hang(node)
        self._paths = {leaf.id for leaf in one.leaves}
        """Nodes that stand for a path, so a leaf must remain when they get children."""
        self._own = set(one.edits)
        self._told = {(edit.node, edit.origin_node, *_why(edit)) for edit in one.edits}

    def take(self, node: Node, pair: Match | None, log: list[TreeEdit], *, is_path: bool) -> None:
        """Find a node of the second tree in the merge, or add it."""
        parent = self._ids[node.parent] if node.parent is not None else None
        here = pair.before if pair is not None else self._sibling(parent, node)
        if here is not None and is_path:
            # A path ends at a leaf: descend through families with the same label.
            while here is not None and here not in self._paths and here in self._below:
                parent, here, pair = here, self._sibling(here, node), None
        if here is None:
            here = self._add(node, parent, log)
        elif not self._is_told(here, node, log[-1]):
            self.tree = self.tree.apply(_kept(node, here, pair, log[-1], self._name))
        self._ids[node.id] = here
        if is_path:
            self._paths.add(here)

    def _add(self, node: Node, parent: str | None, log: list[TreeEdit]) -> str:
        if parent in self._paths:
            self._paths.discard(parent)
            if same_words(self._nodes[parent].label) == same_words(node.label):
                here = self._append(node, parent, log)
                self._paths.add(here)
                return here
            self._keep_path(self._nodes[parent])
        return self._append(node, parent, log)

    def _append(self, node: Node, parent: str | None, log: list[TreeEdit]) -> str:
        here = self.tree.new_id(log[0].label or node.label)
        self._put(_added(node, here, parent, log, self._name))
        return here

    def _keep_path(self, family: Node) -> None:
        """Add a leaf below a former leaf that has become a family."""
        here = self.tree.new_id(family.label)
        leaf = family.model_copy(update={"id": here, "parent": family.id})
        why = "a kind of its own, which is a family in the other tree"
        self._put([adding(leaf, stage="merge", reason=why, origin=self._name)])
        self._paths.add(here)

    def _put(self, edits: list[TreeEdit]) -> None:
        self.tree = self.tree.apply(*edits)
        # The last edit is the addition itself, or a `keep` with the final label.
        self._hang(added(edits[0]).model_copy(update={"label": edits[-1].label}))

    def _hang(self, node: Node) -> None:
        self._nodes[node.id] = node
        if node.parent is not None:
            self._below.setdefault(node.parent, {}).setdefault(same_words(node.label), node.id)

    def _sibling(self, parent: str | None, node: Node) -> str | None:
        return self._below.get(parent or "", {}).get(same_words(node.label))

    def _is_told(self, here: str, node: Node, last: TreeEdit) -> bool:
        """Return whether the log already records, for a node or a family of its label, who gave the label, and why."""
        if last.node == here and last in self._own:
            return True
        place: str | None = here
        while place is not None and same_words(self._nodes[place].label) == same_words(node.label):
            if (place, node.id, *_why(last)) in self._told:
                return True
            place = self._nodes[place].parent
        return (here, node.id, *_why(last)) in self._told


def _why(edit: TreeEdit) -> tuple[int | None, str, str, str]:
    return edit.round, edit.source, edit.model, edit.prompt


def _decisions(tree: "ScenarioTree") -> dict[str, list[TreeEdit]]:
    """Return, per node, the edit that added it and the later edits in force that relabelled or confirmed it."""
    undone = undone_edits(tree.edits)
    found: dict[str, list[TreeEdit]] = {}
    for index, edit in enumerate(tree.edits):
        if edit.op == "add" and (edit.undoes is None or edit.node not in found):
            found[edit.node] = [edit]
        elif (
            edit.op in ("broaden", "narrow", "keep") and edit.undoes is None and index not in undone
        ):
            found[edit.node].append(edit)
    return found


def _kept(node: Node, here: str, pair: Match | None, last: TreeEdit, name: str) -> TreeEdit:
    sure = f", similarity {pair.similarity:.2f}" if pair and pair.similarity is not None else ""
    by = pair.by if pair else "label"
    return TreeEdit(
        op="keep",
        node=here,
        label=node.label,
        stage="merge",
        round=last.round,
        reason=f"the other tree has it as “{node.label}” (same {by}{sure})",
        source=last.source,
        model=last.model,
        prompt=last.prompt,
        origin=_origin(name, last),
        origin_node=node.id,
    )


def _origin(name: str, edit: TreeEdit) -> str:
    """Return the name of the tree that an edit comes from; for an edit of an earlier merge, both names."""
    return f"{name}/{edit.origin}" if edit.origin else name


def _added(
    node: Node, here: str, parent: str | None, log: list[TreeEdit], name: str
) -> list[TreeEdit]:
    edits = [
        edit.model_copy(
            update={
                "node": here,
                "parent": parent if edit.op == "add" else None,
                "attested": node.attested and edit.attested,
                "undoes": None,
                "origin": _origin(name, edit),
                "origin_node": node.id,
            }
        )
        for edit in log
    ]
    told = {"node": here, "label": node.label, "stage": "merge", "origin": name}
    told["origin_node"] = node.id
    labels = [edit.label for edit in edits if edit.op != "keep"]
    if labels[-1] != node.label or node.attested not in {edit.attested for edit in edits}:
        why = "its label in the other tree"
        edits.append(TreeEdit(op="broaden", attested=node.attested, reason=why, **told))
    why = f"merged in from another tree, where its id was {node.id}"
    return [*edits, TreeEdit(op="keep", reason=why, **told)]
