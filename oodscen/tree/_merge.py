"""Merging of two trees that were grown separately."""

from collections.abc import Container, Iterable, Mapping
from typing import TYPE_CHECKING

from oodscen.protocols import Encoder
from oodscen.tree._edits import Node, TreeEdit, added, adding
from oodscen.tree._history import decisions
from oodscen.tree._labels import same_words
from oodscen.tree._matching import (
    THRESHOLD,
    Match,
    classes_of,
    earlier_places,
    grounds_of,
    match,
    shared_ids,
)

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
    that it came from a merge. A family whose leaves all stand elsewhere is not added: it would end a
    path itself. Siblings whose labels have the same words become one. Each of these edits has the
    name of the second tree as its `origin`: `undo(round=3, origin=...)` undoes its round 3.

    Every path of either tree remains a path, with the first tree's labels for the nodes of both: if a
    leaf of one is a family of the other, the family gets a leaf with that label. Merging the second
    tree again changes nothing. The result depends on the arguments alone.

    Raises:
        DataError: If a node would lie too deep.
    """
    merging = _Merging(
        first, second, match(first, second, encoder=encoder, threshold=threshold), name
    )
    for node in second.nodes:
        merging.add(node)
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

    def __init__(
        self,
        first: "ScenarioTree",
        second: "ScenarioTree",
        pairs: Iterable[Match],
        name: str | None,
    ) -> None:
        self.tree = first
        self._name = name or _free_name(first)
        self._decisions = decisions(second)
        self._leaves = {leaf.id for leaf in second.leaves}
        self._shared = shared_ids(first, second)
        self._pairs = {pair.after: pair for pair in pairs}
        self._earlier = _earlier_places(first, second, self._pairs, self._shared)
        self._bringing = _bringing(second, self._pairs.keys() | self._earlier.keys())
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
        self._records = {(edit.node, edit.origin_node, *grounds_of(edit)) for edit in first.edits}
        self._left_out = {
            (edit.node, edit.origin_node)
            for edit in first.edits
            if (edit.op, edit.stage, edit.label) == ("keep", "merge", None)
        }
        """Nodes at whose parent an earlier merge recorded that it left them out."""

    def add(self, node: Node) -> None:
        """Add a node of the second tree, or record it at the node that stands for it."""
        parent = self._ids[node.parent] if node.parent is not None else None
        merged, pair = self._counterpart(node, parent)
        standing = [merged]
        if node.id in self._leaves and merged is not None:
            standing = self._to_path_end(merged, node)
            if len(standing) > 1:
                *_, parent, merged = standing
                pair = None
        if merged is None and parent is not None and node.id not in self._bringing:
            merged = self._leave_out(node, parent)
        elif merged is None:
            merged = self._add_new(node, parent, self._decisions[node.id])
        elif not self._is_recorded(standing, node):
            last = self._decisions[node.id][-1]
            self.tree = self.tree.apply(_keep_edit(node, merged, pair, last, self._name))
        self._ids[node.id] = merged
        if node.id in self._leaves:
            self._path_ends.add(merged)

    def _counterpart(self, node: Node, parent: str | None) -> tuple[str | None, Match | None]:
        """Return the node that stands for one of the second tree, and the pair that says so, if one does."""
        pair = self._pairs.get(node.id)
        if node.id in self._earlier:
            return self._earlier[node.id], None
        if (parent, node.id) in self._left_out and node.id not in self._bringing:
            return None, None
        if pair is not None:
            return pair.before, pair
        return self._child_like(node, parent), None

    def _to_path_end(self, place: str, node: Node) -> list[str | None]:
        """Return the nodes from a place down to a leaf of a label, or else of the family's; if none, `None` is last."""
        if place in self._path_ends or place not in self._children:
            return [place]
        likes = (self._child_like(like, place) for like in (node, self._nodes[place]))
        below = [self._to_path_end(child, node) for child in dict.fromkeys(likes) if child]
        return [place, *next((way for way in below if way[-1]), below[0] if below else [None])]

    def _leave_out(self, node: Node, parent: str) -> str:
        """Record at the parent of a family that it was not added, and return the parent."""
        if (parent, node.id) not in self._left_out:
            edit = TreeEdit(
                op="keep",
                node=parent,
                stage="merge",
                reason=f"all that the other tree has below “{node.label}” stands elsewhere",
                origin=self._name,
                origin_node=node.id,
            )
            self.tree = self.tree.apply(edit)
        return parent

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

    def _is_recorded(self, standing: Iterable[str | None], node: Node) -> bool:
        """Return whether the log already records, at one of some nodes, who gave a node its label, and why."""
        last = self._decisions[node.id][-1]
        if node.id in self._shared and last in self._first_edits:
            return True
        is_known = node.id in self._shared or node.id in self._earlier
        return is_known and any(
            (place, node.id, *grounds_of(last)) in self._records for place in standing
        )


def _earlier_places(
    first: "ScenarioTree",
    second: "ScenarioTree",
    pairs: Mapping[str, Match],
    shared: Container[str],
) -> dict[str, str]:
    """Return the nodes that an earlier merge recorded as those of the second tree, by id there.

    Such a node is of the class of the one it stands for, or of that one's surroundings in the merge,
    if both are of a class.
    """
    recorded = earlier_places(first, second)
    classes, second_classes = classes_of(first), classes_of(second)
    places: dict[str, str] = {}
    surroundings: dict[str | None, str] = {None: ""}
    for node in second.nodes:
        around = surroundings[node.parent]
        fitting = {around, second_classes[node.id]}
        candidates = () if node.id in shared else recorded.get(node.id, ())
        place = next(
            (one for one in candidates if "" in fitting or classes[one] in ("", *fitting)), None
        )
        if place is not None:
            places[node.id] = place
        elif node.id in pairs:
            place = pairs[node.id].before
        surroundings[node.id] = around if place is None else classes[place]
    return places


def _bringing(second: "ScenarioTree", placed: Container[str]) -> set[str]:
    """Return the nodes of the second tree that are leaves, or have new leaves below them."""
    bringing: set[str] = set()
    for node in reversed(second.nodes):
        children = second.children[node.id]
        if not children or any(name in bringing and name not in placed for name in children):
            bringing.add(node.id)
    return bringing


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
