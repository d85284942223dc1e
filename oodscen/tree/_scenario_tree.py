"""The scenario tree: an immutable taxonomy, defined by its edit log."""

from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any, ClassVar, Literal, NoReturn, Self, TypeAlias

from oodscen._arguments import checked, instance_of, instances_of
from oodscen._io.files import read_utf8
from oodscen._numbers import whole_number
from oodscen.data._base import Data, canonical_json, digest
from oodscen.data._episode import Episode
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.errors import DataError, Issue, UnknownComponent, UsageError
from oodscen.protocols import Encoder
from oodscen.tree._comparison import TreeDiff, diff
from oodscen.tree._coverage import Coverage, coverage
from oodscen.tree._edit_log import EditLog
from oodscen.tree._edits import Node, TreeEdit, adding
from oodscen.tree._export import to_dot, to_mermaid, to_nested_json
from oodscen.tree._history import replay, undo, undo_round, version_at
from oodscen.tree._html import notebook_html, to_page
from oodscen.tree._labels import CLASSES, label_fault, slug
from oodscen.tree._matching import THRESHOLD
from oodscen.tree._merge import merge
from oodscen.tree._provenance import Provenance, provenance

__all__ = ["ROOT", "Node", "ScenarioTree", "TreeEdit"]

ROOT = "root"
"""Id of the root of every tree."""


class TreeFile(Data):
    """The content of a tree's file."""

    noun: ClassVar[str] = "scenario tree"

    schema_version: Literal[1] = 1
    nodes: tuple[Node, ...] = ()
    """The nodes that follow from the edits. A file without edits is read as one `add` per node."""
    edits: tuple[TreeEdit, ...] = ()


