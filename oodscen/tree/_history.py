"""The history of a tree: earlier states, replay and undo."""

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from oodscen._numbers import MOST, whole_number
from oodscen.errors import DataError, UsageError
from oodscen.tree._edit_log import EditLog
from oodscen.tree._edits import Node, TreeEdit, adding, edited

if TYPE_CHECKING:
    from oodscen.tree._scenario_tree import ScenarioTree

_CHANGED: Mapping[str, tuple[str, ...]] = {
    "broaden": ("label", "attested"),
    "narrow": ("label", "attested"),
    "move": ("parent",),
}
"""The fields of a node that each kind of edit changes."""


def replay(tree: "ScenarioTree") -> Iterator[tuple[TreeEdit, "ScenarioTree"]]:
    """Yield every edit with the tree after it, starting with the first."""
    after = type(tree)()
    for edit in tree.edits:
        after = after.apply(edit)
        yield edit, after


def version_at(
    edits: Sequence[TreeEdit],
    *,
    edit: int | None = None,
    round: int | None = None,
    stage: str | None = None,
) -> int:
    """Return the number of edits up to a moment; see `ScenarioTree.at`.

    Raises:
        UsageError: If not exactly one argument is given, or there was no such moment.
    """
    if sum(choice is not None for choice in (edit, round, stage)) != 1:
        raise UsageError("a moment is given by one of edit, round and stage")
    if edit is not None:
        return whole_number("edit", edit, 0, len(edits))
    if stage is not None:
        versions = [version for version, item in enumerate(edits, start=1) if item.stage == stage]
        if not versions:
            stages = ", ".join(sorted({item.stage for item in edits if item.stage}))
            raise UsageError(f"no edit is of the stage {stage!r} (there are: {stages or 'none'})")
        return versions[-1]
    return _version_after_round(edits, whole_number("round", round))


def undo(tree: "ScenarioTree", index: int | None = None) -> "ScenarioTree":
    """Undo one edit; see `ScenarioTree.undo`."""
    size = len(tree.edits)
    index = _last_in_force(tree) if index is None else whole_number("index", index, -MOST)
    if not -size <= index < size:
        raise UsageError(f"there is no edit {index}: the log has {size}")
    undoing = _Undoing(tree)
    undoing.undo(index % size)
    return undoing.applied()


def _last_in_force(tree: "ScenarioTree") -> int:
    """Return the index of the last edit that neither undoes another nor is undone itself."""
    undone = undone_edits(tree.edits)
    for index, edit in reversed(list(enumerate(tree.edits))):
        if edit.undoes is None and index not in undone and _is_effective(edit, tree.by_id):
            return index
    raise UsageError("no edit is left to undo")


def undo_round(tree: "ScenarioTree", round: int, *, origin: str = "") -> "ScenarioTree":
    """Undo the edits of a round that are still in force; see `ScenarioTree.undo`."""
    round = whole_number("round", round)
    edits = tree.edits
    undoing = _Undoing(tree)
    for index, edit in reversed(list(enumerate(edits))):
        is_meant = edit.round == round and edit.origin == origin and edit.undoes is None
        # A removal by another edit of the round can only be undone after that edit.
        if is_meant and index not in undoing.undone and _is_effective(edit, undoing.log.nodes):
            undoing.undo(index)
    if not undoing.inverses:
        message = f"no edit of round {round}"
        if origin:
            message += f" of {origin!r}"
        message += " is left to undo"
        others = {edit.origin for edit in edits if edit.round == round and edit.origin != origin}
        if others:
            message += f" (others have one: {', '.join(sorted(map(repr, others)))})"
        raise UsageError(message)
    return undoing.applied()


def undone_edits(edits: Sequence[TreeEdit]) -> set[int]:
    """Return the indices of the edits that are currently undone; an undone undo does not count.

    Only an edit of the same node undoes an edit; an undo may need edits of other nodes, which refer to it as well.
    """
    undone: set[int] = set()
    for index in range(len(edits) - 1, -1, -1):
        earlier = edits[index].undoes
        if earlier is None or index in undone:
            continue
        if edits[earlier].node == edits[index].node:
            undone.add(earlier)
    return undone


