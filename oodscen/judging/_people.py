"""Answers of people to the quiz, as rows beside those of models."""

import shlex
import unicodedata
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import AfterValidator, BeforeValidator, Field, StrictBool, StringConstraints

from oodscen._io.study_files import PEOPLE
from oodscen._words.wording import is_unseen
from oodscen.data._base import Data, digest
from oodscen.data._episode import ACTIONS, Episode
from oodscen.data._verdict import is_without_pictures
from oodscen.errors import DataError, Issue
from oodscen.judging._references import Answers, Case, CaseAnswerer

if TYPE_CHECKING:
    from oodscen.study._store import Store


def as_name(text: str) -> str:
    """Return a name in the form in which names are compared: composed (NFC), so that the same characters are alike."""
    return unicodedata.normalize("NFC", text)


def _checked_name(name: str) -> str:
    if any(map(is_unseen, name)):
        raise ValueError("has characters that do not show or turn the direction of writing")
    if is_without_pictures(name):
        raise ValueError("is the name of a row of a model without pictures; choose another")
    return name


Name = Annotated[
    str,
    BeforeValidator(lambda value: as_name(value) if isinstance(value, str) else value),
    StringConstraints(pattern=r"^[\w.-]([\w .-]{0,38}[\w.-])?$"),
    AfterValidator(_checked_name),
]


class QuizAnswer(Data):
    """A person's answers about one drive. All three questions must be answered."""

    item: str = Field(max_length=64)
    """The drive's token; see `token`."""
    is_ood: StrictBool
    confidence: float | None = Field(default=None, ge=0.5, le=1.0, strict=True)
    aspect: str = Field(default="", max_length=500)
    choice: str = Field(max_length=200)
    """Id of the chosen option."""
    action: Literal[ACTIONS]  # type: ignore[valid-type]  # The ids are listed once.


class QuizAnswers(Data):
    """The file that the quiz saves."""

    noun: ClassVar[str] = "answers to a quiz"

    schema_version: Literal[1] = 1
    id: Name
    """The person's name, composed (NFC)."""
    answers: tuple[QuizAnswer, ...] = Field(min_length=1, max_length=100_000)


def token(episode: Episode) -> str:
    """Return the name of a drive in a quiz, which reveals nothing about what the drive shows."""
    pictures = [episode.file_sha256.get(file, "") for file in sorted(episode.frames.values())]
    return digest(["quiz", episode.scene_id, pictures])[:16]


def is_person(row: str) -> bool:
    """Return whether a row is that of a person."""
    return row.startswith(person(""))


def person(name: str) -> str:
    """Return the name of a person's row."""
    return f"human:{name}"


def _by_token(episodes: Iterable[Episode]) -> dict[str, str]:
    """Return the ids of scenes and ordinary drives by their tokens."""
    return {token(episode): episode.scene_id for episode in episodes if episode.frames}


def _by_drive(
    quiz: QuizAnswers, episodes: Iterable[Episode], source: str, *, leaves_out: bool
) -> dict[str, QuizAnswer]:
    """Return the answers by ids of drives; those about no drive of the study are left out, or refused.

    Raises:
        DataError: If an answer is about no drive and is not left out, or two are about one.
    """
    drives = _by_token(episodes)
    issues, answers = [], dict[str, QuizAnswer]()
    for index, answer in enumerate(quiz.answers):
        drive = drives.get(answer.item)
        if drive is None:
            if not leaves_out:
                issues.append(Issue(f"answers[{index}]", "it is about no drive of this study"))
        elif drive in answers:
            issues.append(Issue(f"answers[{index}]", "this drive has two answers"))
        else:
            answers[drive] = answer
    if issues:
        raise DataError(QuizAnswers.noun, issues, source=source)
    return answers


class PersonAnswers(CaseAnswerer):
    """Answers drives as a person did.

    Args:
        name: The person's name.
        items: The answers by id of the scene or ordinary drive.
    """

    kind: ClassVar[Literal["model"]] = "model"
    takes_cases: ClassVar[bool] = True

    def __init__(self, name: str, items: Mapping[str, QuizAnswer]) -> None:
        self.name = person(name)
        self.items = dict(items)
        answers = {item: answer.model_dump() for item, answer in sorted(self.items.items())}
        self.sha256 = digest(answers)

    @classmethod
    def matched(
        cls, quiz: QuizAnswers, episodes: Iterable[Episode], source: str = ""
    ) -> "PersonAnswers":
        """Return the answers of a file to the drives of a study.

        `source` is the file, for error messages; by default the person's name.

        Raises:
            DataError: If an answer is about no drive of the study, or two are about one.
        """
        return cls(quiz.id, _by_drive(quiz, episodes, source or quiz.id, leaves_out=False))

    @classmethod
    def load(cls, store: "Store", name: str, episodes: Iterable[Episode]) -> "PersonAnswers":
        """Return a person's answers in a study; those about drives that have changed are left out.

        Raises:
            DataError: If the study lacks the person, a line of its file is malformed, or two answers are about one drive.
        """
        found: tuple[QuizAnswers, str] | None = None
        for number, line in store.numbered(PEOPLE):
            source = f"{PEOPLE}, line {number}"
            quiz = QuizAnswers.parse(line, source=source)
            if quiz.id == as_name(name):
                found = quiz, source
        if found is None:
            evaluate = f"oodscen evaluate {shlex.quote(str(store.folder))}"
            remedy = (
                f"give the file again ({evaluate} --answers FILE), or take the row out "
                f"({evaluate} --drop {shlex.quote(person(name))})"
            )
            raise DataError(QuizAnswers.noun, [Issue("", f"{PEOPLE} lacks {name!r}: {remedy}")])
        quiz, source = found
        return cls(quiz.id, _by_drive(quiz, episodes, source, leaves_out=True))

    def judge(self, case: Case) -> Answers:
        """Answer as the person did; a choice that is not among the case's options is none.

        Raises:
            DataError: If the person has not answered about the drive.
        """
        drive = case.episode.scene_id
        if drive not in self.items:
            raise DataError(QuizAnswers.noun, [Issue("", f"{self.name} did not answer {drive!r}")])
        answer = self.items[drive]
        listed = {option.id for option in case.options}
        return Answers(
            is_ood=answer.is_ood,
            aspect=answer.aspect if answer.is_ood else "",
            confidence=answer.confidence,
            choice=answer.choice if answer.choice in listed else None,
            action=answer.action,
        )
