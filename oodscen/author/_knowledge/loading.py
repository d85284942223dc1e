"""Loading of the knowledge base: the shipped TOML files and a user's own, with all their faults."""

import re
from collections.abc import Iterable, Mapping
from copy import deepcopy
from functools import cache, lru_cache
from importlib import resources
from pathlib import Path
from typing import Any

from oodscen._io.files import read_utf8, unreadable
from oodscen._io.toml import parse_toml
from oodscen.author._knowledge.base import (
    AmbientTraffic,
    BackgroundTraffic,
    Clash,
    Conditions,
    Driving,
    HazardKind,
    Knowledge,
    Paper,
    Replacement,
    RoadKind,
    Things,
    Wording,
)
from oodscen.data._base import Data
from oodscen.errors import DataError, Issue

_MAX_BYTES = 16 * 1024 * 1024

_TABLES: dict[str, type[Data]] = {
    "hazard": HazardKind,
    "place": RoadKind,
    "condition": Conditions,
    "traffic": BackgroundTraffic,
    "clash": Clash,
    "driving": Driving,
    "company": AmbientTraffic,
    "things": Things,
    "substitute": Replacement,
}
_SINGLE: dict[str, type[Data]] = {"wording": Wording, "paper": Paper}


class KnowledgeFiles:
    """The content of the files read so far, and its faults."""

    def __init__(self) -> None:
        self.entries: dict[str, list[Any]] = {name: [] for name in _TABLES}
        self.single: dict[str, Any] = {}
        self.issues: list[Issue] = []
        self.salvaged: dict[str, Any] = {}
        """The readable parts of faulty entries, by location; none of them is used for writing."""
        self.broken: dict[str, set[str]] = {}
        """The paths in these entries that were left out."""

    def read(self, name: str, text: str) -> None:
        """Add the content of a file."""
        try:
            content = _content(text)
        except ValueError as error:
            self.issues.append(Issue(name, str(error)))
            return
        for key, value in content.items():
            if key in _TABLES and isinstance(value, list):
                lines = _lines(text, key)
                for index, item in enumerate(value):
                    line = lines[index] if len(lines) == len(value) else None
                    self._add(f"{name}:{line}" if line else name, key, index, item)
            elif key in _SINGLE:
                self._parse(f"{name}: {key}", _SINGLE[key], value, key)
            else:
                known = ", ".join((*_TABLES, *_SINGLE))
                self.issues.append(Issue(f"{name}: {key}", f"unknown table; known are {known}"))

    def _add(self, name: str, key: str, index: int, item: Any) -> None:
        title = item.get("id") or item.get("key") if isinstance(item, Mapping) else None
        where = f"{name}: {key}[{index}]" + (f" {title}" if title else "")
        self._parse(where, _TABLES[key], item, key)

    def _parse(self, where: str, kind: type[Data], item: Any, key: str) -> None:
        try:
            value = kind.parse(item)
        except DataError as error:
            self.issues += [
                Issue(f"{where}: {issue.path}".strip(": "), issue.message) for issue in error.issues
            ]
            if kind is HazardKind and isinstance(item, Mapping):
                self._salvage(where, item, error.issues)
            return
        if key in _TABLES:
            self.entries[key].append((where, value))
        else:
            self.single[key] = value

    def _salvage(self, where: str, item: Mapping[str, Any], issues: Iterable[Issue]) -> None:
        """Keep the readable parts of a hazard, so that its other faults are also found."""
        broken = {issue.path for issue in issues}
        readable = deepcopy(dict(item))
        for path in broken:
            _set_aside(readable, path)
        try:
            hazard = HazardKind.parse({**_STAND_IN, **readable})
        except DataError as error:
            faulty = (*broken, *(issue.path for issue in error.issues))
            fields = {_field(path) for path in faulty}
            broken |= fields
            rest = {name: value for name, value in readable.items() if name not in fields}
            hazard = HazardKind.parse({**_STAND_IN, **rest})
        self.salvaged[where] = hazard
        self.broken[where] = broken

    @property
    def hazards(self) -> list[tuple[str, HazardKind]]:
        """All hazards with their locations, including salvaged ones."""
        return [*self.entries["hazard"], *self.salvaged.items()]

    def is_broken(self, issue: Issue) -> bool:
        """Return whether an issue concerns a part that was left out."""
        return any(
            re.match(rf"{re.escape(f'{where}: {path}')}(?![\w-])", issue.path)
            for where, paths in self.broken.items()
            for path in paths
        )

    def knowledge(self, *, salvaged: bool = False) -> Knowledge | None:
        """Build the knowledge base; a later hazard replaces an earlier one with the same id.

        Inspection includes the readable parts of faulty hazards: `salvaged`.
        """
        if "wording" not in self.single:
            self.issues.append(Issue("wording", "no file has this table"))
            return None
        tables = {name: [entry for _, entry in entries] for name, entries in self.entries.items()}
        hazards = {
            hazard.id: hazard
            for _, hazard in (self.hazards if salvaged else self.entries["hazard"])
        }
        conditions = {condition.key: condition for condition in tables.pop("condition")}
        tables.pop("hazard")
        return Knowledge(
            hazards=tuple(hazards.values()),
            conditions=tuple(conditions.values()),
            places=tuple(tables.pop("place")),
            **{name: tuple(rows) for name, rows in tables.items()},
            **self.single,
        )


