"""The questions of a study as rows, with what their answers are scored by."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from oodscen.data._base import canonical_json
from oodscen.data._messages import Image
from oodscen.data._pairing import Kind, kind_of, scene_of
from oodscen.judging._people import token
from oodscen.judging._questions import (
    OPTIONS,
    acting_prompt,
    choosing_prompt,
    naming_prompt,
    paragraphs,
)
from oodscen.judging._references import Answers, Case, Oracle
from oodscen.prompts._judging.choose_action import ChooseAction
from oodscen.prompts._judging.choose_aspect import ChooseAspect
from oodscen.prompts._judging.drive_facts import DriveQuestion
from oodscen.prompts._judging.name_aspect import NameAspect
from oodscen.publish._splits import Split
from oodscen.study._asked import AskedDrive

TASKS: Mapping[str, tuple[str, ...]] = {
    NameAspect.purpose: ("notice", "name"),
    ChooseAspect.purpose: ("choose",),
    ChooseAction.purpose: ("act",),
}
"""The tasks that the answers to a question count in, by its purpose."""

YES_NO = ("Yes", "No")
"""Options of the yes-or-no form of the first question."""

_METHOD = "Think step by step"
"""The words that begin the part of a question about how to answer it."""


@dataclass(frozen=True)
class PublishedDrive:
    """One drive of a data set."""

    asked: AskedDrive
    split: Split
    pair: str
    """Name of the scene that the drive is, or to which the ordinary drive belongs."""

    @cached_property
    def name(self) -> str:
        """The drive's name in the data set, which tells nothing about what the drive shows."""
        return token(self.asked.episode)

    @property
    def kind(self) -> Kind:
        """The kind of drive: `rare`, `twin` or `demand`."""
        return kind_of(self.asked.episode.scene_id)

    @property
    def frames(self) -> tuple[Image, ...]:
        """The frames in order of time."""
        return self.asked.shown.images

    @property
    def images(self) -> tuple[Image, ...]:
        """The pictures as they are asked about: the frames, and the view to the rear if there is one."""
        return naming_prompt(self.asked.shown).images()

    @cached_property
    def oracle(self) -> Answers:
        """The right answers."""
        key, episode = self.asked.key, self.asked.episode
        return Oracle().judge(Case(episode, key.path, key.leaf, key.options))


@dataclass(frozen=True)
class QuestionRow:
    """One question about one drive."""

    drive: PublishedDrive
    prompt: DriveQuestion[Any]
    options: tuple[str, ...]
    """The options, as they are worded."""
    answer: str
    """A right answer in the form asked for, as JSON; empty where no answer is right."""
    accepted: tuple[int, ...]
    """Indices of all right options."""
    neutral: tuple[int, ...] = ()
    """Indices of the options that score neither way."""
    best: int | None = None
    """Index of the best option; `None` if none is right."""

    @property
    def purpose(self) -> str:
        """The purpose of the question."""
        return self.prompt.purpose

    @property
    def name(self) -> str:
        """The row's name in the data set."""
        return f"{self.drive.name}-{self.purpose}"

    @property
    def stem(self) -> str:
        """The facts and the question without the options and without how to answer."""
        count = 2 if self.prompt.rear is None else 3
        *facts, question = paragraphs(self.prompt)[:count]
        return "\n\n".join([*facts, question.split(_METHOD)[0].strip()])


def question_rows(drive: PublishedDrive) -> Iterator[QuestionRow]:
    """Yield the three questions about a drive."""
    yield _naming_row(drive)
    yield _choosing_row(drive)
    yield _acting_row(drive)


def _naming_row(drive: PublishedDrive) -> QuestionRow:
    answers = drive.oracle
    answer = {"is_ood": answers.is_ood, "confidence": answers.confidence, "aspect": answers.aspect}
    right = 0 if answers.is_ood else 1
    prompt = naming_prompt(drive.asked.shown)
    return QuestionRow(drive, prompt, YES_NO, canonical_json(answer), (right,), best=right)


def _choosing_row(drive: PublishedDrive) -> QuestionRow:
    options, choice = drive.asked.options, drive.oracle.choice
    right = tuple(index for index, option in enumerate(options) if option.id == choice)
    best = right[0] if right else None
    return QuestionRow(
        drive,
        choosing_prompt(drive.asked.shown, options),
        tuple(option.label for option in options),
        "" if best is None else canonical_json({"choice": best + 1}),
        right,
        best=best,
    )


def _acting_row(drive: PublishedDrive) -> QuestionRow:
    names = [option.id for option in OPTIONS]
    actions = drive.asked.episode.actions
    outcomes = [(index, actions[name]) for index, name in enumerate(names) if name in actions]
    safe = tuple(index for index, outcome in outcomes if outcome.safe)
    neutral = tuple(index for index, outcome in outcomes if outcome.marginal)
    best = names.index(str(drive.oracle.action)) if safe else None
    return QuestionRow(
        drive,
        acting_prompt(drive.asked.shown),
        tuple(option.description for option in OPTIONS),
        "" if best is None else canonical_json({"action": names[best]}),
        safe,
        neutral,
        best,
    )


def labels_of_leaves(asked: Iterable[AskedDrive]) -> dict[str, str]:
    """Return the labels of the kinds of situation in some drives, by leaf of the tree."""
    return {drive.key.leaf: drive.key.path[-1] for drive in asked if drive.key.path}


def published_drives(asked: list[AskedDrive], splits: Mapping[str, Split]) -> list[PublishedDrive]:
    """Return the drives of a data set; ordinary drives without their scene are left out."""
    owners = {
        drive.episode.scene_id: token(drive.episode)
        for drive in asked
        if not drive.episode.is_ordinary
    }
    return [
        PublishedDrive(drive, splits.get(drive.key.leaf, "test"), owner)
        for drive in asked
        if (owner := owners.get(scene_of(drive.episode.scene_id)))
    ]
