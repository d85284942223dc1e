"""Evaluation of a model on an episode: the paper's two tasks (section V-C), with further questions."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np
from pydantic import BaseModel

from oodscen._arguments import checked
from oodscen._io.jpeg import to_jpeg
from oodscen._members import working
from oodscen._numbers import said
from oodscen.data._episode import Episode
from oodscen.data._messages import Image
from oodscen.data._scene import Visible
from oodscen.data._verdict import Protocol, Verdict, verdict_id, without_pictures
from oodscen.errors import AnswerError, ContentFiltered, Issue, LLMError, OodscenError, UsageError
from oodscen.judging._parsing import read_description
from oodscen.judging._questions import (
    ATTEMPTS,
    AnswerReader,
    ShownDrive,
    acting_prompt,
    acting_reader,
    choosing_prompt,
    choosing_reader,
    naming_prompt,
    naming_reader,
)
from oodscen.judging._references import (
    Answers,
    AspectOption,
    Case,
    Reference,
    kind_of_answerer,
    takes_cases,
)
from oodscen.judging._scoring import AnswerKey, GivenAnswers, score_answers
from oodscen.llm._ask import ask
from oodscen.prompts._base import Prompt
from oodscen.prompts._judging.describe_frame import DescribeFrame, FrameDescription
from oodscen.prompts._judging.drive_facts import DriveFacts
from oodscen.protocols import LLM, Frame

Answer = TypeVar("Answer", bound=BaseModel)
Value = TypeVar("Value")

NO_DESCRIPTION = "(no usable description)"
KEPT_DESCRIPTION = 6_000
"""Maximum length of a description that is stored and shown to the model again, in characters."""


_DESCRIPTION_READER = AnswerReader(
    DescribeFrame.purpose,
    read_description,
    lambda text, reasons: FrameDescription(description=text),
    "the description, in words",
    lambda answer: {"description": answer.description[:KEPT_DESCRIPTION]},
)


@checked
def evaluate(
    episode: Episode,
    frames: Mapping[str, Image | Frame],
    vlm: LLM,
    *,
    path: Sequence[str],
    leaf: str = "",
    options: Sequence[AspectOption] = (),
    protocol: Protocol = "ours",
    judge: LLM | None = None,
    chain: bool = False,
    before: ShownDrive | None = None,
    visible: Sequence[Visible] = (),
    rear: Image | Frame | None = None,
    withheld: bool = False,
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
        frames: The frames by moment, as `simulate` returns them or as images in files; references need none.
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
        withheld: Ask the same questions without any picture, and say so in each; the verdict is that of
            `MODEL without pictures`. Neither in the paper's protocol nor for references.

    Raises:
        UsageError: If the episode failed, an unusual one has no path, a frame is no picture, or there is none to ask
            about; in the paper's protocol also if there is none up to the decision.
        MissingExtra: If frames are to be encoded, and OpenCV is not installed.
    """
    if episode.status == "failed":
        raise UsageError(
            f"the episode {episode.scene_id!r} failed, so that no action of it is known"
        )
    if not (episode.is_ordinary or any(label.strip() for label in path)):
        raise UsageError("path must have the labels of what is out of the ordinary")
    is_paper = protocol == "paper"
    if is_paper and (withheld or rear is not None):
        raise UsageError("the paper's protocol shows its frames, and no view to the rear")
    if is_paper:
        options = ()
    key = AnswerKey.of(
        episode, path=tuple(path), leaf=leaf, visible=tuple(visible), options=tuple(options)
    )
    if takes_cases(vlm):
        case = Case(episode, key.path, leaf, options, episode.frames)
        return score_answers(key, answers_of_reference(vlm, case, protocol), judge)
    if not frames:
        raise UsageError("there is no frame to ask about")
    interview = _Interview(vlm, protocol, is_chain=is_paper or (chain and not withheld))
    images = {moment: _as_image(frame, episode, moment) for moment, frame in frames.items()}
    behind = None if rear is None else _as_image(rear, episode, "rear")
    shown = ShownDrive.of(episode, images, shows_decision=not is_paper, rear=behind)
    if withheld:
        shown = shown.without_pictures()
    if not is_paper:
        before = None
    elif before is None:
        before = ShownDrive(shown.images[:-1], DriveFacts())
    if before is not None and not before.images:
        raise UsageError("there is no frame of the drive up to the decision to ask about")
    answers = GivenAnswers(
        without_pictures(vlm.name) if withheld else vlm.name,
        interview.answers(shown, before, options),
        interview.failures,
        protocol,
        kind_of_answerer(vlm),
    )
    return score_answers(key, answers, judge)


