"""Rules of one number, with the threshold and the direction learnt on other paths."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from oodscen.judging._items import Items, Mask
from oodscen.judging._shortcuts.facts import ground_truth
from oodscen.statistics._intervals import Floats

FOLDS = 5
_THRESHOLDS = 100


@dataclass(frozen=True, eq=False)
class Guess:
    """The calls of a shortcut, each made by what it learnt on other paths."""

    name: str
    score: Floats
    """[n] higher is more out of the ordinary."""
    is_called: Mask
    """[n] true where the item is called out of the ordinary."""

    @classmethod
    def of(cls, name: str, values: Floats, is_rare: Mask, folds: Floats) -> Self:
        """Return the calls of a rule on one number per item."""
        score, called = np.zeros(len(values)), np.zeros(len(values), np.bool_)
        for fold in np.unique(folds):
            test = folds == fold
            sign, bar = _learnt(values[~test], is_rare[~test])
            score[test] = sign * values[test]
            called[test] = sign * values[test] >= bar
        return cls(name, score, called)

    def balanced(self, is_rare: Mask) -> float:
        """Return the mean of the shares of rare and ordinary items that are called rightly."""
        return float(self.is_called[is_rare].mean() + (~self.is_called[~is_rare]).mean()) / 2


def _learnt(values: Floats, is_rare: Mask) -> tuple[float, float]:
    """Return the direction and the threshold with the best balanced accuracy."""
    if not is_rare.any() or is_rare.all():
        return 1.0, np.inf
    found = []
    for sign in (1.0, -1.0):
        signed = sign * values
        bars = np.unique(np.quantile(signed, np.linspace(0, 1, _THRESHOLDS + 1), method="nearest"))
        rare = (signed[is_rare][:, None] >= bars).mean(axis=0)
        usual = (signed[~is_rare][:, None] >= bars).mean(axis=0)
        best = int(np.argmax(rare - usual))
        found.append((float((rare - usual)[best]), sign, float(bars[best])))
    _, sign, bar = max(found)
    return sign, bar


def folds_of(clusters: Sequence[str]) -> Floats:
    """Return the fold of every item: whole paths, whatever the order of the items."""
    place = {label: index for index, label in enumerate(sorted(set(clusters)))}
    return np.array([place[label] % FOLDS for label in clusters], np.float64)


def is_audited(items: Items) -> Mask:
    """[n] Return the items that are judged: those of scenes whose hazard can be named, with an ordinary drive."""
    scene = np.where(items.owners >= 0, items.owners, np.arange(len(items.episodes)))
    paired = np.zeros(len(items.episodes), np.bool_)
    paired[items.owners[items.owners >= 0]] = True
    named = np.array([not one.is_below_floor for one in items.episodes], np.bool_)
    is_known = items.is_scene | (items.owners >= 0)
    return is_known & paired[scene] & named[scene] if len(scene) else is_known


def best_rule(items: Items) -> tuple[Guess, Mask] | None:
    """Return the best rule on the bodies that the simulator knows, over the audited items; `None` without two paths."""
    there = is_audited(items)
    rows: list[int] = np.flatnonzero(there).tolist()
    clusters = [items.clusters[row] for row in rows]
    if len(set(clusters)) < 2:
        return None
    rare, folds = items.is_scene[there], folds_of(clusters)
    facts = ground_truth([items.episodes[row] for row in rows])
    guesses = [Guess.of(name, values, rare, folds) for name, values in facts.items()]
    return max(guesses, key=lambda guess: guess.balanced(rare)), there
