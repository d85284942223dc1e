"""Verdicts as arrays over the items of a study: its scenes and their twins, in one order."""

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from oodscen.data._episode import ActionOutcome, Episode, has_enough_margin
from oodscen.data._pairing import kind_of, leaf_in, scene_of
from oodscen.data._verdict import Protocol, Verdict
from oodscen.judging._aspects.opinions import is_open

if TYPE_CHECKING:
    from oodscen.data._scenario import Scenario
    from oodscen.judging._scoring import AnswerKey

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]
Value = TypeVar("Value")
Level = Literal["class", "family", "path"]

CAUTIOUS = frozenset(("stop", "emergency_brake", "pull_over"))
"""Stops, which are needless on a road where keeping the speed is safe."""
DISTURBING = CAUTIOUS | {"change_lane_left", "change_lane_right"}
"""Actions that are not right in an ordinary drive in which keeping the speed is safe."""


def last_by(values: Iterable[Value], key: Callable[[Value], Hashable]) -> list[Value]:
    """Return the last value of every key, in the order in which the keys came first."""
    return list({key(value): value for value in values}.values())


def unnamed_scenes(episodes: Iterable[Episode]) -> set[str]:
    """Return the ids of scenes whose hazard cannot be named at the decision, and which are not judged."""
    latest = last_by(episodes, lambda episode: episode.scene_id)
    return {episode.scene_id for episode in latest if episode.is_below_floor}


def judged_episodes(episodes: Iterable[Episode]) -> list[Episode]:
    """Return the last episode of every item, without `unnamed_scenes` and their ordinary drives."""
    latest = last_by(episodes, lambda episode: episode.scene_id)
    unnamed = unnamed_scenes(latest)
    return [episode for episode in latest if scene_of(episode.scene_id) not in unnamed]


@dataclass(frozen=True, eq=False)
class Items:
    """The items of a study: every scene and twin that ran, with its path and safe set."""

    episodes: Sequence[Episode]
    index: Mapping[str, int]
    """Row of every scene id."""
    leaves: Sequence[str]
    clusters: Sequence[str]
    """The path of every item; a twin has its scene's path."""
    levels: Mapping[Level, Sequence[str]]
    """The label of every item at each level of the tree."""
    is_scene: Mask
    kinds: Sequence[str]
    """The kind of every item: `rare` for scenes, `twin` or `demand` for ordinary drives."""
    owners: NDArray[np.int64]
    """[n] row of the scene that an ordinary drive belongs to; -1 for scenes, and without that scene."""
    safe: Floats
    """[n] number of safe actions."""
    unsafe: Floats
    """[n] number of actions that can be executed and are unsafe; marginal ones are neither."""
    has_actions: Mask
    chance: Floats
    """[n] probability that an action drawn at random from those that score is safe; 0 if there are none."""
    keeping_is_safe: Mask
    """[n] items in which keeping the speed is safe with enough margin."""

    @classmethod
    def of(cls, episodes: Iterable[Episode], truths: Mapping[str, "Scenario | AnswerKey"]) -> Self:
        """Return the items of a study; failed episodes are skipped, and the last episode of an item counts.

        `truths` are the scenarios or keys that give the leaf and the path of each scene, by its id.
        """
        latest = last_by(episodes, lambda episode: episode.scene_id)
        ran = [episode for episode in latest if episode.status == "ok"]
        sources = [truths.get(scene_of(episode.scene_id)) for episode in ran]
        paths = [source.path if source else () for source in sources]
        leaves = [
            source.leaf if source and source.leaf else leaf_in(episode.scene_id)
            for source, episode in zip(sources, ran, strict=True)
        ]
        kinds = [kind_of(episode.scene_id) for episode in ran]
        index = {episode.scene_id: row for row, episode in enumerate(ran)}
        owners = [
            -1 if kind == "rare" else index.get(scene_of(episode.scene_id), -1)
            for kind, episode in zip(kinds, ran, strict=True)
        ]
        safe = _action_counts(ran, lambda outcome: outcome.safe)
        scoring = _action_counts(ran, lambda outcome: not outcome.marginal)
        return cls(
            episodes=ran,
            index=index,
            leaves=leaves,
            clusters=[" > ".join(path) or leaf for path, leaf in zip(paths, leaves, strict=True)],
            levels={
                "class": [path[1] if len(path) > 1 else "" for path in paths],
                "family": [path[2] if len(path) > 3 else "" for path in paths],
                "path": [path[-1] if len(path) > 2 else "" for path in paths],
            },
            is_scene=np.array([kind == "rare" for kind in kinds], np.bool_),
            kinds=kinds,
            owners=np.array(owners, np.int64),
            safe=safe,
            unsafe=_action_counts(ran, lambda outcome: outcome.is_unsafe),
            has_actions=np.array([bool(episode.actions) for episode in ran], np.bool_),
            chance=np.divide(safe, scoring, out=np.zeros_like(safe), where=scoring > 0),
            keeping_is_safe=np.array([keeping_is_safe(episode) for episode in ran], np.bool_),
        )

    @property
    def is_decidable(self) -> Mask:
        """[n] scenes in which one action is safe and another is not."""
        return self.is_scene & (self.safe > 0) & (self.unsafe > 0)

    def chance_over(self, mask: Mask) -> float | None:
        """Return the mean score of a random action over the items in a mask; `None` if it is empty."""
        return float(self.chance[mask].mean()) if mask.any() else None

    def parent(self, level: Level, row: int) -> str:
        """Return the label one level above an item's."""
        if level == "class":
            return ""
        family = self.levels["family"][row] if level == "path" else ""
        return family or self.levels["class"][row]

    def leaf_of(self, scene: str) -> str:
        """Return the leaf that a scene realises; for an unknown scene, the one that its id begins with."""
        row = self.index.get(scene)
        return leaf_in(scene) if row is None else self.leaves[row]


