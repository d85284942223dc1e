"""Provenance of nodes: who added a node and why, and later decisions about it."""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from oodscen._words.text import printable
from oodscen.data._base import Data
from oodscen.errors import UnknownComponent
from oodscen.tree._edits import TreeEdit
from oodscen.tree._history import undone_edits

if TYPE_CHECKING:
    from oodscen.tree._scenario_tree import ScenarioTree

_VERBS: Mapping[str, str] = {
    "add": "added",
    "broaden": "broadened",
    "narrow": "narrowed",
    "keep": "kept",
    "move": "moved",
    "remove": "removed",
}


class Decision(Data):
    """One edit of a node."""

    index: int
    """Position of the edit in the tree's log."""
    edit: TreeEdit
    label_before: str = ""
    """Label of the node before the edit; empty if the node did not exist."""
    is_undone: bool = False
    """True if a later edit undid this one."""

    def __str__(self) -> str:
        edit = self.edit
        action = _VERBS[edit.op] if edit.undoes is None else f"undid edit {edit.undoes}"
        if edit.op in ("broaden", "narrow"):
            action += f" from “{self.label_before}” to “{edit.label}”"
        elif edit.op == "move":
            action += f" below {edit.parent}"
        when = "" if edit.round is None else f"round {edit.round}"
        if edit.origin:
            when = f"{when} of {edit.origin}" if when else edit.origin
        author = ", ".join(filter(None, (edit.stage, when, edit.model)))
        line = f"{self.index}: {action} by {author or 'nobody named'}"
        line += f" ({edit.prompt})" if edit.prompt else ""
        line += f": {edit.reason}" if edit.reason else ""
        line += f" [because of: {edit.source}]" if edit.source else ""
        return printable(" ".join(line.split())) + (" (undone)" if self.is_undone else "")


class Provenance(Data):
    """The history of one node."""

    node: str
    """Id of the node."""
    path: tuple[str, ...]
    """Labels from the root down; empty for a removed node."""
    origin: Decision
    """The edit that first added the node."""
    later: tuple[Decision, ...] = ()
    """All later edits of the node, in order."""

    @property
    def is_present(self) -> bool:
        """True if the node is in the tree."""
        return bool(self.path)

    @property
    def stage(self) -> str:
        """The stage that added the node."""
        return self.origin.edit.stage

    @property
    def model(self) -> str:
        """The model that added the node."""
        return self.origin.edit.model

    @property
    def prompt(self) -> str:
        """The prompt that the model answered: `purpose@version`."""
        return self.origin.edit.prompt

    @property
    def round(self) -> int | None:
        """The red-team round that added the node."""
        return self.origin.edit.round

    @property
    def source(self) -> str:
        """The text that caused the node to be added."""
        return self.origin.edit.source

    @property
    def reason(self) -> str:
        """The reason for adding the node."""
        return self.origin.edit.reason

    def __str__(self) -> str:
        head = " > ".join(self.path) if self.path else f"{self.node} (gone)"
        return "\n".join([head, *(f"  {decision}" for decision in (self.origin, *self.later))])


def provenance(tree: "ScenarioTree", node_id: str) -> Provenance:
    """Return the history of one node, which may have been removed.

    Raises:
        UnknownComponent: If there never was such a node.
    """
    histories = provenances(tree, [node_id])
    if node_id not in histories:
        raise UnknownComponent("node", node_id, {edit.node for edit in tree.edits})
    return histories[node_id]


def provenances(tree: "ScenarioTree", node_ids: Iterable[str]) -> dict[str, Provenance]:
    """Return the histories of several nodes in one pass over the log."""
    wanted = set(node_ids)
    edits = tree.edits
    undone = undone_edits(edits)
    by_node: dict[str, list[Decision]] = {}
    for index, edit in enumerate(edits):
        if edit.node in wanted:
            before = tree.before(index)
            by_node.setdefault(edit.node, []).append(
                Decision(
                    index=index,
                    edit=edit,
                    label_before=before.label if before else "",
                    is_undone=index in undone,
                )
            )
    return {
        node_id: Provenance(
            node=node_id,
            path=tree.path(node_id) if node_id in tree.by_id else (),
            origin=decisions[0],
            later=tuple(decisions[1:]),
        )
        for node_id, decisions in by_node.items()
    }


def origin_words(tree: "ScenarioTree") -> dict[str, str]:
    """Describe briefly which nodes were added in a round of red teaming, and which were broadened."""
    additions: dict[str, TreeEdit] = {}
    broadenings: dict[str, list[TreeEdit]] = {}
    undone = undone_edits(tree.edits)
    for index, edit in enumerate(tree.edits):
        if index in undone or edit.undoes is not None:
            continue
        if edit.op == "add":  # The id may be that of a removed node, whose history is another's.
            additions[edit.node], broadenings[edit.node] = edit, []
        elif edit.op == "broaden" and edit.node in additions:
            broadenings[edit.node].append(edit)
    words: dict[str, str] = {}
    for node_id, addition in additions.items():
        parts = []
        if addition.round is not None:
            of_tree = f" of {addition.origin}" if addition.origin else ""
            parts.append(f"new in round {addition.round}{of_tree}")
        if broadenings[node_id]:
            rounds = [str(edit.round) for edit in broadenings[node_id] if edit.round is not None]
            in_rounds = f" in round{'s' if len(rounds) > 1 else ''} {', '.join(rounds)}"
            parts.append(f"broadened{in_rounds if rounds else ''}, at first “{addition.label}”")
        if parts:
            words[node_id] = ", ".join(parts)
    return words
