"""The types of the lines and values of a study's files."""

from collections.abc import Mapping
from typing import ClassVar, Literal

from pydantic import ConfigDict

from oodscen._io.study_files import ASSETS, CATALOGUES, MOTIONS, PEOPLE
from oodscen.data._base import Data
from oodscen.data._claim import Claim
from oodscen.data._drive_result import DriveResult
from oodscen.data._episode import Episode
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.data._verdict import Verdict
from oodscen.judging._aspects.opinions import Opinion
from oodscen.judging._people import QuizAnswers
from oodscen.llm._call_log import Call
from oodscen.metrics._measurements import Measurements
from oodscen.stages._making.making import MadeProp
from oodscen.stages._making.motions import MadeMotion
from oodscen.stages._prune.decisions import PruneDecision
from oodscen.stages._prune.side_by_side import CatalogueComparison
from oodscen.stages._redteam.red_teamer import Round
from oodscen.study._staging import Staging
from oodscen.tree._edits import TreeEdit


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
