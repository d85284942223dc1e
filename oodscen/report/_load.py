"""Everything that a report shows of a study, even of an unfinished one."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from operator import attrgetter
from typing import Any

from oodscen._io.study_files import ASSETS, AUDIT, MOTIONS, TABLES, TREES
from oodscen.data._drive_result import DriveResult
from oodscen.data._episode import Episode
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.data._verdict import Verdict
from oodscen.errors import OodscenError
from oodscen.judging._drive_board import DriveBoard, current_results, drive_board
from oodscen.judging._items import last_by
from oodscen.judging._shortcuts.audit import Audit
from oodscen.metrics._measurements import Measurements
from oodscen.report._tolerant_reader import NO_REASON, FailedItem, TolerantReader, make_printable
from oodscen.stages._making.making import MadeProp
from oodscen.stages._making.motions import MadeMotion
from oodscen.stages._prune.decisions import PruneDecision
from oodscen.stages._redteam.red_teamer import Round
from oodscen.study._config import StudyConfig
from oodscen.study._rounds import failed_at_end
from oodscen.study._stale import changed_texts, in_words, stale_scenes
from oodscen.study._stale_verdicts import Tables, stale_in_words
from oodscen.study._store import Store
from oodscen.study._study import Study
from oodscen.tree._scenario_tree import ScenarioTree


@dataclass
class Material:
    """Everything that could be read of one study."""

    info: dict[str, Any] = field(default_factory=dict)
    """Content of `study.json`, or empty."""
    trees: dict[str, ScenarioTree] = field(default_factory=dict)
    rounds: list[Round] = field(default_factory=list)
    decisions: list[PruneDecision] = field(default_factory=list)
    assets: list[MadeProp] = field(default_factory=list)
    """Things made to order, and those that could not be made."""
    motions: list[MadeMotion] = field(default_factory=list)
    scenarios: list[Scenario] = field(default_factory=list)
    scenes: list[Scene] = field(default_factory=list)
    demands: list[Scene] = field(default_factory=list)
    episodes: list[Episode] = field(default_factory=list)
    whole: list[Episode] = field(default_factory=list)
    """Episodes of the paper's protocol, if it was used."""
    verdicts: list[Verdict] = field(default_factory=list)
    drives: list[DriveResult] = field(default_factory=list)
    restagings: list[dict[str, Any]] = field(default_factory=list)
    """Lines of `restaged.jsonl`."""
    calls: list[dict[str, Any]] = field(default_factory=list)
    texts: dict[str, list[Scenario]] = field(default_factory=dict)
    """The text sets of the diverse tree, by size."""
    metrics: Measurements | None = None
    audit: Audit | None = None
    """The audit of shortcuts, if there is one."""
    failures: list[FailedItem] = field(default_factory=list)
    gaps: dict[str, str] = field(default_factory=dict)
    """By file name: the reason why it is missing, wholly or in part."""

    @property
    def are_verdicts_whole(self) -> bool:
        """False if verdicts are missing or were left out, so that no model can be graded."""
        return TABLES["verdicts"] not in self.gaps

    @property
    def config(self) -> Mapping[str, Any]:
        """The configuration as it was written; empty if there is none."""
        return mapping(self.info.get("config"))

    @property
    def authors(self) -> Mapping[str, Any]:
        """The authors as they were written, by role; empty if they are not."""
        return mapping(self.info.get("authors"))

    @property
    def seed(self) -> int:
        """The seed of the study; 0 if none can be read."""
        seed = self.config.get("seed")
        return seed if isinstance(seed, int) else 0

    @cached_property
    def drive_board(self) -> DriveBoard:
        """The results of all drives, by driver."""
        return drive_board(self.drives, self.scenarios, seed=self.seed)


def read(study: Study) -> Material:
    """Return the material of a study; never raises for a fault in the study."""
    store, files = study.store, TolerantReader(study.store)
    material = Material(failures=files.failures, gaps=files.gaps)
    material.info = files.json_object("study.json") or {}
    material.metrics = files.value("metrics.json", Measurements.parse)
    if store.has(AUDIT):
        material.audit = files.value(AUDIT, Audit.parse)
    for name in TREES:
        tree = files.value(f"tree.{name}.json", ScenarioTree.parse)
        if tree is not None:
            material.trees[name] = tree
    material.rounds = sorted(files.table("redteam", Round), key=attrgetter("round"))
    files.failures += [
        FailedItem("redteam", f"round {failed.round}", failed.error or NO_REASON)
        for failed in failed_at_end(material.rounds)
    ]
    material.decisions = files.table("pruned", PruneDecision)
    material.assets = files.optional_rows(ASSETS, MadeProp)
    material.motions = files.optional_rows(MOTIONS, MadeMotion)
    material.scenarios = files.table("scenarios", Scenario)
    staged = files.table("scenes", Scene)
    material.scenes = [scene for scene in staged if not scene.is_ordinary]
    material.demands = [scene for scene in staged if scene.is_ordinary]
    material.episodes = files.table("episodes", Episode)
    material.verdicts = files.table("verdicts", Verdict)
    material.whole = files.optional_rows("episodes.paper.jsonl", Episode)
    drives = last_by(files.optional_rows("drives.jsonl", DriveResult), lambda row: row.id)
    material.drives = current_results(drives, material.scenes)
    if lost := len(drives) - len(material.drives):
        note = f"{lost} results in drives.jsonl are of scenes that have changed since, and left out"
        files.note("drives.jsonl", note)
    _note_stale(study, files, material)
    _leave_out_stale(store, files, material)
    if store.has("restaged.jsonl"):
        material.restagings = list(files.lines("restaged.jsonl"))
    material.calls = list(files.lines(TABLES["calls"]))
    material.texts = {
        size: files.rows(f"texts.diverse.{size}.jsonl", Scenario, "texts")
        for size in _sizes(material.config)
    }
    _note_unanswered(material)
    return material


