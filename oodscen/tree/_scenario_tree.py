"""The scenario tree: an immutable taxonomy, defined by its edit log."""

from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

from pydantic import SerializerFunctionWrapHandler, model_serializer, model_validator

from oodscen.data._base import Data, Faults
from oodscen.errors import DataError, Issue, UnknownComponent, UsageError
from oodscen.tree._edit_log import Growth, Node, TreeEdit, slug
from oodscen.tree._labels import MAX_LABEL, label_fault

if TYPE_CHECKING:
    from oodscen.tree._provenance import Provenance

__all__ = [
    "CLASSES",
    "MAX_LABEL",
    "ROOT",
    "Node",
    "ScenarioTree",
    "TreeEdit",
    "label_fault",
    "slug",
]

ROOT = "root"
"""Id of the root of every tree."""

CLASSES = ("Environmental", "Interactional")
"""Labels of the two classes of OOD scenarios (paper, section III-A)."""


class ScenarioTree(Data):
    """A taxonomy of OOD scenarios: root, classes, families, leaves.

    Each root-to-leaf path is one distinct kind of OOD scenario (paper, section III-A). The tree is
    a value: every operation returns a new tree, and `edits` is the whole history. Operations on one
    edit take the same time on a tree of any size; `nodes` and `edits` are built on first access. A
    tree is a collection of its nodes: `len`, iteration and `in` are those of `nodes`.
    """

    noun: ClassVar[str] = "scenario tree"

    schema_version: Literal[1] = 1
    nodes: tuple[Node, ...] = ()
    """All nodes, parents before children, otherwise in the order in which they were first added."""
    edits: tuple[TreeEdit, ...] = ()
    """The log that produces `nodes`. A file without a log is read as one `add` per node."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        is_bare = bool(self.nodes) and not self.edits
        edits = tuple(map(_planting, self.nodes)) if is_bare else self.edits
        growth, issues = Growth().extend(0, edits, where="nodes" if is_bare else "edits")
        if not issues and self.nodes and growth.ordered() != self.nodes:
            issues.append(Issue("nodes", "do not follow from the edits"))
        if issues:
            raise Faults(issues)
        self.__dict__.update(nodes=growth.ordered(), edits=edits, _line=(growth, len(edits)))
        return self

    @classmethod
    def planted(cls, label: str = "Out-of-distribution driving scenario") -> Self:
        """Return a tree with a root and the two classes."""
        edits = [TreeEdit(op="add", node=ROOT, label=label, stage="grow")]
        edits += [
            TreeEdit(op="add", node=slug(name), parent=ROOT, label=name, stage="grow")
            for name in CLASSES
        ]
        return cls(edits=tuple(edits))

    # ------------------------------------------------------------------ change

    def apply(self, *edits: TreeEdit) -> "ScenarioTree":
        """Return the tree after further edits.

        Raises:
            DataError: If an edit does not fit (unknown node, taken id, empty label ...). This tree
                never changes.
        """
        growth, version = self._line
        growth, issues = growth.extend(version, edits)
        if issues:
            raise DataError("tree edit", issues)
        return _standing(growth, version + len(edits))

    def undo(
        self, index: int | None = None, *, round: int | None = None, origin: str = ""
    ) -> "ScenarioTree":
        """Return the tree with an earlier edit undone, by appending edits to its log.

        Undoing an `add` also removes the nodes that were later added below it; undoing a `remove`
        also restores parents that were removed later. An undoing edit can be undone like any other.

        Args:
            index: Position in `edits`, from the end if negative; the last edit in force if left
                out.
            round: Undo every edit of this round instead, the last one first.
            origin: With `round`: name of the merged tree to which the round belongs; this tree's
                own rounds if empty.

        Raises:
            UsageError: If there is no such edit, or it cannot be undone in the current tree (its
                node is gone, or it would create a cycle).
        """
        from oodscen.tree._history import undo, undo_round

        if round is not None and index is not None:
            raise UsageError("undo takes the index of an edit or a round, not both")
        if round is None and origin:
            raise UsageError("an origin goes with a round")
        return undo(self, index) if round is None else undo_round(self, round, origin=origin)

    # ----------------------------------------------------------------- history

    def at(
        self, *, edit: int | None = None, round: int | None = None, stage: str | None = None
    ) -> "ScenarioTree":
        """Return the tree as it stood at an earlier time.

        Args:
            edit: After this many edits.
            round: After this red-team round, and before the first edit of a later one or of a
                merge; 0 is the tree before red teaming.
            stage: After the last edit of this stage.

        Raises:
            UsageError: If not exactly one argument is given, or there was no such moment.
        """
        from oodscen.tree._history import moment

        return _standing(self._line[0], moment(self.edits, edit=edit, round=round, stage=stage))

    def provenance(self, node_id: str) -> "Provenance":
        """Return who added a node and why, and the later decisions about it.

        Raises:
            UnknownComponent: If there never was such a node.
        """
        from oodscen.tree._provenance import provenance

        return provenance(self, node_id)

    def before(self, index: int) -> Node | None:
        """Return the state of an edit's node before that edit; `None` if the node did not exist.

        Args:
            index: Position in `edits`, from 0.
        """
        return self._line[0].before[index]

    # -------------------------------------------------------------------- read

    def node(self, node_id: str) -> Node:
        """Return one node.

        Raises:
            UnknownComponent: If there is no such node; the error lists close matches.
        """
        if node_id not in self.by_id:
            raise UnknownComponent("node", node_id, self.by_id)
        return self.by_id[node_id]

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
        """Labels from the root down, by leaf id."""
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
        growth, version = self._line
        size = growth.size(version)
        return len(self.nodes) if size is None else size

    def __iter__(self) -> Iterator[Node]:  # type: ignore[override]  # pydantic's yields fields
        return iter(self.nodes)

    def __contains__(self, node: object) -> bool:
        return isinstance(node, Node) and self.by_id.get(node.id) == node

    def outline(self, *, ids: bool = False) -> str:
        """Render the tree as an indented list, for people and for prompts."""
        return "\n".join(
            f"{'  ' * depth}- {node.label}{f' [{node.id}]' if ids else ''}"
            for node, depth in self.walk()
        )

    def new_id(self, label: str) -> str:
        """Return an id for a new node: the label's slug, with a number if it is taken.

        Ids of removed nodes are never reused.
        """
        growth, version = self._line
        return growth.free_id(slug(label), version)

    def _repr_html_(self) -> str:
        """Return the tree as a collapsible outline for notebooks."""
        from oodscen.tree._html import notebook_html

        return notebook_html(self)

    # ------------------------------------------------- fields that are made late

    @cached_property
    def _line(self) -> tuple[Growth, int]:
        """The shared index of this tree, and the number of edits in it that belong to this tree."""
        growth, _ = Growth().extend(0, self.edits)
        return growth, len(growth)

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            if name == "edits":
                growth, version = self._line
                self.__dict__[name] = tuple(growth.log[:version])
            elif name == "nodes":
                growth, version = self._line
                own = growth.at(version)
                self.__dict__.update(nodes=own.ordered(), _line=(own, version))
            else:
                return super().__getattr__(name)
            return self.__dict__[name]

    @model_serializer(mode="wrap")
    def _whole(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        self._fields()
        return handler(self)  # type: ignore[no-any-return]  # pydantic leaves it open

    def _fields(self) -> dict[str, Any]:
        return {"schema_version": 1, "nodes": self.nodes, "edits": self.edits}

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ScenarioTree) and self.edits == other.edits

    def __hash__(self) -> int:
        return hash(self.edits)

    def __repr_args__(self) -> Iterator[tuple[str, Any]]:
        yield from self._fields().items()

    def __copy__(self) -> Self:
        fields = self._fields()
        copy = super().__copy__()
        copy.__dict__.clear()
        copy.__dict__.update(fields)
        return copy

    def __deepcopy__(self, memo: dict[int, Any] | None = None) -> Self:
        return self  # the tree is immutable

    def __getstate__(self) -> dict[Any, Any]:
        state = super().__getstate__()
        return {**state, "__dict__": self._fields()}


def _standing(growth: Growth, version: int) -> ScenarioTree:
    """Return the tree of the first `version` edits of an index without building its fields."""
    tree = ScenarioTree.model_construct(_fields_set={"nodes", "edits"}, schema_version=1)
    del tree.__dict__["nodes"], tree.__dict__["edits"]
    tree.__dict__["_line"] = (growth, version)
    return tree


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
