"""Evaluation of a model on an episode: the paper's two tasks (section V-C), with further questions."""

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple, Self, TypeVar

from pydantic import BaseModel

from oodscen._seeding import stream
from oodscen.data._episode import ACTIONS, Episode, in_order
from oodscen.data._messages import Image
from oodscen.data._scene import Visible
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
from oodscen.judging._aspects.matching import names_aspect, naming
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
from oodscen.judging._references import AspectOption, Case, is_reference, takes_cases
from oodscen.llm._ask import ask
from oodscen.prompts import Prompt
from oodscen.prompts._judging.choose_action import ActionOption, ChooseAction, ChosenAction
from oodscen.prompts._judging.choose_aspect import ChooseAspect, ChosenAspect
from oodscen.prompts._judging.describe_frame import DescribeFrame, FrameDescription
from oodscen.prompts._judging.drive_facts import DriveFacts
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


def aspect_options(
    kinds: Mapping[str, str] | Sequence[AspectOption], *, seed: int, item: str
) -> tuple[AspectOption, ...]:
    """Return the options of the closed question: the kinds and "nothing", shuffled for one item.

    Args:
        kinds: The kinds to choose from, or their labels by id; see `oodscen.judging._kinds`.
        seed: Seed of the study.
        item: Id of the scene or of its ordinary drive; each has its own order.
    """
    if isinstance(kinds, Mapping):
        kinds = [AspectOption(id=name, label=label) for name, label in sorted(kinds.items())]
    options = [*kinds, NOTHING_UNUSUAL]
    order = stream(seed, "aspect-options", item).permutation(len(options))
    return tuple(options[int(index)] for index in order)