def decisions(tree: "ScenarioTree") -> dict[str, list[TreeEdit]]:
    """Return, per node, the edit that added it and the later edits in force that relabelled or confirmed it."""
    undone = undone_edits(tree.edits)
    by_node: dict[str, list[TreeEdit]] = {}
    for index, edit in enumerate(tree.edits):
        is_in_force = edit.undoes is None and index not in undone
        if edit.op == "add" and (edit.undoes is None or edit.node not in by_node):
            by_node[edit.node] = [edit]
        elif edit.op in ("broaden", "narrow", "keep") and is_in_force:
            by_node[edit.node].append(edit)
    return by_node


def _is_effective(edit: TreeEdit, nodes: Container[str]) -> bool:
    """Return whether the effect of an edit is still there in a tree: its node, or for a removal the lack of it."""
    return (edit.node in nodes) != (edit.op == "remove")


def _version_after_round(edits: Sequence[TreeEdit], round: int) -> int:
    """Return the number of edits up to the last one of a round or of an earlier one.

    A later round, and a run that numbers its rounds from the start, end the count; a merge belongs to the round
    after it. If there is no such edit, all edits up to that end or to a merge count.
    """
    end: int | None = None
    merged: int | None = None
    last_round: int | None = None
    for index, edit in enumerate(edits):
        if edit.origin:
            merged = index if merged is None else merged
            continue
        is_restart = last_round is not None and edit.round is not None and edit.round < last_round
        is_later = edit.round is not None and edit.round > round
        if is_restart or is_later:
            return index if end is None else end
        if edit.round is not None:
            end, last_round = index + 1, edit.round
    if end is None:
        end = merged
    return len(edits) if end is None else end


