"""The files of a study: their names, and the types of their lines."""

import os
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import ClassVar, Literal

from pydantic import ConfigDict

from oodscen._lock import NAME as LOCK
from oodscen.data._base import Data
from oodscen.data._claim import Claim
from oodscen.data._drive_result import DriveResult
from oodscen.data._episode import Episode
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.data._verdict import Verdict
from oodscen.errors import FolderTaken
from oodscen.judging._aspects.opinions import Opinion
from oodscen.judging._people import PEOPLE, QuizAnswers
from oodscen.judging._shortcuts.audit import FILE as AUDIT
from oodscen.llm._call_log import Call
from oodscen.metrics._measurements import Measurements
from oodscen.stages._making.files import ASSETS, PICTURES
from oodscen.stages._making.making import MadeProp
from oodscen.stages._making.motions import MOTIONS, MadeMotion
from oodscen.stages._prune.decisions import PruneDecision
from oodscen.stages._prune.side_by_side import CatalogueComparison
from oodscen.stages._redteam.red_teamer import Round
from oodscen.study._staging import Staging
from oodscen.tree._edits import TreeEdit

TREES = ("initial", "diverse", "simulatable")
"""The trees of a study, in order of growth."""

CATALOGUES = "catalogues.json"
"""The comparison with other simulators' catalogues."""

QUIZ = "quiz.html"
"""The page that puts the questions to a person."""

TABLES: Mapping[str, str] = {
    "redteam": "redteam.jsonl",
    "edits": "edits.jsonl",
    "pruned": "pruned.jsonl",
    "scenarios": "scenarios.jsonl",
    "scenes": "scenes.jsonl",
    "episodes": "episodes.jsonl",
    "verdicts": "verdicts.jsonl",
    "calls": "calls.jsonl",
}
"""File of each table."""


class FailedLine(Data):
    """The line of a failed item in a file whose items have no status of their own."""

    noun: ClassVar[str] = "failed item"
    model_config = ConfigDict(extra="allow")

    id: str
    status: Literal["failed"]
    error: str
    retryable: bool = False


class ClaimsLine(Data):
    """A line of `claims.jsonl`."""

    noun: ClassVar[str] = "list of claims"
    model_config = ConfigDict(extra="allow")

    id: str
    claims: tuple[Claim, ...]


class RestagedLine(Data):
    """A line of `restaged.jsonl`."""

    noun: ClassVar[str] = "restaging"
    model_config = ConfigDict(extra="allow")

    id: str
    scene: Scene | None = None


class ShortPathLine(Data):
    """A line of `short_paths.jsonl`."""

    noun: ClassVar[str] = "short path"

    file: str
    leaf: str
    texts: int


LINES: Mapping[str, type[Data]] = {
    "redteam.jsonl": Round,
    "edits.jsonl": TreeEdit,
    "pruned.jsonl": PruneDecision,
    ASSETS: MadeProp,
    MOTIONS: MadeMotion,
    "scenarios.jsonl": Scenario,
    "short_paths.jsonl": ShortPathLine,
    "claims.jsonl": ClaimsLine,
    "staged.jsonl": Staging,
    "scenes.jsonl": Scene,
    "restaged.jsonl": RestagedLine,
    "episodes.jsonl": Episode,
    "episodes.paper.jsonl": Episode,
    "episodes.rear.jsonl": Episode,
    "verdicts.jsonl": Verdict,
    "opinions.jsonl": Opinion,
    PEOPLE: QuizAnswers,
    "calls.jsonl": Call,
    "drives.jsonl": DriveResult,
}
"""Types of the lines of every file that a run resumes from or reports on, besides the text sets."""

VALUES: Mapping[str, type[Data]] = {"metrics.json": Measurements, CATALOGUES: CatalogueComparison}
"""Types of the files of one value that a run resumes from, besides trees."""

_OTHERS = (
    "study.json",
    "restore.json",
    CATALOGUES,
    "leaderboard.json",
    "metrics.json",
    AUDIT,
    "answers.jsonl",
    "report.html",
    QUIZ,
)
FOLDERS = (PICTURES, "frames", "traces", "videos")
TEXT_SETS = re.compile(r"texts\.diverse\.\d+\.jsonl")


def is_own(name: str) -> bool:
    """Return whether this is the name of a file or folder that a run or a command writes into a study."""
    trees = {f"tree.{tree}.json" for tree in TREES}
    return name in {*_OTHERS, *FOLDERS, *LINES, *trees} or bool(TEXT_SETS.fullmatch(name))


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