def _as_image(frame: Image | Frame, episode: Episode, moment: str) -> Image:
    """Return a frame as a study stores and shows it.

    Raises:
        UsageError: If its colours are not those of a picture, or its file cannot be shown.
    """
    if isinstance(frame, Image):
        if fault := frame.fault():
            raise UsageError(f"frames: {fault}")
        return frame
    rgb = frame.rgb
    if not (
        isinstance(rgb, np.ndarray) and rgb.dtype == np.uint8 and rgb.shape[2:] == (3,) and rgb.size
    ):
        found = f"{rgb.dtype} {rgb.shape}" if isinstance(rgb, np.ndarray) else said(rgb, 80)
        raise UsageError(f"the {moment} frame's rgb must be uint8 [height, width, 3], not {found}")
    return Image.from_bytes(to_jpeg(rgb), f"frames/{episode.scene_id}/{moment}.jpg")


def answers_of_reference(reference: Reference, case: Case, protocol: Protocol) -> GivenAnswers:
    """Return the answers of an answerer that takes cases; none, with the failure, if its own code fails."""
    fields: dict[str, Any] = {}
    failures: list[OodscenError] = []
    try:
        with working("llm", reference.name):
            answers = reference.judge(case)
            if not isinstance(answers, Answers):
                raise TypeError(f"its answers are {said(answers, 80)}, not Answers")
            fields.update(answers)
    except OodscenError as error:
        failures.append(error)
    if not case.options:
        fields.pop("choice", None)
    kind = kind_of_answerer(reference)
    return GivenAnswers(reference.name, fields, failures, protocol, kind)


def unjudged_verdict(
    episode: Episode,
    model: LLM,
    error: str,
    error_type: str,
    protocol: Protocol = "ours",
    *,
    withheld: bool = False,
) -> Verdict:
    """Return the verdict on an item that could not be shown: no episode, or no frames."""
    name = without_pictures(model.name) if withheld else model.name
    return Verdict(
        id=verdict_id(episode.scene_id, name, protocol),
        scene_id=episode.scene_id,
        model=name,
        kind=kind_of_answerer(model),
        status="failed",
        outcome="error",
        error=error,
        error_type=error_type,
        retryable=episode.retryable,
        protocol=protocol,
        is_ordinary=episode.is_ordinary,
    )


@dataclass
class _Interview:
    """Asks the questions about one item, and keeps failures and notes on how answers were read."""

    llm: LLM
    protocol: Protocol
    is_chain: bool
    """True if the model describes the frames before the questions."""
    notes: list[str] = field(default_factory=list)
    failures: list[OodscenError] = field(default_factory=list)
    versions: dict[str, str] = field(default_factory=dict)

    def answers(
        self, shown: ShownDrive, before: ShownDrive | None, options: Sequence[AspectOption]
    ) -> dict[str, Any]:
        """Ask all questions and return the verdict's fields about the answers that came.

        With a drive up to the decision, `before`, the action is asked first and about it alone.
        """
        fields: dict[str, Any] = {}
        try:
            if before is not None:
                fields |= self.action(before, self.described(before))
            descriptions = self.described(shown)
            fields["descriptions"] = descriptions
            naming = naming_prompt(shown, descriptions, self.protocol)
            fields |= self.put(naming, naming_reader(self.protocol))
            if options:
                choosing = choosing_prompt(shown, options, descriptions)
                fields |= self.put(choosing, choosing_reader(options))
            if before is None:
                fields |= self.action(shown, descriptions)
        except LLMError as error:
            self.failures.append(error)
        return fields | {"notes": tuple(self.notes), "prompts": self.versions}

    def action(self, shown: ShownDrive, descriptions: tuple[str, ...]) -> dict[str, Any]:
        """Ask the second task and return the verdict's fields about it, empty without an answer."""
        return self.put(acting_prompt(shown, descriptions, self.protocol), acting_reader())

    def put(self, prompt: Prompt[Answer], reader: AnswerReader[Value, Answer]) -> dict[str, Any]:
        """Return the verdict's fields about a question, empty if no answer can be read; the failure is kept."""
        self.versions[prompt.purpose] = prompt.version()

        def answered(raw: str) -> tuple[Answer | None, list[Issue]]:
            answer, issues, note = reader.read(raw, model=self.llm.name)
            if answer is not None and note != "JSON":
                self.notes.append(f"{prompt.purpose}: {note}")
            return answer, issues

        try:
            return reader.fields(ask(self.llm, prompt, attempts=ATTEMPTS, read=answered))
        except (AnswerError, ContentFiltered) as error:
            self.failures.append(error)
            return {}

    def described(self, shown: ShownDrive) -> tuple[str, ...]:
        """Ask for a description of every frame in turn; none unless the questions follow them.

        A frame without a usable description gets `NO_DESCRIPTION`, so that the others keep their places.
        """
        if not self.is_chain:
            return ()
        descriptions: list[str] = []
        total = len(shown.images)
        for count in range(1, total + 1):
            question = DescribeFrame(
                frames=shown.images[:count], descriptions=tuple(descriptions), total=max(3, total)
            )
            descriptions.append(
                self.put(question, _DESCRIPTION_READER).get("description", NO_DESCRIPTION)
            )
        return tuple(descriptions)
