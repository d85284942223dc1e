"""Traces as tables: Arrow, Parquet and CSV, in SI units."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

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

_KINDS: Mapping[str, type[np.generic]] = {
    "step": np.int32,
    "lane": np.int32,
    "contact": np.bool_,
    "off_road": np.bool_,
}
"""Types of the columns in a table; all others are float64."""
_NEVER = frozenset({"gap_m", "ttc_s", "time_headway_s"})
"""Columns in which null stands for infinity; elsewhere it stands for NaN."""
_SUFFIXES = (".parquet", ".arrow", ".csv")


def to_arrow(ids: tuple[str, ...], columns: Columns) -> "pa.Table":
    """Return columns as an Arrow table, ordered by step and then by body.

    Raises:
        MissingExtra: If pyarrow is not installed.
    """
    pa = _pyarrow()
    rows = np.tile(np.arange(len(ids), dtype=np.int32), len(columns["time"]))
    names = pa.DictionaryArray.from_arrays(pa.array(rows), pa.array(list(ids), pa.string()))
    data = {name: names if name == "id" else _to_arrow(name, columns[name]) for name in COLUMNS}
    return pa.table(data)


def _to_arrow(name: str, column: NDArray[Any]) -> "pa.Array":
    import pyarrow as pa

    values = np.ascontiguousarray(column).reshape(-1)
    empty = ~np.isfinite(values)
    if name in _KINDS:
        values = np.where(empty, 0, values).astype(_KINDS[name])
    return pa.array(values, mask=empty)


def from_arrow(table: "pa.Table", source: str) -> tuple[tuple[str, ...], Columns]:
    """Return the ids and columns of a table.

    Raises:
        DataError: If the table is not a trace.
    """
    missing = [name for name in COLUMNS if name not in table.column_names]
    if missing:
        faults = [Issue(name, "this column is missing") for name in missing]
        raise DataError("trace", faults, source=source)
    names = table["id"].cast("string").to_pylist()
    ids = tuple(dict.fromkeys(names))
    count = len(ids)
    if not count or len(names) % count or tuple(names) != ids * (len(names) // count):
        fault = Issue("id", "the rows are not every body's, step by step")
        raise DataError("trace", [fault], source=source)
    shape = (len(names) // count, count)
    columns = {
        name: _from_arrow(name, table[name].to_numpy(zero_copy_only=False)).reshape(shape)
        for name in COLUMNS
        if name != "id"
    }
    return ids, columns


def _from_arrow(name: str, values: NDArray[Any]) -> NDArray[Any]:
    if name == "step":
        return values.astype(np.int64)
    if name == "contact":
        return values.astype(bool)
    array = values.astype(np.float64)  # None becomes NaN
    return np.where(np.isnan(array), np.inf, array) if name in _NEVER else array


def write(table: "pa.Table", path: Path) -> None:
    """Write a table in the format given by the suffix."""
    if path.suffix == ".parquet":
        import pyarrow.parquet as parquet

        parquet.write_table(table, path)
    elif path.suffix == ".arrow":
        import pyarrow as pa

        with pa.OSFile(str(path), "wb") as sink, pa.ipc.new_file(sink, table.schema) as out:
            out.write_table(table)
    else:
        import pyarrow.csv as csv

        csv.write_csv(_with_plain_ids(table), path)


def read(path: Path) -> "pa.Table":
    """Read a table that `write` wrote.

    Raises:
        DataError: If the file cannot be read.
        MissingExtra: If pyarrow is not installed.
    """
    pa = _pyarrow()
    try:
        if path.suffix == ".parquet":
            import pyarrow.parquet as parquet

            return parquet.read_table(path)
        if path.suffix == ".arrow":
            with pa.OSFile(str(path), "rb") as file:
                return pa.ipc.open_file(file).read_all()
        import pyarrow.csv as csv

        words = csv.ConvertOptions(column_types={"id": pa.string()})
        return csv.read_csv(path, convert_options=words)
    except (OSError, pa.ArrowException) as error:
        raise DataError("trace", [Issue("", str(error))], source=str(path)) from None


def to_parquet(table: "pa.Table") -> bytes:
    """Return an Arrow table as the bytes of a Parquet file."""
    import pyarrow as pa
    import pyarrow.parquet as parquet

    sink = pa.BufferOutputStream()
    parquet.write_table(table, sink)
    return bytes(sink.getvalue())


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
        raise UsageError(f"{target.name}: a trace is written as {', '.join(_SUFFIXES)}")
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
