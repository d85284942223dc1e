"""Reading designs from files, folders and studies."""

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from oodscen._files import read_utf8
from oodscen._json import object_lines
from oodscen._study_files import ASSETS, PICTURES
from oodscen.data._prop import Prop
from oodscen.errors import DataError, Issue
from oodscen.stages._making.making import MadeProp

_SCENES = "scenes.jsonl"


def picture_of(name: str) -> str:
    """Return the file of a study that shows a thing."""
    return f"{PICTURES}/{name}.jpg"


class Designs(NamedTuple):
    """The designs that were found, and the ids of things that could not be made."""

    props: list[Prop]
    unmade: list[str]


def read_props(path: Path) -> Designs:
    """Return the designs in a JSON, JSON Lines or TOML file, in a folder of them, or in a study.

    A TOML file holds one table per design, named by its id. A line may hold a design or, as in a study's
    `assets.jsonl`, have it as its member `prop`, which is `null` if the thing could not be made. Of designs with the
    same id the first counts.

    Raises:
        DataError: When a file cannot be read or holds no valid design; it lists all faults.
    """
    found: dict[str, Prop] = {}
    unmade: dict[str, None] = {}
    for source, value in _values(path):
        if isinstance(value, MadeProp):
            unmade[value.id] = None
            continue
        prop = Prop.parse(value, source=source)
        found.setdefault(prop.id, prop)
    left = [name for name in unmade if name not in found]
    if not found:
        told = f"; could not be made: {', '.join(left)}" if left else ""
        raise DataError(Prop.noun, [Issue("", f"no design found{told}")], source=str(path))
    return Designs(list(found.values()), left)


def _values(path: Path) -> Iterator[tuple[str, Any]]:
    if path.is_dir():
        if (path / ASSETS).is_file():
            yield from _values(path / ASSETS)
        elif (path / _SCENES).is_file():
            yield from _values(path / _SCENES)
        else:
            for one in sorted(path.iterdir()):
                if one.suffix in (".json", ".jsonl", ".toml") and one.is_file():
                    yield from _values(one)
        return
    source, text = str(path), read_utf8(path, Prop.noun)
    if path.suffix == ".toml":
        try:
            tables = tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            raise DataError(
                Prop.noun, [Issue("", f"is not valid TOML: {error}")], source=source
            ) from None
        for name, table in tables.items():
            yield f"{source}, {name}", {"id": name, **table} if isinstance(table, dict) else table
    elif path.suffix == ".jsonl":
        for number, line in object_lines(text.encode()):
            here = f"{source}, line {number}"
            if isinstance(line, ValueError):
                raise DataError(Prop.noun, [Issue("", f"is not valid JSON: {line}")], source=here)
            made = line.get("made")
            if isinstance(made, list):
                yield from ((here, one) for one in made)
            elif "prop" in line and line["prop"] is None:
                yield here, MadeProp.parse(line, source=here)
            elif "parts" in line or "prop" in line:
                yield here, line.get("prop", line)
    else:
        yield source, text
