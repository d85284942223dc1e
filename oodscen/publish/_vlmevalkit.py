"""The questions as multiple choice in the TSV that VLMEvalKit reads."""

import base64
import csv
from collections.abc import Sequence
from pathlib import Path

from oodscen.publish._question_rows import TASKS, PublishedDrive, QuestionRow, question_rows

LETTERS = "ABCDEFGH"
COLUMNS = (
    "index",
    "image",
    "image_path",
    "question",
    *LETTERS,
    "answer",
    "category",
    "l2-category",
    "split",
    "accepted",
    "neutral",
    "drive",
    "pair",
)
"""Columns of the file.

VLMEvalKit knows those up to `split`. An `image` that is a number refers to the row with that index, and
`accepted` and `neutral` list the letters of all right options and of those that score neither way.
"""


def write_tsv(path: Path, drives: Sequence[PublishedDrive]) -> None:
    """Write the questions that have a right answer.

    A question about an action has several right answers; its `answer` is the best one.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    index = 0
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, delimiter="\t", lineterminator="\n", restval="")
        writer.writeheader()
        for drive in drives:
            answerable = [row for row in question_rows(drive) if row.best is not None]
            first = index
            for row in answerable:
                image = _images(drive) if index == first else first
                writer.writerow({"index": index, "image": image, **_cells(row)})
                index += 1


def _cells(row: QuestionRow) -> dict[str, str]:
    """Return the cells of a row but for its index and its pictures."""
    assert row.best is not None
    drive = row.drive
    return {
        "image_path": _image_names(drive),
        "question": row.stem,
        **dict(zip(LETTERS, row.options, strict=False)),
        "answer": LETTERS[row.best],
        "category": TASKS[row.purpose][0],
        "l2-category": drive.kind,
        "split": drive.split,
        "accepted": "".join(LETTERS[index] for index in row.accepted),
        "neutral": "".join(LETTERS[index] for index in row.neutral),
        "drive": drive.name,
        "pair": drive.pair,
    }


def _images(drive: PublishedDrive) -> str:
    return str([base64.b64encode(image.read()).decode() for image in drive.images])


def _image_names(drive: PublishedDrive) -> str:
    """Return the names under which VLMEvalKit saves the pictures: it encodes them again, without loss as PNG."""
    return str([f"{drive.name}-{number}.png" for number in range(len(drive.images))])