def _note_unanswered(material: Material) -> None:
    """Add what a model did not give, as failed items: ordinary twins, rarities and opinions."""
    counted = mapping(material.info.get("failures"))
    if counted.get("ordinary"):
        largest = max(material.texts, key=int, default="")
        material.failures += [
            FailedItem("ordinary", text.id, "no ordinary text was written that could be read")
            for text in (*material.scenarios, *material.texts.get(largest, ()))
            if text.ordinary is None
        ]
    material.failures += [
        FailedItem("opinions", verdict.id, f"scored by the matcher: {verdict.judge_error}")
        for verdict in material.verdicts
        if verdict.judge_error
    ]
    rarity = material.metrics.asked if material.metrics else None
    # Answers belong to texts only as long as there are as many of both.
    if counted.get("rarity") and rarity and len(rarity.per_text) == len(material.scenarios):
        material.failures += [
            FailedItem("rarity", scenario.id, "the model gave no rarity that could be read")
            for scenario, text_rarity in zip(material.scenarios, rarity.per_text, strict=True)
            if "not answered" in text_rarity.flags
        ]


def _note_stale(study: Study, files: TolerantReader, material: Material) -> None:
    """Note the scenes that have changed since they were run, themselves or their texts.

    Without its scenes a study is incomplete anyway, and malformed tables have notes of their own.
    """
    if not material.scenes or "scenes.jsonl" in material.gaps:
        return
    has_staged = study.store.has("staged.jsonl")
    staged = files.lines("staged.jsonl") if has_staged else ()
    changed = set[str]()
    with suppress(OodscenError):
        changed = changed_texts(study)
    if stale := stale_scenes(
        material.episodes, [*material.scenes, *material.demands], staged, changed
    ):
        files.note("episodes.jsonl", in_words(stale))


def _leave_out_stale(store: Store, files: TolerantReader, material: Material) -> None:
    """Leave out the verdicts that do not belong to their drives as they are now, and note them."""
    if not material.verdicts:
        return
    stored = files.stored_rows(TABLES["verdicts"], Verdict)
    scenes = files.stored_rows(TABLES["scenes"], Scene)
    try:
        tables = Tables(
            store,
            StudyConfig.parse(material.config),
            episodes=files.stored_rows(TABLES["episodes"], Episode),
            whole=files.stored_rows("episodes.paper.jsonl", Episode),
            scenarios=files.stored_rows(TABLES["scenarios"], Scenario),
            scenes=[scene for scene in scenes if not scene.is_ordinary],
        )
        stale = tables.stale(stored)
    except OodscenError as error:
        material.verdicts = []
        why = make_printable(str(error))
        files.note("verdicts.jsonl", f"verdicts cannot be compared with their drives: {why}")
        return
    if stale:
        ids = {make_printable(verdict.id) for verdict in stale}
        material.verdicts = [verdict for verdict in material.verdicts if verdict.id not in ids]
        files.note("verdicts.jsonl", f"{make_printable(stale_in_words(stale))}; left out here")


def mapping(value: object) -> Mapping[str, Any]:
    """Return a value if it is a mapping, and an empty one otherwise."""
    return value if isinstance(value, Mapping) else {}


def dig(value: object, *keys: str) -> Any:
    """Return the value under nested keys; `None` if one is missing."""
    for key in keys:
        value = mapping(value).get(key)
    return value


def number(value: object, *keys: str) -> float | None:
    """Return a finite number from nested mappings, or `None`."""
    number = dig(value, *keys)
    if isinstance(number, bool) or not isinstance(number, int | float):
        return None
    return float(number) if abs(number) < float("inf") else None


def _sizes(config: Mapping[str, Any]) -> list[str]:
    sizes = config.get("sets")
    numbers = sizes if isinstance(sizes, list) else [10, 100, 1000]
    return [str(size) for size in numbers if isinstance(size, int) and not isinstance(size, bool)]
