"""Edits of a scenario tree, and its nodes."""

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from oodscen.data._base import Data

Index = Annotated[int, Field(strict=True, ge=0, le=1_000_000_000)]


class TreeEdit(Data):
    """One edit of a tree."""

    op: Literal["add", "broaden", "narrow", "keep", "move", "remove"]
    """`add` a node, `broaden` or `narrow` its label, `keep` it as it is (a recorded decision),
    `move` it with its subtree to another parent, or `remove` it."""
    node: str
    """Id of the edited node; new for `add`."""
    parent: str | None = None
    """`add` and `move`: id of the (new) parent; `None` for the root."""
    label: str | None = None
    """`add`, `broaden` and `narrow`: the new label of the node."""
    attested: Literal["paper"] | None = None
    """`add`, `broaden` and `narrow`: set if the label names a scenario that the paper simulated. A
    broader label keeps the node's attestation, a narrower one does not."""
    stage: str = ""
    """Stage that made the edit: `grow`, `redteam`, `prune`, or a name chosen by the caller."""
    round: Index | None = None
    """Red-team round, if there was one."""
    reason: str = ""
    """Reason, in the words of the model or person that decided."""
    source: str = ""
    """The text that caused the edit."""
    model: str = ""
    """Name of the model that decided; empty if no model was asked."""
    prompt: str = ""
    """The prompt that the model answered: `purpose@version`."""
    origin: str = ""
    """Set by a merge: name of the tree in which the edit was made. Its rounds are counted separately."""
    origin_node: str = ""
    """Set by a merge: id of the node in that tree. The `label` of a `keep` is the node's label there."""
    undoes: Index | None = None
    """Index of the earlier edit that this edit undoes. A `broaden` then restores the attestation as
    well, which otherwise is never removed."""


class Node(Data):
    """One node after all edits."""

    noun: ClassVar[str] = "tree node"

    id: str
    parent: str | None
    label: str
    attested: Literal["paper"] | None = None


def adding(node: Node, **more: Any) -> TreeEdit:
    """Return the edit that adds a node, with further fields of the edit."""
    fields = {"parent": node.parent, "label": node.label, "attested": node.attested, **more}
    return TreeEdit(op="add", node=node.id, **fields)


def added(edit: TreeEdit) -> Node:
    """Return the node that an `add` adds."""
    return Node(id=edit.node, parent=edit.parent, label=edit.label or "", attested=edit.attested)


def edited(edit: TreeEdit, before: Node | None) -> Node | None:
    """Return the node after an edit, given the node before it; `None` if there is none."""
    if edit.op == "add":
        return added(edit)
    if before is None or edit.op == "remove":
        return None
    if edit.op == "move":
        return before.model_copy(update={"parent": edit.parent})
    if edit.op == "keep":
        return before
    attested = edit.attested
    if attested is None and edit.op == "broaden" and edit.undoes is None:
        attested = before.attested
    return before.model_copy(update={"label": edit.label, "attested": attested})
