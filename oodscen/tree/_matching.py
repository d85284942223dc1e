"""Pairing of the nodes of two trees: by id, then by label, then by meaning."""

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import takewhile
from typing import TYPE_CHECKING, Literal

import numpy as np

from oodscen._numbers import finite_number
from oodscen.data._base import Data
from oodscen.encoders._centring import label_rows
from oodscen.encoders._similarity import Vectors, unit
from oodscen.protocols import Encoder
from oodscen.tree._edits import Node, TreeEdit
from oodscen.tree._history import decisions
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

    The roots are a pair, and so are nodes that existed before the trees diverged, or that both have
    by the same edits in one place. Pairs of an earlier merge are kept, and the ids of a tree read
    from a file without a log are trusted. Other ids pair if both trees first assigned them to the
    same label, and neither has narrowed it since. Labels pair regardless of case, spaces and
    invisible characters. Children of paired parents come first, for both, since trees that were
    grown separately number their ids separately; elsewhere only leaf pairs with leaf and branch with
    branch. The remaining nodes pair by meaning: leaf with leaf and branch with branch, if each is the
    other's nearest and the centred cosine reaches the threshold. The meaning of a leaf is its label;
    the meaning of a branch is half its label and half the leaves below it.

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
    threshold = finite_number("threshold", threshold, -1.0, 1.0)
    pairs = _Pairs(classes_of(first), classes_of(second))
    if first.nodes and second.nodes:
        roots = first.nodes[0].id, second.nodes[0].id
        pairs.add(*roots, "id" if roots[0] == roots[1] else "label")
    _pair_by_shared_log(first, second, pairs)
    in_first, in_second = earlier_places(first, second), earlier_places(second, first)
    recorded = [(place, node) for node, places in in_first.items() for place in places]
    recorded += [(node, place) for node, places in in_second.items() for place in places]
    for before, after in recorded:
        if _is_leaf(first, before) == _is_leaf(second, after):
            pairs.add(before, after, "id")
    _ByIdAndLabel(first, second, pairs).pair()
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


def classes_of(tree: "ScenarioTree") -> dict[str, str]:
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


def earlier_places(tree: "ScenarioTree", other: "ScenarioTree") -> dict[str, list[str]]:
    """Return the nodes that stand for those of the other tree since it was merged in, by their ids there, last first.

    Two trees may give one id to nodes of one label, so the record of a merge must also repeat what
    led to one of the node's edits. If that is the same as well, both nodes are returned. The nodes may be of different
    classes.
    """
    grounds = {(edit.node, *grounds_of(edit)) for edit in other.edits}
    repeated = {
        (edit.node, edit.origin_node)
        for edit in tree.edits
        if (edit.origin_node, *grounds_of(edit)) in grounds
    }
    places: dict[str, dict[str, None]] = {}
    for edit in reversed(tree.edits):
        if (
            edit.stage == "merge"
            and edit.node in tree.by_id
            and edit.origin_node in other.by_id
            and (edit.node, edit.origin_node) in repeated
            and same_words(edit.label or "") == same_words(other.by_id[edit.origin_node].label)
        ):
            places.setdefault(edit.origin_node, {})[edit.node] = None
    return {node: list(found) for node, found in places.items()}


def grounds_of(edit: TreeEdit) -> tuple[int | None, str, str, str]:
    """Return what led to an edit."""
    return edit.round, edit.source, edit.model, edit.prompt


def _is_leaf(tree: "ScenarioTree", node_id: str) -> bool:
    return not tree.children[node_id]


def _pair_by_shared_log(first: "ScenarioTree", second: "ScenarioTree", pairs: _Pairs) -> None:
    """Pair the nodes that both logs have, whatever became of their labels."""
    shared = shared_ids(first, second)
    for node in first.nodes:
        if node.id in shared:
            pairs.add(node.id, node.id, "id", is_moved=True)


def shared_ids(first: "ScenarioTree", second: "ScenarioTree") -> set[str]:
    """Return the ids of the nodes that both trees have from before they diverged, or from the same edits in one place."""
    both = zip(first.edits, second.edits, strict=False)
    common = takewhile(lambda edits: edits[0] == edits[1], both)
    added = {edit.node for edit, _ in common if edit.op == "add"}
    first_edits, second_decisions = set(first.edits), decisions(second)
    shared: set[str] = set()
    for node in second.nodes:
        twin = first.by_id.get(node.id)
        if twin is None:
            continue
        is_in_place = node.parent == twin.parent and (node.parent is None or node.parent in shared)
        is_same = is_in_place and first_edits.issuperset(second_decisions[node.id])
        if node.id in added or is_same:
            shared.add(node.id)
    return shared


