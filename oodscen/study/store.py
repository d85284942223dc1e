"""Files of a study: atomic replacement, append-only lines, tolerant of a torn last line."""

import json
import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from oodscen._data import Data, canonical_json
from oodscen.errors import StudyError


class Store:
    """One folder; everything in it is valid at any moment.

    Args:
        folder: Made if it does not exist.
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)

    def prepare(self) -> None:
        """Make the folder.

        Raises:
            StudyError: When it cannot be made or written.
        """
        with self._guard(self.folder):
            self.folder.mkdir(parents=True, exist_ok=True)
            probe = self.folder / ".probe"
            probe.write_bytes(b"")
            probe.unlink()

    def path(self, name: str) -> Path:
        """Return where a file of the study is."""
        return self.folder / name

    def has(self, name: str) -> bool:
        """Whether a file exists."""
        return self.path(name).is_file()

    def write(self, name: str, content: str | bytes) -> None:
        """Replace a file in one step.

        Raises:
            StudyError: When the disk is full or read-only; the old file stays.
        """
        target = self.path(name)
        data = content.encode() if isinstance(content, str) else content
        temporary = target.with_name(f".{target.name}.part")
        with self._guard(target):
            target.parent.mkdir(parents=True, exist_ok=True)
            try:
                with temporary.open("wb") as file:
                    file.write(data)
                    file.flush()
                    os.fsync(file.fileno())
                temporary.replace(target)
            except OSError:
                temporary.unlink(missing_ok=True)
                raise

    def write_lines(self, name: str, items: Iterable[Data | Mapping[str, Any]]) -> None:
        """Replace a file of lines in one step."""
        self.write(name, "".join(map(_line, items)))

    def append(self, name: str, item: Data | Mapping[str, Any]) -> None:
        """Add one line and hand it to the operating system."""
        target = self.path(name)
        with self._guard(target), target.open("ab") as file:
            file.write(_line(item).encode())

    def remove(self, name: str) -> None:
        """Delete a file if it is there."""
        with self._guard(self.path(name)):
            self.path(name).unlink(missing_ok=True)

    def lines(self, name: str) -> Iterator[dict[str, Any]]:
        """Read a file of lines; a torn last line is dropped, a missing file is empty.

        Raises:
            StudyError: When a line before the last is not valid.
        """
        target = self.path(name)
        if not target.is_file():
            return
        with self._guard(target):
            content = target.read_bytes()
        whole, _, torn = content.rpartition(b"\n")
        if torn:
            self.write(name, whole + b"\n" if whole else b"")
        for number, line in enumerate(whole.split(b"\n") if whole else [], start=1):
            try:
                yield json.loads(line)
            except ValueError as error:
                raise StudyError(f"{target}, line {number}: {error}") from None

    @contextmanager
    def _guard(self, target: Path) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            reason = error.strerror or str(error)
            raise StudyError(
                f"cannot read or write {target}: {reason}; what was written before is intact, the "
                "same command continues once this is mended"
            ) from error


def _line(item: Data | Mapping[str, Any]) -> str:
    value = item.model_dump(mode="json") if isinstance(item, Data) else item
    return canonical_json(value) + "\n"
