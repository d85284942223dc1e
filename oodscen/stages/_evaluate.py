"""Evaluation of a model on an episode: the paper's two tasks (section V-C), with further questions."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, TypeVar

from pydantic import BaseModel

from oodscen._seeding import stream
from oodscen.data._episode import ACTIONS, MOMENTS, Episode
from oodscen.data._messages import Image
from oodscen.data._verdict import NOTHING, Outcome, Protocol, Verdict, verdict_id
from oodscen.errors import (
    AnswerError,
    ContentFiltered,
    Issue,
    LLMError,
    LLMTimeout,
    ModelSkipped,
    OodscenError,
)
from oodscen.judging._aspects.matching import names_aspect
from oodscen.judging._aspects.opinions import is_open, opinion, rescored
from oodscen.judging._parsing import (
    ParsedAnswer,
    contradiction,
    is_refusal,
    names_nothing,
    read_action,
    read_aspect,
    read_choice,
    read_description,
    read_named_aspect,
    reasoning_in,
)
from oodscen.judging._references import AspectOption, Case, Reference, is_reference
from oodscen.llm._ask import ask
from oodscen.prompts import Prompt
from oodscen.prompts._judging.choose_action import ActionOption, ChooseAction, ChosenAction
from oodscen.prompts._judging.choose_aspect import ChooseAspect, ChosenAspect
from oodscen.prompts._judging.describe_frame import DescribeFrame, FrameDescription
from oodscen.prompts._judging.name_aspect import NameAspect, OodAspect
from oodscen.prompts._judging.name_ood_aspect import NamedAspect, NameOodAspect
from oodscen.protocols import LLM

__all__ = ["OPTIONS", "aspect_options", "evaluate", "names_aspect", "unjudged"]

Answer = TypeVar("Answer", bound=BaseModel)
Value = TypeVar("Value")

OPTIONS = tuple(
    ActionOption(id=name, description=text)
    for name, text in zip(
        ACTIONS,
        (
            "keep the lane and the speed",
            "keep the lane and slow down gently to half the speed",
            "keep the lane and brake comfortably to a stop",
            "keep the lane and brake as hard as the road allows",
            "change to the next lane on the left, even if it is for oncoming traffic",
            "change to the next lane on the right",
            "slow down, move to the right edge of the road or the shoulder and stop there",
        ),
        strict=True,
    )
)
"""The discrete actions as they are offered to a model."""

NOTHING_UNUSUAL = AspectOption(id=NOTHING, label="Nothing is out of the ordinary")
NO_DESCRIPTION = "(no usable description)"
KEPT_DESCRIPTION = 6_000
"""Maximum length of a description that is stored and shown to the model again, in characters."""
KEPT_REASONING = 600
"""Maximum length of a model's reasoning that is stored, in characters."""
ATTEMPTS = 2
"""Maximum number of attempts per question; an unreadable answer is asked for once more."""


def aspect_options(leaves: Mapping[str, str], *, seed: int, item: str) -> tuple[AspectOption, ...]:
    """Return the options of the closed question: the leaves and "nothing", shuffled for one item.

    Args:
        leaves: Labels by id.
        seed: Seed of the study.
        item: Id of the scene or twin; each has its own order.
    """
    options = [AspectOption(id=name, label=label) for name, label in sorted(leaves.items())]
    options.append(NOTHING_UNUSUAL)
    order = stream(seed, "aspect-options", item).permutation(len(options))
    return tuple(options[int(index)] for index in order)


