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
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from oodscen._display import Brief
from oodscen._files import read_utf8, refuse_special, replace, writing
from oodscen._json import parse_object
from oodscen.baselines._texts import fault_of, refuse
from oodscen.encoders._check import dimension, encode
from oodscen.errors import DataError, Issue, MissingExtra, UsageError
from oodscen.protocols import Encoder

_BATCH = 4096

EMBEDDED = (".npy", ".arrow", ".feather")
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
        """Return a slice of the rows, of unit length or zero, as a new array.

        Raises:
            DataError: If a value is not finite.
        """
        block = np.array(self._rows[rows], np.float32)
        squared = np.einsum("ij,ij->i", block, block, dtype=np.float64)
        if not np.isfinite(squared).all():
            first = rows.indices(len(self))[0] + int(np.isfinite(squared).argmin())
            fault = "is not finite; write the embeddings again"
            raise DataError("embeddings", [Issue(f"row {first}", fault)], source=str(self.path))
        lengths = np.sqrt(squared)[:, None].astype(np.float32)
        block /= np.where(lengths > 0.0, lengths, np.float32(1.0))
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
        DataError: If there is no text, or with one issue per value that is not a usable text.
        OodscenError: If the file cannot be written.
    """
    file = Path(path)
    if file.suffix != ".npy":
        raise UsageError(f"embeddings are written as .npy, not as {file.name}")
    count = 0
    with writing(file), TemporaryDirectory(dir=file.parent, prefix=".oodscen-") as folder:
        headless, whole = Path(folder, "rows"), Path(folder, "whole")
        with headless.open("wb") as stream:
            for batch in _batches(texts):
                encode(encoder, batch).tofile(stream)
                count += len(batch)
        length = dimension(encoder)
        header = {"descr": "<f4", "fortran_order": False, "shape": (count, length)}
        with whole.open("wb") as stream, headless.open("rb") as rows:
            np.lib.format.write_array_header_1_0(stream, header)
            while block := rows.read(1 << 24):
                stream.write(block)
        whole.replace(file)
    about = {"encoder": encoder.name, "n": count, "dimension": length}
    replace(_about(file), f"{json.dumps(about)}\n".encode())
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


def _about(file: Path) -> Path:
    return file.with_name(file.name + ".json")


def _npy(file: Path) -> tuple[Any, str]:
    try:
        rows = np.load(file, mmap_mode="r", allow_pickle=False)
        about = parse_object(read_utf8(_about(file), "embeddings", limit=1 << 20))
        maker = str(about["encoder"])
    except (OSError, ValueError, KeyError, TypeError, EOFError, RecursionError) as error:
        fault = f"cannot be read ({error}); write it again with `Metrics.write_embeddings`"
        raise DataError("embeddings", [Issue("", fault)], source=str(file)) from None
    if rows.ndim != 2 or rows.dtype != np.float32:
        fault = f"is {rows.dtype} of shape {rows.shape}, not float32 [N, d]"
        raise DataError("embeddings", [Issue("", fault)], source=str(file))
    return rows, maker


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
        width, value = int(kind.list_size), str(kind.value_type)
    except (OSError, KeyError, AttributeError, ValueError, pa.ArrowInvalid) as error:
        fault = f"is not an Arrow file with a column `vector` and an encoder's name: {error}"
        raise DataError("embeddings", [Issue("", fault)], source=str(file)) from None
    fault = ""
    if value != "float":
        fault = f"holds vectors of {value}, not float32"
    elif _has_nulls(table.column("vector")):
        fault = "holds nulls"
    if fault:
        raise DataError("embeddings", [Issue("vector", fault)], source=str(file))
    return _ArrowRows(table, width), maker


def _has_nulls(column: Any) -> bool:
    """Return whether a vector of a column, or one of their values, is null."""
    return any(chunk.null_count or chunk.values.null_count for chunk in column.chunks)
