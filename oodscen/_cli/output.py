"""Files and lines that the commands read and write."""

import os
import sys
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TypeVar

import click

from oodscen._io.files import is_written_through, read_utf8, write_named, writing
from oodscen._io.standard_output import results
from oodscen._io.study_files import refuse_own
from oodscen._words.text import printable
from oodscen.data._base import Data
from oodscen.errors import DataError, Issue

Row = TypeVar("Row", bound=Data)

_LONGEST = 1_000
"""Maximum length of a line of a message, in characters."""


def say(text: str, *, err: bool = False) -> None:
    """Print text that a model may have written, without any control characters that steer a terminal."""
    click.echo(printable(text), file=None if err else results(), err=err)


def shortened(text: str) -> str:
    """Cut the middle out of very long lines of a message, such as one that quotes a very long name."""
    return "\n".join(
        line if len(line) <= _LONGEST else f"{line[: _LONGEST - 200]} ... {line[-200:]}"
        for line in text.split("\n")
    )


def drop_output() -> None:
    """Discard output that a full or closed stream did not accept; Python would retry it, and fail, at exit."""
    for stream in filter(None, (sys.stdout, sys.stderr)):
        try:
            stream.flush()
        except (OSError, ValueError):
            with suppress(OSError, ValueError):
                nowhere = os.open(os.devnull, os.O_WRONLY)
                os.dup2(nowhere, stream.fileno())
                os.close(nowhere)


def write(out: Path | None, text: str) -> None:
    """Write a document to a file, or to standard output.

    A regular file, or the target of a symbolic link, is replaced in one step and keeps its mode; a device or
    a pipe is written through. A study's own files are never replaced.

    Raises:
        FolderTaken: When the file belongs to a study.
        OodscenError: When the file cannot be written.
    """
    if out is None:
        # A terminal obeys what it is sent; a file or another program gets the document as it is.
        stream = results()
        click.echo(printable(text) if stream.isatty() else text, file=stream)
        return
    write_bytes(out, f"{text}\n".encode())


def write_bytes(out: Path, data: bytes) -> None:
    """Write a file, as `write` does.

    Raises:
        FolderTaken: When the file belongs to a study.
        OodscenError: When the file cannot be written.
    """
    with writing(out):
        if not is_written_through(out):
            refuse_own(out)
        write_named(out, data)


def write_lines(out: Path | None, items: Iterable[Data]) -> None:
    """Write one value per line."""
    lines = [item.to_json() for item in items]
    if lines:
        write(out, "\n".join(lines))
    elif out is not None:
        write_bytes(out, b"")


@contextmanager
def if_stopped(finished: Collection[object], save: Callable[[], object]) -> Iterator[None]:
    """Save what is finished, if anything, when an error or an interruption ends the work early."""
    try:
        yield
    except BaseException:
        if finished:
            save()
        raise


def read_lines(kind: type[Row], path: Path) -> list[Row]:
    """Read one value per line.

    Raises:
        DataError: With every malformed line and every id of several lines, or when the file has no lines.
    """
    rows: list[Row] = []
    issues: list[Issue] = []
    for number, line in enumerate(read_utf8(path, kind.noun).split("\n"), start=1):
        if line.strip():
            try:
                rows.append(kind.parse(line))
            except DataError as error:
                issues += [
                    Issue(f"line {number}: {issue.path}".rstrip(": "), issue.message)
                    for issue in error.issues
                ]
    counts = Counter(getattr(row, "id", None) for row in rows)
    issues += [
        Issue("id", f"{row_id!r} occurs more than once")
        for row_id, count in counts.items()
        if row_id is not None and count > 1
    ]
    if not rows and not issues:
        issues.append(Issue("", f"holds no {kind.noun}"))
    if issues:
        raise DataError(kind.noun, issues, source=str(path))
    return rows
