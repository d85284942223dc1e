"""The questions about one drive: as they are asked, and as their answers are read."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Generic, Self, TypeVar

from pydantic import BaseModel

from oodscen._seeding import stream
from oodscen.data._episode import ACTIONS, Episode, in_order
from oodscen.data._messages import Image
from oodscen.data._verdict import NOTHING, Protocol
from oodscen.errors import AnswerError, Issue
from oodscen.judging._parsing import (
    ParsedAnswer,
    contradiction,
    names_nothing,
    read_action,
    read_aspect,
    read_choice,
    read_named_aspect,
)
from oodscen.judging._references import AspectOption
from oodscen.prompts._judging.choose_action import ActionOption, ChooseAction, ChosenAction
from oodscen.prompts._judging.choose_aspect import ChooseAspect, ChosenAspect
from oodscen.prompts._judging.drive_facts import DriveFacts, DriveQuestion
from oodscen.prompts._judging.name_aspect import NameAspect, OodAspect
from oodscen.prompts._judging.name_ood_aspect import NamedAspect, NameOodAspect

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
_LONGEST_REASONING = 600
_LONGEST_ASPECT = 500
"""Maximum lengths of stored texts, in characters."""
ATTEMPTS = 2
"""Maximum number of attempts per question; an unreadable answer is asked for once more."""


def aspect_options(
    kinds: Sequence[AspectOption], *, seed: int, item: str
) -> tuple[AspectOption, ...]:
    """Return the options of the closed question: the kinds and "nothing", shuffled by the id of the item."""
    options = [*kinds, NOTHING_UNUSUAL]
    order = stream(seed, "aspect-options", item).permutation(len(options))
    return tuple(options[int(index)] for index in order)


@dataclass(frozen=True)
class ShownDrive:
    """The frames of one drive in order, and its facts, as a model sees them."""

    images: tuple[Image, ...]
    facts: DriveFacts = field(default_factory=DriveFacts)
    rear: Image | None = None
    """The view from the rear window at the last frame, if it is shown."""
    withheld: int = 0
    """Number of frames that are withheld; if there are any, none is shown."""

    @classmethod
    def of(
        cls,
        episode: Episode,
        frames: Mapping[str, Image],
        *,
        shows_decision: bool = True,
        rear: Image | None = None,
    ) -> Self:
        """Return the frames of an episode, by moment, with what it records of speed, times and follower.

        `shows_decision` is true if the last frame shows the decision; `rear` is the view from the rear window at it.
        """
        order = in_order(frames)
        has_times = all(moment in episode.frame_times_s for moment in order)
        follower = episode.follower
        facts = DriveFacts(
            times_s=tuple(episode.frame_times_s[moment] for moment in order) if has_times else (),
            ego_speed_mps=episode.ego_speed_mps,
            shows_decision=shows_decision,
            behind=_behind(episode),
            gap_m=follower.gap_m if follower else 0.0,
            follower_speed_mps=follower.speed_mps if follower else 0.0,
        )
        return cls(tuple(frames[moment] for moment in order), facts, rear)

    def without_pictures(self) -> Self:
        """Return the same facts with the pictures withheld."""
        return replace(self, images=(), rear=None, withheld=len(self.images))


def _behind(episode: Episode) -> str | None:
    """Return the follower with its article; empty without one, `None` if it was not recorded."""
    if episode.follower is None:
        return None if episode.ego_speed_mps is None else ""
    noun = re.sub(r"[\W_]+", " ", episode.follower.what).strip()
    return f"{'an' if noun.startswith(tuple('aeiou')) else 'a'} {noun}"


@dataclass(frozen=True)
class AnswerReader(Generic[Value, Answer]):
    """The reading of the answers to one question."""

    purpose: str
    """The question's purpose, e.g. `choose-action`."""
    parse: Callable[[str], ParsedAnswer[Value]]
    """Parses a model's text."""
    make: Callable[[Value, str], Answer]
    """Makes the answer from the parsed value and the reasons given with it."""
    form: str
    """The expected format, for a model whose answer is unreadable."""
    fields: Callable[[Answer], dict[str, Any]]
    """Returns what a verdict keeps of an answer."""

    def read(self, raw: str, *, model: str) -> tuple[Answer | None, list[Issue], str]:
        """Return the answer, or `None` and its faults, with the note on how it was read.

        Raises:
            AnswerError: If the model declines to answer, so that asking again is useless.
        """
        reading = self.parse(raw)
        if reading.outcome == "refused":
            raise AnswerError(model, self.purpose, [Issue("", "it declines to answer")], raw, 1)
        if reading.value is None:
            return None, [Issue("", f"{reading.note}; give {self.form}")], reading.note
        return self.make(reading.value, reading.reasons), [], reading.note


