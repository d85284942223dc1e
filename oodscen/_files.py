"""Files that are replaced in one step, and names of files that stay inside their folder."""

import os
import re
import secrets
from contextlib import suppress
from pathlib import Path, PurePosixPath

_PART = re.compile(r"\.(\d+)-[0-9a-f]{12}\.oodscen-part")
"""Names of files that are being written, with the process that does."""


def replace(target: Path, data: bytes) -> None:
    """Give a file new content in one step, durably; it keeps its mode, and the old content on any error.

    Raises:
        OSError: When it cannot be written.
    """
    part = target.with_name(f".{os.getpid()}-{secrets.token_hex(6)}.oodscen-part")
    try:
        with part.open("xb") as file:
            file.write(data)
            with suppress(FileNotFoundError):
                os.fchmod(file.fileno(), target.stat().st_mode & 0o7777)
            file.flush()
            os.fsync(file.fileno())
        part.replace(target)
    except BaseException:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        raise


def remove_parts(folder: Path) -> None:
    """Delete what other processes left half written below a folder that only this one writes."""
    for path in folder.rglob(".*.oodscen-part"):
        match = _PART.fullmatch(path.name)
        if match and int(match[1]) != os.getpid():
            with suppress(OSError):
                path.unlink()


def inside(folder: Path, name: str) -> Path:
    """Return where a relative name leads, which is below a folder.

    Raises:
        ValueError: When it leads elsewhere: absolute, with `..`, or through a symbolic link; or is no name.
    """
    path, shown = PurePosixPath(name), repr(name[:100])
    if not name or "\0" in name or path.is_absolute() or ".." in path.parts:
        raise ValueError(f"{shown} is no name of a file inside the folder")
    real = os.path.realpath(folder)
    if not os.path.realpath(folder / name).startswith(os.path.join(real, "")):
        raise ValueError(f"{shown} leads outside the folder")
    try:
        (folder / name).exists()
    except OSError as error:
        raise ValueError(f"{shown}: {error.strerror}") from None
    return folder / name
