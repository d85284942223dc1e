"""Answers of people to the quiz, as rows beside those of models."""

import shlex
import unicodedata
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import AfterValidator, BeforeValidator, Field, StrictBool, StringConstraints

from oodscen._study_files import PEOPLE
from oodscen._wording import is_unseen
from oodscen.data._base import Data, digest
from oodscen.data._episode import ACTIONS, Episode
from oodscen.data._verdict import is_without_pictures
from oodscen.errors import DataError, Issue
from oodscen.judging._references import Answers, Case, CaseAnswerer

if TYPE_CHECKING:
    from oodscen.study._store import Store


def as_name(text: str) -> str:
    """Return a name in the form in which names are compared: composed (NFC), so that what looks alike is alike."""
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
    """A person's answers about one drive; the quiz goes on only when all three questions have one."""

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
        items = _by_token(episodes)
        issues, answers = [], dict[str, QuizAnswer]()
        for index, answer in enumerate(quiz.answers):
            if answer.item not in items:
                issues.append(Issue(f"answers[{index}]", "it is about no drive of this study"))
            elif items[answer.item] in answers:
                issues.append(Issue(f"answers[{index}]", "this drive has two answers"))
            else:
                answers[items[answer.item]] = answer
        if issues:
            raise DataError(QuizAnswers.noun, issues, source=source or quiz.id)
        return cls(quiz.id, answers)

    @classmethod
    def load(cls, store: "Store", name: str, episodes: Iterable[Episode]) -> "PersonAnswers":
        """Return a person's answers in a study; those about drives that have changed are left out."""
        lines = {as_name(line["id"]): line for line in store.lines(PEOPLE)}
        if as_name(name) not in lines:
            remedy = (
                f"give the file again (oodscen evaluate {store.folder} --answers FILE), or take the row out "
                f"(oodscen evaluate {store.folder} --drop {shlex.quote(person(name))})"
            )
            raise DataError(QuizAnswers.noun, [Issue("", f"{PEOPLE} lacks {name!r}: {remedy}")])
        quiz = QuizAnswers.parse(lines[as_name(name)], source=f"{PEOPLE}, {name}")
        items = _by_token(episodes)
        return cls(
            name, {items[answer.item]: answer for answer in quiz.answers if answer.item in items}
        )

    def judge(self, case: Case) -> Answers:
        """Answer as the person did."""
        answer = self.items[case.episode.scene_id]
        listed = {option.id for option in case.options}
        return Answers(
            is_ood=answer.is_ood,
            aspect=answer.aspect if answer.is_ood else "",
            confidence=answer.confidence,
            choice=answer.choice if answer.choice in listed else None,
            action=answer.action,
        )
