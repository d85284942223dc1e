"""Tables of poses: CSV of our own, and esmini's CSV log."""

import csv
import io
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from oodscen._io.csv import csv_fault
from oodscen._io.xml_numbers import double
from oodscen.errors import DataError, Issue
from oodscen.interchange._traces.osi_reading import BodyPose

NOUN = "file of poses"
COLUMNS = ("time", "name", "x", "y", "h")
"""Columns that a CSV file of poses must have; `z` is optional."""
_LONGEST_NAME = 1_000
"""Length of the longest name of a body, in characters."""
_EXCESS = "\n"
"""Key of the cells beyond the last column, which no column can have."""
_ESMINI_COLUMNS = "Index [-]"
"""Beginning of the line of columns in esmini's log."""


def csv_poses(text: str, source: str) -> Iterator[BodyPose]:
    """Yield the poses of a CSV file.

    Raises:
        DataError: If a column is missing or a cell is malformed, with the line.
    """
    table = csv.DictReader(io.StringIO(text, newline=None), restkey=_EXCESS, skipinitialspace=True)
    try:
        columns = table.fieldnames or ()
    except csv.Error as error:
        raise fault("line 1", csv_fault(error), source) from None
    _check_columns(columns, source)
    for row in _table_rows(table, source):
        where = f"line {table.line_num}"
        if any(cell.strip() for cell in row.get(_EXCESS) or ()):
            raise fault(where, f"more cells than the {len(columns)} columns", source)
        cells = {"z": "0", **row}
        time, x, y, z, h = (
            _number(cells[name], where, name, source) for name in ("time", "x", "y", "z", "h")
        )
        yield BodyPose(time, _name((row["name"] or "").strip(), where, source), (x, y, z, h))


def _check_columns(columns: Sequence[str], source: str) -> None:
    missing = [name for name in COLUMNS if name not in columns]
    if missing:
        needed = ", ".join(COLUMNS)
        raise fault("line 1", f"no column {', '.join(missing)}; needed: {needed}", source)
    for name in (*COLUMNS, "z"):
        if columns.count(name) > 1:
            raise fault("line 1", f"two columns {name}", source)


def _table_rows(table: "csv.DictReader[str]", source: str) -> Iterator[dict[str, Any]]:
    """Yield the rows of a table, and raise faults of its format as `DataError`."""
    try:
        yield from table
    except csv.Error as error:
        raise fault(f"line {table.line_num + 1}", csv_fault(error), source) from None


@dataclass(frozen=True)
class _EsminiLine:
    """One line of esmini's log, which has all bodies of a moment."""

    cells: Sequence[str]
    columns: Mapping[str, int]
    """Indices of the cells by column."""
    where: str
    source: str

    def text(self, column: str) -> str:
        """Return a cell.

        Raises:
            DataError: If there is no such column, or the line ends before it.
        """
        index = self.columns.get(column)
        if index is None:
            raise fault(self.where, f"no column {column!r}", self.source)
        if index >= len(self.cells):
            raise fault(self.where, f"is short: no cell in the column {column!r}", self.source)
        return self.cells[index]

    def number(self, column: str, label: str) -> float:
        """Return a cell as a number; errors name it by a label.

        Raises:
            DataError: If it is missing or no finite number.
        """
        return _number(self.text(column), self.where, label, self.source)

    def pose(self, time: float, body: int) -> BodyPose:
        """Return the pose of a body by its number, of which esmini writes the reference point."""
        x, y, z, heading, pitch, ahead = (
            self.number(f"#{body} {label}", label)
            for label in (
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
        name = _name(self.text(f"#{body} Entity_Name [-]"), self.where, self.source)
        return BodyPose(time, name, (x, y, z - ahead * math.sin(pitch), heading))


def esmini_poses(lines: Sequence[str], source: str) -> Iterator[BodyPose]:
    """Yield the poses of esmini's log.

    Raises:
        DataError: If the line of columns is missing or a cell is malformed, with the line.
    """
    head = next((i for i, line in enumerate(lines) if line.startswith(_ESMINI_COLUMNS)), None)
    if head is None:
        raise fault("", "esmini's log has no line of columns", source)
    names = [name.strip() for name in lines[head].split(",")]
    columns = {name: index for index, name in enumerate(names)}
    body_count = sum(name.endswith("Entity_Name [-]") for name in names)
    for number, text in enumerate(lines[head + 1 :], start=head + 2):
        if not text.strip():
            continue
        cells = [cell.strip() for cell in text.split(",")]
        line = _EsminiLine(cells, columns, f"line {number}", source)
        time = line.number("TimeStamp [s]", "TimeStamp")
        for body in range(1, body_count + 1):
            yield line.pose(time, body)


def _name(name: str, where: str, source: str) -> str:
    if len(name) > _LONGEST_NAME:
        raise fault(where, f"a name has {len(name):,} characters", source)
    return name


def _number(text: str | None, where: str, label: str, source: str) -> float:
    try:
        return double(text or "")
    except ValueError:
        message = f"{(text or '')[:40]!r} is not a finite number"
        raise fault(f"{where}: {label}", message, source) from None


def fault(where: str, message: str, source: str) -> DataError:
    """Return the error that refuses a file of poses."""
    return DataError(NOUN, [Issue(where, message)], source=source)
