"""Files: bounded reading of what a user names, replacement in one step, names inside a folder."""

import os
import re
import secrets
import stat
from contextlib import suppress
from pathlib import Path, PurePosixPath

from oodscen.errors import DataError, Issue

MAX_BYTES = 1 << 30
"""Most that is read of one file; the largest public data set of driving texts has about 300 MB."""

_PART = re.compile(r"\.(\d+)-[0-9a-f]{12}\.oodscen-part")
"""Names of files that are being written, with the process that does."""


def read_regular(path: str | Path, noun: str, *, limit: int = MAX_BYTES) -> bytes:
    """Return the bytes of a regular file.

    A pipe is refused without waiting for who writes into it, and a device without reading it.

    Args:
        path: Of the file; links are followed.
        noun: What an error message calls its content.
        limit: Most bytes that it may have.

    Raises:
        DataError: When there is no such file, it is none that can be read, or it is larger.
    """
    try:
        # Without O_NONBLOCK, opening a pipe waits for a writer.
        opened = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK)
        try:
            status = os.fstat(opened)
            if not stat.S_ISREG(status.st_mode):
                raise _refused(noun, path, "is no regular file")
            content = b"" if status.st_size > limit else _read(opened, limit)
        finally:
            os.close(opened)
    except (OSError, ValueError) as error:
        raise _refused(noun, path, getattr(error, "strerror", None) or str(error)) from None
    if max(status.st_size, len(content)) > limit:
        raise _refused(noun, path, f"has more than {limit:,} bytes")
    return content


def refuse_special(path: str | Path, noun: str) -> None:
    """Refuse what another library would wait for, or read without an end.

    Raises:
        DataError: When there is no regular file.
    """
    try:
        is_regular = stat.S_ISREG(os.stat(path).st_mode)
    except (OSError, ValueError) as error:
        raise _refused(noun, path, getattr(error, "strerror", None) or str(error)) from None
    if not is_regular:
        raise _refused(noun, path, "is no regular file")


def read_utf8(path: str | Path, noun: str, *, limit: int = MAX_BYTES) -> str:
    """Return the text of a regular file in UTF-8, without the mark that some editors put before it.

    Raises:
        DataError: As in `read_regular`, or with the line that is something else.
    """
    content = read_regular(path, noun, limit=limit)
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = len((content[: error.start] + b".").splitlines())
        issue = Issue(f"line {line}", f"is not UTF-8 text: {error.reason} at byte {error.start}")
        raise DataError(noun, [issue], source=str(path)) from None


def _read(opened: int, limit: int) -> bytes:
    """Read to the end, or just beyond the limit: a file may grow, and those of /proc tell no size."""
    content = bytearray()
    while len(content) <= limit and (block := os.read(opened, 1 << 20)):
        content += block
    return bytes(content)


def _refused(noun: str, path: str | Path, fault: str) -> DataError:
    return DataError(noun, [Issue("", fault)], source=str(path))


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
