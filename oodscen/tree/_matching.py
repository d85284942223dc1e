"""Pairing of the nodes of two trees: by id, then by label, then by meaning."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import count, takewhile
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


_BLOCK = 1024


class Match(Data):
    """A pair of nodes that are treated as one."""

    before: str
    """Id in the first tree."""
    after: str
    """Id in the second tree."""
    by: Literal["id", "label", "meaning"]
    similarity: float | None = None
    """Centred cosine of the meanings, if the pair was made by meaning."""


def match(
    one: "ScenarioTree",
    other: "ScenarioTree",
    *,
    encoder: Encoder | None = None,
    threshold: float = THRESHOLD,
) -> tuple[Match, ...]:
    """Pair the nodes of two trees, each at most once, in the order of the first tree.

    The roots are a pair, and so are nodes that existed before the trees diverged. Pairs of an
    earlier merge are kept. Ids pair if both trees first assigned them to the same label, since trees that were grown separately number their ids separately; a
    tree read from a file without a log is trusted. Labels pair regardless of case, spaces and
    invisible characters; children of paired parents come first. The remaining nodes pair by
    meaning: leaf with leaf and branch with branch, if each is the other's nearest and the centred
    cosine reaches the threshold. The meaning of a leaf is its label; the meaning of a branch is
    half its label and half the leaves below it.

    A node below Environmental never pairs with one below Interactional, except if both logs begin
    alike, the node existed at that point, and it was moved later.

    The cost is linear in the nodes, except for the cosines of the remaining nodes: every pair is
    compared, in blocks of at most 4 MB.

    Args:
        one: The first tree.
        other: The second tree.
        encoder: Compares meanings; without it, nodes never pair by meaning.
        threshold: Between -1 and 1.

    Raises:
        UsageError: If the threshold is not a cosine.
        EncoderError: If the encoder fails.
    """
    if not (isinstance(threshold, Real) and -1.0 <= threshold <= 1.0):
        raise UsageError(f"the threshold is a cosine, between -1 and 1, not {threshold}")
    pairs = _Pairs(_classes(one), _classes(other))
    for first, second in zip(one.nodes[:1], other.nodes[:1], strict=False):
        pairs.add(first.id, second.id, "id" if first.id == second.id else "label")
    _by_shared_log(one, other, pairs)
    for here, there in _merged(one, other):
        pairs.add(here, there, "id")
    for there, here in _merged(other, one):
        pairs.add(here, there, "id")
    _by_id(one, other, pairs)
    _by_label(one, other, pairs)
    if encoder is not None:
        _by_meaning(one, other, pairs, encoder, threshold)
    return tuple(pairs.forth[node.id] for node in one.nodes if node.id in pairs.forth)


class _Pairs:
    def __init__(self, one: Mapping[str, str], other: Mapping[str, str]) -> None:
        self.forth: dict[str, Match] = {}
        self.back: dict[str, Match] = {}
        self.one, self.other = one, other
        """Class of each node, by id."""

    def add(
        self,
        before: str,
        after: str,
        by: Literal["id", "label", "meaning"],
        similarity: float | None = None,
        *,
        is_moved: bool = False,
    ) -> None:
        """Pair two nodes if neither is paired yet and both are of the same class."""
        classes = {self.one[before], self.other[after]} - {""}
        if before in self.forth or after in self.back or (len(classes) > 1 and not is_moved):
            return
        found = Match(before=before, after=after, by=by, similarity=similarity)
        self.forth[before] = self.back[after] = found


def _classes(tree: "ScenarioTree") -> dict[str, str]:
    """Return the class of every node in lower case; empty if it is neither of the two classes."""
    known = {name.casefold() for name in CLASSES}
    found: dict[str, str] = {}
    for node in tree.nodes:
        above = tree.by_id[node.parent] if node.parent is not None else None
        if above is None:
            found[node.id] = ""
        elif above.parent is None:
            names = (same_words(node.label), node.id)
            found[node.id] = next((name for name in names if name in known), "")
        else:
            found[node.id] = found[above.id]
    return found


def _merged(tree: "ScenarioTree", other: "ScenarioTree") -> Iterator[tuple[str, str]]:
    """Yield pairs of node ids that an earlier merge of the other tree treated as one."""
    for edit in tree.edits:
        if edit.stage == "merge" and edit.origin_node in other.by_id and edit.node in tree.by_id:
            there = other.by_id[edit.origin_node]
            is_same = same_words(edit.label or "") == same_words(there.label)
            if is_same and bool(tree.children[edit.node]) == bool(other.children[there.id]):
                yield edit.node, there.id


def _by_shared_log(one: "ScenarioTree", other: "ScenarioTree", pairs: _Pairs) -> None:
    """Pair the nodes that existed before the trees diverged, whatever became of their labels."""
    shared = _shared(one, other)
    for node in one.nodes:
        if node.id in shared and node.id in other.by_id:
            pairs.add(node.id, node.id, "id", is_moved=True)


def _by_id(one: "ScenarioTree", other: "ScenarioTree", pairs: _Pairs) -> None:
    first, second = _first_adds(one), _first_adds(other)
    for node in one.nodes:
        if node.id in other.by_id:
            added = first[node.id], second[node.id]
            labels = {same_words(edit.label or "") for edit in added if edit.stage != "file"}
            if len(labels) < 2:
                pairs.add(node.id, node.id, "id")


def _first_adds(tree: "ScenarioTree") -> Mapping[str, TreeEdit]:
    found: dict[str, TreeEdit] = {}
    for edit in tree.edits:
        if edit.op == "add":
            found.setdefault(edit.node, edit)
    return found


def _shared(one: "ScenarioTree", other: "ScenarioTree") -> set[str]:
    """Return the ids of the nodes that existed before two trees diverged."""
    both = takewhile(lambda pair: pair[0] == pair[1], zip(one.edits, other.edits, strict=False))
    return {edit.node for edit, _ in both if edit.op == "add"}


def _by_label(one: "ScenarioTree", other: "ScenarioTree", pairs: _Pairs) -> None:
    below: dict[tuple[str, str | None], list[Node]] = defaultdict(list)
    anywhere: dict[tuple[str, str], list[Node]] = defaultdict(list)
    for node in reversed(other.nodes):
        if node.id not in pairs.back:
            words = same_words(node.label)
            below[words, node.parent].append(node)
            anywhere[words, pairs.other[node.id]].append(node)
    for is_strict in (True, False):
        for node in one.nodes:
            if node.id in pairs.forth:
                continue
            words = same_words(node.label)
            parent = pairs.forth.get(node.parent or "")
            if is_strict:
                choices = [below.get((words, parent.after), [])] if parent else []
            else:
                own = pairs.one[node.id]
                names = (own, "") if own else ("", *(name.casefold() for name in CLASSES))
                choices = [anywhere.get((words, name), []) for name in names]
            for candidates in choices:
                while candidates and candidates[-1].id in pairs.back:
                    candidates.pop()
                if candidates and node.id not in pairs.forth:
                    pairs.add(node.id, candidates[-1].id, "label")


def _by_meaning(
    one: "ScenarioTree", other: "ScenarioTree", pairs: _Pairs, encoder: Encoder, threshold: float
) -> None:
    meanings: dict[str, Vectors] | None = None
    for is_leaf in (True, False):
        for name in ("", *(name.casefold() for name in CLASSES)):
            rows, columns = (
                [
                    node
                    for node in tree.nodes
                    if node.id not in paired
                    and classes[node.id] == name
                    and (not tree.children[node.id]) == is_leaf
                ]
                for tree, paired, classes in (
                    (one, pairs.forth, pairs.one),
                    (other, pairs.back, pairs.other),
                )
            )
            if not rows or not columns:
                continue
            meanings = meanings or _meanings((one, other), encoder)
            left = _vectors(one, rows, meanings), _vectors(other, columns, meanings)
            forth, back = _nearest(*left), _nearest(left[1], left[0])
            for node, index, (cosine, there) in zip(rows, count(), forth, strict=False):
                if cosine >= threshold and back[there][1] == index:
                    pairs.add(node.id, columns[there].id, "meaning", cosine)


def _meanings(trees: "Iterable[ScenarioTree]", encoder: Encoder) -> dict[str, Vectors]:
    """Return the vectors of the labels of both trees, without their common component."""
    labels = list(dict.fromkeys(node.label for tree in trees for node in tree.nodes))
    rows, centre = label_rows(encoder, labels)
    return dict(zip(labels, unit((rows - centre).astype(np.float32)), strict=True))


def _vectors(
    tree: "ScenarioTree", nodes: Sequence[Node], meanings: Mapping[str, Vectors]
) -> Vectors:
    """Return the vectors of nodes: a leaf has its label's; a branch has half its label's and half its leaves'."""
    own = np.array([meanings[node.label] for node in nodes])
    if not tree.children[nodes[0].id]:
        return own
    below: dict[str, Vectors] = {}
    for node in reversed(tree.nodes):
        children = tree.children[node.id]
        below[node.id] = (
            np.sum([below[child] for child in children], axis=0)
            if children
            else meanings[node.label]
        )
    return unit(own + unit(np.array([below[node.id] for node in nodes])))


def _nearest(rows: Vectors, columns: Vectors) -> list[tuple[float, int]]:
    """Return the nearest column of each row, with similarities rounded so that numerical noise decides nothing."""
    found = []
    for start in range(0, len(rows), _BLOCK):
        block = rows[start : start + _BLOCK]
        best = np.full(len(block), -np.inf, np.float32)
        place = np.zeros(len(block), np.int64)
        for offset in range(0, len(columns), _BLOCK):
            cosines = np.round(block @ columns[offset : offset + _BLOCK].T, 4)
            here = cosines.argmax(axis=1)
            values = cosines[np.arange(len(block)), here]
            is_better = values > best
            best[is_better] = values[is_better]
            place[is_better] = here[is_better] + offset
        found += [(round(float(b), 4), int(p)) for b, p in zip(best, place, strict=True)]
    return found
