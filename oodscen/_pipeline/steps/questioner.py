"""Questions to one answerer about one drive, with the pictures that it is shown."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from oodscen._pipeline.context import Context
from oodscen.data._episode import MOMENTS, Episode, moments
from oodscen.data._messages import Image
from oodscen.data._pairing import scene_of
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.data._verdict import Protocol, Verdict
from oodscen.errors import DataError, Issue
from oodscen.judging._kinds import Kinds
from oodscen.judging._questions import Shown, aspect_options
from oodscen.judging._references import takes_cases
from oodscen.protocols import LLM
from oodscen.stages._evaluate import evaluate as judge_episode
from oodscen.stages._evaluate import unjudged_verdict


class Item(NamedTuple):
    """One episode to show to one model."""

    episode: Episode
    model: str
    protocol: Protocol
    is_withheld: bool = False
    """True if the model is asked without the pictures."""


class Questioner:
    """Asks answerers about items."""

    def __init__(
        self,
        run: Context,
        scenarios: Sequence[Scenario],
        scenes: Sequence[Scene],
        episodes: Sequence[Episode],
        rears: Mapping[str, str],
    ) -> None:
        """Collect what the questions need.

        Args:
            run: The run, with its configuration and files.
            scenarios: The texts.
            scenes: The scenes of the texts.
            episodes: All drives up to the decision.
            rears: Files of the views to the rear, by drive.
        """
        self._config, self._store = run.config, run.store
        self._scenarios = {scenario.id: scenario for scenario in scenarios}
        self._scenes = {scene.id: scene for scene in scenes}
        self._up_to_decision = {episode.scene_id: episode for episode in episodes}
        self._rears = rears
        maps = {scene.id: scene.map for scene in scenes}
        self._kinds = Kinds.of(scenarios, maps, seed=run.config.seed)

    def verdict(self, item: Item, model: LLM) -> Verdict:
        """Return an answerer's verdict on an item; a failed one if there is nothing to show."""
        episode, protocol = item.episode, item.protocol
        if episode.status == "failed" or not episode.frames:
            why, kind = f"it did not run: {episode.error}", episode.error_type or ""
            return unjudged_verdict(episode, model, why, kind, protocol, withheld=item.is_withheld)
        frames: dict[str, Image] = {}
        before = rear = None
        if not takes_cases(model):
            try:
                frames = self._images(episode, protocol)
                if self._config.rear_view and protocol == "ours":
                    rear = self._rear_view(episode)
                earlier = self._up_to_decision.get(episode.scene_id)
                if protocol == "paper" and earlier is not None:
                    before = Shown.of(earlier, self._images(earlier))
            except (OSError, DataError) as error:
                why, kind = str(error), type(error).__name__
                return unjudged_verdict(
                    episode, model, why, kind, protocol, withheld=item.is_withheld
                )
        scenario = self._scenarios.get(scene_of(episode.scene_id))
        scene = self._scenes.get(scene_of(episode.scene_id))
        leaf = scenario.leaf if scenario else ""
        kinds = self._kinds.offered(leaf, scene.map if scene else "")
        return judge_episode(
            episode,
            frames,
            model,
            path=scenario.path if scenario else (),
            leaf=leaf,
            options=aspect_options(kinds, seed=self._config.seed, item=episode.scene_id),
            protocol=protocol,
            chain=self._config.chain,
            before=before,
            visible=scene.visible if scene else (),
            rear=rear,
            withheld=item.is_withheld,
        )

    def _images(self, episode: Episode, protocol: Protocol = "ours") -> dict[str, Image]:
        """Return the frames; raises `DataError` if one cannot be shown."""
        frames = {
            moment: Image.from_file(self._store.inside(file), file)
            for moment, file in episode.frames.items()
        }
        wanted = moments(self._config.frames) if protocol == "ours" else MOMENTS
        faults = [f"there is no {moment} frame" for moment in wanted if moment not in frames]
        faults += [fault for image in frames.values() if (fault := image.fault())]
        if faults:
            raise DataError("frames", [Issue("", fault) for fault in faults])
        return frames

    def _rear_view(self, episode: Episode) -> Image:
        """Return the view to the rear; raises `DataError` if it cannot be shown."""
        file = self._rears.get(episode.scene_id, "")
        image = Image.from_file(self._store.inside(file), file) if file else None
        fault = image.fault() if image else "there is no view to the rear"
        if image is None or fault:
            raise DataError("frames", [Issue("", fault)])
        return image
