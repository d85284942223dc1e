"""Reads a study, even an unfinished one: missing, torn or malformed parts become notes about gaps."""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from operator import attrgetter
from typing import Any, NamedTuple, TypeVar

from oodscen._io.files import read_bytes
from oodscen._io.json import object_lines, parse_object
from oodscen._io.study_files import ASSETS, AUDIT, MOTIONS, TABLES, TREES
from oodscen.data._base import Data
from oodscen.data._drive_result import DriveResult
from oodscen.data._episode import Episode
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.data._verdict import Verdict
from oodscen.errors import DataError, OodscenError
from oodscen.judging._drive_board import DriveBoard, current_results, drive_board
from oodscen.judging._shortcuts.audit import Audit
from oodscen.metrics._measurements import Measurements
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

Row = TypeVar("Row", bound=Data)
Value = TypeVar("Value")

_UNPRINTABLE = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f\ud800-\udfff\ufffe\uffff]")
_NO_REASON = "no reason was recorded"
_CREDENTIALS = re.compile(r"(://)[^/@\s]+@")


class FailedItem(NamedTuple):
    """One item that failed, in any stage."""

    stage: str
    """The table: `scenes`, `episodes` ..."""
    id: str
    error: str


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
    store = study.store
    material = Material()
    material.info = _object(store, "study.json", material) or {}
    material.metrics = _value(store, "metrics.json", Measurements.parse, material)
    if store.has(AUDIT):
        material.audit = _value(store, AUDIT, Audit.parse, material)
    for name in TREES:
        tree = _value(store, f"tree.{name}.json", ScenarioTree.parse, material)
        if tree is not None:
            material.trees[name] = tree
    material.rounds = sorted(_rows(store, "redteam", Round, material), key=attrgetter("round"))
    material.failures += [
        FailedItem("redteam", f"round {failed.round}", failed.error or _NO_REASON)
        for failed in failed_at_end(material.rounds)
    ]
    material.decisions = _rows(store, "pruned", PruneDecision, material)
    material.assets = _optional(store, ASSETS, MadeProp, material)
    material.motions = _optional(store, MOTIONS, MadeMotion, material)
    material.scenarios = _rows(store, "scenarios", Scenario, material)
    staged = _rows(store, "scenes", Scene, material)
    material.scenes = [scene for scene in staged if not scene.is_ordinary]
    material.demands = [scene for scene in staged if scene.is_ordinary]
    material.episodes = _rows(store, "episodes", Episode, material)
    material.verdicts = _rows(store, "verdicts", Verdict, material)
    material.whole = _optional(store, "episodes.paper.jsonl", Episode, material)
    drives = _optional(store, "drives.jsonl", DriveResult, material)
    material.drives = current_results(drives, material.scenes)
    if lost := len(drives) - len(material.drives):
        note = f"{lost} results in drives.jsonl are of scenes that have changed since, and left out"
        _note(material, "drives.jsonl", note)
    _note_stale(study, material)
    _leave_out_stale(store, material)
    if store.has("restaged.jsonl"):
        material.restagings = list(_lines(store, "restaged.jsonl", material))
    material.calls = list(_lines(store, TABLES["calls"], material))
    material.texts = {size: _texts(store, size, material) for size in _sizes(material.config)}
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


def _note_stale(study: Study, material: Material) -> None:
    """Note the scenes that have changed since they were run, themselves or their texts.

    Without its scenes a study is incomplete anyway, and malformed tables have notes of their own.
    """
    if not material.scenes or "scenes.jsonl" in material.gaps:
        return
    has_staged = study.store.has("staged.jsonl")
    staged = _lines(study.store, "staged.jsonl", material) if has_staged else ()
    changed = set[str]()
    with suppress(OodscenError):
        changed = changed_texts(study)
    if stale := stale_scenes(
        material.episodes, [*material.scenes, *material.demands], staged, changed
    ):
        _note(material, "episodes.jsonl", in_words(stale))


def _leave_out_stale(store: Store, material: Material) -> None:
    """Leave out the verdicts that do not belong to their drives as they are now, and note them."""
    if not material.verdicts:
        return
    stored = _stored(store, TABLES["verdicts"], Verdict)
    scenes = _stored(store, TABLES["scenes"], Scene)
    try:
        tables = Tables(
            store,
            StudyConfig.parse(material.config),
            episodes=_stored(store, TABLES["episodes"], Episode),
            whole=_stored(store, "episodes.paper.jsonl", Episode),
            scenarios=_stored(store, TABLES["scenarios"], Scenario),
            scenes=[scene for scene in scenes if not scene.is_ordinary],
        )
        stale = tables.stale(stored)
    except OodscenError as error:
        material.verdicts = []
        why = make_printable(str(error))
        _note(material, "verdicts.jsonl", f"verdicts cannot be compared with their drives: {why}")
        return
    if stale:
        ids = {make_printable(verdict.id) for verdict in stale}
        material.verdicts = [verdict for verdict in material.verdicts if verdict.id not in ids]
        _note(material, "verdicts.jsonl", f"{make_printable(stale_in_words(stale))}; left out here")


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


