"""The history of a tree: earlier states, replay and undo."""

from collections.abc import Container, Iterator, Sequence
from functools import cached_property
from typing import TYPE_CHECKING

from oodscen.errors import UsageError
from oodscen.tree._edit_log import Node, TreeEdit, added, adding

if TYPE_CHECKING:
    from oodscen.tree._scenario_tree import ScenarioTree


def replay(tree: "ScenarioTree") -> Iterator[tuple[TreeEdit, "ScenarioTree"]]:
    """Yield every edit with the tree after it, starting with the first."""
    after = type(tree)()
    for edit in tree.edits:
        after = after.apply(edit)
        yield edit, after


def moment(
    edits: Sequence[TreeEdit],
    *,
    edit: int | None = None,
    round: int | None = None,
    stage: str | None = None,
) -> int:
    """Return the number of edits made up to a moment; see `ScenarioTree.at`.

    Raises:
        UsageError: If not exactly one argument is given, or there was no such moment.
    """
    if sum(choice is not None for choice in (edit, round, stage)) != 1:
        raise UsageError("a moment is given by one of edit, round and stage")
    if edit is not None:
        if not 0 <= edit <= len(edits):
            raise UsageError(f"there is no moment after {edit} edits: the log has {len(edits)}")
        return edit
    if stage is not None:
        last = [index for index, item in enumerate(edits, start=1) if item.stage == stage]
        if not last:
            known = ", ".join(sorted({item.stage for item in edits if item.stage}))
            raise UsageError(f"no edit is of the stage {stage!r} (there are: {known or 'none'})")
        return last[-1]
    return _after_round(edits, round or 0)


def undo(tree: "ScenarioTree", index: int | None = None) -> "ScenarioTree":
    """Undo one edit; see `ScenarioTree.undo`."""
    edits = tree.edits
    if index is None:
        standing = _standing(tree)
        if not standing:
            raise UsageError("no edit is left to be undone")
        index = standing[-1]
    if not -len(edits) <= index < len(edits):
        raise UsageError(f"there is no edit {index}: the log has {len(edits)}")
    index %= len(edits)
    return tree.apply(*_inverse(tree, _Now(tree), index))


def undo_round(tree: "ScenarioTree", round: int, *, origin: str = "") -> "ScenarioTree":
    """Undo the edits of a round that are still in force; see `ScenarioTree.undo`."""
    edits, undone = tree.edits, undone_edits(tree.edits)
    now = _Now(tree)
    inverses: list[TreeEdit] = []
    for index in range(len(edits) - 1, -1, -1):
        edit = edits[index]
        is_meant = edit.round == round and edit.origin == origin and edit.undoes is None
        # A removal by another edit of the round can only be undone after that edit.
        if is_meant and index not in undone and now.is_effective(edit):
            some = _inverse(tree, now, index)
            for step in some:
                now.play(step)
            inverses += some
    if not inverses:
        others = {edit.origin for edit in edits if edit.round == round and edit.origin != origin}
        known = f" (others have one: {', '.join(sorted(map(repr, others)))})" if others else ""
        of = f" of {origin!r}" if origin else ""
        raise UsageError(f"no edit of round {round}{of} is left to be undone{known}")
    return tree.apply(*inverses)


def undone_edits(edits: Sequence[TreeEdit]) -> set[int]:
    """Return the positions of the edits that are currently undone; an undone undo does not count."""
    undone: set[int] = set()
    for index in range(len(edits) - 1, -1, -1):
        takes_back = edits[index].undoes
        if takes_back is not None and index not in undone:
            undone.add(takes_back)
    return undone


def _standing(tree: "ScenarioTree") -> list[int]:
    """Return the positions of the edits that can be undone and have not been."""
    undone = undone_edits(tree.edits)
    return [
        index
        for index, edit in enumerate(tree.edits)
        if edit.undoes is None and index not in undone and _is_effective(edit, tree.by_id)
    ]


def _is_effective(edit: TreeEdit, nodes: Container[str]) -> bool:
    return (edit.node in nodes) != (edit.op == "remove")


