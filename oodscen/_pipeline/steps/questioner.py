"""Questions to one answerer about one drive, with the pictures that it is shown."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from oodscen._pipeline.context import Context
from oodscen.data._episode import MOMENTS, Episode, moments
from oodscen.data._messages import Image
from oodscen.data._verdict import Protocol, Verdict, without_pictures
from oodscen.errors import DataError, Issue
from oodscen.judging._questions import ShownDrive
from oodscen.judging._references import Case, kind_of_answerer, takes_cases
from oodscen.judging._scoring import (
    GivenAnswers,
    answers_in,
    rescored,
    score_answers,
)
from oodscen.protocols import LLM
from oodscen.stages._evaluate import answers_of_reference, unjudged_verdict
from oodscen.stages._evaluate import evaluate as judge_episode
from oodscen.study._frames import frames_of, rear_view_of
from oodscen.study._judged import AnswerKeys


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
        keys: AnswerKeys,
        episodes: Sequence[Episode],
        behind: Mapping[str, Episode],
    ) -> None:
        """Collect what the questions need.

        Args:
            run: The run, with its configuration and files.
            keys: The keys to the answers.
            episodes: All drives up to the decision.
            behind: The runs in which the views to the rear were taken, by drive.
        """
        self._config, self._store, self._keys = run.config, run.store, keys
        self._up_to_decision = {episode.scene_id: episode for episode in episodes}
        self._behind = behind

    def verdict(self, item: Item) -> Verdict:
        """Return the answerer's verdict on an item; a failed one if there is nothing to show."""
        episode, model, protocol = item.episode, item.model, item.protocol
        if episode.status == "failed" or not episode.frames:
            error = f"it did not run: {episode.error}"
            return self._unjudged(item, error, episode.error_type or "")
        frames: dict[str, Image] = {}
        before = rear = None
        if not takes_cases(model):
            try:
                frames = self._images(episode, protocol)
                if self._config.rear_view and protocol == "ours":
                    name, camera = episode.scene_id, self._config.camera
                    rear = rear_view_of(self._store, name, self._behind.get(name), camera)
                earlier = self._up_to_decision.get(episode.scene_id)
                if protocol == "paper" and earlier is not None:
                    before = ShownDrive.of(earlier, self._images(earlier))
            except (OSError, DataError) as error:
                return self._unjudged(item, str(error), type(error).__name__)
        key = self._keys.of(episode, protocol)
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

    def _unjudged(self, item: Item, error: str, error_type: str) -> Verdict:
        return unjudged_verdict(
            item.episode,
            item.model,
            error,
            error_type,
            item.protocol,
            withheld=item.is_withheld,
        )

    def rescored(self, verdict: Verdict, item: Item) -> Verdict:
        """Return a stored verdict with its scores computed again, without a question.

        References, and people, whose answers the study holds, answer again; a model's answers are those of the
        verdict.
        """
        episode, model, protocol = item.episode, item.model, item.protocol
        if episode.status == "failed" or not episode.frames:
            return verdict
        key = self._keys.of(episode, protocol)
        if takes_cases(model):
            case = Case(episode, key.path, key.leaf, key.options, episode.frames)
            answers = answers_of_reference(model, case, protocol)
            if answers.failures:
                update = {"made_from": verdict.made_from}
                return score_answers(key, answers).model_copy(update=update)
            return rescored(verdict, key, answers)
        name = without_pictures(model.name) if item.is_withheld else model.name
        kind = kind_of_answerer(model)
        answers = GivenAnswers(name, answers_in(verdict), protocol=protocol, kind=kind)
        return rescored(verdict, key, answers)

    def _images(self, episode: Episode, protocol: Protocol = "ours") -> dict[str, Image]:
        """Return the frames; raises `DataError` if one cannot be shown."""
        camera = self._config.camera
        frames = frames_of(self._store, episode.frames, episode.file_sha256, camera)
        expected = moments(self._config.frames) if protocol == "ours" else MOMENTS
        issues = [
            Issue("", f"there is no {moment} frame") for moment in expected if moment not in frames
        ]
        if issues:
            raise DataError("frames", issues)
        return frames