@dataclass(frozen=True)
class Shown:
    """The frames of one drive in order, and its facts, as a model is told."""

    images: tuple[Image, ...]
    facts: DriveFacts = field(default_factory=DriveFacts)
    rear: Image | None = None
    """The view from the rear window at the last frame, if it is shown."""

    @classmethod
    def of(
        cls,
        episode: Episode,
        frames: Mapping[str, Image],
        *,
        is_present: bool = True,
        rear: Image | None = None,
    ) -> Self:
        """Return the frames of an episode with what it records of speed, times and follower.

        Args:
            episode: The episode.
            frames: The images by moment.
            is_present: True if the last frame shows the decision.
            rear: The view from the rear window at the last frame.
        """
        order = in_order(frames)
        times = tuple(episode.frame_times_s.get(moment, math.nan) for moment in order)
        follower, behind = episode.follower, None
        if follower is not None:
            what = re.sub(r"[\W_]+", " ", follower.what).strip()
            behind = f"{'an' if what[:1] in set('aeiou') else 'a'} {what}"
        elif episode.ego_speed_mps is not None:
            behind = ""
        facts = DriveFacts(
            times_s=() if any(map(math.isnan, times)) else times,
            ego_speed_mps=episode.ego_speed_mps,
            is_present=is_present,
            behind=behind,
            gap_m=follower.gap_m if follower else 0.0,
            follower_speed_mps=follower.speed_mps if follower else 0.0,
        )
        return cls(tuple(frames[moment] for moment in order), facts, rear)


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
    chain: bool = False,
    before: Shown | None = None,
    visible: Sequence[Visible] = (),
    rear: Image | None = None,
) -> Verdict:
    """Ask a model about one episode; a failure of the model is a verdict, not an exception.

    Task one: the model says whether anything is out of the ordinary, with a confidence, and names it (open),
    then chooses it among `options` (closed). Task two: it chooses one of the discrete actions, whose outcome in
    the simulator is known. Every question shows all frames with the ego's speed, the times of the frames and
    who follows, and nothing of the model's other answers. An unreadable answer (see
    `oodscen.judging._parsing`) is asked for once more and then counted separately; the other questions are
    asked in any case.

    Args:
        episode: The episode, with the outcome of every action. The ids of ordinary drives mark them.
        frames: The images by moment.
        vlm: The model to judge. A `Reference` is asked directly.
        path: Labels from the root to the leaf: the ground truth of task one.
        leaf: Id of that leaf.
        options: Options of the closed question, which is skipped without them and in the paper's protocol.
        protocol: `paper` asks as the paper did: which aspect is OOD, without mentioning how likely that is
            and without a confidence, always as a `chain`; no closed question, collisions only. The action is
            asked first, about the drive up to the decision.
        judge: Decides whether an open aspect is right, for references too, instead of the documented matcher.
            If it gives no usable answer, the matcher decides and `judge_error` records the reason.
        chain: The model describes the frames in turn first, and every question follows its descriptions, as in
            the paper.
        before: The drive up to the decision, for the action in the paper's protocol; by default the frames
            before the last, since the last shows the outcome.
        visible: Everything that can be seen of the hazard, which names it as well as the path's label does.
        rear: The view from the rear window at the decision, shown after the frames; not in the paper's protocol.
    """
    truth = Truth(tuple(path), leaf, tuple(visible))
    if protocol == "paper":
        options = ()
    if takes_cases(vlm):
        return _judged_directly(episode, vlm, truth, options, protocol, judge)
    asked = _Asked(vlm, is_chain=chain or protocol == "paper")
    is_paper = protocol == "paper"
    shown = Shown.of(episode, frames, is_present=not is_paper, rear=None if is_paper else rear)
    fields: dict[str, Any] = {}
    try:
        if protocol == "paper":
            decided = before or Shown(shown.images[:-1], DriveFacts())
            fields |= asked.action(decided, asked.described(decided), protocol)
        descriptions = asked.described(shown)
        fields["descriptions"] = descriptions
        fields |= asked.aspect(shown, descriptions, protocol)
        if options:
            fields["choice"] = asked.choice(shown, descriptions, tuple(options))
        if protocol != "paper":
            fields |= asked.action(shown, descriptions, protocol)
    except LLMError as error:
        asked.failures.append(error)
    fields["notes"] = tuple(asked.notes)
    fields["prompts"] = asked.versions
    return _scored(episode, vlm, truth, options, fields, protocol, asked.failures, judge)


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
        is_ordinary=episode.is_ordinary,
    )


# ------------------------------------------------------------------ asking


