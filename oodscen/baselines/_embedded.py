"""Baselines of embeddings on disk, of any size: vectors are read a block at a time.

`Metrics.write_embeddings(path, texts)` creates one; `Metrics(encoder, path)` opens it. Two formats:

    .npy                float32 [N, d], memory-mapped; `<name>.npy.json` beside it records the encoder
    .arrow, .feather    Arrow IPC files with a column `vector` (fixed-size list of float32); the encoder's name
                        is in the schema's metadata under `encoder`. Needs the extra `tables`.
"""

import hashlib
import json
from collections.abc import Iterable, Iterator
from itertools import islice
from pathlib import Path
from shutil import copyfileobj
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from oodscen._display import Brief
from oodscen._io.files import read_utf8, refuse_special, writing
from oodscen._io.json import parse_object
from oodscen.baselines._texts import fault_of, refuse
from oodscen.encoders._check import dimension, encode
from oodscen.errors import DataError, Issue, MissingExtra, UsageError
from oodscen.protocols import Encoder

_BATCH = 4096

SUFFIXES = (".npy", ".arrow", ".feather")
"""Extensions of the files that hold embeddings."""


class EmbeddedBaseline(Brief):
    """A baseline known only by its embeddings. Rows are scaled to unit length as they are read."""

    _repr_fields = ("path", "encoder", "dimension")

    def __init__(self, path: Path, rows: Any, encoder: str, dimension: int) -> None:
        self.path = path
        self.texts: tuple[str, ...] = ()
        """Always empty: only embeddings are known."""
        self.name = path.name
        self.encoder = encoder
        self.dimension = dimension
        self._rows = rows

    def __len__(self) -> int:
        return len(self._rows)

    def __getitem__(self, rows: slice) -> NDArray[np.float32]:
        """Return successive rows, of unit length or zero, as a new array.

        Raises:
            UsageError: If the slice has a step.
            DataError: If a value is not finite.
        """
        if rows.step not in (None, 1):
            raise UsageError("rows of embeddings are read without a step")
        block = np.array(self._rows[rows], np.float32)
        squared = np.einsum("ij,ij->i", block, block, dtype=np.float64)
        if not np.isfinite(squared).all():
            first = rows.indices(len(self))[0] + int(np.isfinite(squared).argmin())
            fault = "is not finite; write the embeddings again"
            raise DataError("embeddings", [Issue(f"row {first}", fault)], source=str(self.path))
        lengths = np.sqrt(squared)[:, None]  # float64: that of a finite row may be no float32.
        block /= np.where(lengths > 0.0, lengths, 1.0)
        return block

    def digest(self) -> str:
        """Return a SHA-256 of the name, the size and the first and last rows, without reading the whole file."""
        sha256 = hashlib.sha256(f"{self.encoder} {len(self)} {self.dimension}".encode())
        for rows in (slice(0, 16), slice(max(len(self) - 16, 0), len(self))):
            sha256.update(self[rows].tobytes())
        return sha256.hexdigest()


def write_embeddings(path: str | Path, encoder: Encoder, texts: Iterable[str]) -> int:
    """Encode texts a batch at a time into a `.npy` file, record the encoder beside it, and return their number.

    The file is replaced only after all texts are written; texts are read once and not kept.

    Raises:
        UsageError: If the file is not to be a `.npy` file.
        DataError: If there is no text, or with one issue per value that is not a usable text.
        EncoderError: If the encoder fails or breaks its contract.
        OodscenError: If a file cannot be written.
    """
    file = Path(path)
    if file.suffix != ".npy":
        raise UsageError(f"embeddings are written as .npy, not as {path}")
    record = _record(file)
    with writing(file):
        folder = TemporaryDirectory(dir=file.parent, prefix=".oodscen-", ignore_cleanup_errors=True)
    count = 0
    with folder as name:
        headless, whole, about = Path(name, "rows"), Path(name, "whole"), Path(name, "record")
        for batch in _batches(texts):
            vectors = encode(encoder, batch)
            with writing(file), headless.open("ab") as stream:
                vectors.tofile(stream)
            count += len(batch)
        shape = (count, dimension(encoder))
        with writing(file), whole.open("wb") as stream, headless.open("rb") as rows:
            header = {"descr": "<f4", "fortran_order": False, "shape": shape}
            np.lib.format.write_array_header_1_0(stream, header)
            copyfileobj(rows, stream, 1 << 24)
        with writing(record):
            facts = {"encoder": encoder.name, "n": count, "dimension": shape[1]}
            about.write_text(f"{json.dumps(facts)}\n", encoding="utf-8")
            record.unlink(missing_ok=True)  # It must never describe the other array.
        with writing(file):
            whole.replace(file)
        with writing(record):
            about.replace(record)
    return count


