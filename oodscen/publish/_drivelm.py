"""The questions in the JSON of DriveLM, with the pictures beside it."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from oodscen.data._base import canonical_json
from oodscen.publish._question_rows import PublishedDrive, QuestionRow, question_rows
from oodscen.publish._vlmevalkit import LETTERS

CAMERA, REAR_CAMERA = "CAM_FRONT", "CAM_BACK"
PARTS = {"name-aspect": "perception", "choose-aspect": "perception", "choose-action": "planning"}
"""DriveLM's part of a scene's questions, by purpose."""
_ALL_PARTS = ("perception", "prediction", "planning", "behavior")


def write_drivelm(folder: Path, drives: Sequence[PublishedDrive]) -> None:
    """Write one JSON file per split and the pictures.

    A drive is a scene, and its frames are key frames. The questions stand with the last frame and are about all of
    them; questions without a right answer are left out.
    """
    (folder / "images").mkdir(parents=True, exist_ok=True)
    for split in dict.fromkeys(drive.split for drive in drives):
        scenes = {
            drive.name: _scene(drive, folder / "images") for drive in drives if drive.split == split
        }
        (folder / f"{split}.json").write_text(canonical_json(scenes) + "\n", encoding="utf-8")


def _scene(drive: PublishedDrive, images: Path) -> dict[str, Any]:
    """Return a drive as a scene, after writing its pictures into a folder."""
    frames: dict[str, Any] = {}
    last, rear = len(drive.frames) - 1, drive.asked.rear
    for number, image in enumerate(drive.frames):
        name = f"{drive.name}-{number}"
        views = {CAMERA: (name, image)}
        if number == last and rear is not None:
            views[REAR_CAMERA] = (f"{drive.name}-{len(drive.frames)}", rear)
        for file, view in views.values():
            (images / f"{file}.jpg").write_bytes(view.read())
        rows = question_rows(drive) if number == last else ()
        frames[name] = {
            "key_object_infos": {},
            "QA": _questions(row for row in rows if row.best is not None),
            "image_paths": {camera: f"images/{file}.jpg" for camera, (file, _) in views.items()},
        }
    return {"scene_description": "", "pair": drive.pair, "kind": drive.kind, "key_frames": frames}


def _questions(rows: Iterable[QuestionRow]) -> dict[str, list[dict[str, Any]]]:
    questions: dict[str, list[dict[str, Any]]] = {part: [] for part in _ALL_PARTS}
    for row in rows:
        questions[PARTS[row.purpose]].append(_question(row))
    return questions


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
        "accepted": [LETTERS[index] for index in row.accepted],
    }