class _Now:
    """The working state while edits are undone: each step costs what it changes, not the tree's size."""

    def __init__(self, tree: "ScenarioTree") -> None:
        self.nodes: dict[str, Node] = dict(tree.by_id)
        self._tree = tree
        self._children: dict[str, dict[str, None]] = {}
        """Children of the nodes visited so far."""
        self._gone: dict[str, Node | None] = {}

    def is_effective(self, edit: TreeEdit) -> bool:
        """Return whether an edit has a visible effect."""
        return _is_effective(edit, self.nodes)

    def at_or_below(self, node_id: str) -> list[str]:
        """Return a node and its descendants, parents first."""
        found = {node_id: None}
        order = [node_id]
        for current in order:
            for child in self._below(current):
                if child not in found:
                    found[child] = None
                    order.append(child)
        return order

    def removed(self, node_id: str) -> Node | None:
        """Return a removed node in its last state."""
        return self._gone[node_id] if node_id in self._gone else self._removed.get(node_id)

    @cached_property
    def _removed(self) -> dict[str, Node | None]:
        """Removed nodes by id, each in its last state."""
        return {
            edit.node: self._tree.before(index)
            for index, edit in enumerate(self._tree.edits)
            if edit.op == "remove"
        }

    def _below(self, node_id: str) -> dict[str, None]:
        if node_id not in self._children:
            self._children[node_id] = dict.fromkeys(self._tree.children.get(node_id, ()))
        return self._children[node_id]

    def play(self, edit: TreeEdit) -> None:
        """Apply an undoing edit without checking that it fits."""
        old = self.nodes.get(edit.node)
        if edit.op == "remove":
            self._gone[edit.node] = old
            self._hang(old, None)
        elif edit.op == "add":
            self._hang(old, added(edit))
        elif edit.op == "move" and old is not None:
            self._hang(old, old.model_copy(update={"parent": edit.parent}))
        elif edit.op == "broaden" and old is not None:
            update = {"label": edit.label, "attested": edit.attested}
            self.nodes[edit.node] = old.model_copy(update=update)

    def _hang(self, old: Node | None, new: Node | None) -> None:
        if old is not None:
            self.nodes.pop(old.id)
            self._below(old.parent or "").pop(old.id, None)
        if new is not None:
            self.nodes[new.id] = new
            self._below(new.parent or "")[new.id] = None


def _after_round(edits: Sequence[TreeEdit], round: int) -> int:
    """Return the end of a round; a later run that restarts the numbering is not included."""
    end = before = None
    for index, item in enumerate(edits, start=1):
        if item.origin:
            return index - 1 if end is None else end
        if item.round is None:
            continue
        if item.round > round or (before is not None and item.round < before):
            return index - 1 if end is None else end
        end, before = index, item.round
    return len(edits) if end is None else end


def _inverse(tree: "ScenarioTree", now: _Now, index: int) -> list[TreeEdit]:
    edit, before = tree.edits[index], tree.before(index)
    if not now.is_effective(edit):
        state = "is there again" if edit.op == "remove" else "is gone"
        raise UsageError(f"edit {index} cannot be undone: its node {edit.node!r} {state}")
    why = {"stage": "undo", "reason": f"takes back edit {index} ({edit.op})", "undoes": index}
    if edit.op == "add":
        return [
            TreeEdit(op="remove", node=node_id, **why)
            for node_id in reversed(now.at_or_below(edit.node))
        ]
    if before is None or edit.op == "keep":
        return [TreeEdit(op="keep", node=edit.node, **why)]
    if edit.op in ("broaden", "narrow"):
        return [
            TreeEdit(
                op="broaden", node=edit.node, label=before.label, attested=before.attested, **why
            )
        ]
    missing = _missing_parents(now, before)
    if edit.op == "remove":
        missing.insert(0, before)
    returned = [adding(node, **why) for node in reversed(missing)]
    if edit.op == "move":
        returned.append(TreeEdit(op="move", node=edit.node, parent=before.parent, **why))
    return returned


def _missing_parents(now: _Now, node: Node) -> list[Node]:
    """Return the removed ancestors between a node and the tree in their last state, from the bottom up."""
    found: list[Node] = []
    seen = {node.id}
    while node.parent is not None and node.parent not in now.nodes:
        parent = now.removed(node.parent)
        if parent is None or parent.id in seen:
            raise UsageError(f"{node.id!r} cannot come back: its parents lie below it")
        seen.add(parent.id)
        found.append(parent)
        node = parent
    return found