def _batches(texts: Iterable[str]) -> Iterator[list[str]]:
    """Yield usable texts, as many at a time as are encoded together.

    Raises:
        DataError: If there is none, or a value is not a usable text.
    """
    if isinstance(texts, str | bytes):
        raise DataError("text set", [Issue("", "is one string, not a sequence of texts")])
    source, start = iter(texts), 0
    while batch := list(islice(source, _BATCH)):
        faults = enumerate(map(fault_of, batch), start=start)
        refuse("text set", [Issue(f"[{index}]", fault) for index, fault in faults if fault])
        yield batch
        start += len(batch)
    if not start:
        raise DataError("text set", [Issue("", "holds no text")])


def open_embeddings(path: str | Path, encoder: Encoder) -> EmbeddedBaseline:
    """Return a baseline of embeddings on disk, made by the given encoder.

    Raises:
        DataError: If the file cannot be read, is truncated, or is not [N, d] float32.
        UsageError: If another encoder made it.
        MissingExtra: If it is an Arrow file and pyarrow is not installed.
    """
    file = Path(path)
    refuse_special(file, "embeddings")
    rows, maker = _arrow(file) if file.suffix in (".arrow", ".feather") else _npy(file)
    if maker != encoder.name:
        raise UsageError(
            f"{file.name} holds embeddings of {maker}, not of {encoder.name}: use that encoder, or write "
            "them again with `Metrics.write_embeddings`"
        )
    if rows.shape[1] != (length := dimension(encoder)) or not len(rows):
        fault = f"has the shape {rows.shape}, not [N, {length}] with N at least 1"
        raise DataError("embeddings", [Issue("", fault)], source=str(file))
    return EmbeddedBaseline(file, rows, maker, length)


def _record(file: Path) -> Path:
    """Return the file beside an array that names its encoder."""
    return file.with_name(file.name + ".json")


def _npy(file: Path) -> tuple[Any, str]:
    try:
        rows = np.lib.format.open_memmap(file, mode="r")
    except Exception as error:  # A damaged header makes numpy raise errors of many types.
        raise _refused(file, f"is no array: {error}") from None
    if rows.ndim != 2 or rows.dtype != np.float32:
        raise _refused(file, f"is {rows.dtype} of shape {rows.shape}, not float32 [N, d]")
    record = _record(file)
    text = read_utf8(record, "record of embeddings", limit=1 << 20)
    try:
        facts = parse_object(text)
        maker = facts["encoder"]
    except (ValueError, KeyError, RecursionError) as error:
        raise _refused(record, f"names no encoder: {error}") from None
    shape = (facts.get("n", rows.shape[0]), facts.get("dimension", rows.shape[1]))
    if shape != rows.shape:
        raise _refused(file, f"has the shape {rows.shape}, but {shape} in {record.name}")
    return rows, str(maker)


def _refused(file: Path, fault: str) -> DataError:
    fault = f"{fault}; write it again with `Metrics.write_embeddings`"
    return DataError("embeddings", [Issue("", fault)], source=str(file))


class _ArrowRows:
    """The vectors of a memory-mapped Arrow file, read by slices."""

    def __init__(self, table: Any, width: int) -> None:
        self._column = table.column("vector")
        self.shape = (len(self._column), width)

    def __len__(self) -> int:
        return int(self.shape[0])

    def __getitem__(self, rows: slice) -> NDArray[np.float32]:
        start, stop, _ = rows.indices(len(self))
        parts = [
            chunk.flatten().to_numpy().reshape(-1, self.shape[1])
            for chunk in self._column.slice(start, stop - start).chunks
        ]
        return np.concatenate(parts) if parts else np.zeros((0, self.shape[1]), np.float32)


def _arrow(file: Path) -> tuple[Any, str]:
    try:
        import pyarrow as pa
    except ImportError:
        raise MissingExtra("embeddings in an Arrow file", "tables", "pyarrow") from None
    try:
        table = pa.ipc.open_file(pa.memory_map(str(file))).read_all()
        kind = table.schema.field("vector").type
        maker = (table.schema.metadata or {})[b"encoder"].decode()
    except (OSError, KeyError, ValueError, pa.ArrowException) as error:
        fault = f"is not an Arrow file with a column `vector` and an encoder's name: {error}"
        raise DataError("embeddings", [Issue("", fault)], source=str(file)) from None
    fault = ""
    if not pa.types.is_fixed_size_list(kind) or kind.value_type != pa.float32():
        fault = f"holds values of the type {kind}, not fixed_size_list<float>"
    elif _has_nulls(table.column("vector")):
        fault = "holds nulls"
    if fault:
        raise DataError("embeddings", [Issue("vector", fault)], source=str(file))
    return _ArrowRows(table, int(kind.list_size)), maker


def _has_nulls(column: Any) -> bool:
    """Return whether a vector of a column, or one of their values, is null."""
    return any(chunk.null_count or chunk.values.null_count for chunk in column.chunks)
