"""The log of a tree as time: earlier moments, replay, undo."""

from collections.abc import Iterator, Sequence

from oodscen.edits import Node, TreeEdit
from oodscen.errors import UsageError
from oodscen.tree import ScenarioTree


def replay(tree: ScenarioTree) -> Iterator[tuple[TreeEdit, ScenarioTree]]:
    """Yield every edit with the tree after it, from the first on."""
    after = ScenarioTree()
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
    """Return how many edits had been made at a moment; see `ScenarioTree.at`.

    Raises:
        UsageError: When not exactly one is given, or there was no such moment.
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


def undo(tree: ScenarioTree, index: int | None = None) -> ScenarioTree:
    """Take back one edit; see `ScenarioTree.undo`."""
    edits = tree.edits
    if index is None:
        standing = _standing(tree)
        if not standing:
            raise UsageError("no edit is left to be undone")
        index = standing[-1]
    if not -len(edits) <= index < len(edits):
        raise UsageError(f"there is no edit {index}: the log has {len(edits)}")
    index %= len(edits)
    return tree.apply(*_inverse(tree, index))


def undo_round(tree: ScenarioTree, round: int) -> ScenarioTree:
    """Take back what a round did, as far as it still stands; see `ScenarioTree.undo`."""
    edits = tree.edits
    found = [index for index in _standing(tree) if edits[index].round == round]
    if not found:
        raise UsageError(f"no edit of round {round} is left to be undone")
    for index in reversed(found):
        if _is_effective(tree, edits[index]):
            tree = tree.apply(*_inverse(tree, index))
    return tree


def undone_edits(edits: Sequence[TreeEdit]) -> set[int]:
    """Return the positions of the edits that others take back, unless those are taken back too."""
    undone: set[int] = set()
    for index in range(len(edits) - 1, -1, -1):
        takes_back = edits[index].undoes
        if takes_back is not None and index not in undone:
            undone.add(takes_back)
    return undone


def _standing(tree: ScenarioTree) -> list[int]:
    """Return the positions of the edits that can be taken back and were not."""
    undone = undone_edits(tree.edits)
    return [
        index
        for index, edit in enumerate(tree.edits)
        if edit.undoes is None and index not in undone and _is_effective(tree, edit)
    ]


def _is_effective(tree: ScenarioTree, edit: TreeEdit) -> bool:
    return (edit.node in tree.by_id) != (edit.op == "remove")


def _after_round(edits: Sequence[TreeEdit], round: int) -> int:
    """Return the end of a round; where rounds start over, another run begins that is not meant."""
    end = before = None
    for index, item in enumerate(edits, start=1):
        if item.round is None:
            continue
        if item.round > round or (before is not None and item.round < before):
            return index - 1 if end is None else end
        end, before = index, item.round
    return len(edits) if end is None else end


def _inverse(tree: ScenarioTree, index: int) -> list[TreeEdit]:
    edit, before = tree.edits[index], tree.before(index)
    if not _is_effective(tree, edit):
        state = "is there again" if edit.op == "remove" else "is gone"
        raise UsageError(f"edit {index} cannot be undone: its node {edit.node!r} {state}")
    why = {"stage": "undo", "reason": f"takes back edit {index} ({edit.op})", "undoes": index}
    if edit.op == "add":
        return [
            TreeEdit(op="remove", node=node_id, **why)
            for node_id in reversed(_at_or_below(tree, edit.node))
        ]
    if before is None or edit.op == "keep":
        return [TreeEdit(op="keep", node=edit.node, **why)]
    if edit.op in ("broaden", "narrow"):
        return [
            TreeEdit(
                op="broaden", node=edit.node, label=before.label, attested=before.attested, **why
            )
        ]
    missing = _missing_parents(tree, before)
    if edit.op == "remove":
        missing.insert(0, before)
    returned = [
        TreeEdit(
            op="add",
            node=node.id,
            parent=node.parent,
            label=node.label,
            attested=node.attested,
            **why,
        )
        for node in reversed(missing)
    ]
    if edit.op == "move":
        returned.append(TreeEdit(op="move", node=edit.node, parent=before.parent, **why))
    return returned


def _at_or_below(tree: ScenarioTree, node_id: str) -> list[str]:
    found = [node_id]
    for current in found:
        found += tree.children[current]
    return found


def _missing_parents(tree: ScenarioTree, node: Node) -> list[Node]:
    """Return the removed nodes between a node and the tree, as they last were, upwards."""
    found: list[Node] = []
    removed: dict[str, int] = {}
    seen = {node.id}
    while node.parent is not None and node.parent not in tree.by_id:
        if not removed:
            removed = {
                item.node: index for index, item in enumerate(tree.edits) if item.op == "remove"
            }
        parent = tree.before(removed[node.parent])
        if parent is None or parent.id in seen:
            raise UsageError(f"{node.id!r} cannot come back: its parents lie below it")
        seen.add(parent.id)
        found.append(parent)
        node = parent
    return found