def evaluate(
    episode: Episode,
    frames: Mapping[str, Image],
    vlm: LLM,
    *,
    path: Sequence[str],
    leaf: str = "",
    options: Sequence[AspectOption] = (),
    protocol: Protocol = "ours",
    judge: LLM | None = None,
) -> Verdict:
    """Ask a model about one episode; a failure of the model is a verdict, not an exception.

    The model describes the frames in turn. Task one: it says whether anything is out of the ordinary, with a
    confidence, and names it (open), then chooses it among `options` (closed). Task two: it chooses one of the
    discrete actions, whose outcome in the simulator is known. An unreadable answer (see
    `oodscen.judging._parsing`) is asked for once more and then counted separately; the other questions are
    asked in any case.

    Args:
        episode: The episode, with the outcome of every action. The ids of twins mark them.
        frames: The images by moment.
        vlm: The model to judge. A `Reference` is asked directly.
        path: Labels from the root to the leaf: the ground truth of task one.
        leaf: Id of that leaf.
        options: Options of the closed question, which is skipped without them and in the paper's protocol.
        protocol: `paper` asks as the paper did: which aspect is OOD, without mentioning how likely that is
            and without a confidence; no closed question, collisions only.
        judge: Decides whether an open aspect is right, for references too, instead of the documented matcher.
            If it gives no usable answer, the matcher decides and `judge_error` records the reason.
    """
    if protocol == "paper":
        options = ()
    if is_reference(vlm) and isinstance(vlm, Reference):
        return _judged_directly(episode, vlm, path, leaf, options, protocol, judge)
    asked = _Asked(vlm)
    images = tuple(frames[moment] for moment in MOMENTS)
    fields: dict[str, Any] = {}
    try:
        descriptions: tuple[str, ...] = ()
        for count in range(1, len(images) + 1):
            seen = asked.put(
                DescribeFrame(frames=images[:count], descriptions=descriptions),
                read_description,
                lambda raw, said: FrameDescription(description=said),
                "the description, in words",
            )
            said = seen.description[:KEPT_DESCRIPTION] if seen else NO_DESCRIPTION
            descriptions = (*descriptions, said)
            fields["descriptions"] = descriptions
        fields |= asked.aspect(images, descriptions, protocol)
        if options:
            fields["choice"] = asked.choice(images, descriptions, tuple(options))
        chosen = asked.put(
            ChooseAction(
                frames=images,
                descriptions=descriptions,
                options=OPTIONS,
                is_whole_trace=protocol == "paper",
            ),
            lambda raw: read_action(raw, ACTIONS),
            lambda raw, name: ChosenAction(action=name, reasoning=reasoning_in(raw)),
            f'"action": exactly one of {", ".join(ACTIONS)}',
        )
        if chosen:
            fields["action"] = chosen.action
            fields["reasoning"] = chosen.reasoning[:KEPT_REASONING]
            fields["contradiction"] = contradiction(chosen.reasoning, chosen.action, ACTIONS)
    except LLMError as error:
        asked.failures.append(error)
    fields["notes"] = tuple(asked.notes)
    fields["prompts"] = asked.versions
    return _scored(episode, vlm, path, leaf, fields, protocol, asked.failures, judge)


def unjudged(
    episode: Episode, model: LLM, error: str, error_type: str, protocol: Protocol = "ours"
) -> Verdict:
    """Return the verdict on an item that could not be shown: no episode, or no frames."""
    return Verdict(
        id=verdict_id(episode.scene_id, model.name, protocol),
        scene_id=episode.scene_id,
        model=model.name,
        kind=_kind(model),
        status="failed",
        outcome="error",
        error=error,
        error_type=error_type,
        retryable=episode.retryable,
        protocol=protocol,
        is_twin=episode.is_ordinary,
    )


# ------------------------------------------------------------------ asking