class _ByIdAndLabel:
    """Pairing by id and by label: below a pair first, then families anywhere, then leaves."""

    def __init__(self, first: "ScenarioTree", second: "ScenarioTree", pairs: _Pairs) -> None:
        self._first, self._second, self._pairs = first, second, pairs
        self._words = {node.id: same_words(node.label) for node in first.nodes}
        self._same_ids: set[str] = set()
        """Ids that both trees gave to the same label, and neither has narrowed since."""
        self._children: dict[tuple[str, str], list[str]] = defaultdict(list)
        """Ids in the second tree by words and parent, the first one last."""
        self._anywhere: dict[tuple[str, str, bool], list[str]] = defaultdict(list)
        """Ids in the second tree by words, class and whether they are leaves, the first one last."""
        for node in reversed(second.nodes):
            words = same_words(node.label)
            self._children[words, node.parent or ""].append(node.id)
            key = words, pairs.second_classes[node.id], _is_leaf(second, node.id)
            self._anywhere[key].append(node.id)

    def pair(self) -> None:
        """Add all pairs of one id or label."""
        adds = _first_adds(self._first), _first_adds(self._second)
        for node_id in (node.id for node in self._first.nodes if node.id in self._second.by_id):
            both = [added[node_id] for added in adds]
            if any(edit.stage == "file" for edit in both):
                self._pairs.add(node_id, node_id, "id")
            elif len({same_words(edit.label or "") for edit in both}) == 1:
                self._same_ids.add(node_id)
        self._same_ids -= _narrowed(self._first) | _narrowed(self._second)
        self._pair(self._by_id_below)
        self._pair(self._by_id_below, self._by_label_below)
        for are_leaves in (False, True):
            for anywhere in (self._by_id, self._by_label):
                self._pair(self._by_id_below, self._by_label_below, anywhere, are_leaves=are_leaves)

    def _pair(self, *criteria: Callable[[Node], None], are_leaves: bool = False) -> None:
        """Pair the nodes by some criteria, the third of which is for leaves only or for families only."""
        for node in self._first.nodes:
            is_meant = _is_leaf(self._first, node.id) == are_leaves
            for pair_by in criteria if is_meant else criteria[:2]:
                if node.id not in self._pairs.by_first:
                    pair_by(node)

    def _by_id_below(self, node: Node) -> None:
        parent = self._pairs.by_first.get(node.parent or "")
        is_same = node.id in self._same_ids and parent is not None
        if parent is not None and is_same and self._second.by_id[node.id].parent == parent.after:
            self._pairs.add(node.id, node.id, "id")

    def _by_label_below(self, node: Node) -> None:
        if (parent := self._pairs.by_first.get(node.parent or "")) is not None:
            self._take(node, self._children[self._words[node.id], parent.after])

    def _by_id(self, node: Node) -> None:
        is_same = node.id in self._same_ids and not self._is_own_leaf(node)
        if is_same and _is_leaf(self._first, node.id) == _is_leaf(self._second, node.id):
            self._pairs.add(node.id, node.id, "id")

    def _by_label(self, node: Node) -> None:
        """Pair nodes of one class, or else a node of a class with one that is in neither."""
        if self._is_own_leaf(node):
            return
        own, is_leaf = self._pairs.first_classes[node.id], _is_leaf(self._first, node.id)
        for possible in (own, "") if own else ("", *_CLASS_KEYS):
            if node.id not in self._pairs.by_first:
                self._take(node, self._anywhere[self._words[node.id], possible, is_leaf])

    def _is_own_leaf(self, node: Node) -> bool:
        """Return whether a node is the leaf of a family's own label, and the family is paired with a leaf."""
        words = self._words[node.id]
        while node.parent is not None and self._words[node.parent] == words:
            node = self._first.by_id[node.parent]
            if node.id in self._pairs.by_first:
                return _is_leaf(self._second, self._pairs.by_first[node.id].after)
        return False

    def _take(self, node: Node, candidates: list[str]) -> None:
        """Pair a node with the first free candidate, which stands last."""
        while candidates and candidates[-1] in self._pairs.by_second:
            candidates.pop()
        if candidates:
            self._pairs.add(node.id, candidates[-1], "label")


def _first_adds(tree: "ScenarioTree") -> Mapping[str, TreeEdit]:
    """Return the edit that first added each node, by id."""
    adds: dict[str, TreeEdit] = {}
    for edit in tree.edits:
        if edit.op == "add":
            adds.setdefault(edit.node, edit)
    return adds


def _narrowed(tree: "ScenarioTree") -> set[str]:
    """Return the nodes that stand for less than when they were added."""
    log = decisions(tree)
    return {
        node.id
        for node in tree.nodes
        if any(edit.op == "narrow" for edit in log[node.id])
        and same_words(node.label) != same_words(log[node.id][0].label or "")
    }


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
