"""The scenario tree: an immutable taxonomy, defined as the fold of its log of edits."""

import re
import unicodedata
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from typing import ClassVar, Literal, Self

from pydantic import model_validator

from oodscen._data import Data, Faults
from oodscen.errors import DataError, Issue

ROOT = "root"
"""Id of the root of every tree."""

CLASSES = ("Environmental", "Interactional")
"""Labels of the two classes of OOD scenarios (paper, section III-A)."""

MAX_LABEL = 200
"""Longest label, in characters."""


class TreeEdit(Data):
    """One step in the making of a tree."""

    noun: ClassVar[str] = "tree edit"

    op: Literal["add", "broaden", "keep", "move", "remove"]
    """`add` a node, `broaden` its label, `keep` it as it is (a recorded decision), `move` it with
    all below it under another parent, `remove` it."""
    node: str
    """Id of the node concerned; new for `add`."""
    parent: str | None = None
    """`add` and `move`: id of the (new) parent; `None` for the root."""
    label: str | None = None
    """`add` and `broaden`: the label the node has from here on."""
    attested: Literal["paper"] | None = None
    """`add` and `broaden`: set where the label names a scenario that the paper simulated."""
    stage: str = ""
    """Who made the edit: `grow`, `redteam`, `prune`, or a name of the caller's."""
    round: int | None = None
    """Red-team round, where there was one."""
    reason: str = ""
    """Why, in the words of whoever decided."""
    source: str = ""
    """The text that caused the edit."""
    model: str = ""
    """Name of the model that decided; empty where none was asked."""
    prompt: str = ""
    """The question it was asked: `purpose@version`."""


class Node(Data):
    """One node as it stands after all edits."""

    noun: ClassVar[str] = "tree node"

    id: str
    parent: str | None
    label: str
    attested: Literal["paper"] | None = None