_STAND_IN: dict[str, Any] = {
    "id": "unnamed",
    "class": "environmental",
    "family": "a family without a name",
    "label": "a hazard without a name",
    "places": ["urban"],
    "events": ["The ego vehicle meets something without a name"],
    "ordinary": "the lane ahead is clear",
}
"""Substitutes for unreadable fields; faults found in them are not reported."""


def _field(path: str) -> str:
    """Return the field of an entry that a path points into."""
    return re.split(r"[.\[]", path, maxsplit=1)[0]


def _set_aside(entry: dict[str, Any], path: str) -> None:
    """Remove the target of a path; a placeholder replaces a name in a list, and a backward range is turned round."""
    steps: list[str | int] = [
        int(step[1:-1]) if step.startswith("[") else step
        for step in re.findall(r"\[\d+\]|[^.\[\]]+", path)
    ]
    inner: Any = entry
    for step in steps[:-1]:
        try:
            inner = inner[step]
        except (KeyError, IndexError, TypeError):
            return
    if steps and isinstance(inner, dict):
        target = inner.pop(steps[-1], None)
        if _is_backward(target):
            inner[steps[-1]] = target[::-1]
    elif steps and isinstance(inner, list) and isinstance(last := steps[-1], int) and inner[last:]:
        inner[last] = f"Without a name {last}"


def _is_backward(value: Any) -> bool:
    is_pair = isinstance(value, list) and len(value) == 2
    return is_pair and all(isinstance(end, (int, float)) for end in value) and value[0] > value[1]


@lru_cache(maxsize=8)
def _content(text: str) -> Mapping[str, Any]:
    """Return the parsed content of a file. Cached: every load of a user's file re-reads the shipped files."""
    return parse_toml(text)


def _lines(text: str, key: str) -> list[int]:
    """Return the numbers of the lines that open the entries of a table array."""
    opens = re.compile(rf"\[\[\s*{key}\s*\]\]")
    lines = enumerate(text.split("\n"), start=1)
    return [number for number, line in lines if opens.match(line.strip())]


def _shipped_files() -> list[tuple[str, str]]:
    folder = resources.files("oodscen.author._knowledge")
    files = [file for file in folder.iterdir() if file.name.endswith(".toml")]
    files.sort(key=lambda file: file.name)
    return [(file.name, file.read_text(encoding="utf-8")) for file in files]


def file_of(where: str) -> str:
    """Return the name of the file of an entry or a fault, by its location."""
    return where.split(":", 1)[0]


def own_files(path: Path) -> tuple[str, ...]:
    """Return the names of the files at a user's path."""
    return tuple(file.name for file in _toml_files(path))


def _toml_files(path: Path) -> list[Path]:
    """Return the files of a folder, or the path itself if it is none."""
    try:
        return sorted(path.glob("*.toml")) if path.is_dir() else [path]
    except OSError as error:
        raise unreadable("knowledge base", path, error) from None


def _user_files(path: Path) -> list[tuple[str, str]]:
    if not (files := _toml_files(path)):
        raise DataError("knowledge base", [Issue("", "no .toml file in it")], source=str(path))
    try:
        return [(file.name, read_utf8(file, "knowledge base", limit=_MAX_BYTES)) for file in files]
    except DataError as error:
        issues = [Issue("", f"{error.source}: {issue}") for issue in error.issues]
        raise DataError("knowledge base", issues, source=str(path)) from None


def gather(
    path: str | Path | None, *, salvaged: bool = False
) -> tuple[KnowledgeFiles, Knowledge | None]:
    """Read the shipped files and a user's own, and collect all faults.

    Raises:
        DataError: If a file cannot be read at all.
    """
    shelf = KnowledgeFiles()
    for name, text in _shipped_files():
        shelf.read(name, text)
    if path is not None:
        for name, text in _user_files(Path(path)):
            shelf.read(name, text)
    return shelf, shelf.knowledge(salvaged=salvaged)


def load_knowledge(path: str | Path | None = None) -> Knowledge:
    """Read the shipped knowledge base, extended by a user's own.

    Args:
        path: A TOML file, or a folder of them, that adds hazards, places, conditions or traffic; a
            hazard with the id of a shipped one replaces it.

    Raises:
        DataError: If entries cannot be used; the error lists each with its file and path.
    """
    return _cached(None if path is None else str(Path(path)), stamp_of(path))


def stamp_of(path: str | Path | None) -> tuple[tuple[str, int, int], ...]:
    """Return a stamp that changes with a user's files: path, modification time and size of each."""
    if path is None:
        return ()
    files = _toml_files(Path(path))
    return tuple(
        (str(file), file.stat().st_mtime_ns, file.stat().st_size) for file in files if file.exists()
    )


@cache
def _cached(path: str | None, stamp: tuple[Any, ...]) -> Knowledge:
    del stamp
    shelf, knowledge = gather(path)
    if shelf.issues or knowledge is None:
        raise DataError("knowledge base", shelf.issues, source=path or "shipped")
    return knowledge
