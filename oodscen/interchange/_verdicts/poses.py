"""Reads the poses that a player wrote: CSV of our own, esmini's CSV log, and OSI traces."""

import csv
import io
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from oodscen._csv import csv_fault
from oodscen._display import Brief
from oodscen._files import read_regular
from oodscen.errors import DataError, Issue
from oodscen.interchange._traces.osi_reading import Pose, Row, read_osi_trace
from oodscen.numerics._exact import Floats

COLUMNS = ("time", "name", "x", "y", "h")
"""Columns that a CSV file of poses must have; `z` is optional."""
MAX_BYTES = 512 * 1024 * 1024
_LONGEST_NAME = 1_000
"""Length of the longest name of a body, in characters."""
_NOUN = "file of poses"
_REST = "\n"
"""Key of the cells beyond the last column, which no column can have."""


@dataclass(frozen=True, eq=False, repr=False)
class PlayedPoses(Brief):
    """The poses of the bodies in one run of a player."""

    names: tuple[str, ...]
    time: Floats
    """[n], s, increasing."""
    poses: Floats
    """[n, bodies, 4] x, y, z of the footprints' centres, m, and heading, rad; NaN where a body is missing."""
    unnamed: int = 0
    """Most bodies without a name at one time."""
    ego_sizes: tuple[tuple[float, float], ...] = ()
    """Lengths and widths of the ego that the file tells, m; the run is judged with the scene's."""
    host: str = ""
    """The body that the file takes for the ego, and when, if it is another one than `ego`; else empty."""


def read_poses(path: str | Path) -> PlayedPoses:
    """Read the poses of one run.

    A CSV file has the columns `time,name,x,y,h` and, if it likes, `z`: one row per time and body, with the centre
    of the footprint in metres and the heading in radians. esmini's own CSV log and OSI traces of ground truth
    (`.osi`, `.mcap`) are read as they are.

    Raises:
        DataError: If the file is none of these, with the line of every fault.
    """
    data = read_regular(path, _NOUN, limit=MAX_BYTES)
    source = str(path)
    if source.endswith((".osi", ".mcap")):
        return _collected(read_osi_trace(data, source), source)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise _fault("", f"byte {error.start} is not UTF-8", source) from None
    lines = text.splitlines()
    if lines and lines[0].startswith("esmini "):
        return _collected(_esmini_rows(lines, source), source)
    return _collected(_plain_rows(text, source), source)


def _collected(rows: Iterator[Row], source: str) -> PlayedPoses:
    names: dict[str, int] = {}
    found: list[Row] = []
    unnamed: dict[float, set[Pose]] = {}
    for row in rows:
        if row.name:
            names.setdefault(row.name, len(names))
            found.append(row)
        else:
            unnamed.setdefault(row.time, set()).add(row.pose)
    times = sorted({row.time for row in found})
    if len(times) < 2:
        raise _fault("", "holds fewer than two moments", source)
    order = {time: index for index, time in enumerate(times)}
    poses = np.full((len(times), len(names), 4), np.nan)
    for time, name, pose, *_ in found:
        before = poses[order[time], names[name]]
        if not np.isnan(before[0]) and tuple(before) != pose:
            raise _fault(name, f"has two poses at {time:g} s", source)
        poses[order[time], names[name]] = pose
    most = max(map(len, unnamed.values()), default=0)
    sizes = dict.fromkeys(row.size for row in found if row.name == "ego" and row.size)
    return PlayedPoses(tuple(names), np.array(times), poses, most, tuple(sizes), _other_host(found))


def _other_host(rows: Sequence[Row]) -> str:
    """Return the body that a file takes for the ego where it is not `ego`, and the first such time; else empty."""
    first = next((row.time for row in rows if row.name == "ego" and row.is_host is False), None)
    if first is None:
        return ""
    named = [row.name for row in rows if row.time == first and row.is_host]
    return f"{named[0] if named else 'no named body'} at {first:g} s"


def _plain_rows(text: str, source: str) -> Iterator[Row]:
    table = csv.DictReader(io.StringIO(text), restkey=_REST, skipinitialspace=True)
    try:
        given = table.fieldnames or ()
    except csv.Error as error:
        raise _fault("line 1", csv_fault(error), source) from None
    if missing := [name for name in COLUMNS if name not in given]:
        needed = ", ".join(COLUMNS)
        raise _fault("line 1", f"no column {', '.join(missing)}; needed: {needed}", source)
    if twice := [name for name in given if name in (*COLUMNS, "z") and given.count(name) > 1]:
        raise _fault("line 1", f"two columns {twice[0]}", source)
    for row in _table_rows(table, source):
        where = f"line {table.line_num}"
        if any(cell.strip() for cell in row.get(_REST) or ()):
            raise _fault(where, f"more cells than the {len(given)} columns", source)
        cells = {**row, "z": row.get("z") or "0"}
        time, x, y, z, h = (
            _number(cells[name], where, name, source) for name in ("time", "x", "y", "z", "h")
        )
        name = (row["name"] or "").strip()
        if len(name) > _LONGEST_NAME:
            raise _fault(where, f"a name has {len(name):,} characters", source)
        yield Row(time, name, (x, y, z, h))


def _table_rows(table: "csv.DictReader[str]", source: str) -> Iterator[dict[str, Any]]:
    """Yield the rows of a table, and raise faults of its format as `DataError`."""
    try:
        yield from table
    except csv.Error as error:
        raise _fault(f"line {table.line_num + 1}", csv_fault(error), source) from None


def _esmini_rows(lines: Sequence[str], source: str) -> Iterator[Row]:
    """Yield rows of esmini's log, which has all bodies of a moment on one line."""
    head = next((i for i, line in enumerate(lines) if line.startswith("Index [-]")), None)
    if head is None:
        raise _fault("", "esmini's log has no line of columns", source)
    columns = [name.strip() for name in lines[head].split(",")]
    places = {name: index for index, name in enumerate(columns)}
    count = sum(name.endswith("Entity_Name [-]") for name in columns)
    for number, line in enumerate(lines[head + 1 :], start=head + 2):
        if not line.strip():
            continue
        cells = [cell.strip() for cell in line.split(",")]
        where = f"line {number}"

        def cell(name: str, cells: list[str] = cells, where: str = where) -> str:
            index = places.get(name)
            if index is None:
                raise _fault(where, f"no column {name!r}", source)
            if index >= len(cells):
                raise _fault(where, f"is short: no cell in the column {name!r}", source)
            return cells[index]

        time = _number(cell("TimeStamp [s]"), where, "TimeStamp", source)
        for body in range(1, count + 1):
            x, y, z, heading, pitch, ahead = (
                _number(cell(f"#{body} {name}"), where, name, source)
                for name in (
                    "World_Position_X [m]",
                    "World_Position_Y [m]",
                    "World_Position_Z [m]",
                    "World_Heading_Angle [rad]",
                    "World_Pitch_Angle [rad]",
                    "bb_x [m]",
                )
            )
            level = ahead * math.cos(pitch)
            x, y = x + level * math.cos(heading), y + level * math.sin(heading)
            yield Row(
                time,
                cell(f"#{body} Entity_Name [-]"),
                (x, y, z - ahead * math.sin(pitch), heading),
            )


def _number(text: str | None, where: str, name: str, source: str) -> float:
    try:
        value = math.nan if "_" in (text or "") else float(text or "")
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise _fault(f"{where}: {name}", f"{(text or '')[:40]!r} is not a finite number", source)
    return value


def _fault(where: str, message: str, source: str) -> DataError:
    return DataError(_NOUN, [Issue(where, message)], source=source)