class ScenarioTree(Data):
    """A taxonomy of OOD scenarios: root, classes, families, leaves.

    Each root-to-leaf path is one distinct kind of OOD scenario (paper, section III-A). The tree is
    a value: every operation returns a new tree, and `edits` is the whole history.
    """

    noun: ClassVar[str] = "scenario tree"

    schema_version: Literal[1] = 1
    nodes: tuple[Node, ...] = ()
    """All nodes, parents before children, in the order in which they were added."""
    edits: tuple[TreeEdit, ...] = ()
    """The log whose fold is `nodes`. A file without it is read as one `add` per node."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.nodes and not self.edits:
            issues, folded = _fold([_planting(node) for node in self.nodes], where="nodes")
        else:
            issues, folded = _fold(self.edits)
            if self.nodes and not issues and tuple(folded.values()) != self.nodes:
                issues.append(Issue("nodes", "do not follow from the edits"))
        if issues:
            raise Faults(issues)
        if not self.edits:
            object.__setattr__(self, "edits", tuple(map(_planting, self.nodes)))
        if not self.nodes:
            object.__setattr__(self, "nodes", tuple(folded.values()))
        return self

    @classmethod
    def planted(cls, label: str = "Out-of-distribution driving scenario") -> Self:
        """Return a tree of one root and the two classes."""
        edits = [TreeEdit(op="add", node=ROOT, label=label, stage="grow")]
        edits += [
            TreeEdit(op="add", node=slug(name), parent=ROOT, label=name, stage="grow")
            for name in CLASSES
        ]
        return cls(edits=tuple(edits))

    def apply(self, *edits: TreeEdit) -> "ScenarioTree":
        """Return the tree after further edits.

        Raises:
            DataError: When an edit does not fit (unknown node, taken id, empty label ...); this
                tree is unchanged in any case.
        """
        issues, folded = _fold(edits, start=self.by_id)
        if issues:
            raise DataError("tree edit", issues)
        return ScenarioTree.model_construct(
            schema_version=1, nodes=tuple(folded.values()), edits=(*self.edits, *edits)
        )

    @cached_property
    def by_id(self) -> dict[str, Node]:
        """Nodes by id, in order."""
        return {node.id: node for node in self.nodes}

    @cached_property
    def children(self) -> dict[str, tuple[str, ...]]:
        """Ids of the children of every node, in order."""
        found: dict[str, list[str]] = {node.id: [] for node in self.nodes}
        for node in self.nodes:
            if node.parent is not None:
                found[node.parent].append(node.id)
        return {key: tuple(value) for key, value in found.items()}

    @property
    def leaves(self) -> tuple[Node, ...]:
        """Nodes without children that lie below a class, in tree order."""
        return tuple(
            node for node, depth in self.walk() if not self.children[node.id] and depth >= 2
        )

    def path(self, node_id: str) -> tuple[str, ...]:
        """Return the labels from the root down to a node."""
        labels = []
        cursor: str | None = node_id
        while cursor is not None:
            node = self.by_id[cursor]
            labels.append(node.label)
            cursor = node.parent
        return tuple(reversed(labels))

    @property
    def paths(self) -> dict[str, tuple[str, ...]]:
        """Labels from the root down, by id of the leaf."""
        found = {}
        labels: list[str] = []
        for node, depth in self.walk():
            del labels[depth:]
            labels.append(node.label)
            if depth >= 2 and not self.children[node.id]:
                found[node.id] = tuple(labels)
        return found

    def walk(self) -> Iterator[tuple[Node, int]]:
        """Yield every node with its depth, parents first, siblings in order."""
        stack = [(node.id, 0) for node in self.nodes if node.parent is None]
        while stack:
            node_id, depth = stack.pop()
            yield self.by_id[node_id], depth
            stack.extend((child, depth + 1) for child in reversed(self.children[node_id]))

    @property
    def depth(self) -> int:
        """Number of edges from the root to the deepest node."""
        return max((depth for _, depth in self.walk()), default=0)

    def __len__(self) -> int:
        return len(self.nodes)

    def outline(self, *, ids: bool = False) -> str:
        """Render the tree as an indented list, for people and for prompts."""
        return "\n".join(
            f"{'  ' * depth}- {node.label}{f' [{node.id}]' if ids else ''}"
            for node, depth in self.walk()
        )

    def new_id(self, label: str) -> str:
        """Return an id for a new node: the label's slug, numbered where it is taken.

        Ids of removed nodes are taken for good.
        """
        used = {edit.node for edit in self.edits}
        base = slug(label)
        candidate, number = base, 2
        while candidate in used:
            candidate, number = f"{base}-{number}", number + 1
        return candidate


def slug(label: str) -> str:
    """Turn a label into an id that is safe in file names and URLs (at most 48 characters)."""
    plain = unicodedata.normalize("NFKD", label).encode("ascii", "ignore").decode().lower()
    return re.sub(r"[^a-z0-9]+", "-", plain)[:48].strip("-") or "node"


def label_fault(label: str) -> str:
    """Say why a text cannot be a label, or return an empty string."""
    if not label.strip():
        return "the label is empty"
    if len(label) > MAX_LABEL:
        return f"the label has {len(label)} characters, at most {MAX_LABEL} are allowed"
    if any(unicodedata.category(char) in ("Cc", "Zl", "Zp") for char in label):
        return "the label contains line breaks or control characters"
    return ""


def _planting(node: Node) -> TreeEdit:
    """Return the edit that adds a node read from a file without a log."""
    return TreeEdit(
        op="add",
        node=node.id,
        parent=node.parent,
        label=node.label,
        attested=node.attested,
        stage="file",
    )


def _fold(
    edits: Iterable[TreeEdit], start: Mapping[str, Node] | None = None, *, where: str = "edits"
) -> tuple[list[Issue], dict[str, Node]]:
    """Play edits on top of some nodes; collect every misfit instead of stopping at the first."""
    nodes = dict(start or {})
    degree: dict[str, int] = {}
    for node in nodes.values():
        if node.parent is not None:
            degree[node.parent] = degree.get(node.parent, 0) + 1
    issues: list[Issue] = []
    for index, edit in enumerate(edits):
        message = _misfit(edit, nodes, degree)
        if message:
            issues.append(Issue(f"{where}[{index}]", message))
            continue
        if edit.op == "add":
            nodes[edit.node] = Node(
                id=edit.node, parent=edit.parent, label=edit.label or "", attested=edit.attested
            )
            if edit.parent is not None:
                degree[edit.parent] = degree.get(edit.parent, 0) + 1
        elif edit.op == "broaden":
            nodes[edit.node] = nodes[edit.node].model_copy(
                update={"label": edit.label, "attested": edit.attested or nodes[edit.node].attested}
            )
        elif edit.op == "remove":
            parent = nodes.pop(edit.node).parent
            if parent is not None:
                degree[parent] -= 1
        elif edit.op == "move" and edit.parent is not None:
            before = nodes[edit.node].parent
            if before is not None:
                degree[before] -= 1
            degree[edit.parent] = degree.get(edit.parent, 0) + 1
            nodes[edit.node] = nodes[edit.node].model_copy(update={"parent": edit.parent})
    return issues, _ordered(nodes)


def _ordered(nodes: dict[str, Node]) -> dict[str, Node]:
    """Put parents before children, and otherwise leave the order as it is."""
    found: dict[str, Node] = {}
    waiting: dict[str, list[Node]] = {}
    for node in nodes.values():
        if node.parent is not None and node.parent not in found:
            waiting.setdefault(node.parent, []).append(node)
            continue
        ready = [node]
        while ready:
            found[ready[-1].id] = last = ready.pop()
            ready.extend(reversed(waiting.pop(last.id, ())))
    return found


def _misfit(edit: TreeEdit, nodes: Mapping[str, Node], degree: Mapping[str, int]) -> str:
    """Say why an edit cannot be applied, or return an empty string."""
    if edit.op in ("add", "broaden") and (fault := label_fault(edit.label or "")):
        return fault
    if edit.op == "add":
        if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,63}", edit.node):
            return f"{edit.node!r} is not a valid id (letters, digits, '-', '_', '.')"
        if edit.node in nodes:
            return f"the id {edit.node!r} is taken"
        if edit.parent is None and nodes:
            return f"{edit.node!r} would be a second root"
        if edit.parent is not None and edit.parent not in nodes:
            return f"the parent {edit.parent!r} does not exist (before its child)"
    elif edit.node not in nodes:
        return f"the node {edit.node!r} does not exist"
    elif edit.op == "move":
        if edit.parent is None or edit.parent not in nodes:
            return f"the parent {edit.parent!r} does not exist"
        cursor: str | None = edit.parent
        while cursor is not None:
            if cursor == edit.node:
                return f"{edit.parent!r} lies at or below {edit.node!r}: that would be a cycle"
            cursor = nodes[cursor].parent
    elif edit.op == "remove" and degree.get(edit.node, 0):
        return f"the node {edit.node!r} still has children"
    return ""
