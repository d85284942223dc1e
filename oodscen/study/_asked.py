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
from oodscen.judging._questions import ShownDrive
from oodscen.judging._references import AspectOption
from oodscen.judging._scoring import AnswerKey
from oodscen.protocols import Camera
from oodscen.study._frames import frames_of, rear_view_of
from oodscen.study._judged import AnswerKeys, Judged, is_shown
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
    key: AnswerKey
    """Everything that answers are scored by."""
    store: "Store"
    """The study's folder, which holds the pictures."""
    camera: Camera
    """The camera of the frames."""
    shows_rear: bool
    """The study's questions show the view from the rear window as well."""
    behind: Episode | None
    """The run in which that view was taken."""

    @cached_property
    def frames(self) -> Mapping[str, Image]:
        """The pictures by moment.

        Raises:
            DataError: If one is not the recorded frame, cannot be shown, or lies outside the study.
        """
        episode = self.episode
        return frames_of(self.store, episode.frames, episode.file_sha256, self.camera)

    @cached_property
    def rear(self) -> Image | None:
        """The view from the rear window at the decision; `None` if the study's questions do not show it.

        Raises:
            DataError: If they do, and it was not taken or is not the recorded one.
        """
        if not self.shows_rear:
            return None
        return rear_view_of(self.store, self.episode.scene_id, self.behind, self.camera)

    @property
    def shown(self) -> ShownDrive:
        """The frames in order, the facts that go with them, and the view to the rear if there is one."""
        return ShownDrive.of(self.episode, self.frames, rear=self.rear)

    @property
    def options(self) -> tuple[AspectOption, ...]:
        """The options of the closed question, as shown."""
        return self.key.options


def asked_drives(study: "Study") -> list[AskedDrive]:
    """Return the drives of a study that ran and have frames, in the study's order.

    Scenes whose hazard cannot be named at the decision are left out together with their ordinary drives.

    Raises:
        DataError: If a table of the study cannot be read or is malformed.
        UsageError: If a scene or its text has changed since it was run.
    """
    config, scenarios, scenes = study.config, study.scenarios, study.scenes
    episodes = study.episodes
    refuse_stale(study, episodes, scenes)
    judged = Judged.of(episodes, scenes, config)
    keys = AnswerKeys(scenarios, judged.scenes, seed=config.seed)
    scenario_by_id = {scenario.id: scenario for scenario in scenarios}
    scene_by_id = {scene.id: scene for scene in judged.scenes}
    behind = {episode.scene_id: episode for episode in study.rear_episodes}
    return [
        AskedDrive(
            episode,
            scenario_by_id.get(scene_of(episode.scene_id)),
            scene_by_id.get(scene_of(episode.scene_id)),
            keys.of(episode, "ours"),
            study.store,
            config.camera,
            config.rear_view,
            behind.get(episode.scene_id),
        )
        for episode in judged.asked
        if is_shown(episode)
    ]
