"""Reading designs from files, folders and studies."""

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from oodscen._files import read_utf8
from oodscen._json import object_lines
from oodscen._study_files import ASSETS, PICTURES
from oodscen.data._prop import Prop
from oodscen.errors import DataError, Issue

_SCENES = "scenes.jsonl"


def picture_of(name: str) -> str:
    """Return the file of a study that shows a thing."""
    return f"{PICTURES}/{name}.jpg"


def read_props(path: Path) -> list[Prop]:
    """Return the designs in a JSON, JSON Lines or TOML file, in a folder of them, or in a study.

    A TOML file holds one table per design, named by its id. A line may hold a design or, as in a study's
    `assets.jsonl`, have it as its member `prop`. Of designs with the same id the first counts.

    Raises:
        DataError: When a file cannot be read or holds no valid design; it lists all faults.
    """
    found: dict[str, Prop] = {}
    for source, value in _values(path):
        prop = Prop.parse(value, source=source)
        found.setdefault(prop.id, prop)
    if not found:
        raise DataError(Prop.noun, [Issue("", "no design found")], source=str(path))
    return list(found.values())


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
            elif "parts" in line or "prop" in line:
                yield here, line.get("prop", line)
    else:
        yield source, text
