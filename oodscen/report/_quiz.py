"""The quiz: one self-contained page that puts a study's questions to a person."""

import base64
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from oodscen._io.files import is_written_through, write_named
from oodscen._io.files import replace as replace_file
from oodscen._io.study_files import QUIZ, refuse_own
from oodscen._seeding import stream
from oodscen._words.decimals import seconds
from oodscen.data._base import canonical_json, digest
from oodscen.data._episode import in_order
from oodscen.data._messages import Image
from oodscen.data._pairing import scene_of
from oodscen.errors import DataError, Issue
from oodscen.judging._people import token
from oodscen.judging._questions import (
    OPTIONS,
    ShownDrive,
    acting_prompt,
    choosing_prompt,
    naming_prompt,
    paragraphs,
)
from oodscen.report._render import environment
from oodscen.study._asked import AskedDrive, asked_drives
from oodscen.study._study import Study

SCENES = 20
"""Scenes of a quiz, unless told otherwise; each comes with its ordinary drives."""


def write_quiz(
    study: Study,
    out: Path | None = None,
    *,
    scenes: int = SCENES,
    rear_view: bool = False,
) -> Path:
    """Write the quiz of a study, and return the file's path.

    The page holds the pictures and the questions as models get them, in the same order, and neither an answer
    nor an id that reveals one. It needs no network.

    Args:
        study: Has the pictures and the questions.
        out: The file; `quiz.html` in the study's folder by default.
        scenes: Maximum number of scenes, drawn by the study's seed so that all paths have their share.
        rear_view: Show the views from the rear window, which the study has.

    Raises:
        DataError: If no episode of the study has frames, or one is not the recorded frame or cannot be shown.
        UsageError: If a scene or its text has changed since it was run.
        FolderTaken: If the file is one of a study's, other than its quiz.
    """
    target = out or study.folder / QUIZ
    if out is not None and not is_written_through(out):
        refuse_own(out, but=QUIZ)
    payload = _payload(study, scenes, rear_view)
    page = environment().get_template("quiz.html.j2").render(payload=payload)
    # A link in the study's folder may lead out of it; one that the caller named is followed.
    write = write_named if out else replace_file
    write(target, page.encode("utf-8"))
    return target


def _payload(study: Study, scenes: int, rear_view: bool) -> str:
    """Return the data of the page as JSON that can stand in a script element."""
    drives = [replace(drive, shows_rear=rear_view) for drive in draw_drives(study, scenes)]
    items = [_item(drive) for drive in drives]
    if not items:
        raise DataError("study", [Issue("", "no episode has frames")], source=str(study.folder))
    actions = [[option.id, option.description] for option in OPTIONS]
    payload = {
        "study": study.folder.resolve().name,
        "page": digest(items)[:16],
        "actions": actions,
        "items": items,
    }
    return canonical_json(payload).replace("<", "\\u003c")


def _item(drive: AskedDrive) -> dict[str, Any]:
    episode, shown = drive.episode, ShownDrive.of(drive.episode, drive.frames)
    naming = paragraphs(naming_prompt(shown))
    choosing = paragraphs(choosing_prompt(shown, drive.options))
    acting = paragraphs(acting_prompt(shown))
    item = {
        "item": token(episode),
        "frames": [_data_url(drive.frames[moment]) for moment in in_order(drive.frames)],
        "times": [seconds(time) for time in shown.facts.times_s],
        "facts": naming[0],
        "questions": [naming[1], choosing[1], acting[1]],
        "options": [[option.id, option.label] for option in drive.options],
    }
    if drive.rear is not None:
        item["rear"] = _data_url(drive.rear)
    return item


def _data_url(image: Image) -> str:
    data = image.read()
    kind = "png" if data.startswith(b"\x89PNG") else "jpeg"
    return f"data:image/{kind};base64,{base64.b64encode(data).decode()}"


def draw_drives(study: Study, scenes: int) -> Sequence[AskedDrive]:
    """Return the drives of a quiz of so many scenes, shuffled."""
    asked = asked_drives(study)
    rare = {drive.episode.scene_id: drive for drive in asked if not drive.episode.is_ordinary}
    scenes_of: dict[str, list[str]] = {}
    for name in sorted(rare):
        scenes_of.setdefault(rare[name].key.leaf, []).append(name)
    random = stream(study.config.seed, "quiz")
    ranked = [
        (rank, float(random.random()), scenes_of[leaf][int(index)])
        for leaf in sorted(scenes_of)
        for rank, index in enumerate(random.permutation(len(scenes_of[leaf])))
    ]
    chosen = {name for _, _, name in sorted(ranked)[:scenes]}
    drives = [drive for drive in asked if scene_of(drive.episode.scene_id) in chosen]
    return [drives[int(index)] for index in random.permutation(len(drives))]