def make_printable(value: Any) -> Any:
    """Return nested data with unprintable characters replaced (lone surrogates, control characters).

    Credentials in URLs are removed too.
    """
    if isinstance(value, str):
        return _CREDENTIALS.sub(r"\1", _UNPRINTABLE.sub("\ufffd", value))
    if isinstance(value, Mapping):
        return {make_printable(str(key)): make_printable(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [make_printable(item) for item in value]
    return value


def _sizes(config: Mapping[str, Any]) -> list[str]:
    sizes = config.get("sets")
    numbers = sizes if isinstance(sizes, list) else [10, 100, 1000]
    return [str(size) for size in numbers if isinstance(size, int) and not isinstance(size, bool)]


def _object(store: Store, name: str, material: Material) -> dict[str, Any] | None:
    content = _bytes(store, name, material)
    if content is None:
        return None
    try:
        return dict(make_printable(parse_object(content)))
    except ValueError as error:
        material.gaps[name] = f"{name} cannot be read: {error}"
        return None


def _value(
    store: Store, name: str, parse: Callable[[dict[str, Any]], Value], material: Material
) -> Value | None:
    """Return the value in a file of its own; a file that holds something else becomes a note."""
    content = _object(store, name, material)
    if content is None:
        return None
    try:
        return parse(content)
    except DataError as error:
        material.gaps[name] = f"{name} cannot be read: {_first_issue(error)}"
        return None


def _rows(store: Store, table: str, kind: type[Row], material: Material) -> list[Row]:
    lines = _parse(_lines(store, TABLES[table], material), kind, TABLES[table], material)
    return _sound(lines, table, material)


def _sound(lines: Iterable[Row | dict[str, Any]], table: str, material: Material) -> list[Row]:
    """Return the rows of a table; failed items but rounds are collected, whether rows or plain data."""
    rows = []
    for line in lines:
        if isinstance(line, Data):
            rows.append(line)
            if getattr(line, "status", "ok") != "failed" or isinstance(line, Round):
                continue
            name, error = getattr(line, "id", None), getattr(line, "error", None)
        else:
            name, error = line.get("id"), line.get("error")
        material.failures.append(FailedItem(table, str(name or "?"), str(error or _NO_REASON)))
    return rows


def _stored(store: Store, name: str, kind: type[Row]) -> list[Row]:
    """Return the sound rows of a file character by character, as digests cover them."""
    rows = []
    try:
        content = read_bytes(store.path(name))
    except OSError:
        return []
    for _, line in object_lines(content):
        with suppress(DataError):
            if not isinstance(line, ValueError):
                rows.append(kind.parse(line))
    return rows


def _optional(store: Store, name: str, kind: type[Row], material: Material) -> list[Row]:
    """Return the rows of a file that most studies do not have."""
    if not store.has(name):
        return []
    lines = _parse(_lines(store, name, material), kind, name, material)
    return [line for line in lines if isinstance(line, kind)]


def _texts(store: Store, size: str, material: Material) -> list[Scenario]:
    name = f"texts.diverse.{size}.jsonl"
    return _sound(
        _parse(_lines(store, name, material), Scenario, name, material), "texts", material
    )


def _parse(
    lines: Iterable[dict[str, Any]], kind: type[Row], name: str, material: Material
) -> Iterator[Row | dict[str, Any]]:
    """Yield rows; a line for a failed item stays plain data."""
    faults: list[str] = []
    for line in lines:
        if line.get("status") == "failed" and "status" not in kind.model_fields:
            yield line
            continue
        try:
            yield kind.parse(line)
        except DataError as error:
            faults.append(_first_issue(error))
            yield {"id": line.get("id"), "error": f"malformed line: {faults[-1]}"}
    if faults:
        _note(material, name, f"{len(faults)} malformed line(s) in {name}, the first: {faults[0]}")


def _lines(store: Store, name: str, material: Material) -> Iterator[dict[str, Any]]:
    """Yield the objects in a file of lines; a torn last line is still being written."""
    content = _bytes(store, name, material)
    if content is None:
        return
    unreadable = 0
    for _, line in object_lines(content):
        if isinstance(line, ValueError):
            unreadable += 1
        else:
            yield dict(make_printable(line))
    if unreadable:
        note = f"{unreadable} line(s) of {name} are not JSON objects and were left out"
        _note(material, name, note)


def _bytes(store: Store, name: str, material: Material) -> bytes | None:
    try:
        return read_bytes(store.path(name))
    except FileNotFoundError:
        material.gaps[name] = f"{name} is not there yet"
    except OSError as error:
        material.gaps[name] = f"{name} cannot be read: {error.strerror or error}"
    return None


def _note(material: Material, name: str, message: str) -> None:
    material.gaps[name] = f"{material.gaps[name]}; {message}" if name in material.gaps else message


def _first_issue(error: DataError) -> str:
    return str(error.issues[0]) if error.issues else str(error)


def by_key(rows: Iterable[Row], key: Callable[[Row], str]) -> dict[str, Row]:
    """Return rows by a key; the last of equal keys wins."""
    return {key(row): row for row in rows}
