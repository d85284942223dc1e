"""The index of a scenario tree: the nodes that result from applying edits one after the other."""

import re
import threading
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from oodscen._numbers import said
from oodscen._words.text import whole
from oodscen.errors import Issue
from oodscen.tree._edits import Node, TreeEdit, edited
from oodscen.tree._labels import label_fault

MAX_DEPTH = 50
"""Largest number of edges from the root of a tree to a node."""
_ID = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,63}")
_FIELDS: dict[str, frozenset[str]] = {
    "add": frozenset({"parent", "label", "attested"}),
    "broaden": frozenset({"label", "attested"}),
    "narrow": frozenset({"label", "attested"}),
    "keep": frozenset(),
    "move": frozenset({"parent"}),
    "remove": frozenset(),
}
"""The fields about the node that each kind of edit uses."""
_FREE_TEXTS = ("stage", "reason", "source", "model", "prompt", "origin", "origin_node")
_TOO_DEEP = f"a node would lie more than {MAX_DEPTH} levels below the root: hang it higher up"


class _Fault(NamedTuple):
    """The reason why an edit cannot be applied."""

    text: str
    missing: str | None = None
    """Id of the node that does not exist, if that is the reason."""


class EditLog:
    """The index that all trees of one line of edits share.

    The newest tree is the index as it stands; an older tree is a number of edits. Appending an edit
    therefore takes constant time, and only a branch off an older tree needs a copy.
    """

    def __init__(self) -> None:
        self.log: list[TreeEdit] = []
        self.before: list[Node | None] = []
        """The edited node before each edit; `None` if it did not exist."""
        self.nodes: dict[str, Node] = {}
        self.born: dict[str, int] = {}
        """Index of the first edit that added each id, including removed ones. It determines the order."""
        self._children: dict[str, dict[str, None]] = {}
        self._numbers: dict[str, int] = {}
        self._is_ordered = True
        self._lock = threading.Lock()

    def extend(
        self, version: int, edits: Iterable[TreeEdit], *, where: str = "edits"
    ) -> tuple["EditLog", list[Issue]]:
        """Apply edits on top of the first `version` edits.

        Returns:
            The index with the result (this one, if nothing was added since), and all faults. If
            there is one, no edit is applied.
        """
        with self._lock:
            index = self if version == len(self.log) else self._fork(version)
            issues, refused = [], set[str]()
            for position, edit in enumerate(edits):
                fault = index._fault(edit, version + position)
                if fault is None:
                    index._play(edit)
                    continue
                # An edit that only lacks a refused node has no fault of its own.
                if fault.missing not in refused:
                    issues.append(Issue(f"{where}[{position}]", fault.text))
                if edit.op == "add":
                    refused.add(edit.node)
            if issues:
                index._cut(version)
            return index, issues

    def copy(self, version: int) -> "EditLog":
        """Return a copy of the index of the first `version` edits."""
        with self._lock:
            return self._fork(version)

    def at(self, version: int) -> "EditLog":
        """Return the index of the first `version` edits: this one, or a copy."""
        with self._lock:
            return self if version == len(self.log) else self._fork(version)

    def size(self, version: int) -> int | None:
        """Return the number of nodes after the first `version` edits, or `None` if there are later edits."""
        with self._lock:
            return len(self.nodes) if version == len(self.log) else None

    def ordered(self) -> tuple[Node, ...]:
        """Return all nodes: parents before children, otherwise in the order in which they were first added."""
        with self._lock:
            if not self._is_ordered:
                by_birth = sorted(self.nodes.values(), key=lambda node: self.born[node.id])
                self.nodes = _parents_first(by_birth)
                self._is_ordered = True
            return tuple(self.nodes.values())

    def at_or_below(self, node_id: str) -> list[str]:
        """Return the ids of a node and its descendants, parents first."""
        ids = [node_id]
        for name in ids:
            ids += sorted(self._children.get(name, ()), key=self.born.__getitem__)
        return ids

    def has_one_child(self, node_id: str) -> bool:
        """Return whether exactly one node hangs directly below a node."""
        return len(self._children.get(node_id, ())) == 1

    def before_removal(self, node_id: str) -> Node | None:
        """Return a node as it was before it was last removed."""
        for edit, before in zip(reversed(self.log), reversed(self.before), strict=True):
            if edit.op == "remove" and edit.node == node_id:
                return before
        return None

    def free_id(self, base: str, version: int) -> str:
        """Return an id that none of the first `version` edits has used."""
        with self._lock:
            is_newest = version == len(self.log)
            number = self._numbers.get(base, 1) if is_newest else 1
            candidate = base if number == 1 else f"{base}-{number}"
            while self.born.get(candidate, version) < version:
                number += 1
                candidate = f"{base}-{number}"
            if is_newest:
                self._numbers[base] = number
            return candidate

    def _fork(self, version: int) -> "EditLog":
        """Return a copy of the index of the first `version` edits; the lock must be held."""
        copy = EditLog()
        copy.log, copy.before = self.log.copy(), self.before.copy()
        copy.nodes, copy.born = self.nodes.copy(), self.born.copy()
        copy._children = {key: below.copy() for key, below in self._children.items()}
        copy._is_ordered = self._is_ordered
        copy._cut(version)
        return copy

    def _cut(self, version: int) -> None:
        """Drop all but the first `version` edits."""
        while len(self.log) > version:
            edit, before = self.log.pop(), self.before.pop()
            self._put(edit.node, before)
            if self.born[edit.node] == len(self.log):
                del self.born[edit.node]

    def _play(self, edit: TreeEdit) -> None:
        """Apply an edit that fits."""
        before = self.nodes.get(edit.node)
        self.born.setdefault(edit.node, len(self.log))
        self.log.append(edit)
        self.before.append(before)
        if edit.op != "keep":
            self._put(edit.node, edited(edit, before))

    def _put(self, node_id: str, node: Node | None) -> None:
        """Replace, insert or delete one node."""
        old = self.nodes.get(node_id)
        if old is not None and old.parent is not None:
            del self._children[old.parent][node_id]
        if node is None:
            self.nodes.pop(node_id, None)
            return
        if node.parent is not None:
            self._children.setdefault(node.parent, {})[node_id] = None
        # A re-inserted key comes last, and a moved one may precede its parent.
        is_newest = old is None and self.born[node_id] == len(self.log) - 1
        if not is_newest and (old is None or old.parent != node.parent):
            self._is_ordered = False
        self.nodes[node_id] = node

    def _fault(self, edit: TreeEdit, index: int) -> _Fault | None:
        """Return the first reason why an edit cannot be applied."""
        if field := _unused_field(edit):
            return _Fault(f"a {edit.op!r} edit has no `{field}`")
        for name in _FREE_TEXTS:
            if whole(text := getattr(edit, name)) != text:
                return _Fault(f"`{name}` has a lone surrogate, which is no character")
        if edit.undoes is not None and not 0 <= edit.undoes < index:
            return _Fault(f"it undoes edit {edit.undoes}, which does not come before it")
        if edit.op in ("add", "broaden", "narrow") and (fault := label_fault(edit.label or "")):
            return _Fault(fault)
        if edit.op == "add":
            return self._fault_of_add(edit)
        if edit.node not in self.nodes:
            return _Fault(f"the node {edit.node[:80]!r} does not exist", edit.node)
        if edit.op == "move":
            return self._fault_of_move(edit)
        if edit.op == "remove" and self._children.get(edit.node):
            return _Fault(f"the node {edit.node!r} still has children")
        return None

    def _fault_of_add(self, edit: TreeEdit) -> _Fault | None:
        """Return why a node cannot be added."""
        if not _ID.fullmatch(edit.node):
            rule = "1 to 64 letters, digits, '-', '_' and '.', the first a letter or a digit"
            return _Fault(f"{said(edit.node, 80)} is not a valid id: {rule}")
        if edit.node in self.nodes:
            return _Fault(f"the id {edit.node!r} is taken")
        if edit.parent is None and self.nodes:
            return _Fault(f"{edit.node!r} would be a second root")
        if edit.parent is not None and edit.parent not in self.nodes:
            text = f"the parent {edit.parent[:80]!r} does not exist (before its child)"
            return _Fault(text, edit.parent)
        return _Fault(_TOO_DEEP) if len(self.ancestry(edit.parent)) > MAX_DEPTH else None

    def _fault_of_move(self, edit: TreeEdit) -> _Fault | None:
        """Return why a node cannot be moved."""
        if edit.parent is None:
            return _Fault(f"{edit.node!r} would be a second root")
        if edit.parent not in self.nodes:
            return _Fault(f"the parent {edit.parent[:80]!r} does not exist", edit.parent)
        above = self.ancestry(edit.parent)
        if edit.node in above:
            return _Fault(f"{edit.parent!r} lies at or below {edit.node!r}: that would be a cycle")
        level = [edit.node]
        for _ in range(len(above), MAX_DEPTH + 1):
            level = [child for name in level for child in self._children.get(name, ())]
        return _Fault(_TOO_DEEP) if level else None

    def ancestry(self, node_id: str | None) -> list[str]:
        """Return the ids from a node up to the root."""
        ids = []
        while node_id is not None:
            ids.append(node_id)
            node_id = self.nodes[node_id].parent
        return ids


def _unused_field(edit: TreeEdit) -> str:
    """Return the name of a field about the node that is set, but that this kind of edit does not use; else ""."""
    used = _FIELDS[edit.op]
    if edit.op == "keep" and edit.origin_node:
        used = frozenset({"label"})
    for name in ("parent", "label", "attested"):
        if name not in used and getattr(edit, name) is not None:
            return name
    return ""


def _parents_first(nodes: Sequence[Node]) -> dict[str, Node]:
    """Order the nodes so that parents precede their children; siblings keep their order."""
    ordered: dict[str, Node] = {}
    waiting: dict[str, list[Node]] = {}
    for node in nodes:
        if node.parent is not None and node.parent not in ordered:
            waiting.setdefault(node.parent, []).append(node)
            continue
        ready = [node]
        while ready:
            current = ready.pop()
            ordered[current.id] = current
            ready.extend(reversed(waiting.pop(current.id, ())))
    return ordered
