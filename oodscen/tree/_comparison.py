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
        lines += [f"+ {_shown(item.path)}" for item in self.added]
        lines += [f"- {_shown(item.path)}" for item in self.removed]
        for broad in self.broadened:
            similarity = "" if broad.similarity is None else f" (similarity {broad.similarity:.2f})"
            lines.append(f"~ {broad.label_before} -> {broad.label_after}{similarity}")
        lines += [f"> {_shown(m.path_before)} -> {_shown(m.path_after)}" for m in self.moved]
        return "\n".join(lines)

    def to_mermaid(self) -> str:
        """Return the changes as a Mermaid flowchart: added green, removed red, relabelled amber."""
        chart = _Chart(self.matches)
        for items, key_of, style in (
            (self.removed, chart.first, "removed"),
            (self.added, chart.second, "added"),
        ):
            for item in items:
                chart.show(key_of(item.id), item.path[-1], style)
                if item.parent is not None:
                    chart.hang(key_of(item.id), key_of(item.parent), item.path)
        for broad in self.broadened:
            text = f"{broad.label_before} → {broad.label_after}"
            chart.show(chart.second(broad.after), text, "broadened")
        for moved in self.moved:
            key = chart.second(moved.after)
            chart.show_moved(key, moved.path_after[-1])
            if moved.parent_before is not None:
                parent = chart.first(moved.parent_before)
                chart.hang(key, parent, moved.path_before, "-. was .->")
            if moved.parent_after is not None:
                chart.hang(key, chart.second(moved.parent_after), moved.path_after)
        return "\n".join(chart.lines())


class _Chart:
    """A Mermaid flowchart of two trees; paired nodes are one node of the chart."""

    def __init__(self, matches: Iterable[Match]) -> None:
        self._partner = {pair.before: pair.after for pair in matches}
        self._texts: dict[str, str] = {}
        self._styles: dict[str, str] = {}
        self._edges: list[tuple[str, str, str]] = []

    def first(self, node_id: str) -> str:
        """Return the key of a node of the first tree."""
        after = self._partner.get(node_id)
        return f"a {node_id}" if after is None else f"b {after}"

    def second(self, node_id: str) -> str:
        """Return the key of a node of the second tree."""
        return f"b {node_id}"

    def show(self, key: str, text: str, style: str) -> None:
        """Show a node that was added, removed or relabelled."""
        self._texts[key], self._styles[key] = text, style

    def show_moved(self, key: str, text: str) -> None:
        """Show a moved node, unless it is shown as relabelled."""
        self._texts.setdefault(key, text)
        self._styles.setdefault(key, "moved")

    def hang(self, key: str, parent: str, path: tuple[str, ...], arrow: str = "-->") -> None:
        """Draw an edge from a parent, the last but one of the path."""
        self._texts.setdefault(parent, path[-2])
        self._edges.append((parent, arrow, key))

    def lines(self) -> list[str]:
        """Return the lines of the flowchart."""
        names = {key: f"n{number}" for number, key in enumerate(self._texts)}
        return [
            "flowchart LR",
            *(f'  {names[key]}["{mermaid_text(text)}"]' for key, text in self._texts.items()),
            *(f"  {names[above]} {arrow} {names[below]}" for above, arrow, below in self._edges),
            *(f"  class {names[key]} {style}" for key, style in self._styles.items()),
            *_STYLES,
        ]


def diff(
    one: "ScenarioTree",
    other: "ScenarioTree",
    *,
    encoder: Encoder | None = None,
    threshold: float = THRESHOLD,
) -> TreeDiff:
    """Return the nodes that the second tree adds, removes, relabels or moves; see `ScenarioTree.diff`."""
    matches = match(one, other, encoder=encoder, threshold=threshold)
    partner = {pair.before: pair.after for pair in matches}
    broadened, moved = [], []
    for pair in matches:
        before, after = one.by_id[pair.before], other.by_id[pair.after]
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
        expected = partner.get(before.parent) if before.parent else None
        if after.parent != expected:
            moved.append(
                Moved(
                    before=before.id,
                    after=after.id,
                    parent_before=before.parent,
                    parent_after=after.parent,
                    path_before=_path(one, before.id),
                    path_after=_path(other, after.id),
                )
            )
    return TreeDiff(
        encoder=encoder.name if encoder is not None else "",
        threshold=threshold if encoder is not None else None,
        sizes=(len(one), len(other)),
        matches=matches,
        added=_alone(other, set(partner.values())),
        removed=_alone(one, partner.keys()),
        broadened=tuple(broadened),
        moved=tuple(moved),
    )


def _alone(tree: "ScenarioTree", paired: Container[str]) -> tuple[OwnNode, ...]:
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
    cursor: str | None = node_id
    while cursor is not None and len(labels) < _SHOWN_LABELS:
        labels.append(tree.by_id[cursor].label)
        cursor = tree.by_id[cursor].parent
    return (*(("…",) if cursor is not None else ()), *reversed(labels))


def _shown(path: tuple[str, ...]) -> str:
    """Join a path without the root, which carries no information."""
    return " > ".join(path[1:] if len(path) > 1 and path[0] != "…" else path)
