"""Questions to one answerer about one drive, with the pictures that it is shown."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from oodscen._pipeline.context import Context
from oodscen.data._episode import MOMENTS, Episode, moments
from oodscen.data._messages import Image
from oodscen.data._pairing import scene_of
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.data._verdict import Protocol, Verdict, without_pictures
from oodscen.errors import DataError, Issue
from oodscen.judging._kinds import Kinds
from oodscen.judging._questions import Shown, aspect_options
from oodscen.judging._references import Case, takes_cases
from oodscen.judging._scoring import AnswerKey, GivenAnswers, Truth, kind_of_answerer, rescored
from oodscen.protocols import LLM
from oodscen.stages._evaluate import answers_of_reference, unjudged_verdict
from oodscen.stages._evaluate import evaluate as judge_episode
from oodscen.study._frames import frames_of


class Item(NamedTuple):
    """One episode to show to one answerer."""

    episode: Episode
    answerer: str
    """The name by which the study asks it."""
    model: LLM
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
        self._keys: dict[tuple[str, Protocol], AnswerKey] = {}
        maps = {scene.id: scene.map for scene in scenes}
        self._kinds = Kinds.of(scenarios, maps, seed=run.config.seed)

    def verdict(self, item: Item) -> Verdict:
        """Return the answerer's verdict on an item; a failed one if there is nothing to show."""
        episode, model, protocol = item.episode, item.model, item.protocol
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
        key = self._key(episode, protocol)
        return judge_episode(
            episode,
            frames,
            model,
            path=key.path,
            leaf=key.leaf,
            options=key.options,
            protocol=protocol,
            chain=self._config.chain,
            before=before,
            visible=key.visible,
            rear=rear,
            withheld=item.is_withheld,
        )

    def rescored(self, verdict: Verdict, item: Item) -> Verdict:
        """Return a stored verdict with its scores computed again, without a question.

        References, and people, whose answers the study holds, answer again; a model's answers are those of the verdict.
        """
        episode, model, protocol = item.episode, item.model, item.protocol
        if episode.status == "failed" or not episode.frames:
            return verdict
        key = self._key(episode, protocol)
        if takes_cases(model):
            case = Case(episode, key.path, key.leaf, key.options, episode.frames)
            return rescored(verdict, key, answers_of_reference(model, case, protocol))
        fields = {name: getattr(verdict, name) for name in ("is_ood", "aspect", "choice", "action")}
        said = {name: value for name, value in fields.items() if value is not None}
        name = without_pictures(model.name) if item.is_withheld else model.name
        given = GivenAnswers(name, said, protocol=protocol, kind=kind_of_answerer(model))
        return rescored(verdict, key, given)

    def _key(self, episode: Episode, protocol: Protocol) -> AnswerKey:
        """Return the key to the answers about an episode, with the options of the closed question."""
        name = scene_of(episode.scene_id)
        if (known := self._keys.get((episode.scene_id, protocol))) is not None:
            return known
        scenario, scene = self._scenarios.get(name), self._scenes.get(name)
        leaf = scenario.leaf if scenario else ""
        kinds = self._kinds.offered(leaf, scene.map if scene else "")
        options = aspect_options(kinds, seed=self._config.seed, item=episode.scene_id)
        truth = Truth(scenario.path if scenario else (), leaf, scene.visible if scene else ())
        key = AnswerKey.of(episode, truth, () if protocol == "paper" else options)
        self._keys[episode.scene_id, protocol] = key
        return key

    def _images(self, episode: Episode, protocol: Protocol = "ours") -> dict[str, Image]:
        """Return the frames; raises `DataError` if one cannot be shown."""
        camera = self._config.camera
        frames = frames_of(self._store, episode.frames, episode.file_sha256, camera)
        wanted = moments(self._config.frames) if protocol == "ours" else MOMENTS
        faults = [f"there is no {moment} frame" for moment in wanted if moment not in frames]
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
