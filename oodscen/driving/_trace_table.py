"""Traces as tables: Arrow, Parquet and CSV, in SI units."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from oodscen._io.files import read_regular
from oodscen.errors import DataError, Issue, MissingExtra, UsageError

if TYPE_CHECKING:
    import pyarrow as pa

Columns = Mapping[str, NDArray[Any]]
"""Arrays [steps, bodies] by name of `COLUMNS`, except `id`."""

COLUMNS: Mapping[str, str] = {
    "step": "steps since the start",
    "time": "s since the start",
    "id": "`ego`, or the actor's id",
    "x": "m, of the footprint's centre",
    "y": "m",
    "z": "m, of the footprint's underside",
    "yaw": "rad, counter-clockwise from the world's x axis",
    "speed": "m/s along the heading, negative in reverse",
    "vx": "m/s in the world: how far it came in the step; at the start, the speed along the heading",
    "vy": "m/s, likewise",
    "acceleration": "m/s^2: how much the speed changed in the step; 0 at the start",
    "lateral_acceleration": "m/s^2 to the left: speed times rate of turn in the step; 0 at the start",
    "s": "m along the road that the ego drives",
    "t": "m to the left of that road's reference line",
    "lane": "lanes to the left of the lane in which the ego started; null off these lanes",
    "gap_m": "m between its body and the ego's; null for the ego and far away",
    "ttc_s": "s until its footprint touches the ego's at constant velocities; null if never",
    "time_headway_s": "s that the ego takes to where its rear is now; null unless in the ego's path",
    "contact": "it touches the ego; for the ego: anything touches it",
    "off_road": "the ego left the drivable road; null for others",
    "length": "m, of the footprint",
    "width": "m, of the footprint",
    "height": "m, of the body",
}
"""All columns of the table in order, with their meanings."""

_WRITTEN_TYPES: Mapping[str, type[np.generic]] = {
    "step": np.int32,
    "lane": np.int32,
    "contact": np.bool_,
    "off_road": np.bool_,
}
"""Types of the columns in a table that is written; all others are float64."""
_READ_TYPES: Mapping[str, str] = {
    "step": "int64",
    "lane": "int64",
    "contact": "bool",
    "off_road": "bool",
}
"""Types to which the columns of a table that is read must convert; all others are float64."""
_CONTENTS = {"int64": "whole numbers", "bool": "truth values", "float64": "numbers"}
_INFINITE = frozenset({"gap_m", "ttc_s", "time_headway_s"})
"""Columns in which null stands for infinity."""
_UNKNOWN = frozenset({"lane", "off_road"})
"""Columns in which null stands for NaN; no other column has nulls."""
_SUFFIXES = (".parquet", ".arrow", ".csv")


def to_arrow(ids: tuple[str, ...], columns: Columns) -> "pa.Table":
    """Return columns as an Arrow table, ordered by step and then by body.

    Raises:
        MissingExtra: If pyarrow is not installed.
    """
    pa = _pyarrow()
    rows = np.tile(np.arange(len(ids), dtype=np.int32), len(columns["time"]))
    names = pa.DictionaryArray.from_arrays(pa.array(rows), pa.array(list(ids), pa.string()))
    data = {
        name: names if name == "id" else _to_arrow_column(name, columns[name]) for name in COLUMNS
    }
    return pa.table(data)


def _to_arrow_column(name: str, column: NDArray[Any]) -> "pa.Array":
    import pyarrow as pa

    values = np.ascontiguousarray(column).reshape(-1)
    is_null = ~np.isfinite(values)
    if name in _WRITTEN_TYPES:
        values = np.where(is_null, 0, values).astype(_WRITTEN_TYPES[name])
    return pa.array(values, mask=is_null)


def from_arrow(table: "pa.Table", source: str) -> tuple[tuple[str, ...], Columns]:
    """Return the ids and columns of a table.

    Raises:
        DataError: If the table is not a trace, with every fault.
    """
    try:
        names = table.column_names
    except UnicodeDecodeError as error:
        raise DataError("trace", [Issue("", f"a column's name: {error}")], source=source) from None
    issues: list[Issue] = []
    for name in COLUMNS:
        count = names.count(name)
        if count != 1:
            fault = "is missing" if count == 0 else f"stands here {count} times"
            issues.append(Issue(name, f"this column {fault}"))
    if issues:
        raise DataError("trace", issues, source=source)
    ids: tuple[str, ...] = ()
    columns: dict[str, NDArray[Any]] = {}
    for name in COLUMNS:
        try:
            if name == "id":
                ids = _ids_of(table[name])
            else:
                columns[name] = _from_arrow_column(name, table[name])
        except ValueError as error:
            issues.append(Issue(name, str(error)))
    if issues:
        raise DataError("trace", issues, source=source)
    columns = {name: column.reshape(-1, len(ids)) for name, column in columns.items()}
    time = columns["time"]
    if (time != time[:, :1]).any() or (time[1:] <= time[:-1]).any():
        fault = "must rise from step to step, and be the same for all bodies of a step"
        raise DataError("trace", [Issue("time", fault)], source=source)
    return ids, columns


def _ids_of(column: "pa.ChunkedArray") -> tuple[str, ...]:
    """Return the ids of the bodies, the ego's first, which repeat step by step.

    Raises:
        ValueError: If they do not.
    """
    names = _cast(column, "string").to_pylist()
    ids = tuple(dict.fromkeys(names))
    is_complete = bool(ids) and len(names) % len(ids) == 0
    if not is_complete or None in ids or tuple(names) != ids * (len(names) // len(ids)):
        raise ValueError("the rows are not every body's, step by step")
    if ids[0] != "ego":
        raise ValueError("the first body of each step is not the ego")
    return ids


def _from_arrow_column(name: str, column: "pa.ChunkedArray") -> NDArray[Any]:
    """Return a column as an array of int64, bool or float64.

    Raises:
        ValueError: If it holds values of another type, or none in some row.
    """
    kind = _READ_TYPES.get(name, "float64")
    values = _cast(column, kind).to_numpy(zero_copy_only=False)
    if name in _INFINITE | _UNKNOWN:
        numbers: NDArray[np.float64] = values.astype(np.float64)  # None becomes NaN.
        return np.where(np.isnan(numbers), np.inf, numbers) if name in _INFINITE else numbers
    if column.null_count or not np.isfinite(values).all():
        raise ValueError("some rows have no value")
    array: NDArray[Any] = values
    return array


def _cast(column: "pa.ChunkedArray", kind: str) -> "pa.ChunkedArray":
    """Return a column of another type.

    Raises:
        ValueError: If some value has no counterpart.
    """
    import pyarrow as pa

    try:
        return column.cast(kind)
    except pa.ArrowException:
        raise ValueError(f"must hold {_CONTENTS.get(kind, 'words')} only") from None


def to_bytes(table: "pa.Table", suffix: str) -> bytes:
    """Return a table as the bytes of a file in the format given by its suffix."""
    import pyarrow as pa

    sink = pa.BufferOutputStream()
    if suffix == ".parquet":
        import pyarrow.parquet as parquet

        parquet.write_table(table, sink)
    elif suffix == ".arrow":
        with pa.ipc.new_file(sink, table.schema) as out:
            out.write_table(table)
    else:
        import pyarrow.csv as csv

        csv.write_csv(_with_plain_ids(table), sink)
    return bytes(sink.getvalue())


def read(path: Path) -> "pa.Table":
    """Read a table from a file that holds the bytes of `to_bytes`.

    Raises:
        DataError: If the file cannot be read.
        MissingExtra: If pyarrow is not installed.
    """
    pa = _pyarrow()
    content = pa.BufferReader(read_regular(path, "trace"))
    try:
        if path.suffix == ".parquet":
            import pyarrow.parquet as parquet

            return parquet.read_table(content)
        if path.suffix == ".arrow":
            return pa.ipc.open_file(content).read_all()
        import pyarrow.csv as csv

        options = csv.ConvertOptions(column_types={"id": pa.string()})
        return csv.read_csv(content, convert_options=options)
    except (OSError, pa.ArrowException) as error:
        raise DataError("trace", [Issue("", str(error))], source=str(path)) from None


def with_phase(table: "pa.Table", phase: str) -> "pa.Table":
    """Return a table with a first column, `phase`, that has one value."""
    import pyarrow as pa

    column = pa.array([phase] * len(table), pa.string())
    return _with_plain_ids(table).add_column(0, "phase", column)


def checked_path(path: str | Path) -> Path:
    """Return the path of a table's file.

    Raises:
        UsageError: If its suffix is not that of a known format.
    """
    target = Path(path)
    if target.suffix not in _SUFFIXES:
        raise UsageError(f"{target.name}: the file of a trace ends in {', '.join(_SUFFIXES)}")
    return target


def _with_plain_ids(table: "pa.Table") -> "pa.Table":
    """Return a table whose ids are strings instead of a dictionary."""
    return table.set_column(2, "id", table["id"].cast("string"))


def _pyarrow() -> Any:
    try:
        import pyarrow
    except ImportError:
        raise MissingExtra("a trace as a table", "tables", "pyarrow") from None
    return pyarrow
