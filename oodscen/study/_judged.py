"""The part of a study that answerers are judged on, and the keys to their answers."""

from collections.abc import Sequence
from typing import NamedTuple

from oodscen.data._episode import Episode
from oodscen.data._pairing import scene_of
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.data._verdict import Protocol
from oodscen.judging._items import judged_episodes, unnamed_scenes
from oodscen.judging._kinds import Kinds
from oodscen.judging._questions import aspect_options
from oodscen.judging._references import AspectOption
from oodscen.judging._scoring import AnswerKey
from oodscen.judging._selection import choose_items
from oodscen.study._config import StudyConfig


class Judged(NamedTuple):
    """The part of a study that answerers are judged on."""

    episodes: list[Episode]
    """The episodes without those of scenes whose hazard cannot be named at the decision."""
    asked: list[Episode]
    """The episodes that answerers are asked about."""
    scenes: list[Scene]

    @classmethod
    def of(
        cls, episodes: Sequence[Episode], scenes: Sequence[Scene], config: StudyConfig
    ) -> "Judged":
        """Return the part of a study's episodes and scenes that answerers are judged on."""
        asked = choose_items(episodes, count=config.ordinary, seed=config.seed)
        unnamed = unnamed_scenes(episodes)
        judged = judged_episodes(episodes)
        return cls(judged, asked, [scene for scene in scenes if scene.id not in unnamed])


class AnswerKeys:
    """The keys to the answers about the drives of a study.

    Args:
        scenarios: The texts.
        scenes: The scenes of the texts.
        seed: The study's seed.
    """

    def __init__(
        self, scenarios: Sequence[Scenario], scenes: Sequence[Scene], *, seed: int
    ) -> None:
        self._scenarios = {scenario.id: scenario for scenario in scenarios}
        self._scenes = {scene.id: scene for scene in scenes}
        self._seed = seed
        self._keys: dict[tuple[str, Protocol], AnswerKey] = {}
        self._kinds = Kinds.of(scenarios, {scene.id: scene.map for scene in scenes}, seed=seed)

    def of(self, episode: Episode, protocol: Protocol) -> AnswerKey:
        """Return the key to the answers about an episode, with the options of the closed question."""
        name = episode.scene_id, protocol
        if name not in self._keys:
            self._keys[name] = self._key(episode, protocol)
        return self._keys[name]

    def _key(self, episode: Episode, protocol: Protocol) -> AnswerKey:
        scene_id = scene_of(episode.scene_id)
        scenario, scene = self._scenarios.get(scene_id), self._scenes.get(scene_id)
        leaf = scenario.leaf if scenario else ""
        options: tuple[AspectOption, ...] = ()
        if protocol == "ours":
            kinds = self._kinds.offered(leaf, scene.map if scene else "")
            options = aspect_options(kinds, seed=self._seed, item=episode.scene_id)
        return AnswerKey.of(
            episode,
            path=scenario.path if scenario else (),
            leaf=leaf,
            visible=scene.visible if scene else (),
            options=options,
        )


def is_shown(episode: Episode) -> bool:
    """Return whether there is something to show of an episode."""
    return episode.status == "ok" and bool(episode.frames)
