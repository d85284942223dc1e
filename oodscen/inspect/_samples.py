"""The questions of a study or a published data set as samples of inspect_ai."""

import base64
import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from inspect_ai.dataset import Sample
from inspect_ai.model import ChatMessageSystem, ChatMessageUser, ContentImage, ContentText

from oodscen.data._pairing import is_ordinary, kind_of, scene_of
from oodscen.errors import DataError, Issue, MissingExtra, UsageError
from oodscen.judging._questions import acting_prompt, choosing_prompt, naming_prompt
from oodscen.judging._scoring import AnswerKey
from oodscen.prompts._judging.choose_action import ChooseAction
from oodscen.prompts._judging.choose_aspect import ChooseAspect
from oodscen.prompts._judging.drive_facts import DriveQuestion
from oodscen.prompts._judging.name_aspect import NameAspect
from oodscen.study._asked import AskedDrive, asked_drives
from oodscen.study._study import Study

_COLUMNS = ["purpose", "system", "question", "images", "answer", "key"]


class _Question(NamedTuple):
    """One question, of a study or of a data set."""

    key: AnswerKey
    system: str
    text: str
    images: tuple[str, ...]
    """Files, or addresses that hold the data."""


def samples(
    folder: str | Path, purpose: str, *, split: str | None, is_paired: bool
) -> list[Sample]:
    """Return the questions of one purpose as samples.

    Args:
        folder: Folder of a study, or of a data set that `oodscen publish` wrote.
        purpose: Purpose of the question.
        split: Split of the data set, by default `test`; a study has none.
        is_paired: Whether the ordinary drives are asked about as well.

    Raises:
        UsageError: If the folder is neither, is a study though a split is named, or holds no such question.
    """
    folder = Path(folder).resolve()
    if (folder / "study.json").is_file():
        if split is not None:
            raise UsageError(
                f"{folder} is a study, which has no splits: leave -T split={split} out, or publish it"
            )
        questions = _of_study(folder, purpose)
    elif (folder / "data" / "questions").is_dir():
        questions = _of_data_set(folder, purpose, split or "test")
    else:
        raise UsageError(
            f"{folder} holds neither a study nor a published data set: give one with -T study=FOLDER"
        )
    dataset = [
        _sample(question, purpose)
        for question in questions
        if is_paired or not is_ordinary(question.key.item)
    ]
    if not dataset:
        raise UsageError(f"{folder} holds no question {purpose!r}")
    return dataset


def _sample(question: _Question, purpose: str) -> Sample:
    key = question.key
    pictures = [ContentImage(image=image) for image in question.images]
    return Sample(
        id=key.item,
        input=[
            ChatMessageSystem(content=question.system),
            ChatMessageUser(content=[ContentText(text=question.text), *pictures]),
        ],
        target=_target(key, purpose),
        metadata={
            "key": key.model_dump(mode="json"),
            "purpose": purpose,
            "path": " > ".join(key.path) or key.leaf,
            "kind": kind_of(key.item),
            "scene": scene_of(key.item),
        },
    )


def _target(key: AnswerKey, purpose: str) -> str | list[str]:
    """Return what is right, for readers of the log; scores do not depend on it."""
    if purpose == ChooseAction.purpose:
        return list(key.episode.safe_set)
    if is_ordinary(key.item):
        return ""
    if purpose == ChooseAspect.purpose:
        return next((option.label for option in key.options if option.holds(key.leaf)), "")
    return key.path[-1] if key.path else ""


def _of_study(folder: Path, purpose: str) -> Iterator[_Question]:
    study = Study.open(folder)
    for drive in asked_drives(study):
        prompt = _prompt(drive, purpose)
        yield _Question(
            drive.key,
            prompt.instructions(),
            prompt.question(),
            tuple(str(image.path) for image in prompt.images()),
        )


def _prompt(drive: AskedDrive, purpose: str) -> DriveQuestion[Any]:
    if purpose == NameAspect.purpose:
        return naming_prompt(drive.shown)
    if purpose == ChooseAspect.purpose:
        return choosing_prompt(drive.shown, drive.options)
    return acting_prompt(drive.shown)


def _of_data_set(folder: Path, purpose: str, split: str) -> Iterator[_Question]:
    try:
        from pyarrow import parquet
    except ImportError:
        raise MissingExtra("a published data set", "publish", "pyarrow") from None
    path = folder / "data" / "questions" / f"{split}.parquet"
    if not path.is_file():
        raise UsageError(f"{folder} has no split {split!r}")
    try:
        with parquet.ParquetFile(path) as file:
            for batch in file.iter_batches(batch_size=96, columns=_COLUMNS):
                for row in batch.to_pylist():
                    if row["purpose"] == purpose:
                        yield _question(row)
    except (OSError, ValueError, KeyError) as error:
        raise DataError("data set", [Issue("", str(error))], source=str(path)) from None


def _question(row: dict[str, Any]) -> _Question:
    """Return the question in a row of a data set, with its pictures as addresses."""
    images: Sequence[dict[str, bytes]] = row["images"]
    return _Question(
        AnswerKey.parse(json.loads(row["key"])),
        row["system"],
        row["question"],
        tuple(
            f"data:image/jpeg;base64,{base64.b64encode(image['bytes']).decode()}"
            for image in images
        ),
    )
