"""Reading designs from files, folders and studies."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from oodscen._io.files import read_utf8
from oodscen._io.json import object_lines
from oodscen._io.study_files import ASSETS, TABLES
from oodscen._io.toml import parse_toml
from oodscen.data._catalogue import Asset
from oodscen.data._designs.prop import Prop, check_prop
from oodscen.errors import DataError, Issue, UsageError
from oodscen.stages._making.making import MadeProp

_STUDY_TABLES = (ASSETS, TABLES["scenes"])
"""The files of a study that hold designs, of which a folder's first is read."""


class Designs(NamedTuple):
    """The designs that were found, and the ids of things that could not be made."""

    props: list[Prop]
    unmade: list[str]


class _Entry(NamedTuple):
    """One entry of a file, not yet checked."""

    source: str
    value: Any
    kind: type[Prop] | type[MadeProp] = Prop
    fault: str = ""
    """The reason why its text cannot be read; empty if it can."""

    def parse(self) -> Prop | MadeProp:
        """Return the design, or what is known of a thing without one.

        Raises:
            DataError: If it is neither.
        """
        if self.fault:
            raise DataError(Prop.noun, [Issue("", self.fault)], source=self.source)
        return self.kind.parse(self.value, source=self.source)


def read_props(path: Path, assets: Sequence[Asset] | None = None) -> Designs:
    """Return the designs in a JSON, JSON Lines or TOML file, in a folder of them, or in a study.

    A TOML file holds one table per design, named by its id. A line may hold a design or, as in a study's
    `assets.jsonl`, have it as its member `prop`, which is `null` if the thing could not be made; or a scene, with the
    designs that it carries. A design that is given twice counts once.

    Args:
        path: The file, folder or study.
        assets: The assets of the simulator that is to show the designs; without them, each is checked alone.

    Raises:
        DataError: When a file cannot be read, holds no valid design, or two designs of one id differ; it lists the
            faults of all designs.
    """
    found: dict[str, tuple[Prop, str]] = {}
    unmade: dict[str, None] = {}
    issues: list[Issue] = []
    for entry in _entries(path):
        place = entry.source.removeprefix(str(path)).lstrip("/, ")
        try:
            one = entry.parse()
        except DataError as error:
            issues += [_placed(place, issue) for issue in error.issues]
            continue
        if isinstance(one, MadeProp):
            unmade[one.id] = None
            continue
        first, its_place = found.setdefault(one.id, (one, place))
        if first is not one:
            if first == one:
                continue
            fault = f"{its_place or path.name} holds another design with the id {one.id!r}"
            issues.append(_placed(place, Issue("id", fault)))
        if assets is not None:
            issues += [_placed(place, issue) for issue in check_prop(one, assets)]
    left = [name for name in unmade if name not in found]
    if not found and not issues:
        told = f"; could not be made: {', '.join(left)}" if left else ""
        raise UsageError(f"{path} holds no design of a thing made to order{told}")
    if issues:
        raise DataError(Prop.noun, issues, source=str(path))
    return Designs([prop for prop, _ in found.values()], left)


def _placed(place: str, issue: Issue) -> Issue:
    """Return an issue with the place of its design."""
    return Issue(": ".join(filter(None, (place, issue.path))), issue.message)


def _entries(path: Path) -> Iterator[_Entry]:
    if path.is_dir():
        for file in design_files(path):
            try:
                yield from _entries(file)
            except DataError as error:
                for issue in error.issues:
                    yield _Entry(str(file), None, fault=issue.message)
        return
    source, text = str(path), read_utf8(path, Prop.noun)
    if path.suffix == ".toml":
        yield from _tables(source, text)
    elif path.suffix == ".jsonl":
        # The last line of a study's own file may have been cut off, since its writer was killed.
        whole = text if path.name in _STUDY_TABLES else f"{text}\n"
        for number, line in object_lines(whole.encode()):
            yield from _of_line(f"{source}, line {number}", line)
    else:
        yield _Entry(source, text)


def design_files(folder: Path) -> list[Path]:
    """Return the file of a study that holds its designs, or all files of another folder."""
    for name in _STUDY_TABLES:
        if (folder / name).is_file():
            return [folder / name]
    kinds = (".json", ".jsonl", ".toml")
    return sorted(file for file in folder.iterdir() if file.suffix in kinds and file.is_file())


def _tables(source: str, text: str) -> Iterator[_Entry]:
    """Yield the designs of a TOML document."""
    try:
        tables = parse_toml(text)
    except ValueError as error:
        yield _Entry(source, None, fault=f"is not valid TOML: {error}")
        return
    for name, table in tables.items():
        here = f"{source}, {name}"
        if not isinstance(table, dict):
            yield _Entry(here, table)
        elif (own := table.get("id", name)) != name:
            yield _Entry(here, table, fault=f"the table has the id {own!r}, which must be its name")
        else:
            yield _Entry(here, {"id": name, **table})


def _of_line(here: str, line: dict[str, Any] | ValueError) -> Iterator[_Entry]:
    """Yield the designs of a line; a scene may have none."""
    if isinstance(line, ValueError):
        yield _Entry(here, None, fault=f"is not valid JSON: {line}")
    elif isinstance(made := line.get("made"), list):
        yield from (_Entry(here, one) for one in made)
    elif "prop" in line:
        prop = line["prop"]
        yield _Entry(here, line, MadeProp) if prop is None else _Entry(here, prop)
    elif "scenario_id" not in line:
        yield _Entry(here, line)
