"""Option and argument types for paths, and the check that a command's files are distinct."""

import os
from collections.abc import Iterator
from itertools import accumulate, combinations
from pathlib import Path
from typing import Any

import click

from oodscen._io.files import is_written_through
from oodscen._io.study_files import refuse_own
from oodscen.errors import UsageError


class PathName(click.Path):
    """A path; one that must exist must be a regular file or a folder, not a pipe or a device."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the path, or fail with a one-line message."""
        if not str(value):
            self.fail("the name is empty.", param, ctx)
        try:
            os.stat(value)
        except (FileNotFoundError, NotADirectoryError, PermissionError):
            pass  # Reported below, or by the code that makes the folder.
        except OSError as error:
            self.fail(f"{value!r}: {error.strerror}.", param, ctx)
        path = super().convert(value, param, ctx)
        if not self.file_okay and os.path.exists(path) and not os.path.isdir(path):
            self.fail(f"{value!r} is not a folder.", param, ctx)
        if self.exists and not (os.path.isfile(path) or os.path.isdir(path)):
            self.fail(f"{self.name.title()} {value!r} is not a regular file.", param, ctx)
        return path


class OutputName(PathName):
    """A file that a command writes."""

    def __init__(self) -> None:
        super().__init__(dir_okay=False, path_type=Path)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the path, or fail; `-`, which means standard output elsewhere, is no name here."""
        if str(value) == "-":
            self.fail("name /dev/stdout for standard output, or ./- for a file.", param, ctx)
        return super().convert(value, param, ctx)


class FileCommand(click.Command):
    """A command that refuses to write one file twice, or to replace a file that it reads or that is a study's."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command.

        Raises:
            UsageError: When two of its files are the same, links followed, before any work.
            FolderTaken: When a file that it writes is one of a study's, before any work.
        """
        outputs = [
            (param.opts[-1], ctx.params[param.name])
            for param in self.params
            if isinstance(param.type, OutputName) and param.name and ctx.params[param.name]
        ]
        outputs = [(name, path) for name, path in outputs if not is_written_through(path)]
        for (name, path), (other_name, other_path) in combinations(outputs, 2):
            if is_same_file(path, other_path):
                raise UsageError(f"{name} and {other_name} name the same file: {other_path}")
        for name, path in outputs:
            for input_name, input_path in self._inputs(ctx):
                if is_same_file(path, input_path):
                    raise UsageError(
                        f"{name} would replace a file that {input_name} reads: {input_path}"
                    )
        for _, path in outputs:
            refuse_own(path)
        return super().invoke(ctx)

    def _inputs(self, ctx: click.Context) -> Iterator[tuple[str, Path]]:
        """Yield the files that arguments and options name, also as in `replay:FILE#MODEL`."""
        for param in self.params:
            value = ctx.params.get(param.name or "")
            if isinstance(param.type, OutputName):
                continue
            is_argument = isinstance(param, click.Argument)
            name = param.human_readable_name if is_argument else param.opts[-1]
            for text in map(str, value if isinstance(value, tuple) else (value,)):
                after_kind = text.partition(":")[2]
                for path in (text, *accumulate(after_kind.split("#"), "{}#{}".format)):
                    if os.path.isfile(path):
                        yield name, Path(path)


def is_same_file(first: Path, second: Path) -> bool:
    """Return whether two paths lead to one file, which need not exist."""
    try:
        return os.path.samefile(first, second)
    except OSError:
        return os.path.realpath(first) == os.path.realpath(second)


READABLE = PathName(exists=True, dir_okay=False, path_type=Path)
