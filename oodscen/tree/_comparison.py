"""Differences between two trees, node by node."""

from collections.abc import Container, Iterable
from typing import TYPE_CHECKING, ClassVar, Literal

from oodscen.data._base import Data
from oodscen.protocols import Encoder
from oodscen.tree._export import mermaid_text
from oodscen.tree._matching import THRESHOLD, Match, match

if TYPE_CHECKING:
    from oodscen.tree._scenario_tree import ScenarioTree


_SHOWN_LABELS = 12
"""Number of labels of a path that are shown."""
_STYLES = (
    "  classDef added fill:#d9f2e6,stroke:#0f7558,color:#10201a",
    "  classDef removed fill:#fae0d9,stroke:#b23a1e,color:#2a120b,stroke-dasharray:4",
    "  classDef broadened fill:#fbf1d9,stroke:#7a5200,color:#2a1d00",
    "  classDef moved fill:#dce9f8,stroke:#1d5a9e,color:#0c1b2b",
)
"""Colours of a chart's nodes."""


class OwnNode(Data):
    """A node that only one of the trees has."""

    noun: ClassVar[str] = "node of one tree"

    id: str
    parent: str | None
    path: tuple[str, ...]
    """Labels from the root down; for a deep node only the last ones, after `…`."""
    is_leaf: bool


class Broadened(Data):
    """A node whose label differs in the second tree."""

    noun: ClassVar[str] = "relabelled node"

    before: str
    """Id in the first tree."""
    after: str
    """Id in the second tree."""
    label_before: str
    label_after: str
    by: Literal["id", "label", "meaning"]
    """Criterion that paired the two nodes."""
    similarity: float | None = None


class Moved(Data):
    """A node whose parent differs in the second tree."""

    noun: ClassVar[str] = "moved node"

    before: str
    """Id in the first tree."""
    after: str
    """Id in the second tree."""
    parent_before: str | None
    parent_after: str | None
    path_before: tuple[str, ...]
    path_after: tuple[str, ...]


class TreeDiff(Data):
    """The differences between a first and a second tree."""

    schema_version: Literal[1] = 1
    encoder: str = ""
    """Name of the encoder that compared meanings; empty if none was used."""
    threshold: float | None = None
    sizes: tuple[int, int] = (0, 0)
    """Number of nodes in the first and the second tree."""
    matches: tuple[Match, ...] = ()
    """Paired nodes, in the order of the first tree."""
    added: tuple[OwnNode, ...] = ()
    """Nodes that only the second tree has, in its order."""
    removed: tuple[OwnNode, ...] = ()
    """Nodes that only the first tree has, in its order."""
    broadened: tuple[Broadened, ...] = ()
    moved: tuple[Moved, ...] = ()
    """Nodes with a different parent; nodes that moved along with their parent are not listed."""

    @property
    def is_empty(self) -> bool:
        """True if both trees hold the same nodes with the same labels in the same places."""
        return not (self.added or self.removed or self.broadened or self.moved)

    @property
    def unchanged(self) -> int:
        """Number of pairs with the same label and place."""
        changed = {item.before for item in self.broadened} | {item.before for item in self.moved}
        return len(self.matches) - len(changed)

    def __str__(self) -> str:
        lines = [
            f"{self.sizes[0]} -> {self.sizes[1]} nodes: {len(self.added)} added, "
            f"{len(self.removed)} removed, {len(self.broadened)} broadened, {len(self.moved)} "
            f"moved, {self.unchanged} unchanged"
        ]
        lines += [f"+ {_joined(item.path)}" for item in self.added]
        lines += [f"- {_joined(item.path)}" for item in self.removed]
        for item in self.broadened:
            similarity = "" if item.similarity is None else f" (similarity {item.similarity:.2f})"
            lines.append(f"~ {item.label_before} -> {item.label_after}{similarity}")
        lines += [f"> {_joined(m.path_before)} -> {_joined(m.path_after)}" for m in self.moved]
        return "\n".join(lines)

    def to_mermaid(self) -> str:
        """Return the changes as a Mermaid flowchart: added green, removed red, relabelled amber."""
        chart = _Chart(self.matches)
        for items, key_of, style in (
            (self.removed, chart.key_before, "removed"),
            (self.added, chart.key_after, "added"),
        ):
            for item in items:
                chart.add_node(key_of(item.id), item.path[-1], style)
                if item.parent is not None:
                    chart.add_edge(key_of(item.id), key_of(item.parent), item.path)
        for broadened in self.broadened:
            text = f"{broadened.label_before} → {broadened.label_after}"
            chart.add_node(chart.key_after(broadened.after), text, "broadened")
        for moved in self.moved:
            key = chart.key_after(moved.after)
            chart.add_moved_node(key, moved.path_after[-1])
            if moved.parent_before is not None:
                parent = chart.key_before(moved.parent_before)
                chart.add_edge(key, parent, moved.path_before, "-. was .->")
            if moved.parent_after is not None:
                chart.add_edge(key, chart.key_after(moved.parent_after), moved.path_after)
        return "\n".join(chart.lines())