def _action_counts(
    episodes: Sequence[Episode], is_counted: Callable[[ActionOutcome], bool]
) -> Floats:
    """Return the [n] numbers of actions with a certain outcome."""
    counts = [sum(map(is_counted, episode.actions.values())) for episode in episodes]
    return np.array(counts, np.float64)


VALUES = (
    "called",
    "p_ood",
    "stated",
    "open",
    "closed",
    "safe",
    "success",
    "cautious",
    "fitting",
    "neutral",
)
"""Names of the values of an answer."""


def answer_values(verdict: Verdict, episode: Episode) -> dict[str, float]:
    """Return the values of the answers about one item, by the names in `VALUES`; NaN marks a missing answer."""
    action = verdict.action
    outcome = episode.actions.get(action or "")
    is_safe = verdict.action_is_safe
    is_needless = action in DISTURBING and keeping_is_safe(episode)
    values: dict[str, float | None] = {
        "called": verdict.is_ood,
        "p_ood": verdict.p_ood,
        "stated": verdict.is_ood is not None and verdict.confidence is not None,
        "open": verdict.aspect_is_right,
        "closed": verdict.choice_is_right,
        "safe": is_safe,
        "success": verdict.success,
        "cautious": action in CAUTIOUS if action else None,
        "fitting": False if is_needless else is_safe,
        "neutral": outcome is not None and is_safe is None,
    }
    return {name: np.nan if value is None else float(value) for name, value in values.items()}


def keeping_is_safe(episode: Episode) -> bool:
    """Return whether keeping the speed is safe with enough margin."""
    return "keep_speed" in episode.actions and has_enough_margin(episode.actions["keep_speed"])


