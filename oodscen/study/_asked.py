"""The drives of a study that answerers are asked about, each with its frames, options and truth."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from oodscen.data._episode import Episode
from oodscen.data._messages import Image
from oodscen.data._pairing import scene_of
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.judging._kinds import Kinds
from oodscen.judging._questions import ShownDrive, aspect_options
from oodscen.judging._references import AspectOption
from oodscen.judging._scoring import AnswerKey, Truth
from oodscen.judging._selection import choose_items
from oodscen.protocols import Camera
from oodscen.study._frames import frames_of
from oodscen.study._stale import refuse_stale

if TYPE_CHECKING:
    from oodscen.study._store import Store
    from oodscen.study._study import Study


@dataclass(frozen=True)
class AskedDrive:
    """A scene, or the ordinary drive that goes with it, as answerers are asked about it."""

    episode: Episode
    scenario: Scenario | None
    """The text of the scene, or of the scene to which the ordinary drive belongs."""
    scene: Scene | None
    options: tuple[AspectOption, ...]
    """Options of the closed question, as shown."""
    store: "Store"
    """The study's folder, which holds the pictures."""
    camera: Camera
    """The camera of the frames."""

    @cached_property
    def frames(self) -> Mapping[str, Image]:
        """The pictures by moment.

        Raises:
            DataError: If one is not the recorded frame, cannot be shown, or lies outside the study.
        """
        episode = self.episode
        return frames_of(self.store, episode.frames, episode.file_sha256, self.camera)

    @property
    def shown(self) -> ShownDrive:
        """The frames in order, and the facts that go with them."""
        return ShownDrive.of(self.episode, self.frames)

    @property
    def key(self) -> AnswerKey:
        """Everything that answers are scored by."""
        return AnswerKey.of(self.episode, self.truth, self.options)

    @property
    def truth(self) -> Truth:
        """The truth about the drive."""
        return Truth.of(self.scenario, self.scene)


def asked_drives(study: "Study") -> list[AskedDrive]:
    """Return the drives of a study that ran and have frames, in the study's order.

    Scenes whose hazard cannot be named at the decision are left out together with their ordinary drives.

    Raises:
        DataError: If a table of the study cannot be read or is malformed.
        UsageError: If a scene or its text has changed since it was run.
    """
    config, episodes = study.config, study.episodes
    scenarios = {scenario.id: scenario for scenario in study.scenarios}
    scenes = {scene.id: scene for scene in study.scenes}
    refuse_stale(study, episodes, scenes.values())
    maps = {name: scene.map for name, scene in scenes.items()}
    kinds = Kinds.of(list(scenarios.values()), maps, seed=config.seed)
    drives = []
    for episode in choose_items(episodes, count=config.ordinary, seed=config.seed):
        name = scene_of(episode.scene_id)
        if episode.status != "ok" or not episode.frames:
            continue
        scenario, scene = scenarios.get(name), scenes.get(name)
        offered = kinds.offered(scenario.leaf if scenario else "", maps.get(name, ""))
        options = aspect_options(offered, seed=config.seed, item=episode.scene_id)
        drives.append(AskedDrive(episode, scenario, scene, options, study.store, config.camera))
    return drives
