"""Which node of one tree is which of another: by id, then by label, then by meaning."""

import unicodedata
from collections import defaultdict
from collections.abc import Mapping, Sequence
from itertools import count
from typing import ClassVar, Literal

import numpy as np

from oodscen._data import Data
from oodscen._text import one_line
from oodscen.edits import Node
from oodscen.errors import UsageError
from oodscen.metrics.similarity import Vectors, unit
from oodscen.protocols import Encoder
from oodscen.tree import ScenarioTree

THRESHOLD = 0.65
"""Cosine from which two labels are taken to mean the same, for MiniLM."""

_BLOCK = 1024


class Match(Data):
    """Two nodes that are taken to be one."""

    noun: ClassVar[str] = "match"

    before: str
    """Id in the first tree."""
    after: str
    """Id in the second tree."""
    by: Literal["id", "label", "meaning"]
    similarity: float | None = None
    """Cosine of the meanings, where it decided."""


def match(
    one: ScenarioTree,
    other: ScenarioTree,
    *,
    encoder: Encoder | None = None,
    threshold: float = THRESHOLD,
) -> tuple[Match, ...]:
    """Pair the nodes of two trees, each at most once; in the order of the first tree.

    Roots are a pair. Ids pair where both trees gave them for the same label at first, since trees
    that were grown apart number their ids apart; a tree read from a file without a log is trusted.
    Labels pair without regard to case and spaces, below paired parents first. What is left
    pairs by meaning: leaf with leaf and branch with branch, where each is the other's nearest and
    the cosine is at least the threshold. A leaf means its label; a branch means its label and the
    leaves below it, half and half.

    All is linear in the nodes, but for the cosines of those left over: every pair is looked at, in
    blocks of at most 4 MB.

    Args:
        one: The first tree.
        other: The second tree.
        encoder: Without one, meaning plays no part.
        threshold: Between -1 and 1.

    Raises:
        UsageError: When the threshold is no cosine.
        EncoderError: When the encoder fails.
    """
    if not -1.0 <= threshold <= 1.0:
        raise UsageError(f"the threshold is a cosine, between -1 and 1, not {threshold}")
    pairs = _Pairs()
    for first, second in zip(one.nodes[:1], other.nodes[:1], strict=False):
        pairs.add(first.id, second.id, "id" if first.id == second.id else "label")
    _by_id(one, other, pairs)
    _by_label(one, other, pairs)
    if encoder is not None:
        for is_leaf in (True, False):
            left = _left(one, pairs.forth, is_leaf), _left(other, pairs.back, is_leaf)
            if left[0] and left[1]:
                rows, columns = (
                    _vectors(tree, nodes, encoder)
                    for tree, nodes in zip((one, other), left, strict=True)
                )
                forth, back = _nearest(rows, columns), _nearest(columns, rows)
                for node, index, (cosine, there) in zip(left[0], count(), forth, strict=False):
                    if cosine >= threshold and back[there][1] == index:
                        pairs.add(node.id, left[1][there].id, "meaning", cosine)
    return tuple(pairs.forth[node.id] for node in one.nodes if node.id in pairs.forth)


def same_words(label: str) -> str:
    """Return what two labels share that differ only in case, width and spaces."""
    return one_line(unicodedata.normalize("NFKC", label).casefold())


class _Pairs:
    def __init__(self) -> None:
        self.forth: dict[str, Match] = {}
        self.back: dict[str, Match] = {}

    def add(
        self,
        before: str,
        after: str,
        by: Literal["id", "label", "meaning"],
        similarity: float | None = None,
    ) -> None:
        if before not in self.forth and after not in self.back:
            found = Match(before=before, after=after, by=by, similarity=similarity)
            self.forth[before] = self.back[after] = found


def _by_id(one: ScenarioTree, other: ScenarioTree, pairs: _Pairs) -> None:
    first, second = _first_labels(one), _first_labels(other)
    for node in one.nodes:
        if node.id in other.by_id:
            labels = {first[node.id], second[node.id]}
            if len(labels - {None}) < 2:
                pairs.add(node.id, node.id, "id")


def _first_labels(tree: ScenarioTree) -> Mapping[str, str | None]:
    """Return the label that every id was given for; `None` where a file does not say."""
    found: dict[str, str | None] = {}
    for edit in tree.edits:
        if edit.op == "add" and edit.node not in found:
            found[edit.node] = None if edit.stage == "file" else same_words(edit.label or "")
    return found


def _by_label(one: ScenarioTree, other: ScenarioTree, pairs: _Pairs) -> None:
    below: dict[tuple[str, str | None], list[Node]] = defaultdict(list)
    anywhere: dict[str, list[Node]] = defaultdict(list)
    for node in reversed(other.nodes):
        if node.id not in pairs.back:
            below[same_words(node.label), node.parent].append(node)
            anywhere[same_words(node.label)].append(node)
    for is_strict in (True, False):
        for node in one.nodes:
            if node.id in pairs.forth:
                continue
            words = same_words(node.label)
            parent = pairs.forth.get(node.parent or "")
            if is_strict:
                candidates = below.get((words, parent.after), []) if parent else []
            else:
                candidates = anywhere.get(words, [])
            while candidates and candidates[-1].id in pairs.back:
                candidates.pop()
            if candidates:
                pairs.add(node.id, candidates.pop().id, "label")


def _left(tree: ScenarioTree, paired: Mapping[str, Match], is_leaf: bool) -> list[Node]:
    return [
        node
        for node in tree.nodes
        if node.id not in paired and (not tree.children[node.id]) == is_leaf
    ]


def _vectors(tree: ScenarioTree, nodes: Sequence[Node], encoder: Encoder) -> Vectors:
    """Return what nodes mean: a leaf its label, a branch half its label and half its leaves."""
    own = _encoded(nodes, encoder)
    if not tree.children[nodes[0].id]:
        return own
    leaves = [node for node in tree.nodes if not tree.children[node.id]]
    below = dict(zip((leaf.id for leaf in leaves), _encoded(leaves, encoder), strict=True))
    for node in reversed(tree.nodes):
        children = tree.children[node.id]
        if children:
            below[node.id] = np.sum([below[child] for child in children], axis=0)
    return unit(own + unit(np.array([below[node.id] for node in nodes])))


def _encoded(nodes: Sequence[Node], encoder: Encoder) -> Vectors:
    return unit(encoder.encode([node.label for node in nodes]))


def _nearest(rows: Vectors, columns: Vectors) -> list[tuple[float, int]]:
    """Return the nearest column of each row; rounded, so that rounding errors decide nothing."""
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
