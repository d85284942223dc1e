"""The history of a tree: earlier states, replay and undo."""

from collections.abc import Container, Iterator, Sequence
from typing import TYPE_CHECKING

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
        edit = whole_number("edit", edit, -MOST)
        if not 0 <= edit <= len(edits):
            raise UsageError(f"there is no moment after {edit} edits: the log has {len(edits)}")
        return edit
    if stage is not None:
        last = [index for index, item in enumerate(edits, start=1) if item.stage == stage]
        if not last:
            known = ", ".join(sorted({item.stage for item in edits if item.stage}))
            raise UsageError(f"no edit is of the stage {stage!r} (there are: {known or 'none'})")
        return last[-1]
    return _after_round(edits, whole_number("round", round, -MOST))


def undo(tree: "ScenarioTree", index: int | None = None) -> "ScenarioTree":
    """Undo one edit; see `ScenarioTree.undo`."""
    edits = tree.edits
    if index is None:
        undone = undone_edits(edits)
        standing = (
            index
            for index, edit in reversed(list(enumerate(edits)))
            if edit.undoes is None and index not in undone and _is_effective(edit, tree.by_id)
        )
        index = next(standing, None)
        if index is None:
            raise UsageError("no edit is left to undo")
    index = whole_number("index", index, -MOST)
    if not -len(edits) <= index < len(edits):
        raise UsageError(f"there is no edit {index}: the log has {len(edits)}")
    return tree.apply(*_inverse(tree._edit_log(), index % len(edits)))


def undo_round(tree: "ScenarioTree", round: int, *, origin: str = "") -> "ScenarioTree":
    """Undo the edits of a round that are still in force; see `ScenarioTree.undo`."""
    round = whole_number("round", round, -MOST)
    edits, undone = tree.edits, undone_edits(tree.edits)
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
        others = {edit.origin for edit in edits if edit.round == round and edit.origin != origin}
        known = f" (others have one: {', '.join(sorted(map(repr, others)))})" if others else ""
        of = f" of {origin!r}" if origin else ""
        raise UsageError(f"no edit of round {round}{of} is left to undo{known}")
    return tree.apply(*inverses)


def undone_edits(edits: Sequence[TreeEdit]) -> set[int]:
    """Return the positions of the edits that are currently undone; an undone undo does not count.

    An edit is undone by one of its own node; those of other nodes that an undo needs refer to it, too.
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
    """Return whether an edit can be undone in a tree with some nodes."""
    return (edit.node in nodes) != (edit.op == "remove")


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


def _inverse(log: EditLog, index: int) -> list[TreeEdit]:
    """Return the edits that undo an earlier one in the tree as it is now."""
    edit, before = log.log[index], log.before[index]
    if not _is_effective(edit, log.nodes):
        state = "is there again" if edit.op == "remove" else "is gone"
        raise UsageError(f"edit {index} cannot be undone: its node {edit.node!r} {state}")
    why = {"stage": "undo", "reason": f"takes back edit {index} ({edit.op})", "undoes": index}
    if edit.op == "add":
        return [
            TreeEdit(op="remove", node=node_id, **why)
            for node_id in reversed(log.at_or_below(edit.node))
        ]
    if before is None or edit.op == "keep":
        return [TreeEdit(op="keep", node=edit.node, **why)]
    if edit.op in ("broaden", "narrow"):
        earlier = {"label": before.label, "attested": before.attested}
        return [TreeEdit(op="broaden", node=edit.node, **earlier, **why)]
    missing = _missing_parents(log, before)
    if edit.op == "remove":
        missing.insert(0, before)
    returned = [adding(node, **why) for node in reversed(missing)]
    if edit.op == "move":
        returned.append(TreeEdit(op="move", node=edit.node, parent=before.parent, **why))
    return returned


def _missing_parents(log: EditLog, node: Node) -> list[Node]:
    """Return the removed ancestors between a node and the tree in their last state, from the bottom up."""
    nodes: list[Node] = []
    seen = {node.id}
    while node.parent is not None and node.parent not in log.nodes:
        parent = log.removed(node.parent)
        if parent is None or parent.id in seen:
            raise UsageError(f"{node.id!r} cannot come back: its parents lie below it")
        seen.add(parent.id)
        nodes.append(parent)
        node = parent
    return nodes
