"""Near-duplicates of a proposal among the labels of the leaves and among earlier proposals."""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from oodscen._paper import FEW_SHOTS
from oodscen._words.text import folded_words
from oodscen.encoders._centring import Vector, label_rows, unit_rows
from oodscen.encoders._check import dimension
from oodscen.protocols import Encoder
from oodscen.stages._redteam.rounds import Round
from oodscen.stages._redteam.shared_words import shared_word_scores
from oodscen.stages._redteam.thresholds import NEAREST_LABEL, NEAREST_TEXT
from oodscen.tree._scenario_tree import ROOT, ScenarioTree


class ClosestText(NamedTuple):
    """The leaf or earlier proposal that is most similar to a proposal."""

    similarity: float | None
    """Cosine, rounded to four decimals; `None` if nothing was compared."""
    node: str | None
    """Id of the leaf, or of the leaf that the earlier proposal stands for."""
    by: Literal["label", "text"] | None
    words: str
    """The most similar label or text."""
    is_too_near: bool


class NoveltyFilter:
    """Remembers leaves and proposals, and compares a new proposal with them.

    Sentences about driving share a frame ("The ego vehicle is driving on ...") that makes all of them
    similar. Vectors are therefore centred before cosines are taken: those of proposals on the mean of the
    few-shot examples and all proposals so far, those of labels on the mean of the initial labels. Without an
    encoder only literal repetitions are found.

    Every text is encoded separately and in the order of the rounds, so that neither threads nor a resumed run
    change a bit.

    Args:
        tree: The tree before the first round.
        encoder: Turns texts into vectors.
        text: Similarity to an earlier proposal from which a proposal is too near.
        label: Similarity to a leaf's label from which a proposal is too near.
        shown: The few-shot examples of the red-LLM.
    """

    def __init__(
        self,
        tree: ScenarioTree,
        encoder: Encoder | None = None,
        *,
        text: float = NEAREST_TEXT,
        label: float = NEAREST_LABEL,
        shown: Sequence[str] = FEW_SHOTS,
    ) -> None:
        self._encoder = encoder
        self._limits = {"text": text, "label": label}
        self._literal: dict[str, str] = {}
        self._leaves: dict[str, str] = {leaf.id: leaf.label for leaf in tree.leaves}
        self._labels: dict[str, Vector] = {}
        self._proposed: list[str] = []
        self._kinds: list[str] = []
        self._texts = np.empty((0, 0))
        if encoder is None:
            return
        labels = list(self._leaves.values())
        rows, self._label_centre = label_rows(encoder, labels)
        self._labels = dict(zip(labels, rows, strict=True))
        frames = unit_rows(encoder, shown) if shown else np.zeros((0, dimension(encoder)))
        self._text_sum: Vector = frames.sum(axis=0)
        self._text_count = len(frames)
        self._texts = np.empty((16, dimension(encoder)))

    def closest(self, text: str) -> ClosestText:
        """Compare a proposal with all leaves and all earlier proposals."""
        if (kind := self._literal.get(folded_words(text))) is not None:
            return ClosestText(1.0, kind, "text", text, True)
        if self._encoder is None:
            return ClosestText(None, None, None, "", False)
        vector = self._vector(text)
        texts: list[ClosestText] = []
        if self._leaves:
            ids = list(self._leaves)
            cosines = _cosines(self._label_rows(), vector)
            best = int(cosines.argmax())
            label = self._leaves[ids[best]]
            texts.append(self._compared(float(cosines[best]), ids[best], "label", label))
        if self._proposed:
            cosines = _cosines(self._texts[: len(self._proposed)] - self._text_centre, vector)
            best = int(cosines.argmax())
            kind, words = self._kinds[best], self._proposed[best]
            texts.append(self._compared(float(cosines[best]), kind, "text", words))
        if not texts:
            return ClosestText(None, None, None, "", False)
        return max(texts, key=lambda closest: (closest.is_too_near, self._excess(closest)))

    def rank_leaves(self, text: str, tree: ScenarioTree) -> list[str]:
        """Return the ids of a tree's leaves, ordered from the nearest to a text."""
        leaves = tree.leaves
        labels = [leaf.label for leaf in leaves]
        if self._encoder is None or not leaves:
            scores = shared_word_scores(text, labels)
        else:
            rows = np.stack([self._label(label) for label in labels]) - self._label_centre
            cosines = _cosines(rows, self._vector(text))
            scores = [round(float(cosine), 4) for cosine in cosines]
        order = sorted(range(len(leaves)), key=lambda index: (-scores[index], index))
        return [leaves[index].id for index in order]

    def learn(self, item: Round, tree: ScenarioTree) -> None:
        """Remember the proposal and the changes of a round that led to a tree."""
        for edit in item.edits:
            self._update(edit.node, tree)
            if edit.parent is not None:
                self._update(edit.parent, tree)
        if item.decision == "split":
            whole, old = item.edits[0].node, item.edits[1].node
            self._kinds = [old if kind == whole else kind for kind in self._kinds]
            self._literal = {
                words: old if kind == whole else kind for words, kind in self._literal.items()
            }
        if not item.text or item.kind is None:
            return
        self._literal.setdefault(folded_words(item.text), item.kind)
        if self._encoder is None or item.decision == "duplicate":
            return
        row = self._raw(item.text)
        if len(self._proposed) == len(self._texts):
            self._texts = np.concatenate([self._texts, np.empty_like(self._texts)])
        self._texts[len(self._proposed)] = row
        self._proposed.append(item.text)
        self._kinds.append(item.kind)
        self._text_sum = self._text_sum + row
        self._text_count += 1

    def _update(self, node_id: str, tree: ScenarioTree) -> None:
        node = tree.by_id.get(node_id)
        is_top = node is None or node.parent in (None, ROOT)
        if node is None or is_top or tree.children[node_id]:
            self._leaves.pop(node_id, None)
        else:
            self._leaves[node_id] = node.label

    def _compared(
        self, cosine: float, node: str, by: Literal["label", "text"], words: str
    ) -> ClosestText:
        similarity = round(cosine, 4)
        return ClosestText(similarity, node, by, words, similarity >= self._limits[by])

    def _excess(self, closest: ClosestText) -> float:
        return (closest.similarity or 0.0) - self._limits[closest.by or "text"]

    @property
    def _text_centre(self) -> Vector:
        centre: Vector = self._text_sum / max(self._text_count, 1)
        return centre

    def _vector(self, text: str) -> Vector:
        return self._raw(text) - self._text_centre

    def _raw(self, text: str) -> Vector:
        assert self._encoder is not None
        row: Vector = unit_rows(self._encoder, [text])[0]
        return row

    def _label(self, label: str) -> Vector:
        if label not in self._labels:
            self._labels[label] = self._raw(label)
        return self._labels[label]

    def _label_rows(self) -> Vector:
        rows: Vector = np.stack([self._label(label) for label in self._leaves.values()])
        return rows - self._label_centre


def _cosines(rows: Vector, vector: Vector) -> Vector:
    """Return the cosine of each row with a vector; uses sums instead of BLAS for bit-exact results."""
    dots = (rows * vector).sum(axis=1)
    lengths = np.sqrt((rows * rows).sum(axis=1) * (vector * vector).sum())
    return np.asarray(np.divide(dots, lengths, out=np.zeros_like(dots), where=lengths > 0.0))