@dataclass
class _Asked:
    """Asks the questions about one item, and keeps failures and notes on how answers were read."""

    llm: LLM
    is_chain: bool = False
    """True if the model describes the frames before the questions."""
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

    def described(self, shown: Shown) -> tuple[str, ...]:
        """Ask for a description of every frame in turn; none unless the questions follow them.

        A frame without a usable description gets `NO_DESCRIPTION`, so that the others keep their places.
        """
        said: tuple[str, ...] = ()
        total = len(shown.images)
        for count in range(1, total + 1) if self.is_chain else ():
            seen = self.put(
                DescribeFrame(frames=shown.images[:count], descriptions=said, total=max(3, total)),
                read_description,
                lambda raw, text: FrameDescription(description=text),
                "the description, in words",
            )
            said = (*said, seen.description[:KEPT_DESCRIPTION] if seen else NO_DESCRIPTION)
        return said

    def aspect(
        self, shown: Shown, descriptions: tuple[str, ...], protocol: Protocol
    ) -> dict[str, Any]:
        """Ask the first task and return the verdict's fields about it, empty without an answer."""
        if protocol == "paper":
            named = self.put(
                NameOodAspect(frames=shown.images, descriptions=descriptions, facts=shown.facts),
                read_named_aspect,
                lambda raw, aspect: NamedAspect(aspect=aspect),
                '"aspect": one short noun phrase',
            )
            if named is None:
                return {}
            is_ood = not names_nothing(named.aspect)
            return {"is_ood": is_ood, "aspect": named.aspect[:500] if is_ood else ""}
        found = self.put(
            NameAspect(
                frames=shown.images,
                descriptions=descriptions,
                facts=shown.facts,
                rear=shown.rear,
            ),
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
        self, shown: Shown, descriptions: tuple[str, ...], options: tuple[AspectOption, ...]
    ) -> str | None:
        """Ask the closed question and return the id of the chosen option."""
        labels = {option.id: option.label for option in options}
        names = list(labels)
        answer = self.put(
            ChooseAspect(
                frames=shown.images,
                descriptions=descriptions,
                facts=shown.facts,
                rear=shown.rear,
                labels=tuple(labels.values()),
            ),
            lambda raw: read_choice(raw, labels),
            lambda raw, name: ChosenAspect(choice=names.index(name) + 1),
            f'"choice": one number from 1 to {len(names)}',
        )
        return names[answer.choice - 1] if answer else None

    def action(
        self, shown: Shown, descriptions: tuple[str, ...], protocol: Protocol
    ) -> dict[str, Any]:
        """Ask the second task and return the verdict's fields about it, empty without an answer."""
        chosen = self.put(
            ChooseAction(
                frames=shown.images,
                descriptions=descriptions,
                facts=shown.facts,
                rear=shown.rear,
                options=OPTIONS,
                is_collision_only=protocol == "paper",
            ),
            lambda raw: read_action(raw, ACTIONS),
            lambda raw, name: ChosenAction(action=name, reasoning=reasoning_in(raw)),
            f'"action": exactly one of {", ".join(ACTIONS)}',
        )
        if chosen is None:
            return {}
        return {
            "action": chosen.action,
            "reasoning": chosen.reasoning[:KEPT_REASONING],
            "contradiction": contradiction(chosen.reasoning, chosen.action, ACTIONS),
        }


# ------------------------------------------------------------------ scoring


class Truth(NamedTuple):
    """The ground truth of the first task."""

    path: tuple[str, ...]
    """Labels from the root to the leaf."""
    leaf: str
    visible: tuple[Visible, ...] = ()
    """Everything that can be seen of the hazard."""


def _judged_directly(
    episode: Episode,
    reference: Any,
    truth: Truth,
    options: Sequence[AspectOption],
    protocol: Protocol,
    judge: LLM | None,
) -> Verdict:
    said = reference.judge(Case(episode, truth.path, truth.leaf, options, episode.frames))
    fields = {
        "is_ood": said.is_ood,
        "aspect": said.aspect,
        "confidence": said.confidence,
        "choice": said.choice if options else None,
        "action": said.action,
    }
    return _scored(episode, reference, truth, options, fields, protocol, [], judge, bool(options))


def _scored(
    episode: Episode,
    model: LLM,
    truth: Truth,
    options: Sequence[AspectOption],
    fields: dict[str, Any],
    protocol: Protocol,
    failures: Sequence[OodscenError],
    judge: LLM | None,
    is_closed_asked: bool = False,
) -> Verdict:
    """Compare the answers with the ground truth."""
    is_ood, action, choice = fields.get("is_ood"), fields.get("action"), fields.get("choice")
    if is_ood is not None and not episode.is_ordinary:
        named = naming(fields["aspect"] if is_ood else "", truth.path, truth.visible)
        fields |= {"thing_is_right": named.thing, "aspect_is_right": named.right}
    if choice is not None or is_closed_asked:
        right = NOTHING if episode.is_ordinary else truth.leaf
        right = next((one.id for one in options if one.holds(right)), right)
        fields["choice_is_right"] = choice == right
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
        is_ordinary=episode.is_ordinary,
        **fields,
    )
    if judge is None or not is_open(verdict):
        return verdict
    found = opinion(judge, verdict.aspect, truth.path, truth.visible)
    return rescored(verdict, truth.path, {found.id: found}, found.judge, truth.visible)


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
