"""The names of a study's files, and the refusal to write others in their place."""

import os
import re
from collections.abc import Iterator, Mapping
from pathlib import Path

from oodscen._io.lock import NAME as LOCK
from oodscen.errors import FolderTaken

TREES = ("initial", "diverse", "simulatable")
"""The trees of a study, in order of growth."""

TABLES: Mapping[str, str] = {
    "redteam": "redteam.jsonl",
    "edits": "edits.jsonl",
    "pruned": "pruned.jsonl",
    "scenarios": "scenarios.jsonl",
    "scenes": "scenes.jsonl",
    "episodes": "episodes.jsonl",
    "verdicts": "verdicts.jsonl",
    "drives": "drives.jsonl",
    "calls": "calls.jsonl",
}
"""File of each table."""

ASSETS = "assets.jsonl"
"""The things made to order."""

PICTURES = "assets"
"""The folder of their pictures."""

MOTIONS = "motions.jsonl"
"""The movements made to order."""

CATALOGUES = "catalogues.json"
"""The comparison with other simulators' catalogues."""

QUIZ = "quiz.html"
"""The page that puts the questions to a person."""

PEOPLE = "people.jsonl"
"""Answers of people to that page."""

AUDIT = "audit.json"
"""The audit of what questions give away."""

FOLDERS = (PICTURES, "frames", "traces", "videos")
TEXT_SETS = re.compile(r"texts\.diverse\.\d+\.jsonl")

REAR = "episodes.rear.jsonl"
"""File of the runs in which the views to the rear were taken."""

_FILES = frozenset(
    {
        *(f"tree.{tree}.json" for tree in TREES),
        *TABLES.values(),
        ASSETS,
        MOTIONS,
        CATALOGUES,
        QUIZ,
        PEOPLE,
        AUDIT,
        "study.json",
        "restore.json",
        "leaderboard.json",
        "metrics.json",
        "report.html",
        "answers.jsonl",
        "short_paths.jsonl",
        "claims.jsonl",
        "staged.jsonl",
        "restaged.jsonl",
        "episodes.paper.jsonl",
        REAR,
        "opinions.jsonl",
    }
)


def picture_of(name: str) -> str:
    """Return the file of a study that shows a thing made to order."""
    return f"{PICTURES}/{name}.jpg"


def is_own(name: str) -> bool:
    """Return whether this is the name of a file or folder that a run or a command writes into a study."""
    return name in _FILES or name in FOLDERS or bool(TEXT_SETS.fullmatch(name))


def refuse_own(target: Path, *, but: str = "") -> None:
    """Refuse to write a file that belongs to a study; a missing comparison of catalogues may be added.

    Args:
        target: The file, which need not exist.
        but: Name of the one file of a study that may be written.

    Raises:
        FolderTaken: When the file, links followed, is a study's, or would lie below one of its folders.
    """
    place = Path(os.path.realpath(target))
    for folder, part in _owners(place):
        may_be_added = part == CATALOGUES and not place.exists()
        if place.parent != folder or not (may_be_added or part == but):
            # What is there is named, as the error says that it is.
            name = str(place.relative_to(folder)) if place.exists() else part
            raise FolderTaken(str(folder), [name])


def refuse_inside(folder: Path) -> None:
    """Refuse to write into a study's folder or one of its parts; a folder of one's own in it is none of them.

    Raises:
        FolderTaken: When the folder, links followed, is a study's, or below one of its own files or folders.
    """
    place = Path(os.path.realpath(folder))
    if (place / "study.json").exists():
        raise FolderTaken(str(folder), ["study.json"])
    for owner, part in _owners(place):
        raise FolderTaken(str(owner), [part])


def _owners(place: Path) -> Iterator[tuple[Path, str]]:
    """Yield the studies that own a place, the nearest first, each with its file or folder that is it or holds it."""
    for parent in place.parents:
        part = place.relative_to(parent).parts[0]
        if (is_own(part) or part == LOCK) and (parent / "study.json").exists():
            yield parent, part
