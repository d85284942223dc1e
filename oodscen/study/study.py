"""A study on disk, for reading: every table in one call."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self, TypeVar

from oodscen._data import Data
from oodscen.episode import Episode
from oodscen.errors import DataError, MissingExtra, StudyError, StudyMissing, UnknownComponent
from oodscen.prune import PruneDecision
from oodscen.pruning.comparing import Comparison
from oodscen.pruning.restoring import Restoration
from oodscen.redteam import Round
from oodscen.scenario import Scenario
from oodscen.scene import Scene
from oodscen.study.config import StudyConfig
from oodscen.study.store import Store
from oodscen.tree import ScenarioTree
from oodscen.verdict import Verdict

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa

Row = TypeVar("Row", bound=Data)

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
    "calls": "calls.jsonl",
}
"""File of every table."""


class Study:
    """The folder that `oodscen run` leaves behind."""

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        self.store = Store(folder)

    @classmethod
    def open(cls, folder: str | Path) -> Self:
        """Open an existing study.

        Raises:
            StudyMissing: When the folder holds none.
        """
        study = cls(folder)
        if not study.store.has("study.json"):
            raise StudyMissing(str(folder))
        return study

    @property
    def info(self) -> dict[str, Any]:
        """Content of `study.json`: configuration, seeds, versions, counts, status."""
        loaded = self._json("study.json")
        if not isinstance(loaded, dict):
            raise StudyError(f"{self.folder / 'study.json'} is not an object")
        return loaded

    @property
    def config(self) -> StudyConfig:
        """The configuration that the study was made with."""
        return StudyConfig.parse(self.info.get("config"), source=str(self.folder / "study.json"))

    @property
    def metrics(self) -> dict[str, Any]:
        """Content of `metrics.json`; empty while there is none."""
        return self._json("metrics.json") if self.store.has("metrics.json") else {}

    def tree(self, name: str) -> ScenarioTree:
        """Return the `initial`, `diverse` or `simulatable` tree."""
        if name not in TREES:
            raise UnknownComponent("tree", name, TREES)
        return ScenarioTree.load(self.folder / f"tree.{name}.json")

    @property
    def rounds(self) -> list[Round]:
        """Every round of red teaming."""
        return self._rows(Round, "redteam.jsonl")

    @property
    def decisions(self) -> list[PruneDecision]:
        """What became of every node of the diverse tree."""
        return self._rows(PruneDecision, "pruned.jsonl")

    @property
    def restoration(self) -> Restoration:
        """What would restore the branches that pruning dropped, ranked."""
        return Restoration.load(self.folder / "restore.json")

    @property
    def comparison(self) -> Comparison:
        """What other simulators' catalogues make of the diverse tree."""
        return Comparison.load(self.folder / "catalogues.json")

    @property
    def scenarios(self) -> list[Scenario]:
        """The texts along the paths of the simulatable tree."""
        return self._rows(Scenario, "scenarios.jsonl")

    def texts(self, size: int) -> list[Scenario]:
        """Return one of the text sets of the diverse tree."""
        return self._rows(Scenario, f"texts.diverse.{size}.jsonl")

    @property
    def scenes(self) -> list[Scene]:
        """The scenes that were staged."""
        return self._rows(Scene, "scenes.jsonl")

    @property
    def episodes(self) -> list[Episode]:
        """Every episode, the failed ones included."""
        return self._rows(Episode, "episodes.jsonl")

    @property
    def verdicts(self) -> list[Verdict]:
        """Every verdict, the failed ones included."""
        return self._rows(Verdict, "verdicts.jsonl")

    def trace(self, scene_id: str) -> "pa.Table":
        """Return the ground truth of one episode as an Arrow table; its first column is `phase`.

        Raises:
            StudyError: When the run that simulated it did not keep traces.
            MissingExtra: When pyarrow is not installed.
        """
        name = f"traces/{scene_id}.parquet"
        if not self.store.has(name):
            raise StudyError(f"{self.folder} holds no {name}: run it with traces")
        try:
            import pyarrow.parquet as parquet
        except ImportError:
            raise MissingExtra("a trace as a table", "tables", "pyarrow") from None
        return parquet.read_table(self.store.path(name))

    def failures(self, table: str) -> list[dict[str, Any]]:
        """Return the lines of a table that failed, each with its `error`."""
        return [row for row in self.table(table) if row.get("status") == "failed"]

    def table(self, name: str) -> list[dict[str, Any]]:
        """Return the lines of a table as plain data.

        Raises:
            UnknownComponent: With close matches.
        """
        if name not in TABLES:
            raise UnknownComponent("table", name, TABLES)
        return list(self.store.lines(TABLES[name]))

    def to_arrow(self, name: str) -> "pa.Table":
        """Return a table as an Arrow table, one row per line; mappings become structs."""
        try:
            import pyarrow as pa
        except ImportError:
            raise MissingExtra("a table in Arrow's format", "tables", "pyarrow") from None
        return pa.Table.from_pylist(self.table(name))

    def to_pandas(self, name: str) -> "pd.DataFrame":
        """Return a table as a data frame, one row per line; fields of mappings are joined by dots."""
        try:
            import pandas as pd
        except ImportError:
            raise MissingExtra("a table as a data frame", "tables", "pandas") from None
        return pd.json_normalize(self.table(name), max_level=1)

    def _json(self, name: str) -> Any:
        path = self.folder / name
        try:
            return json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise StudyError(f"cannot read {path}: {error}") from None

    def _rows(self, kind: type[Row], name: str) -> list[Row]:
        rows = []
        for number, line in enumerate(self.store.lines(name), start=1):
            if line.get("status") == "failed" and "status" not in kind.model_fields:
                continue
            try:
                rows.append(kind.parse(line))
            except DataError as error:
                source = f"{self.folder / name}, line {number}"
                raise DataError(error.noun, error.issues, source=source) from None
        return rows
