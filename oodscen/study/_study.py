"""Reading a study from disk: every table in one call."""

import os
from collections.abc import Iterable, Iterator, Mapping
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self, TypeVar
from urllib.parse import quote

from oodscen._arguments import checked, instance_of
from oodscen._display import Brief, escaped, html_table
from oodscen._io.files import unreadable
from oodscen._io.study_files import AUDIT, FOLDERS, REAR, TABLES, TEXT_SETS, TREES, is_own
from oodscen.data._base import Data
from oodscen.data._drive_result import DriveResult
from oodscen.data._episode import Episode
from oodscen.data._pairing import is_ordinary
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.data._verdict import Verdict
from oodscen.errors import (
    DataError,
    FolderTaken,
    Issue,
    MissingExtra,
    OodscenError,
    StudyError,
    StudyMissing,
    UnknownComponent,
)
from oodscen.judging._drive_board import DriveBoard, drive_board
from oodscen.judging._items import last_by
from oodscen.judging._leaderboard.board import Leaderboard
from oodscen.judging._leaderboard.requirements import (
    RequirementResult,
    parse_requirement,
    requirements,
)
from oodscen.judging._shortcuts.audit import Audit
from oodscen.metrics._rarity.exposure import TreeRarity
from oodscen.stages._prune.decisions import PruneDecision
from oodscen.stages._prune.restoration import Restoration
from oodscen.stages._prune.side_by_side import CatalogueComparison
from oodscen.stages._redteam.red_teamer import Round
from oodscen.study._board import board_of
from oodscen.study._config import StudyConfig
from oodscen.study._files import LINES, VALUES, FailedLine
from oodscen.study._record import Info
from oodscen.study._rounds import rounds_on
from oodscen.study._stale_verdicts import refuse_stale_verdicts
from oodscen.study._store import Store
from oodscen.study._study_uses import StudyUses
from oodscen.tree._coverage import Coverage, study_coverage
from oodscen.tree._scenario_tree import ScenarioTree

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa

Row = TypeVar("Row", bound=Data)

_HASHES = "file_sha256"
"""Field with an entry for every file of an episode."""