class ScenarioTree:
    """A taxonomy of OOD scenarios: root, classes, families, leaves.

    Each root-to-leaf path is one distinct kind of OOD scenario (paper, section III-A). The tree is
    a value: every operation returns a new tree, and `edits` is the whole history. Appending an
    edit takes the same time on a tree of any size; `nodes` and `edits` are built on first access. A
    tree is a collection of its nodes: `len`, iteration and `in` are those of `nodes`.
    """

    noun: ClassVar[str] = TreeFile.noun
    Edit: TypeAlias = TreeEdit
    """One edit: `ScenarioTree.Edit(op="add", node="fog", parent="environmental", label="Fog")`."""

    _index: EditLog
    """The index that this tree shares with the trees before and after it."""
    _version: int
    """The number of edits in the index that belong to this tree."""

    @checked
    def __init__(self, edits: Iterable[TreeEdit] = ()) -> None:
        """Apply a log of edits to the empty tree.

        Raises:
            DataError: With one issue per edit that does not fit.
            UsageError: If an element is no edit.
        """
        log = tuple(edits)
        instances_of("edits", log, TreeEdit)
        index, issues = EditLog().extend(0, log)
        if issues:
            raise DataError(self.noun, issues)
        self.__dict__.update(_index=index, _version=len(log))

    @classmethod
    def _at(cls, index: EditLog, version: int) -> Self:
        """Return the tree of the first `version` edits of an index."""
        tree = cls.__new__(cls)
        tree.__dict__.update(_index=index, _version=version)
        return tree

    @classmethod
    @checked
    def initial(cls, label: str = "Out-of-distribution driving scenario") -> Self:
        """Return a tree with a root and the two classes.

        Raises:
            DataError: If the text cannot be a label.
        """
        nodes = [Node(id=ROOT, parent=None, label=label)]
        nodes += [Node(id=slug(name), parent=ROOT, label=name) for name in CLASSES]
        return cls(adding(node, stage="grow") for node in nodes)

    @classmethod
    @checked
    def parse(cls, value: object, *, source: str = "") -> Self:
        """Read a tree from plain data or JSON text.

        Args:
            value: A JSON document as text, or the equivalent mapping.
            source: The origin of the data, for error messages.

        Raises:
            DataError: With one issue per fault of the data and per edit that does not fit.
        """
        file = TreeFile.parse(value, source=source)
        if not file.model_fields_set & {"nodes", "edits"}:
            raise DataError(cls.noun, [Issue("", "has neither nodes nor edits")], source=source)
        is_bare = bool(file.nodes) and not file.edits
        edits = tuple(adding(node, stage="file") for node in file.nodes) if is_bare else file.edits
        index, issues = EditLog().extend(0, edits, where="nodes" if is_bare else "edits")
        is_stated = "nodes" in file.model_fields_set
        if not issues and is_stated and index.ordered() != file.nodes:
            issues.append(Issue("nodes", "do not follow from the edits"))
        if issues:
            raise DataError(cls.noun, issues, source=source)
        return cls._at(index, len(edits))

    @classmethod
    @checked
    def load(cls, path: str | Path) -> Self:
        """Read a tree from a JSON file.

        Raises:
            DataError: If the file cannot be read or does not hold a valid tree.
        """
        return cls.parse(read_utf8(path, cls.noun), source=str(path))

    def to_json(self) -> str:
        """Return the canonical JSON text: the same bytes for equal trees."""
        return canonical_json(self._plain())

    def digest(self) -> str:
        """Return the SHA-256 of the canonical JSON text."""
        return digest(self._plain())

    def _plain(self) -> dict[str, Any]:
        # The parts are valid, and validating them again would cost more than writing them.
        file = TreeFile.model_construct(nodes=self.nodes, edits=self.edits)
        return file.model_dump(mode="json")

    def apply(self, *edits: TreeEdit) -> "ScenarioTree":
        """Return the tree after further edits.

        Raises:
            DataError: If an edit does not fit (unknown node, taken id, empty label ...). This tree
                never changes.
        """
        for edit in edits:
            instance_of("each edit", edit, TreeEdit)
        index, issues = self._index.extend(self._version, edits)
        if issues:
            raise DataError("tree edit", issues)
        return self._at(index, self._version + len(edits))

    @checked
    def undo(
        self, index: int | None = None, *, round: int | None = None, origin: str = ""
    ) -> "ScenarioTree":
        """Return the tree with an earlier edit undone, by appending edits to its log.

        Undoing an `add` also removes the nodes that were later added below it; undoing a `remove`
        also restores parents that were removed later. A label or a place that a later edit has
        replaced stays as it is. An undoing edit can be undone like any other.

        Args:
            index: Position in `edits`, from the end if negative; the last edit in force if left
                out.
            round: Undo every edit of this round instead, the last one first.
            origin: With `round`: name of the merged tree to which the round belongs; this tree's
                own rounds if empty.

        Raises:
            UsageError: If there is no such edit, or it is undone already, or it cannot be undone in
                the current tree (its node is gone, or it would create a cycle).
        """
        if round is not None and index is not None:
            raise UsageError("undo takes the index of an edit or a round, not both")
        if round is None and origin:
            raise UsageError("an origin goes with a round")
        return undo(self, index) if round is None else undo_round(self, round, origin=origin)

    @checked
    def at(
        self, *, edit: int | None = None, round: int | None = None, stage: str | None = None
    ) -> "ScenarioTree":
        """Return the tree as it stood at an earlier time.

        Args:
            edit: After this many edits.
            round: After this red-team round, and before the first edit of a later one or of a
                merge; 0 is the tree before red teaming. A round that changed nothing, or comes after the last
                one, is the tree that was there by then.
            stage: After the last edit of this stage.

        Raises:
            UsageError: If not exactly one argument is given, or there was no such edit or stage.
        """
        return self._at(self._index, version_at(self.edits, edit=edit, round=round, stage=stage))

    @checked
    def provenance(self, node_id: str) -> Provenance:
        """Return who added a node and why, and the later decisions about it.

        Raises:
            UnknownComponent: If there never was such a node.
        """
        return provenance(self, node_id)

    def replay(self) -> "Iterator[tuple[TreeEdit, ScenarioTree]]":
        """Yield every edit with the tree after it, starting with the first."""
        return replay(self)

    def _edit_log(self) -> EditLog:
        """Return a copy of the index of this tree's edits, for trying further ones."""
        return self._index.copy(self._version)

    def before(self, index: int) -> Node | None:
        """Return the state of an edit's node before that edit; `None` if the node did not exist.

        Args:
            index: Position in `edits`, from 0.

        Raises:
            UsageError: If there is no such edit.
        """
        if not self._version:
            raise UsageError("the tree has no edits")
        return self._index.before[whole_number("index", index, 0, self._version - 1)]

    @checked
    def diff(
        self,
        other: "ScenarioTree",
        *,
        encoder: Encoder | None = None,
        threshold: float = THRESHOLD,
    ) -> TreeDiff:
        """Return the nodes that another tree adds, removes, relabels or moves.

        Args:
            other: The tree to compare with.
            encoder: Pairs nodes by meaning if neither id nor label pairs them.
            threshold: Least centred cosine of two labels with the same meaning.

        Raises:
            UsageError: If the threshold is not a cosine.
            EncoderError: If the encoder fails.
        """
        instance_of("other", other, ScenarioTree)
        return diff(self, other, encoder=encoder, threshold=threshold)

    @checked
    def merge(
        self,
        other: "ScenarioTree",
        *,
        encoder: Encoder | None = None,
        threshold: float = THRESHOLD,
        name: str | None = None,
    ) -> "ScenarioTree":
        """Return this tree, with the nodes that only another one has added in their places.

        The log of this tree stays as it is. Every path of either tree remains a path, with this tree's
        labels for the nodes of both, and merging the same tree again changes nothing.

        Args:
            other: The tree to merge in.
            encoder: Pairs nodes by meaning if neither id nor label pairs them.
            threshold: Least centred cosine of two labels with the same meaning.
            name: Name of the other tree in the log; `merge-1`, `merge-2` ... if left out.

        Raises:
            UsageError: If the threshold is not a cosine.
            EncoderError: If the encoder fails.
            DataError: If a node would lie more than 50 levels below the root.
        """
        instance_of("other", other, ScenarioTree)
        return merge(self, other, encoder=encoder, threshold=threshold, name=name)

    @checked
    def coverage(
        self,
        *,
        texts: Iterable[Scenario] = (),
        scenes: Iterable[Scene] = (),
        episodes: Iterable[Episode] = (),
    ) -> Coverage:
        """Count the texts, scenes and episodes that cover each node; `Study.coverage` does it for a study.

        Args:
            texts: The texts; each belongs to the leaf that it names.
            scenes: The staged scenes; each belongs to the leaf of its text.
            episodes: The episodes of the scenes, including those of twins.
        """
        return coverage(self, texts=texts, scenes=scenes, episodes=episodes)

    def to_mermaid(self) -> str:
        """Return the tree as a Mermaid flowchart; leaves that the paper names have a bold border."""
        return to_mermaid(self)

    def to_dot(self) -> str:
        """Return the tree in Graphviz's DOT language; node names are the ids."""
        return to_dot(self)

    def to_nested_json(self) -> str:
        """Return the tree as nested JSON objects, without its log."""
        return to_nested_json(self)

    def to_page(self) -> str:
        """Return the whole tree as a separate page, light or dark by the reader's preference."""
        return to_page(self)

    @cached_property
    def nodes(self) -> tuple[Node, ...]:
        """All nodes, parents before children, otherwise in the order in which they were first added."""
        index = self._index.at(self._version)
        self.__dict__["_index"] = index
        return index.ordered()

    @cached_property
    def edits(self) -> tuple[TreeEdit, ...]:
        """The log that produces `nodes`."""
        return tuple(self._index.log[: self._version])

    def node(self, node_id: str) -> Node:
        """Return one node.

        Raises:
            UnknownComponent: If there is no such node; the error lists close matches.
        """
        instance_of("node_id", node_id, str)
        if node_id not in self.by_id:
            raise UnknownComponent("node", node_id, self.by_id)
        return self.by_id[node_id]

    @cached_property
    def by_id(self) -> Mapping[str, Node]:
        """Nodes by id, in order."""
        return MappingProxyType({node.id: node for node in self.nodes})

    @cached_property
    def children(self) -> Mapping[str, tuple[str, ...]]:
        """Ids of the children of every node, in order."""
        children: dict[str, list[str]] = {node.id: [] for node in self.nodes}
        for node in self.nodes:
            if node.parent is not None:
                children[node.parent].append(node.id)
        return MappingProxyType({node_id: tuple(ids) for node_id, ids in children.items()})

    @property
    def leaves(self) -> tuple[Node, ...]:
        """Nodes without children that lie below a class, in tree order."""
        return tuple(
            node for node, depth in self.walk() if not self.children[node.id] and depth >= 2
        )

    def path(self, node_id: str) -> tuple[str, ...]:
        """Return the labels from the root down to a node.

        Raises:
            UnknownComponent: If there is no such node; the error lists close matches.
        """
        node = self.node(node_id)
        labels = [node.label]
        while node.parent is not None:
            node = self.by_id[node.parent]
            labels.append(node.label)
        return tuple(reversed(labels))

    @property
    def paths(self) -> dict[str, tuple[str, ...]]:
        """Labels from the root down, by leaf id."""
        return {leaf.id: self.path(leaf.id) for leaf in self.leaves}

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
        size = self._index.size(self._version)
        return len(self.nodes) if size is None else size

    def __iter__(self) -> Iterator[Node]:
        return iter(self.nodes)

    def __contains__(self, node: object) -> bool:
        return isinstance(node, Node) and self.by_id.get(node.id) == node

    @checked
    def outline(self, *, ids: bool = False) -> str:
        """Render the tree as an indented list, for people and for prompts."""
        return "\n".join(
            f"{'  ' * depth}- {node.label}{f' [{node.id}]' if ids else ''}"
            for node, depth in self.walk()
        )

    @staticmethod
    @checked
    def label_fault(label: str) -> str:
        """Return why a text cannot be a label, or an empty string."""
        return label_fault(label)

    def new_id(self, label: str) -> str:
        """Return an id for a new node: the label's slug, with a number if it is taken.

        Ids of removed nodes are never reused.
        """
        instance_of("label", label, str)
        return self._index.free_id(slug(label), self._version)

    def _repr_html_(self) -> str:
        """Return the tree as a collapsible outline for notebooks."""
        return notebook_html(self)

    def __setattr__(self, name: str, value: object) -> NoReturn:
        raise AttributeError("a tree never changes: `apply` returns another one")

    def __delattr__(self, name: str) -> NoReturn:
        raise AttributeError("a tree never changes: `apply` returns another one")

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ScenarioTree) and self.edits == other.edits

    def __hash__(self) -> int:
        return hash(self.edits)

    def __reduce__(self) -> tuple[type[Self], tuple[tuple[TreeEdit, ...]]]:
        return type(self), (self.edits,)

    def __repr__(self) -> str:
        return f"<{self.noun}: {len(self)} nodes, {len(self.leaves)} paths, {self._version} edits>"
