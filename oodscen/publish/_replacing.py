"""The folder of a data set, which holds the earlier one or the new one, whatever goes wrong."""

import os
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from oodscen._io.files import file_sha256, inside, read_regular
from oodscen._io.lock import NAME as LOCK
from oodscen._io.lock import locked
from oodscen.errors import FolderTaken, UsageError

SUMS = "SHA256SUMS"
"""File with the SHA-256 of every other file."""

CARD = "README.md"
"""The card, which people complete by hand."""

_PART = ".oodscen-part"
"""Folder, inside that of the data set, in which the new one is written."""

_NAME = (
    r"README\.md|data/(questions|drives)/\w+\.parquet|vlmevalkit/oodscen\.tsv"
    r"|lmms_eval/oodscen/[\w.]+|drivelm/(\w+\.json|images/[\w-]+\.jpg)"
)
"""Name of a file of a data set: no other file is ever replaced or removed."""
_LINE = re.compile(rf"(?P<digest>[0-9a-f]{{64}})  (?P<name>{_NAME})")
"""Line of the sums of a data set."""


@contextmanager
def replacing(folder: Path) -> Iterator[Path]:
    """Yield an empty folder whose files then take the place of the data set in a folder, which may be new or empty.

    If the work in the context fails, the earlier data set stays as it was, and a folder that was made for the
    new one is removed again. A call that is killed while it moves the files leaves no sums; the next one knows
    both data sets and tidies up.

    Raises:
        FolderTaken: If the folder holds other files.
        InUse: If another process writes the folder.
        OSError: If a file cannot be written.
        UsageError: If a file of the data set was changed since it was written.
    """
    new_folders = [path for path in (folder, *folder.parents) if not path.exists()]
    part = folder / _PART
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with locked(folder, "data set"):
            earlier = _earlier(folder)
            if others := set(names(folder)) - earlier:
                foreign_first = sorted(others, key=lambda name: (_is_name_of_data_set(name), name))
                raise FolderTaken(str(folder), foreign_first)
            shutil.rmtree(part, ignore_errors=True)
            part.mkdir()
            try:
                yield part
            except BaseException:
                shutil.rmtree(part, ignore_errors=True)
                raise
            _move(part, folder, earlier)
            shutil.rmtree(part, ignore_errors=True)
    finally:
        for new_folder in new_folders:
            with suppress(OSError):
                new_folder.rmdir()


def names(folder: Path) -> list[str]:
    """Return the sorted names of all files and links below a folder, but not of the lock and the new data set."""
    paths: list[Path] = []
    for parent, folders, files in os.walk(folder):
        if Path(parent) == folder and _PART in folders:
            folders.remove(_PART)
        links = [name for name in folders if Path(parent, name).is_symlink()]
        paths += [Path(parent, name) for name in (*files, *links)]
    relative = (path.relative_to(folder).as_posix() for path in paths)
    return sorted(name for name in relative if name != LOCK)


def _is_name_of_data_set(name: str) -> bool:
    """Return whether a file may be one of a data set, by its name."""
    return name == SUMS or re.fullmatch(_NAME, name) is not None


def _earlier(folder: Path) -> set[str]:
    """Return the names of the files of the data set in a folder, and of one that was being moved in.

    Raises:
        UsageError: If one of them was changed since.
    """
    earlier = _hashes(folder / SUMS)
    for name, digest in earlier.items():
        path = folder / name
        is_whole = path.is_file() and not path.is_symlink()
        if os.path.lexists(path) and not (is_whole and file_sha256(path).hex() == digest):
            raise UsageError(
                f"{path} was changed since it was published; nothing is overwritten: move it away, "
                "or choose another folder"
            )
    unmoved = _hashes(folder / _PART / SUMS)
    return {*earlier, *unmoved, SUMS} if earlier or unmoved else set()


def _hashes(sums: Path) -> dict[str, str]:
    """Return the hashes in the sums of a data set by the names of their files; empty for sums of other kinds."""
    if not sums.exists():
        return {}
    lines = read_regular(sums, "data set").decode("utf-8", "replace").splitlines()
    matches = [_LINE.fullmatch(line) for line in lines]
    hashes = {match["name"]: match["digest"] for match in matches if match}
    return hashes if all(matches) and CARD in hashes else {}


def _move(part: Path, folder: Path, earlier: set[str]) -> None:
    """Remove the earlier files that have no successor, and move the new ones to their places, the sums last."""
    new = sorted(names(part), key=lambda name: (name == SUMS, name))
    for name in sorted(earlier - set(new)):
        with suppress(ValueError, FileNotFoundError):
            inside(folder, name).unlink()
            for parent in Path(name).parents[:-1]:
                with suppress(OSError):
                    (folder / parent).rmdir()
    (folder / SUMS).unlink(missing_ok=True)
    for name in new:
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        (part / name).replace(target)