class Study(Brief, StudyUses):
    """The folder that `oodscen run` leaves behind."""

    _repr_fields = ("folder",)

    @checked
    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        self.store = Store(folder)

    @classmethod
    @checked
    def open(cls, folder: str | Path) -> Self:
        """Open an existing study.

        Raises:
            StudyMissing: When the folder holds no study.
            DataError: When a name of a study's file belongs to a folder, a pipe or a device, or `study.json` is
                malformed: empty, cut off, or without its fields.
        """
        study = cls(folder)
        if not study.store.has("study.json"):
            raise StudyMissing(str(folder))
        study._check_kinds(study.own())
        _ = study.info
        return study

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the folder alone, from the root down: another process may work elsewhere."""
        return type(self), (self.folder.absolute(),)

    def _repr_html_(self) -> str:
        """Return the counts of the study and a link to its report, for notebooks."""
        try:
            info = self.info if self.store.has("study.json") else {}
            has_report = self.store.has("report.html")
        except OodscenError as error:
            return f"<p>{escaped(self.folder)}: {escaped(error)}</p>"
        if not info:
            return f"<p>{escaped(self.folder)}: no study yet</p>"
        counts = {"status": info.get("status", ""), **info.get("counts", {})}
        rows = [
            (name.replace("_", " "), _in_words(value))
            for name, value in counts.items()
            if value not in ({}, None)
        ]
        link = f'<p><a href="{escaped(self._link())}">report</a></p>' if has_report else ""
        return f"<div>{html_table(rows, caption=str(self.folder))}{link}</div>"

    def _link(self) -> str:
        """Return the address of the report: relative below the working folder, else a file's."""
        path = (self.folder / "report.html").resolve()
        here = Path.cwd().resolve()
        return (
            f"./{quote(path.relative_to(here).as_posix())}"
            if here in path.parents
            else path.as_uri()
        )

    def own(self) -> list[str]:
        """Return the sorted names of the study's own files in the folder."""
        try:
            return sorted(filter(is_own, os.listdir(self.folder)))
        except FileNotFoundError:
            return []
        except OSError as error:
            raise unreadable(Info.noun, self.folder, error) from None

    def check(self) -> None:
        """Check that a run can resume from the folder, or start in it.

        Raises:
            FolderTaken: When the folder holds no study, but files that a study would write.
            DataError: When a file cannot be read, or a line or a tree is malformed.
        """
        names = self.own()
        if names and not self.store.has("study.json"):
            raise FolderTaken(str(self.folder), names)
        self._check_kinds(names)
        self._check_links(names)
        for name in names:
            kind = Scenario if TEXT_SETS.fullmatch(name) else LINES.get(name)
            if kind is not None:
                self._rows(kind, name)
            if name in VALUES and self.store.holds(name):
                VALUES[name].parse(self.store.read(name), source=str(self.folder / name))
        trees = {name: self.tree(name) for name in TREES if self.store.holds(f"tree.{name}.json")}
        if "initial" in trees:
            rounds_on(self, trees["initial"])
        self._check_unique_scenes()

    def _check_unique_scenes(self) -> None:
        """Check that no two rare scenes of `scenes.jsonl`, which may be edited by hand, share an id."""
        names: set[str] = set()
        for number, line in self.store.numbered("scenes.jsonl"):
            if line.get("status") == "failed" or is_ordinary(line["id"]):
                continue
            if line["id"] in names:
                issue = Issue("", f"there are two scenes {line['id']!r}; remove one")
                source = f"{self.store.path('scenes.jsonl')}, line {number}"
                raise DataError(Scene.noun, [issue], source=source)
            names.add(line["id"])

    def _check_links(self, names: Iterable[str]) -> None:
        """Check that no folder, nor what lies directly in it, is a link that leads outside the study."""
        for name in sorted({*FOLDERS} & {*names}):
            with os.scandir(self.store.inside(name)) as entries:
                links = sorted(entry.name for entry in entries if entry.is_symlink())
            for link in links:
                self.store.inside(f"{name}/{link}")

    def _check_kinds(self, names: Iterable[str]) -> None:
        """Check that files are regular files, and folders are folders."""
        for name in names:
            path = self.folder / name
            kind, is_of_kind = "regular file", path.is_file()
            if name in FOLDERS:
                kind, is_of_kind = "folder", path.is_dir()
            if not is_of_kind:
                raise DataError(Info.noun, [Issue("", f"is not a {kind}")], source=str(path))

    @property
    def info(self) -> dict[str, Any]:
        """Content of `study.json`: configuration, seeds, versions, counts, status."""
        content = self.store.read("study.json")
        Info.parse(content, source=str(self.folder / "study.json"))
        return content

    @property
    def config(self) -> StudyConfig:
        """The configuration that the study was made with."""
        return StudyConfig.parse(self.info.get("config"), source=str(self.folder / "study.json"))

    @property
    def metrics(self) -> dict[str, Any]:
        """Content of `metrics.json`; empty if there is none yet."""
        is_missing = self.folder.is_dir() and not self.store.has("metrics.json")
        return {} if is_missing else self.store.read("metrics.json")

    @property
    def exposure(self) -> dict[str, float]:
        """Estimated meetings per kilometre by leaf of the diverse tree; empty before the texts are measured."""
        paths, source = self.metrics.get("paths"), str(self.folder / "metrics.json")
        return TreeRarity.parse(paths, source=source).per_km() if paths else {}

    @checked
    def tree(self, name: str) -> ScenarioTree:
        """Return the `initial`, `diverse` or `simulatable` tree."""
        if name not in TREES:
            raise UnknownComponent("tree", name, TREES)
        return ScenarioTree.load(self.folder / f"tree.{name}.json")

    @property
    def rounds(self) -> list[Round]:
        """Every round of red teaming, in order."""
        return sorted(self._rows(Round, "redteam.jsonl"), key=attrgetter("round"))

    @property
    def decisions(self) -> list[PruneDecision]:
        """The pruning decision for every node of the diverse tree."""
        return self._rows(PruneDecision, "pruned.jsonl")

    @property
    def restoration(self) -> Restoration:
        """The additions that would restore the branches that pruning dropped, ranked."""
        return Restoration.load(self.folder / "restore.json")

    @property
    def comparison(self) -> CatalogueComparison:
        """The comparison of other simulators' catalogues on the diverse tree."""
        return CatalogueComparison.load(self.folder / "catalogues.json")

    @property
    def scenarios(self) -> list[Scenario]:
        """The texts along the paths of the simulatable tree."""
        return self._rows(Scenario, "scenarios.jsonl")

    @checked
    def texts(self, size: int) -> list[Scenario]:
        """Return the text set of a size of the diverse tree; empty if there is none."""
        instance_of("size", size, int)
        return self._rows(Scenario, f"texts.diverse.{size}.jsonl")

    @property
    def scenes(self) -> list[Scene]:
        """The rare scenes that were staged."""
        return [scene for scene in self._rows(Scene, "scenes.jsonl") if not scene.is_ordinary]

    @property
    def demands(self) -> list[Scene]:
        """The ordinary demands of the scenes."""
        return [scene for scene in self._rows(Scene, "scenes.jsonl") if scene.is_ordinary]

    @property
    def episodes(self) -> list[Episode]:
        """Every episode, including failed ones."""
        return self._rows(Episode, "episodes.jsonl")

    @property
    def paper_episodes(self) -> list[Episode]:
        """Every episode of the paper's protocol, including failed ones."""
        return self._rows(Episode, "episodes.paper.jsonl")

    @property
    def rear_episodes(self) -> list[Episode]:
        """Every run in which the view from the rear window was taken, including failed ones."""
        return self._rows(Episode, REAR)

    @property
    def verdicts(self) -> list[Verdict]:
        """Every verdict, including failed ones.

        Raises:
            UsageError: If one does not belong to its drive as it is now, or was edited. The same run makes it again;
                `stored_verdicts` has it as it is.
        """
        verdicts = self.stored_verdicts
        refuse_stale_verdicts(self, verdicts)
        return verdicts

    @property
    def stored_verdicts(self) -> list[Verdict]:
        """Every verdict of the file, even if it does not belong to its drive as it is now."""
        return self._rows(Verdict, "verdicts.jsonl")

    @property
    def drives(self) -> list[DriveResult]:
        """The results of `oodscen drive`, the last of each drive."""
        return last_by(self._rows(DriveResult, "drives.jsonl"), lambda row: row.id)

    def leaderboard(self) -> Leaderboard:
        """Return the leaderboard of the study's verdicts, as in `leaderboard.json`.

        Raises:
            UsageError: If a verdict does not belong to its drive as it is now.
        """
        return board_of(self, self.verdicts)

    @property
    def audit(self) -> Audit | None:
        """The audit of shortcuts (`oodscen audit`); `None` if there is none."""
        return Audit.load(self.folder / AUDIT) if self.store.has(AUDIT) else None

    @checked
    def requirements(self, text: str) -> list[RequirementResult]:
        """Return the grade of every model against a requirement such as `safe>=0.9,needless<=0.05`.

        Raises:
            UsageError: If the text is malformed, or names an unknown figure, or if a verdict does not belong to its
                drive as it is now.
        """
        return requirements(
            self.verdicts,
            self.episodes,
            self.scenarios,
            parse_requirement(text),
            seed=self.config.seed,
        )

    def drive_board(self) -> DriveBoard:
        """Return the results of every driver of `oodscen drive`."""
        return drive_board(self.drives, self.scenarios, seed=self.config.seed)

    @checked
    def coverage(self, tree: str = "simulatable") -> Coverage:
        """Count what the study holds for each node of one of its trees.

        Args:
            tree: `initial`, `diverse` or `simulatable`. For the two larger trees, the texts of the
                text sets count as well as the scenarios.

        Raises:
            UnknownComponent: If the tree has another name.
            DataError: If a file cannot be read, or is malformed.
        """
        return study_coverage(self, tree)

    @checked
    def trace(self, scene_id: str) -> "pa.Table":
        """Return the ground truth of one episode as an Arrow table; its first column is `phase`.

        Raises:
            StudyError: When there is no such episode, its run kept no traces, or its trace cannot be read.
            MissingExtra: When pyarrow is not installed.
        """
        name = f"traces/{scene_id}.parquet"
        if not self.store.has(name):
            raise StudyError(
                f"{self.folder} holds no {name}: there is no such episode, or it was run without traces"
            )
        try:
            import pyarrow as pa
            from pyarrow import parquet
        except ImportError:
            raise MissingExtra("a trace as a table", "tables", "pyarrow") from None
        try:
            return parquet.read_table(self.store.inside(name))
        except (OSError, pa.ArrowException) as error:
            raise StudyError(f"cannot read {self.folder / name}: {error}") from None

    @checked
    def failures(self, table: str) -> list[dict[str, Any]]:
        """Return the failed lines of a table, each with its `error`."""
        return [row for row in self.table(table) if row.get("status") == "failed"]

    @checked
    def table(self, name: str) -> list[dict[str, Any]]:
        """Return the lines of a table as plain data.

        Raises:
            UnknownComponent: When the table is unknown, with close matches.
        """
        if name not in TABLES:
            raise UnknownComponent("table", name, TABLES)
        return [line for _, line in self._lines(TABLES[name])]

    @checked
    def to_arrow(self, name: str) -> "pa.Table":
        """Return a table as an Arrow table, one row per line; mappings become structs.

        It has the fields of all lines; one that a line lacks is null there.

        Raises:
            StudyError: When the values of a field have several types.
        """
        try:
            import pyarrow as pa
        except ImportError:
            raise MissingExtra("a table in Arrow's format", "tables", "pyarrow") from None
        rows = self.table(name)
        # Arrow takes the names of its columns from the first row.
        fields = dict.fromkeys(field for row in rows for field in row)
        try:
            return pa.Table.from_pylist(
                [{field: row.get(field) for field in fields} for row in rows]
            )
        except (pa.ArrowException, OverflowError) as error:
            raise StudyError(f"{self.folder / TABLES[name]} is not a table: {error}") from None

    @checked
    def to_pandas(self, name: str) -> "pd.DataFrame":
        """Return a table as a data frame, one row per line; nested field names are joined by dots.

        Hashes by file stay in one column.
        """
        try:
            import pandas as pd
        except ImportError:
            raise MissingExtra("a table as a data frame", "tables", "pandas") from None
        rows = self.table(name)
        hashes = [row.pop(_HASHES, None) for row in rows]
        frame = pd.json_normalize(rows, max_level=1)
        return frame.assign(**{_HASHES: hashes}) if any(hashes) else frame

    def _lines(self, name: str) -> Iterator[tuple[int, dict[str, Any]]]:
        """Return the lines of a file with their numbers; a missing file is empty, but no missing study."""
        if not self.folder.is_dir():
            raise StudyMissing(str(self.folder))
        return self.store.numbered(name)

    def _rows(self, kind: type[Row], name: str) -> list[Row]:
        rows = []
        for number, line in self._lines(name):
            try:
                if line.get("status") == "failed" and "status" not in kind.model_fields:
                    FailedLine.parse(line)
                else:
                    rows.append(kind.parse(line))
            except DataError as error:
                source = f"{self.folder / name}, line {number}"
                raise DataError(error.noun, error.issues, source=source) from None
        return rows


def _in_words(count: object) -> object:
    """Return a count of `study.json` for a table: several counts in one line, anything else as it is."""
    if isinstance(count, Mapping):
        return ", ".join(f"{name}: {number}" for name, number in count.items())
    return count
