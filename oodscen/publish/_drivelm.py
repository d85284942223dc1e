"""The questions in the JSON of DriveLM, with the pictures beside it."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from oodscen.data._base import canonical_json
from oodscen.publish._question_rows import PublishedDrive, QuestionRow, question_rows
from oodscen.publish._vlmevalkit import LETTERS

CAMERA = "CAM_FRONT"
PARTS = {"name-aspect": "perception", "choose-aspect": "perception", "choose-action": "planning"}
"""DriveLM's part of a scene's questions, by purpose."""


def write_drivelm(folder: Path, drives: Sequence[PublishedDrive]) -> None:
    """Write one JSON file per split and the pictures.

    A drive is a scene, and its frames are key frames. The questions stand with the last frame and are about all of
    them; questions without a right answer are left out.
    """
    (folder / "images").mkdir(parents=True, exist_ok=True)
    for split in dict.fromkeys(drive.split for drive in drives):
        found = {}
        for drive in (
            published_drive for published_drive in drives if published_drive.split == split
        ):
            rows = [row for row in question_rows(drive) if row.best is not None]
            found[drive.name] = _scene(drive, rows, folder)
        (folder / f"{split}.json").write_text(canonical_json(found) + "\n", encoding="utf-8")


def _scene(drive: PublishedDrive, asked: Sequence[QuestionRow], folder: Path) -> dict[str, Any]:
    frames: dict[str, Any] = {}
    last = len(drive.images) - 1
    for number, image in enumerate(drive.images):
        name = f"{drive.name}-{number}"
        (folder / "images" / f"{name}.jpg").write_bytes(image.read())
        questions: dict[str, list[dict[str, Any]]] = {
            part: [] for part in ("perception", "prediction", "planning", "behavior")
        }
        for row in asked if number == last else ():
            questions[PARTS[row.purpose]].append(_question(row))
        frames[name] = {
            "key_object_infos": {},
            "QA": questions,
            "image_paths": {CAMERA: f"images/{name}.jpg"},
        }
    return {"scene_description": "", "pair": drive.pair, "kind": drive.kind, "key_frames": frames}


def _question(row: QuestionRow) -> dict[str, Any]:
    options = "\n".join(
        f"{letter}. {text}" for letter, text in zip(LETTERS, row.options, strict=False)
    )
    assert row.best is not None
    return {
        "Q": f"{row.stem}\n{options}",
        "A": f"{LETTERS[row.best]}. {row.options[row.best]}",
        "C": None,
        "con_up": None,
        "con_down": None,
        "cluster": None,
        "layer": None,
        "accepted": [LETTERS[place] for place in row.accepted],
    }
