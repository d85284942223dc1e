"""The files of a study: atomic replacement, append-only lines, tolerant of a torn last line."""

import errno
import hashlib
import os
import threading
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from oodscen._display import Brief
from oodscen._io.files import inside, read_regular, remove_parts, replace, writing
from oodscen._io.json import is_object, object_lines, parse_object
from oodscen._io.lock import locked
from oodscen._words.text import whole
from oodscen.data._base import Data, canonical_json
from oodscen.errors import DataError, Issue, StudyError

_NOUN = "study"


class Store(Brief):
    """One folder whose files are valid at any moment.

    Reading changes nothing. A writer holds `writing` to exclude other writers.

    Args:
        folder: The folder; created if it does not exist.
    """

    _repr_fields = ("folder",)

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        self._appending = threading.Lock()
        self._whole: set[str] = set()
        """Files that are known to end with a newline."""

    def prepare(self) -> None:
        """Create the folder.

        Raises:
            StudyError: When it cannot be created.
        """
        with writing(self.folder, StudyError):
            self.folder.mkdir(parents=True, exist_ok=True)

    @contextmanager
    def writing(self) -> Iterator[None]:
        """Hold the folder as its only writer; it is created, and removed again if it stays empty.

        Raises:
            InUse: When another process writes it.
            StudyError: When it cannot be created or locked.
        """
        with writing(self.folder, StudyError):
            missing = [path for path in (self.folder, *self.folder.parents) if not path.exists()]
        self.prepare()
        try:
            with locked(self.folder, "study"):
                remove_parts(self.folder)
                self._whole.clear()
                yield
        finally:
            for path in missing:
                with suppress(OSError):
                    path.rmdir()

    def path(self, name: str) -> Path:
        """Return the path of a file of the study."""
        return self.folder / name

    def inside(self, name: str) -> Path:
        """Return the path of a file that the study's data names.

        Raises:
            DataError: When the name leads outside the folder.
        """
        try:
            return inside(self.folder, name)
        except ValueError as error:
            raise _malformed(self.folder, str(error)) from None

    def has(self, name: str) -> bool:
        """Return whether a file exists."""
        return os.path.isfile(self.path(name))

    def holds(self, name: str) -> bool:
        """Return whether a file exists and is not empty."""
        return self.has(name) and self.path(name).stat().st_size > 0

    def digest(self, name: str) -> str:
        """Return the SHA-256 of a file that the study's data names.

        Raises:
            DataError: When the file cannot be read, or lies outside the folder.
        """
        return hashlib.sha256(read_regular(self.inside(name), _NOUN)).hexdigest()

    def write(self, name: str, content: str | bytes) -> None:
        """Replace a file in one step.

        Raises:
            StudyError: When the disk is full or read-only; the old file stays.
            DataError: When a folder of the study leads elsewhere; nothing is written.
        """
        target = self.path(name)
        if target.parent != self.folder:
            self.inside(str(target.parent.relative_to(self.folder)))
        data = content.encode() if isinstance(content, str) else content
        with self._guard(target):
            if not self.folder.is_dir():  # Moved or deleted since `prepare`.
                raise FileNotFoundError(errno.ENOENT, "the folder of the study is gone")
            target.parent.mkdir(parents=True, exist_ok=True)
            replace(target, data)

    def write_lines(self, name: str, items: Iterable[Data | Mapping[str, Any]]) -> None:
        """Replace a file of lines in one step."""
        self.write(name, "".join(map(_line, items)))

    def append(self, name: str, item: Data | Mapping[str, Any]) -> None:
        """Append one line and hand it to the operating system.

        A torn last line, left by a writer that was killed, is cut off; a complete one without a newline gets one.
        """
        target = self.path(name)
        line = _line(item).encode()
        with self._appending, self._guard(target), target.open("a+b", buffering=0) as file:
            if name not in self._whole:
                _mend(file.fileno())
            self._whole.discard(name)
            if file.write(line) != len(line):
                raise OSError("the disk is full")
            self._whole.add(name)

    def remove(self, name: str) -> None:
        """Delete a file if it exists."""
        with self._guard(self.path(name)):
            self.path(name).unlink(missing_ok=True)

    def read(self, name: str) -> dict[str, Any]:
        """Return the JSON object that a file holds.

        Raises:
            DataError: When the file cannot be read or holds anything else.
        """
        path = self.path(name)
        try:
            return parse_object(read_regular(path, _NOUN))
        except ValueError as error:
            raise _malformed(path, str(error)) from None

    def lines(self, name: str) -> Iterator[dict[str, Any]]:
        """Yield the lines of a file; a torn last line is skipped, and a missing file is empty.

        Raises:
            DataError: When the file cannot be read, or a line is not a JSON object.
        """
        for _, line in self.numbered(name):
            yield line

    def numbered(self, name: str) -> Iterator[tuple[int, dict[str, Any]]]:
        """Yield lines as `lines` does, each with its number from 1."""
        target = self.path(name)
        if not os.path.lexists(target):
            return
        for number, line in object_lines(read_regular(target, _NOUN)):
            if isinstance(line, ValueError):
                raise _malformed(f"{target}, line {number}", str(line))
            yield number, line

    @contextmanager
    def _guard(self, target: Path) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            reason = error.strerror or str(error)
            raise StudyError(
                f"cannot write {target}: {reason}; earlier results are intact: fix this and run the "
                "same command to continue"
            ) from error


def _malformed(source: str | Path, fault: str) -> DataError:
    return DataError(_NOUN, [Issue("", fault)], source=str(source))


def _line(item: Data | Mapping[str, Any]) -> str:
    value = item.model_dump(mode="json") if isinstance(item, Data) else item
    # The error of a model, say, may quote half of a surrogate pair.
    return whole(canonical_json(value)) + "\n"


def _mend(file: int) -> None:
    """Make a file end with a newline, and cut off a torn last line."""
    end = os.lseek(file, 0, os.SEEK_END)
    tail = b""
    while end and b"\n" not in tail:
        start = max(0, end - len(tail) - 65_536)
        tail = os.pread(file, end - start, start)
        if not start:
            break
    torn = tail.rpartition(b"\n")[2]
    if is_object(torn):
        os.write(file, b"\n")
    elif torn:
        os.ftruncate(file, end - len(torn))