@dataclass(frozen=True, eq=False)
class AnswerColumns:
    """The answers of one answerer as [n] columns; NaN marks a missing answer."""

    was_asked: Mask
    called: Floats
    """1 if the item was called out of the ordinary."""
    p_ood: Floats
    stated: Mask
    """True if a confidence came with the answer."""
    open: Floats
    closed: Floats
    safe: Floats
    success: Floats
    cautious: Floats
    """1 if the action is one of `CAUTIOUS`."""
    fitting: Floats
    """1 if the action is safe, 0 if it is not or is one of `DISTURBING` where keeping the speed is safe."""
    scorer: Sequence[str | None]
    """[n] the judge that scored the open aspect; empty for the matcher, `None` if there was nothing to score."""
    is_neutral: Mask
    """True if the chosen action is marginal: it scores neither way, and is not missing."""

    @classmethod
    def of(cls, items: Items, verdicts: Iterable[Verdict]) -> Self:
        """Return the verdicts of one answerer as columns, the last of an item; unknown items are skipped."""
        known = last_by(
            (verdict for verdict in verdicts if verdict.scene_id in items.index),
            lambda verdict: verdict.scene_id,
        )
        values = {
            verdict.scene_id: answer_values(verdict, items.episodes[items.index[verdict.scene_id]])
            for verdict in known
        }
        scorers = {verdict.scene_id: verdict.judge for verdict in known if is_open(verdict)}
        return cls.of_values(items, values, scorers)

    @classmethod
    def of_values(
        cls,
        items: Items,
        values: Mapping[str, Mapping[str, float]],
        scorers: Mapping[str, str] = MappingProxyType({}),
    ) -> Self:
        """Return answers as columns, from their values by item as `answer_values` returns them.

        Means over several answers are values too, and a value that is left out is missing. `scorers` are the judges
        that scored the open aspects, by item.
        """
        n = len(items.episodes)
        columns = {name: np.full(n, np.nan) for name in VALUES}
        was_asked = np.zeros(n, np.bool_)
        scorer: list[str | None] = [None] * n
        for item, item_values in values.items():
            row = items.index[item]
            was_asked[row] = True
            scorer[row] = scorers.get(item)
            for name, column in columns.items():
                column[row] = item_values.get(name, np.nan)
        stated, neutral = columns.pop("stated") > 0, columns.pop("neutral") > 0
        return cls(
            was_asked=was_asked,
            stated=stated,
            scorer=scorer,
            is_neutral=neutral & ~np.isfinite(columns["safe"]),
            **columns,
        )

    def right(self, task: str, items: Items) -> Floats:
        """Return [n] 1 if the answer in a task is right, 0 if it is wrong, NaN if it is missing."""
        if task == "detection":
            return np.where(items.is_scene, self.called, 1.0 - self.called)
        values: Floats = {"open": self.open, "closed": self.closed, "control": self.safe}[task]
        return np.where(items.is_scene, values, np.nan)

    def unanswered(self, task: str, items: Items) -> Mask:
        """Return the [n] items that were asked about in a task and got no answer."""
        mask = np.ones_like(items.is_scene) if task == "detection" else items.is_scene
        if task == "control":
            mask = mask & ~self.is_neutral
        return mask & self.was_asked & ~np.isfinite(self.right(task, items))

    def scored_unlike(self, other: Self) -> Mask:
        """Return the [n] items whose open aspects, of both answerers, different judges scored."""
        pairs = zip(self.scorer, other.scorer, strict=True)
        return np.array([None not in (a, b) and a != b for a, b in pairs], np.bool_)


Sheets = Mapping[tuple[str, Protocol], AnswerColumns]
"""The answers by answerer and protocol."""


@dataclass(frozen=True, eq=False)
class Ratio:
    """A ratio of two sums over some items: the values, divided by the count or by a maximum."""

    values: Floats
    """[n] numerators; NaN marks a missing answer."""
    mask: Mask
    """[n] the items that count."""
    most: Floats | None = None
    """[n] denominator of every item; 1 if left out."""
    is_neutral: Mask | None = None
    """[n] answers that score neither way, and do not count as missing."""

    @cached_property
    def is_there(self) -> Mask:
        """[n] items that count and got an answer."""
        return self.mask & np.isfinite(self.values)

    @cached_property
    def above(self) -> Floats:
        """[n] numerators of the answered items that count, 0 elsewhere."""
        return np.where(self.is_there, self.values, 0.0)

    @cached_property
    def below(self) -> Floats:
        """[n] denominators of the answered items that count, 0 elsewhere."""
        return np.where(self.is_there, 1.0 if self.most is None else self.most, 0.0)

    def missing(self, sheet: AnswerColumns) -> Mask:
        """Return the [n] items that were asked about and got no answer."""
        missing = self.mask & sheet.was_asked & ~self.is_there
        return missing if self.is_neutral is None else missing & ~self.is_neutral
