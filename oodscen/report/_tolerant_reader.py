"""A reader of the files of a study that never raises: what is missing, torn or malformed becomes a note."""

import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from typing import Any, NamedTuple, TypeVar

from oodscen._io.files import read_bytes
from oodscen._io.json import object_lines, parse_object
from oodscen._io.study_files import TABLES
from oodscen.data._base import Data
from oodscen.errors import DataError
from oodscen.stages._redteam.red_teamer import Round
from oodscen.study._store import Store

Row = TypeVar("Row", bound=Data)
Value = TypeVar("Value")

NO_REASON = "no reason was recorded"
_UNPRINTABLE = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f\ud800-\udfff\ufffe\uffff]")
_CREDENTIALS = re.compile(r"(://)[^/@\s]+@")


class FailedItem(NamedTuple):
    """One item that failed, in any stage."""

    stage: str
    """The table: `scenes`, `episodes` ..."""
    id: str
    error: str


class TolerantReader:
    """Reads the files of a study, with unprintable characters replaced, and collects its faults."""

    def __init__(self, store: Store) -> None:
        self._store = store
        self.failures: list[FailedItem] = []
        self.gaps: dict[str, str] = {}
        """By file name: the reason why it is missing, wholly or in part."""

    def note(self, name: str, message: str) -> None:
        """Add a note about a file."""
        self.gaps[name] = f"{self.gaps[name]}; {message}" if name in self.gaps else message

    def json_object(self, name: str) -> dict[str, Any] | None:
        """Return the object in a file."""
        content = self._bytes(name)
        if content is None:
            return None
        try:
            return dict(make_printable(parse_object(content)))
        except ValueError as error:
            self.gaps[name] = f"{name} cannot be read: {error}"
            return None

    def value(self, name: str, parse: Callable[[dict[str, Any]], Value]) -> Value | None:
        """Return the value in a file of its own; a file that holds something else becomes a note."""
        content = self.json_object(name)
        if content is None:
            return None
        try:
            return parse(content)
        except DataError as error:
            self.gaps[name] = f"{name} cannot be read: {_first_issue(error)}"
            return None

    def table(self, table: str, kind: type[Row]) -> list[Row]:
        """Return the rows of a table, and collect its failed items."""
        return self.rows(TABLES[table], kind, table)

    def rows(self, name: str, kind: type[Row], stage: str) -> list[Row]:
        """Return the rows of a file, and collect its failed items, unless they are rounds."""
        rows = []
        for line in self._parsed(name, kind):
            if isinstance(line, Data):
                rows.append(line)
                if getattr(line, "status", "ok") != "failed" or isinstance(line, Round):
                    continue
                item, error = getattr(line, "id", None), getattr(line, "error", None)
            else:
                item, error = line.get("id"), line.get("error")
            self.failures.append(FailedItem(stage, str(item or "?"), str(error or NO_REASON)))
        return rows

    def optional_rows(self, name: str, kind: type[Row]) -> list[Row]:
        """Return the rows of a file that most studies do not have."""
        if not self._store.has(name):
            return []
        return [line for line in self._parsed(name, kind) if isinstance(line, kind)]

    def stored_rows(self, name: str, kind: type[Row]) -> list[Row]:
        """Return the sound rows of a file character by character, as digests cover them."""
        rows = []
        try:
            content = read_bytes(self._store.path(name))
        except OSError:
            return []
        for _, line in object_lines(content):
            with suppress(DataError):
                if not isinstance(line, ValueError):
                    rows.append(kind.parse(line))
        return rows

    def lines(self, name: str) -> Iterator[dict[str, Any]]:
        """Yield the objects in a file of lines; a torn last line is still being written."""
        content = self._bytes(name)
        if content is None:
            return
        unreadable = 0
        for _, line in object_lines(content):
            if isinstance(line, ValueError):
                unreadable += 1
            else:
                yield dict(make_printable(line))
        if unreadable:
            self.note(
                name, f"{unreadable} line(s) of {name} are not JSON objects and were left out"
            )

    def _parsed(self, name: str, kind: type[Row]) -> Iterator[Row | dict[str, Any]]:
        """Yield rows; a line for a failed item stays plain data."""
        faults: list[str] = []
        for line in self.lines(name):
            if line.get("status") == "failed" and "status" not in kind.model_fields:
                yield line
                continue
            try:
                yield kind.parse(line)
            except DataError as error:
                faults.append(_first_issue(error))
                yield {"id": line.get("id"), "error": f"malformed line: {faults[-1]}"}
        if faults:
            self.note(name, f"{len(faults)} malformed line(s) in {name}, the first: {faults[0]}")

    def _bytes(self, name: str) -> bytes | None:
        try:
            return read_bytes(self._store.path(name))
        except FileNotFoundError:
            self.gaps[name] = f"{name} is not there yet"
        except OSError as error:
            self.gaps[name] = f"{name} cannot be read: {error.strerror or error}"
        return None


def make_printable(value: Any) -> Any:
    """Return nested data with unprintable characters replaced (lone surrogates, control characters).

    Credentials in URLs are removed too.
    """
    if isinstance(value, str):
        if value.isprintable() and "@" not in value:  # Nearly all are: the patterns find nothing.
            return value
        return _CREDENTIALS.sub(r"\1", _UNPRINTABLE.sub("\ufffd", value))
    if isinstance(value, int | float):  # Numbers take longer to be told from mappings.
        return value
    if isinstance(value, Mapping):
        return {make_printable(str(key)): make_printable(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [make_printable(item) for item in value]
    return value


def _first_issue(error: DataError) -> str:
    return str(error.issues[0]) if error.issues else str(error)