class _Undoing:
    """Undoing in progress: the log of a tree, and the edits that undo earlier ones."""

    def __init__(self, tree: "ScenarioTree") -> None:
        self._tree = tree
        self.log = tree._edit_log()
        self.undone = undone_edits(tree.edits)
        self.inverses: list[TreeEdit] = []
        self._edits = tree.edits
        self._indices: dict[str, list[int]] = {}
        """Indices of the edits that undo nothing, by node."""
        for index, edit in enumerate(tree.edits):
            if edit.undoes is None:
                self._indices.setdefault(edit.node, []).append(index)
        self._added_at = {
            edit.node: index for index, edit in enumerate(tree.edits) if edit.op == "add"
        }
        """Index of the last edit that added each node."""

    def undo(self, index: int) -> None:
        """Undo an edit in the tree as it is now."""
        edit = self._edits[index]
        if index in self.undone:
            raise UsageError(f"edit {index} is undone already")
        if not _is_effective(edit, self.log.nodes):
            state = "is there again" if edit.op == "remove" else "is gone"
            raise UsageError(f"edit {index} cannot be undone: its node {edit.node!r} {state}")
        steps = self._inverse(index)
        first = len(self.log.log)
        self.log.extend(first, steps)
        self.inverses += steps
        self._added_at |= {
            step.node: number for number, step in enumerate(steps, first) if step.op == "add"
        }

    def applied(self) -> "ScenarioTree":
        """Return the tree with everything undone."""
        try:
            return self._tree.apply(*self.inverses)
        except DataError as error:
            why = "; ".join(issue.message for issue in error.issues)
            raise UsageError(f"it cannot be undone in the tree as it is now: {why}") from None

    def _inverse(self, index: int) -> list[TreeEdit]:
        """Return the edits that undo one; of one that a later edit has replaced, only the record."""
        edit = self._edits[index]
        fields: dict[str, Any] = {
            "stage": "undo",
            "reason": f"takes back edit {index} ({edit.op})",
            "undoes": index,
        }
        before, was = self.log.before[index], self._in_force(edit.node)
        self._leave_out(index)
        if edit.op == "add":
            bare = [] if edit.undoes is not None else self._left_bare(index)
            going = [*reversed(self.log.at_or_below(edit.node)), *bare]
            return [TreeEdit(op="remove", node=node_id, **fields) for node_id in going]
        if before is not None and edit.op == "remove":
            returning = [before, *_missing_parents(self.log, before)]
            return [adding(node, **fields) for node in reversed(returning)]
        now, without = self.log.nodes[edit.node], self._in_force(edit.node)
        names = _CHANGED.get(self._op(index), ())
        if was is not None and without is not None and not _differ(was, now, names):
            before = without
        if before is None or not _differ(before, now, names):
            return [TreeEdit(op="keep", node=edit.node, **fields)]
        if "label" in names:
            label = {"label": before.label, "attested": before.attested}
            return [TreeEdit(op="broaden", node=edit.node, **label, **fields)]
        parents = reversed(_missing_parents(self.log, before))
        move = TreeEdit(op="move", node=edit.node, parent=before.parent, **fields)
        # What an undo brought back has edits of its own, which can be undone.
        bare = [] if edit.undoes is not None else self._left_bare(index, keep=before.parent)
        return [
            *(adding(node, **fields) for node in parents),
            move,
            *(TreeEdit(op="remove", node=node_id, **fields) for node_id in bare),
        ]

    def _left_bare(self, index: int, *, keep: str | None = None) -> list[str]:
        """Return the nodes above one that only came back with it or its like, and are bare without it, bottom up.

        Args:
            index: The edit that is undone, whose node goes.
            keep: A node that must stay, with all nodes above it.
        """
        bare: list[str] = []
        kept = set(self.log.ancestry(keep)) if keep in self.log.nodes else set[str]()
        below = self._edits[index].node
        while (parent := self.log.nodes[below].parent) is not None:
            is_needed = parent in kept or not self.log.has_one_child(parent)
            if is_needed or not self._is_aid(parent, index):
                break
            bare.append(parent)
            below = parent
        return bare

    def _is_aid(self, node_id: str, index: int) -> bool:
        """Return whether a node is only there since a node below it came back, after an edit and with none of its own."""
        added_at = self._added_at[node_id]
        own = self._indices.get(node_id, ())
        if added_at < index or any(added_at < one and one not in self.undone for one in own):
            return False
        if self._in_force(node_id) is None:
            return True
        earlier = self.log.log[added_at].undoes
        return earlier is not None and self.log.log[earlier].node != node_id

    def _op(self, index: int) -> str:
        """Return the kind of an edit; if it only records that another is undone, the kind of that one."""
        edit = self._edits[index]
        while edit.op == "keep" and edit.undoes is not None:
            edit = self._edits[edit.undoes]
        return edit.op

    def _leave_out(self, index: int) -> None:
        """Count an edit as undone."""
        if self._edits[index].undoes is None:
            self.undone.add(index)
        else:
            record = TreeEdit(op="keep", node=self._edits[index].node, undoes=index)
            self.undone = undone_edits([*self._edits, record])

    def _in_force(self, node_id: str) -> Node | None:
        """Return a node as its edits in force made it."""
        node: Node | None = None
        for index in self._indices.get(node_id, ()):
            if index not in self.undone:
                node = edited(self._edits[index], node)
        return node


def _differ(one: Node, other: Node, names: Iterable[str]) -> bool:
    return any(getattr(one, name) != getattr(other, name) for name in names)


def _missing_parents(log: EditLog, node: Node) -> list[Node]:
    """Return the removed ancestors between a node and the tree in their last state, from the bottom up."""
    nodes: list[Node] = []
    seen = {node.id}
    while node.parent is not None and node.parent not in log.nodes:
        parent = log.before_removal(node.parent)
        if parent is None or parent.id in seen:
            raise UsageError(f"{node.id!r} cannot come back: its parents lie below it")
        seen.add(parent.id)
        nodes.append(parent)
        node = parent
    return nodes
