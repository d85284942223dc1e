"""The history of a tree: earlier states, replay and undo."""

from collections.abc import Container, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from oodscen._numbers import MOST, whole_number
from oodscen.errors import UsageError
from oodscen.tree._edit_log import EditLog
from oodscen.tree._edits import Node, TreeEdit, adding

if TYPE_CHECKING:
    from oodscen.tree._scenario_tree import ScenarioTree


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
        edit = whole_number("edit", edit, -MOST)
        if not 0 <= edit <= len(edits):
            raise UsageError(f"there is no moment after {edit} edits: the log has {len(edits)}")
        return edit
    if stage is not None:
        versions = [version for version, item in enumerate(edits, start=1) if item.stage == stage]
        if not versions:
            stages = ", ".join(sorted({item.stage for item in edits if item.stage}))
            raise UsageError(f"no edit is of the stage {stage!r} (there are: {stages or 'none'})")
        return versions[-1]
    return _version_after_round(edits, whole_number("round", round, -MOST))


def undo(tree: "ScenarioTree", index: int | None = None) -> "ScenarioTree":
    """Undo one edit; see `ScenarioTree.undo`."""
    size = len(tree.edits)
    index = _last_in_force(tree) if index is None else whole_number("index", index, -MOST)
    if not -size <= index < size:
        raise UsageError(f"there is no edit {index}: the log has {size}")
    return tree.apply(*_inverse(tree._edit_log(), index % size))


def _last_in_force(tree: "ScenarioTree") -> int:
    """Return the index of the last edit that neither undoes another nor is undone itself."""
    undone = undone_edits(tree.edits)
    for index, edit in reversed(list(enumerate(tree.edits))):
        if edit.undoes is None and index not in undone and _is_effective(edit, tree.by_id):
            return index
    raise UsageError("no edit is left to undo")


def undo_round(tree: "ScenarioTree", round: int, *, origin: str = "") -> "ScenarioTree":
    """Undo the edits of a round that are still in force; see `ScenarioTree.undo`."""
    round = whole_number("round", round, -MOST)
    edits = tree.edits
    undone = undone_edits(edits)
    log = tree._edit_log()
    inverses: list[TreeEdit] = []
    for index, edit in reversed(list(enumerate(edits))):
        is_meant = edit.round == round and edit.origin == origin and edit.undoes is None
        # A removal by another edit of the round can only be undone after that edit.
        if is_meant and index not in undone and _is_effective(edit, log.nodes):
            steps = _inverse(log, index)
            log.extend(len(log.log), steps)
            inverses += steps
    if not inverses:
        message = f"no edit of round {round}"
        if origin:
            message += f" of {origin!r}"
        message += " is left to undo"
        others = {edit.origin for edit in edits if edit.round == round and edit.origin != origin}
        if others:
            message += f" (others have one: {', '.join(sorted(map(repr, others)))})"
        raise UsageError(message)
    return tree.apply(*inverses)


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


def _is_effective(edit: TreeEdit, nodes: Container[str]) -> bool:
    """Return whether the effect of an edit is still there in a tree: its node, or for a removal the lack of it."""
    return (edit.node in nodes) != (edit.op == "remove")


def _version_after_round(edits: Sequence[TreeEdit], round: int) -> int:
    """Return the number of edits up to the end of a round, but not those of a run that restarts the numbering.

    If no edit is of that round or an earlier one, the edits up to the first later round or merge count.
    """
    end: int | None = None
    last_round: int | None = None
    for index, edit in enumerate(edits):
        is_restart = last_round is not None and edit.round is not None and edit.round < last_round
        is_later = edit.round is not None and edit.round > round
        if edit.origin or is_restart or is_later:
            return index if end is None else end
        if edit.round is not None:
            end, last_round = index + 1, edit.round
    return len(edits) if end is None else end


def _inverse(log: EditLog, index: int) -> list[TreeEdit]:
    """Return the edits that undo an earlier one in the tree as it is now."""
    edit, before = log.log[index], log.before[index]
    if not _is_effective(edit, log.nodes):
        state = "is there again" if edit.op == "remove" else "is gone"
        raise UsageError(f"edit {index} cannot be undone: its node {edit.node!r} {state}")
    fields: dict[str, Any] = {
        "stage": "undo",
        "reason": f"takes back edit {index} ({edit.op})",
        "undoes": index,
    }
    if edit.op == "add":
        return [
            TreeEdit(op="remove", node=node_id, **fields)
            for node_id in reversed(log.at_or_below(edit.node))
        ]
    if before is None or edit.op == "keep":
        return [TreeEdit(op="keep", node=edit.node, **fields)]
    if edit.op in ("broaden", "narrow"):
        fields |= {"label": before.label, "attested": before.attested}
        return [TreeEdit(op="broaden", node=edit.node, **fields)]
    missing = _missing_parents(log, before)
    if edit.op == "remove":
        missing.insert(0, before)
    edits = [adding(node, **fields) for node in reversed(missing)]
    if edit.op == "move":
        edits.append(TreeEdit(op="move", node=edit.node, parent=before.parent, **fields))
    return edits


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
