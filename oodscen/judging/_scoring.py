"""Verdicts: answers about one drive, compared with the truth about it."""

from collections.abc import Sequence
from typing import Any, ClassVar, Literal, NamedTuple, Self

from oodscen.data._base import Data
from oodscen.data._episode import ActionOutcome, Episode
from oodscen.data._pairing import scene_of
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Visible
from oodscen.data._verdict import NOTHING, Outcome, Protocol, Verdict, verdict_id
from oodscen.errors import (
    AnswerError,
    ContentFiltered,
    LLMTimeout,
    ModelSkipped,
    OodscenError,
)
from oodscen.judging._aspects.matching import score_naming
from oodscen.judging._aspects.opinions import is_open, opinion, rescore_verdict
from oodscen.judging._parsing import is_refusal
from oodscen.judging._questions import AnswerReader, acting_reader, choosing_reader, naming_reader
from oodscen.judging._references import AspectOption, is_reference
from oodscen.llm._ask import heard
from oodscen.protocols import LLM


class Truth(NamedTuple):
    """The ground truth of the first task."""

    path: tuple[str, ...]
    """Labels from the root to the leaf."""
    leaf: str
    visible: tuple[Visible, ...] = ()
    """Everything that can be seen of the hazard."""


class AnswerKey(Data):
    """Everything that the answers about one drive are scored by."""

    noun: ClassVar[str] = "answer key"

    item: str
    """Id of the scene or of its ordinary drive."""
    path: tuple[str, ...] = ()
    """Labels from the root to the leaf of the scene."""
    leaf: str = ""
    visible: tuple[Visible, ...] = ()
    """Everything that can be seen of the hazard."""
    options: tuple[AspectOption, ...] = ()
    """Options of the closed question, as shown."""
    actions: dict[str, ActionOutcome] = {}
    """Outcomes by action."""
    is_deterministic: bool = True

    @classmethod
    def of(cls, episode: Episode, truth: Truth, options: Sequence[AspectOption]) -> Self:
        """Return the key to the answers about an episode."""
        return cls(
            item=episode.scene_id,
            path=truth.path,
            leaf=truth.leaf,
            visible=truth.visible,
            options=tuple(options),
            actions=episode.actions,
            is_deterministic=episode.is_deterministic,
        )

    @property
    def truth(self) -> Truth:
        """The truth of the first task."""
        return Truth(self.path, self.leaf, self.visible)

    @property
    def episode(self) -> Episode:
        """The episode, as far as answers are scored by it."""
        return Episode(
            id=self.item,
            scene_id=self.item,
            status="ok",
            actions=self.actions,
            is_deterministic=self.is_deterministic,
        )

    @property
    def scenario(self) -> Scenario:
        """The scenario of the scene, as far as answers are scored by it."""
        return Scenario(id=scene_of(self.item), text="-", leaf=self.leaf, path=self.path)

    def reader(self, purpose: str) -> AnswerReader[Any, Any]:
        """Return the reader of the answers to the question of this purpose."""
        readers = {reader.purpose: reader for reader in (naming_reader(), acting_reader())}
        return readers[purpose] if purpose in readers else choosing_reader(self.options)

    def verdict(
        self, purpose: str, raw: str, *, model: str = "", judge: LLM | None = None
    ) -> Verdict:
        """Return the verdict on one answer in a model's words.

        Args:
            purpose: Purpose of the question: `name-aspect`, `choose-aspect` or `choose-action`.
            raw: The model's text.
            model: The model's name.
            judge: Decides whether an open aspect is right, instead of the documented matcher.
        """
        reader, raw = self.reader(purpose), heard(raw)
        failures: list[OodscenError] = []
        fields: dict[str, Any] = {}
        try:
            answer, issues, _ = reader.read(raw, model=model)
            if answer is None:
                raise AnswerError(model, purpose, issues, raw, 1)
            fields = reader.fields(answer)
        except AnswerError as error:
            failures.append(error)
        return score_answers(
            self.episode, model, self.truth, self.options, fields, "ours", failures, judge
        )


def score_answers(
    episode: Episode,
    model: str,
    truth: Truth,
    options: Sequence[AspectOption],
    fields: dict[str, Any],
    protocol: Protocol,
    failures: Sequence[OodscenError],
    judge: LLM | None,
    *,
    kind: Literal["model", "reference"] = "model",
) -> Verdict:
    """Compare the answers with the ground truth.

    Args:
        episode: The episode, with the outcome of every action.
        model: Name of the answerer.
        truth: The ground truth of the first task.
        options: Options of the closed question, as shown.
        fields: The verdict's fields about the answers; a field is missing where no answer could be read.
        protocol: Protocol of the questions.
        failures: Errors of the questions without an answer.
        judge: Decides whether an open aspect is right, instead of the documented matcher.
        kind: Kind of the answerer.
    """
    is_ood, action = fields.get("is_ood"), fields.get("action")
    if is_ood is not None and not episode.is_ordinary:
        named = score_naming(fields["aspect"] if is_ood else "", truth.path, truth.visible)
        fields |= {"thing_is_right": named.thing, "aspect_is_right": named.right}
    if "choice" in fields:
        right = NOTHING if episode.is_ordinary else truth.leaf
        right = next((one.id for one in options if one.holds(right)), right)
        fields["choice_is_right"] = fields["choice"] == right
    outcome = episode.actions.get(action) if action else None
    if outcome is not None:
        touched = bool(outcome.contacts)
        fields["success"] = not outcome.unavailable and not touched and episode.is_deterministic
        is_marginal = outcome.marginal and protocol != "paper"
        fields["action_is_marginal"] = is_marginal
        is_safe = fields["success"] if protocol == "paper" else outcome.safe
        fields["action_is_safe"] = None if is_marginal else is_safe
    error = failures[0] if failures else None
    ended: Outcome = _outcome(error)
    if error is None and outcome is not None and outcome.unavailable:
        ended = "unavailable"
    verdict = Verdict(
        id=verdict_id(episode.scene_id, model, protocol),
        scene_id=episode.scene_id,
        model=model,
        kind=kind,
        status="failed" if error else "ok",
        outcome=ended,
        error=str(error)[:2_000] if error else None,
        error_type=type(error).__name__ if error else "",
        retryable=any(getattr(one, "retryable", False) for one in failures),
        protocol=protocol,
        is_ordinary=episode.is_ordinary,
        **fields,
    )
    if judge is None or not is_open(verdict):
        return verdict
    found = opinion(judge, verdict.aspect, truth.path, truth.visible)
    return rescore_verdict(verdict, truth.path, {found.id: found}, found.judge, truth.visible)


def _outcome(error: OodscenError | None) -> Outcome:
    if error is None:
        return "answered"
    if isinstance(error, AnswerError):
        return "refused" if is_refusal(error.raw) else "unparsed"
    if isinstance(error, ContentFiltered):
        return "refused"
    if isinstance(error, ModelSkipped):
        return "unasked"
    words = str(error).casefold()
    is_late = isinstance(error, LLMTimeout) or any(
        word in words for word in ("timeout", "timed out", "time is up", "in time", "deadline")
    )
    return "timeout" if is_late else "error"


def kind_of_answerer(model: LLM) -> Literal["model", "reference"]:
    """Return the kind of an answerer, as verdicts state it."""
    return "reference" if is_reference(model) else "model"