@dataclass
class _Asked:
    """Asks the questions about one item, and keeps failures and notes on how answers were read."""

    llm: LLM
    notes: list[str] = field(default_factory=list)
    failures: list[OodscenError] = field(default_factory=list)
    versions: dict[str, str] = field(default_factory=dict)

    def put(
        self,
        prompt: Prompt[Answer],
        read: Callable[[str], ParsedAnswer[Value]],
        make: Callable[[str, Value], Answer],
        form: str,
    ) -> Answer | None:
        """Return the answer, or `None` if none can be read; the failure is kept.

        Args:
            prompt: The question.
            read: Parses the model's text.
            make: Makes the answer from the text and the parsed value.
            form: The expected format, as told to a model whose answer is unreadable.
        """
        self.versions[prompt.purpose] = prompt.version()

        def answered(raw: str) -> tuple[Answer | None, list[Issue]]:
            reading = read(raw)
            if reading.outcome == "refused":
                declined = [Issue("", "it declines to answer")]
                raise AnswerError(self.llm.name, prompt.purpose, declined, raw, 1)
            if reading.value is None:
                return None, [Issue("", f"{reading.note}; give {form}")]
            if reading.note != "JSON":
                self.notes.append(f"{prompt.purpose}: {reading.note}")
            return make(raw, reading.value), []

        try:
            return ask(self.llm, prompt, attempts=ATTEMPTS, read=answered)
        except (AnswerError, ContentFiltered) as error:
            self.failures.append(error)
            return None

    def aspect(
        self, images: tuple[Image, ...], descriptions: tuple[str, ...], protocol: Protocol
    ) -> dict[str, Any]:
        """Ask the first task and return the verdict's fields about it, empty without an answer."""
        if protocol == "paper":
            named = self.put(
                NameOodAspect(frames=images, descriptions=descriptions),
                read_named_aspect,
                lambda raw, aspect: NamedAspect(aspect=aspect),
                '"aspect": one short noun phrase',
            )
            if named is None:
                return {}
            is_ood = not names_nothing(named.aspect)
            return {"is_ood": is_ood, "aspect": named.aspect[:500] if is_ood else ""}
        found = self.put(
            NameAspect(frames=images, descriptions=descriptions),
            read_aspect,
            lambda raw, found: OodAspect(
                is_ood=found.is_ood, aspect=found.aspect, confidence=found.confidence
            ),
            '"is_ood": true or false, and where it is true "aspect": one short noun phrase',
        )
        if found is None:
            return {}
        return {
            "is_ood": found.is_ood,
            "confidence": found.confidence,
            "aspect": found.aspect[:500],
        }

    def choice(
        self,
        images: tuple[Image, ...],
        descriptions: tuple[str, ...],
        options: tuple[AspectOption, ...],
    ) -> str | None:
        """Ask the closed question and return the id of the chosen option."""
        labels = {option.id: option.label for option in options}
        names = list(labels)
        answer = self.put(
            ChooseAspect(frames=images, descriptions=descriptions, labels=tuple(labels.values())),
            lambda raw: read_choice(raw, labels),
            lambda raw, name: ChosenAspect(choice=names.index(name) + 1),
            f'"choice": one number from 1 to {len(names)}',
        )
        return names[answer.choice - 1] if answer else None


# ------------------------------------------------------------------ scoring


def _judged_directly(
    episode: Episode,
    reference: Any,
    path: Sequence[str],
    leaf: str,
    options: Sequence[AspectOption],
    protocol: Protocol,
    judge: LLM | None,
) -> Verdict:
    said = reference.judge(Case(episode, path, leaf, options, episode.frames))
    fields = {
        "is_ood": said.is_ood,
        "aspect": said.aspect,
        "confidence": said.confidence,
        "choice": said.choice if options else None,
        "action": said.action,
    }
    return _scored(episode, reference, path, leaf, fields, protocol, [], judge, bool(options))


def _scored(
    episode: Episode,
    model: LLM,
    path: Sequence[str],
    leaf: str,
    fields: dict[str, Any],
    protocol: Protocol,
    failures: Sequence[OodscenError],
    judge: LLM | None,
    is_closed_asked: bool = False,
) -> Verdict:
    """Compare the answers with the ground truth."""
    is_ood, action, choice = fields.get("is_ood"), fields.get("action"), fields.get("choice")
    if is_ood is not None and not episode.is_ordinary:
        fields["aspect_is_right"] = is_ood and names_aspect(fields["aspect"], path)
    if choice is not None or is_closed_asked:
        fields["choice_is_right"] = choice == (NOTHING if episode.is_ordinary else leaf)
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
        id=verdict_id(episode.scene_id, model.name, protocol),
        scene_id=episode.scene_id,
        model=model.name,
        kind=_kind(model),
        status="failed" if error else "ok",
        outcome=ended,
        error=str(error)[:2_000] if error else None,
        error_type=type(error).__name__ if error else "",
        retryable=any(getattr(one, "retryable", False) for one in failures),
        protocol=protocol,
        is_twin=episode.is_ordinary,
        **fields,
    )
    if judge is None or not is_open(verdict):
        return verdict
    found = opinion(judge, verdict.aspect, path)
    return rescored(verdict, path, {found.id: found}, found.judge)


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


def _kind(model: LLM) -> Literal["model", "reference"]:
    return "reference" if is_reference(model) else "model"
