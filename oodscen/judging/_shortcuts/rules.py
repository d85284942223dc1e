"""Rules of one number, with the threshold and the direction learnt on other paths."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from oodscen.data._episode import Episode
from oodscen.data._verdict import Verdict, verdict_id
from oodscen.judging._items import Items, Mask
from oodscen.judging._shortcuts.facts import ground_truth
from oodscen.statistics._intervals import Floats

Calls = tuple[str, Mapping[str, bool]]
"""The name of a shortcut, and by item whether it calls it out of the ordinary."""

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
            sign, threshold = _best_threshold(values[~test], is_rare[~test])
            score[test] = sign * values[test]
            called[test] = sign * values[test] >= threshold
        return cls(name, score, called)

    def balanced(self, is_rare: Mask) -> float:
        """Return the mean of the shares of rare and ordinary items that are called rightly."""
        return float(self.is_called[is_rare].mean() + (~self.is_called[~is_rare]).mean()) / 2

    def calls(self, episodes: Sequence[Episode]) -> dict[str, bool]:
        """Return by scene id whether an item is called out of the ordinary."""
        names = [episode.scene_id for episode in episodes]
        return dict(zip(names, self.is_called.tolist(), strict=True))


def _best_threshold(values: Floats, is_rare: Mask) -> tuple[float, float]:
    """Return the direction and the threshold with the best balanced accuracy."""
    if not is_rare.any() or is_rare.all():
        return 1.0, np.inf
    rules = []
    shares = np.linspace(0, 1, _THRESHOLDS + 1)
    for sign in (1.0, -1.0):
        signed = sign * values
        thresholds = np.unique(np.quantile(signed, shares, method="nearest"))
        called_rare = (signed[is_rare][:, None] >= thresholds).mean(axis=0)
        called_ordinary = (signed[~is_rare][:, None] >= thresholds).mean(axis=0)
        gain = called_rare - called_ordinary
        best = int(np.argmax(gain))
        rules.append((float(gain[best]), sign, float(thresholds[best])))
    _, sign, threshold = max(rules)
    return sign, threshold


def folds_of(clusters: Sequence[str]) -> Floats:
    """Return the fold of every item: whole paths, whatever the order of the items."""
    number_of = {path: number for number, path in enumerate(sorted(set(clusters)))}
    return np.array([number_of[path] % FOLDS for path in clusters], np.float64)


def is_audited(items: Items) -> Mask:
    """Return [n] the items of scenes that have an ordinary drive."""
    has_scene = items.owners >= 0
    scene = np.where(has_scene, items.owners, np.arange(len(items.episodes)))
    has_drive = np.zeros(len(items.episodes), np.bool_)
    has_drive[items.owners[has_scene]] = True
    return (items.is_scene | has_scene) & has_drive[scene]


def rule_calls(items: Items) -> Calls | None:
    """Return the calls of the best rule on the bodies that the simulator knows; `None` without two paths."""
    rows: list[int] = np.flatnonzero(is_audited(items)).tolist()
    clusters = [items.clusters[row] for row in rows]
    if len(set(clusters)) < 2:
        return None
    episodes = [items.episodes[row] for row in rows]
    is_rare, folds = items.is_scene[rows], folds_of(clusters)
    facts = ground_truth(episodes)
    guesses = [Guess.of(name, values, is_rare, folds) for name, values in facts.items()]
    best = max(guesses, key=lambda guess: guess.balanced(is_rare))
    return best.name, best.calls(episodes)


def shortcut_verdicts(items: Items, calls: Calls | None) -> list[Verdict]:
    """Return the calls of a shortcut as verdicts of a reference, which has no action and names nothing."""
    if calls is None:
        return []
    name, by_item = calls
    model = f"shortcut: {name}"
    return [
        Verdict(
            id=verdict_id(item, model),
            scene_id=item,
            model=model,
            kind="reference",
            is_ordinary=not items.is_scene[items.index[item]],
            is_ood=is_called,
        )
        for item, is_called in by_item.items()
        if item in items.index
    ]