class _Chart:
    """A Mermaid flowchart of two trees; paired nodes are one node of the chart."""

    def __init__(self, matches: Iterable[Match]) -> None:
        self._partner = {pair.before: pair.after for pair in matches}
        self._texts: dict[str, str] = {}
        self._styles: dict[str, str] = {}
        self._edges: list[tuple[str, str, str]] = []

    def key_before(self, node_id: str) -> str:
        """Return the key of a node of the first tree."""
        after = self._partner.get(node_id)
        return f"a {node_id}" if after is None else f"b {after}"

    def key_after(self, node_id: str) -> str:
        """Return the key of a node of the second tree."""
        return f"b {node_id}"

    def add_node(self, key: str, text: str, style: str) -> None:
        """Add a node that was added, removed or relabelled."""
        self._texts[key], self._styles[key] = text, style

    def add_moved_node(self, key: str, text: str) -> None:
        """Add a moved node, unless it is there as a relabelled one."""
        self._texts.setdefault(key, text)
        self._styles.setdefault(key, "moved")

    def add_edge(self, key: str, parent: str, path: tuple[str, ...], arrow: str = "-->") -> None:
        """Add an edge from a parent, the last but one of the path."""
        self._texts.setdefault(parent, path[-2])
        self._edges.append((parent, arrow, key))

    def lines(self) -> list[str]:
        """Return the lines of the flowchart."""
        names = {key: f"n{index}" for index, key in enumerate(self._texts)}
        return [
            "flowchart LR",
            *(f'  {names[key]}["{mermaid_text(text)}"]' for key, text in self._texts.items()),
            *(f"  {names[above]} {arrow} {names[below]}" for above, arrow, below in self._edges),
            *(f"  class {names[key]} {style}" for key, style in self._styles.items()),
            *_STYLES,
        ]


def diff(
    first: "ScenarioTree",
    second: "ScenarioTree",
    *,
    encoder: Encoder | None = None,
    threshold: float = THRESHOLD,
) -> TreeDiff:
    """Return the nodes that the second tree adds, removes, relabels or moves; see `ScenarioTree.diff`."""
    matches = match(first, second, encoder=encoder, threshold=threshold)
    partner = {pair.before: pair.after for pair in matches}
    broadened, moved = [], []
    for pair in matches:
        before, after = first.by_id[pair.before], second.by_id[pair.after]
        if before.label != after.label:
            broadened.append(
                Broadened(
                    before=before.id,
                    after=after.id,
                    label_before=before.label,
                    label_after=after.label,
                    by=pair.by,
                    similarity=pair.similarity,
                )
            )
        parent_in_second = partner.get(before.parent) if before.parent is not None else None
        if after.parent != parent_in_second:
            moved.append(
                Moved(
                    before=before.id,
                    after=after.id,
                    parent_before=before.parent,
                    parent_after=after.parent,
                    path_before=_path(first, before.id),
                    path_after=_path(second, after.id),
                )
            )
    return TreeDiff(
        encoder=encoder.name if encoder is not None else "",
        threshold=threshold if encoder is not None else None,
        sizes=(len(first), len(second)),
        matches=matches,
        added=_unpaired(second, set(partner.values())),
        removed=_unpaired(first, partner.keys()),
        broadened=tuple(broadened),
        moved=tuple(moved),
    )


def _unpaired(tree: "ScenarioTree", paired: Container[str]) -> tuple[OwnNode, ...]:
    return tuple(
        OwnNode(
            id=node.id,
            parent=node.parent,
            path=_path(tree, node.id),
            is_leaf=not tree.children[node.id],
        )
        for node in tree.nodes
        if node.id not in paired
    )


def _path(tree: "ScenarioTree", node_id: str) -> tuple[str, ...]:
    """Return the labels from the root to a node, cut to a readable length."""
    labels: list[str] = []
    ancestor: str | None = node_id
    while ancestor is not None and len(labels) < _SHOWN_LABELS:
        labels.append(tree.by_id[ancestor].label)
        ancestor = tree.by_id[ancestor].parent
    if ancestor is not None:
        labels.append("…")
    return tuple(reversed(labels))


def _joined(path: tuple[str, ...]) -> str:
    """Join a path without the root, which carries no information."""
    has_root = len(path) > 1 and path[0] != "…"
    return " > ".join(path[1:] if has_root else path)