def naming_reader(protocol: Protocol = "ours") -> AnswerReader[Any, Any]:
    """Return the reader of the first task's open question."""
    if protocol == "paper":
        return AnswerReader(
            NameOodAspect.purpose,
            read_named_aspect,
            lambda aspect, reasons: NamedAspect(aspect=aspect),
            '"aspect": one short noun phrase',
            _named_fields,
        )
    return AnswerReader(
        NameAspect.purpose,
        read_aspect,
        lambda detected, reasons: OodAspect(
            is_ood=detected.is_ood, aspect=detected.aspect, confidence=detected.confidence
        ),
        '"is_ood": true or false, and where it is true "aspect": one short noun phrase',
        lambda answer: {
            "is_ood": answer.is_ood,
            "confidence": answer.confidence,
            "aspect": answer.aspect[:_LONGEST_ASPECT],
        },
    )


def choosing_reader(options: Sequence[AspectOption]) -> AnswerReader[str, ChosenAspect]:
    """Return the reader of the closed question with these options."""
    labels = {option.id: option.label for option in options}
    names = list(labels)
    return AnswerReader(
        ChooseAspect.purpose,
        lambda raw: read_choice(raw, labels),
        lambda name, reasons: ChosenAspect(choice=names.index(name) + 1),
        f'"choice": one number from 1 to {len(names)}',
        lambda answer: {"choice": names[answer.choice - 1]},
    )


def acting_reader() -> AnswerReader[str, ChosenAction]:
    """Return the reader of the second task's question."""
    return AnswerReader(
        ChooseAction.purpose,
        lambda raw: read_action(raw, ACTIONS),
        lambda name, reasons: ChosenAction(action=name, reasoning=reasons),
        f'"action": exactly one of {", ".join(ACTIONS)}',
        lambda answer: {
            "action": answer.action,
            "reasoning": answer.reasoning[:_LONGEST_REASONING],
            "contradiction": contradiction(answer.reasoning, answer.action, ACTIONS),
        },
    )


def naming_prompt(
    shown: ShownDrive, descriptions: tuple[str, ...] = (), protocol: Protocol = "ours"
) -> DriveQuestion[Any]:
    """Return the first task's open question."""
    kind = NameOodAspect if protocol == "paper" else NameAspect
    return kind(**_common_fields(shown, descriptions))


def choosing_prompt(
    shown: ShownDrive, options: Sequence[AspectOption], descriptions: tuple[str, ...] = ()
) -> ChooseAspect:
    """Return the closed question."""
    return ChooseAspect(
        **_common_fields(shown, descriptions),
        labels=tuple({option.id: option.label for option in options}.values()),
    )


def acting_prompt(
    shown: ShownDrive, descriptions: tuple[str, ...] = (), protocol: Protocol = "ours"
) -> ChooseAction:
    """Return the second task's question."""
    return ChooseAction(
        **_common_fields(shown, descriptions),
        options=OPTIONS,
        is_collision_only=protocol == "paper",
    )


def _common_fields(shown: ShownDrive, descriptions: tuple[str, ...]) -> dict[str, Any]:
    """Return the fields that every question about a drive has."""
    return {
        "frames": shown.images,
        "descriptions": descriptions,
        "facts": shown.facts,
        "rear": shown.rear,
        "withheld": shown.withheld,
    }


def paragraphs(prompt: DriveQuestion[Any]) -> list[str]:
    """Return the paragraphs of a question, each in one line: the facts, the question itself, then the rest."""
    return [" ".join(part.split()) for part in prompt.question().split("\n\n")]


def _named_fields(answer: NamedAspect) -> dict[str, Any]:
    is_ood = not names_nothing(answer.aspect)
    return {"is_ood": is_ood, "aspect": answer.aspect[:_LONGEST_ASPECT] if is_ood else ""}
