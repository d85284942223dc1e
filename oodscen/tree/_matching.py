"""Pairing of the nodes of two trees: by id, then by label, then by meaning."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import takewhile
from numbers import Real
from typing import TYPE_CHECKING, Literal

import numpy as np

from oodscen.data._base import Data
from oodscen.encoders._centring import label_rows
from oodscen.encoders._similarity import Vectors, unit
from oodscen.errors import UsageError
from oodscen.protocols import Encoder
from oodscen.tree._edits import Node, TreeEdit
from oodscen.tree._labels import CLASSES, same_words

if TYPE_CHECKING:
    from oodscen.tree._scenario_tree import ScenarioTree

THRESHOLD = 0.75
"""Centred cosine (`oodscen.encoders._centring`) from which two labels mean the same, for
MiniLM. Measured so that hardly any pair is wrong: an unpaired node stays, a wrongly paired one
is lost."""
By = Literal["id", "label", "meaning"]
"""Criteria by which nodes pair."""
_CLASS_KEYS = tuple(name.casefold() for name in CLASSES)
_BLOCK = 1024
"""Number of rows and columns of cosines that are computed at once."""


class Match(Data):
    """A pair of nodes that are treated as one."""

    before: str
    """Id in the first tree."""
    after: str
    """Id in the second tree."""
    by: By
    similarity: float | None = None
    """Centred cosine of the meanings, if the pair was made by meaning."""


def match(
    first: "ScenarioTree",
    second: "ScenarioTree",
    *,
    encoder: Encoder | None = None,
    threshold: float = THRESHOLD,
) -> tuple[Match, ...]:
    """Pair the nodes of two trees, each at most once, in the order of the first tree.

    The roots are a pair, and so are nodes that existed before the trees diverged. Pairs of an
    earlier merge are kept. Ids pair if both trees first assigned them to the same label, since trees
    that were grown separately number their ids separately; a tree read from a file without a log is
    trusted. Labels pair regardless of case, spaces and
    invisible characters; children of paired parents come first. The remaining nodes pair by
    meaning: leaf with leaf and branch with branch, if each is the other's nearest and the centred
    cosine reaches the threshold. The meaning of a leaf is its label; the meaning of a branch is
    half its label and half the leaves below it.

    A node below Environmental never pairs with one below Interactional, except if both logs begin
    alike, the node existed at that point, and it was moved later.

    The cost is linear in the nodes, except for the cosines of the remaining nodes: every pair is
    compared, in blocks of at most 4 MB.

    Args:
        first: The first tree.
        second: The second tree.
        encoder: Compares meanings; without it, nodes never pair by meaning.
        threshold: Between -1 and 1.

    Raises:
        UsageError: If the threshold is not a cosine.
        EncoderError: If the encoder fails.
    """
    if not (isinstance(threshold, Real) and -1.0 <= threshold <= 1.0):
        raise UsageError(f"the threshold is a cosine, between -1 and 1, not {threshold}")
    pairs = _Pairs(_classes(first), _classes(second))
    if first.nodes and second.nodes:
        roots = first.nodes[0].id, second.nodes[0].id
        pairs.add(*roots, "id" if roots[0] == roots[1] else "label")
    _pair_by_shared_log(first, second, pairs)
    for before, after in _merged(first, second):
        pairs.add(before, after, "id")
    for after, before in _merged(second, first):
        pairs.add(before, after, "id")
    _pair_by_id(first, second, pairs)
    _pair_below_pairs(first, second, pairs)
    _pair_by_label(first, second, pairs)
    if encoder is not None:
        _pair_by_meaning(first, second, pairs, encoder, threshold)
    return tuple(pairs.by_first[node.id] for node in first.nodes if node.id in pairs.by_first)


class _Pairs:
    """The pairs found so far, by the id in either tree."""

    def __init__(self, first_classes: Mapping[str, str], second_classes: Mapping[str, str]) -> None:
        self.by_first: dict[str, Match] = {}
        self.by_second: dict[str, Match] = {}
        self.first_classes = first_classes
        """Class of each node of the first tree, by id; empty if it is in neither."""
        self.second_classes = second_classes

    def add(
        self,
        before: str,
        after: str,
        by: By,
        similarity: float | None = None,
        *,
        is_moved: bool = False,
    ) -> None:
        """Pair two nodes, unless one is paired already or, if they have not moved, their classes differ."""
        classes = {self.first_classes[before], self.second_classes[after]} - {""}
        if (
            before in self.by_first
            or after in self.by_second
            or (len(classes) > 1 and not is_moved)
        ):
            return
        pair = Match(before=before, after=after, by=by, similarity=similarity)
        self.by_first[before] = self.by_second[after] = pair


def _classes(tree: "ScenarioTree") -> dict[str, str]:
    """Return the class of every node in lower case; empty if it is neither of the two classes."""
    classes: dict[str, str] = {}
    for node in tree.nodes:
        parent = tree.by_id[node.parent] if node.parent is not None else None
        if parent is None:
            classes[node.id] = ""
        elif parent.parent is None:
            keys = (same_words(node.label), node.id)
            classes[node.id] = next((key for key in keys if key in _CLASS_KEYS), "")
        else:
            classes[node.id] = classes[parent.id]
    return classes


def _merged(tree: "ScenarioTree", other: "ScenarioTree") -> Iterator[tuple[str, str]]:
    """Yield pairs of node ids that an earlier merge of the other tree treated as one."""
    for edit in tree.edits:
        if edit.stage == "merge" and edit.origin_node in other.by_id and edit.node in tree.by_id:
            origin = other.by_id[edit.origin_node]
            has_same_label = same_words(edit.label or "") == same_words(origin.label)
            if has_same_label and _is_leaf(tree, edit.node) == _is_leaf(other, origin.id):
                yield edit.node, origin.id


def _is_leaf(tree: "ScenarioTree", node_id: str) -> bool:
    return not tree.children[node_id]


def _pair_by_shared_log(first: "ScenarioTree", second: "ScenarioTree", pairs: _Pairs) -> None:
    """Pair the nodes that existed before the trees diverged, whatever became of their labels."""
    both = zip(first.edits, second.edits, strict=False)
    shared = {
        edit.node
        for edit, _ in takewhile(lambda edits: edits[0] == edits[1], both)
        if edit.op == "add"
    }
    for node in first.nodes:
        if node.id in shared and node.id in second.by_id:
            pairs.add(node.id, node.id, "id", is_moved=True)


def _pair_by_id(first: "ScenarioTree", second: "ScenarioTree", pairs: _Pairs) -> None:
    """Pair nodes of one id if both trees added it with the same label, or read it from a file without a log."""
    adds = _first_adds(first), _first_adds(second)
    for node in first.nodes:
        if node.id not in second.by_id:
            continue
        both = [added[node.id] for added in adds]
        labels = {same_words(edit.label or "") for edit in both if edit.stage != "file"}
        if len(labels) < 2:
            pairs.add(node.id, node.id, "id")


def _first_adds(tree: "ScenarioTree") -> Mapping[str, TreeEdit]:
    """Return the edit that first added each node, by id."""
    adds: dict[str, TreeEdit] = {}
    for edit in tree.edits:
        if edit.op == "add":
            adds.setdefault(edit.node, edit)
    return adds


def _pair_below_pairs(first: "ScenarioTree", second: "ScenarioTree", pairs: _Pairs) -> None:
    """Pair children of paired parents that have the same label."""
    children: dict[tuple[str, str | None], list[str]] = defaultdict(list)
    for node in reversed(second.nodes):
        if node.id not in pairs.by_second:
            children[same_words(node.label), node.parent].append(node.id)
    for node in first.nodes:
        parent = pairs.by_first.get(node.parent or "")
        if parent is not None and node.id not in pairs.by_first:
            _pair_with_first(node, children[same_words(node.label), parent.after], pairs)


def _pair_by_label(first: "ScenarioTree", second: "ScenarioTree", pairs: _Pairs) -> None:
    """Pair nodes that have the same label, those of the same class first."""
    candidates: dict[tuple[str, str], list[str]] = defaultdict(list)
    for node in reversed(second.nodes):
        if node.id not in pairs.by_second:
            key = same_words(node.label), pairs.second_classes[node.id]
            candidates[key].append(node.id)
    for node in first.nodes:
        class_key = pairs.first_classes[node.id]
        possible_classes = (class_key, "") if class_key else ("", *_CLASS_KEYS)
        for possible_class in possible_classes:
            if node.id not in pairs.by_first:
                _pair_with_first(node, candidates[same_words(node.label), possible_class], pairs)


def _pair_with_first(node: Node, candidates: list[str], pairs: _Pairs) -> None:
    """Pair a node with the first free candidate, which stands last."""
    while candidates and candidates[-1] in pairs.by_second:
        candidates.pop()
    if candidates:
        pairs.add(node.id, candidates[-1], "label")


def _pair_by_meaning(
    first: "ScenarioTree",
    second: "ScenarioTree",
    pairs: _Pairs,
    encoder: Encoder,
    threshold: float,
) -> None:
    """Pair leaves with leaves and branches with branches of one class that are nearest to each other."""
    meanings: dict[str, Vectors] | None = None
    for are_leaves in (True, False):
        for class_key in ("", *_CLASS_KEYS):
            rows = [
                node
                for node in first.nodes
                if node.id not in pairs.by_first
                and pairs.first_classes[node.id] == class_key
                and _is_leaf(first, node.id) == are_leaves
            ]
            columns = [
                node
                for node in second.nodes
                if node.id not in pairs.by_second
                and pairs.second_classes[node.id] == class_key
                and _is_leaf(second, node.id) == are_leaves
            ]
            if not rows or not columns:
                continue
            if meanings is None:
                meanings = _meanings((first, second), encoder)
            row_vectors = _vectors(first, rows, meanings)
            column_vectors = _vectors(second, columns, meanings)
            nearest_rows = _nearest(column_vectors, row_vectors)
            for index, (cosine, nearest) in enumerate(_nearest(row_vectors, column_vectors)):
                if cosine >= threshold and nearest_rows[nearest][1] == index:
                    pairs.add(rows[index].id, columns[nearest].id, "meaning", cosine)


def _meanings(trees: "Iterable[ScenarioTree]", encoder: Encoder) -> dict[str, Vectors]:
    """Return the vectors of the labels of both trees, without their common component."""
    labels = list(dict.fromkeys(node.label for tree in trees for node in tree.nodes))
    rows, centre = label_rows(encoder, labels)
    return dict(zip(labels, unit((rows - centre).astype(np.float32)), strict=True))


def _vectors(
    tree: "ScenarioTree", nodes: Sequence[Node], meanings: Mapping[str, Vectors]
) -> Vectors:
    """Return the vectors of leaves, those of their labels, or of branches, half of the label and half of the leaves."""
    of_labels = np.array([meanings[node.label] for node in nodes])
    if _is_leaf(tree, nodes[0].id):
        return of_labels
    of_leaves: dict[str, Vectors] = {}
    for node in reversed(tree.nodes):
        if children := tree.children[node.id]:
            of_leaves[node.id] = np.sum([of_leaves[child] for child in children], axis=0)
        else:
            of_leaves[node.id] = meanings[node.label]
    return unit(of_labels + unit(np.array([of_leaves[node.id] for node in nodes])))


def _nearest(rows: Vectors, columns: Vectors) -> list[tuple[float, int]]:
    """Return the nearest column of each row, with similarities rounded so that numerical noise decides nothing."""
    nearest: list[tuple[float, int]] = []
    for start in range(0, len(rows), _BLOCK):
        block = rows[start : start + _BLOCK]
        best = np.full(len(block), -np.inf, np.float32)
        index = np.zeros(len(block), np.int64)
        for offset in range(0, len(columns), _BLOCK):
            cosines = np.round(block @ columns[offset : offset + _BLOCK].T, 4)
            best_here = cosines.argmax(axis=1)
            values = cosines[np.arange(len(block)), best_here]
            is_better = values > best
            best[is_better] = values[is_better]
            index[is_better] = best_here[is_better] + offset
        nearest += [
            (round(float(cosine), 4), int(column))
            for cosine, column in zip(best, index, strict=True)
        ]
    return nearest
