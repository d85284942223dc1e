"""Option and argument types for paths."""

import os
from pathlib import Path
from typing import Any

import click


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
        found = super().convert(value, param, ctx)
        if self.exists and not (os.path.isfile(found) or os.path.isdir(found)):
            self.fail(f"{self.name.title()} {value!r} is no regular file.", param, ctx)
        return found


READABLE = PathName(exists=True, dir_okay=False, path_type=Path)
