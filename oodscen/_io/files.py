"""File access: size-limited reading, atomic replacement, names confined to a folder, and files that ship."""

import errno
import hashlib
import os
import re
import secrets
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib import resources
from pathlib import Path, PurePosixPath
from socket import gethostname
from tempfile import TemporaryDirectory

from oodscen._io.standard_output import place
from oodscen.errors import DataError, Issue, OodscenError, UsageError

_KINDS = {
    stat.S_IFDIR: "a directory",
    stat.S_IFIFO: "a pipe",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFSOCK: "a socket",
}
"""Words for what is not a regular file."""

MAX_BYTES = 1 << 30
"""Maximum number of bytes read from one file. The largest public data set of driving texts has about 300 MB."""

_PART = re.compile(
    r"\.(?P<pid>\d+)-(?P<host>[0-9a-f]{8})-(?P<target>[0-9a-f]{8})-[0-9a-f]{8}\.oodscen-part"
)
"""Matches the names of partly written files: process, host and target, the latter two as digests."""


def check_name(name: str | Path) -> None:
    """Check that a name can be one of a file.

    Raises:
        UsageError: If it holds a NUL or what the system's encoding cannot say, or a part is too long.
    """
    try:
        written = os.fsencode(name)
        is_sound = b"\0" not in written and all(len(part) <= 255 for part in written.split(b"/"))
    except UnicodeEncodeError:
        is_sound = False
    if not is_sound:
        raise UsageError(f"{str(name)[:80]!r} cannot be the name of a file")


def file_sha256(path: str | Path) -> bytes:
    """Return the SHA-256 of a file's bytes, read in pieces."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").digest()


def read_regular(path: str | Path, noun: str, *, limit: int = MAX_BYTES) -> bytes:
    """Return the bytes of a regular file.

    A pipe is refused without waiting for a writer, and a device without being read.

    Args:
        path: The file; links are followed.
        noun: The word for the content in error messages.
        limit: Maximum size in bytes.

    Raises:
        DataError: If the file is missing, unreadable, not a regular file, or too large.
    """
    try:
        return read_bytes(path, limit=limit)
    except (OSError, ValueError) as error:
        raise unreadable(noun, path, error) from None


def read_bytes(path: str | Path, *, limit: int = MAX_BYTES) -> bytes:
    """Return the bytes of a regular file, as `read_regular` does, for callers that expect an `OSError`.

    Raises:
        OSError: If the file is missing, unreadable, not a regular file, or too large.
    """
    _check_regular(os.stat(path), path)
    # The file may have been replaced since; without O_NONBLOCK, opening a pipe waits for a writer.
    opened = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK)
    try:
        status = os.fstat(opened)
        _check_regular(status, path)
        content = b"" if status.st_size > limit else _read(opened, limit)
    finally:
        os.close(opened)
    if max(status.st_size, len(content)) > limit:
        raise OSError(errno.EFBIG, f"has more than {limit:,} bytes", str(path))
    return content


def refuse_special(path: str | Path, noun: str) -> None:
    """Raise an error for anything but a regular file: another library could block on it or read it forever.

    Raises:
        DataError: If the path is not a regular file.
    """
    try:
        _check_regular(os.stat(path), path)
    except (OSError, ValueError) as error:
        raise unreadable(noun, path, error) from None


def _check_regular(status: os.stat_result, path: str | Path) -> None:
    if not stat.S_ISREG(status.st_mode):
        kind = _KINDS.get(stat.S_IFMT(status.st_mode), "something else")
        raise OSError(errno.EINVAL, f"is not a regular file but {kind}", str(path))


def read_utf8(path: str | Path, noun: str, *, limit: int = MAX_BYTES) -> str:
    """Return the text of a regular UTF-8 file, without its byte order mark.

    Raises:
        DataError: As in `read_regular`, or with the number of the line that is not UTF-8.
    """
    content = read_regular(path, noun, limit=limit)
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        # The error counts from behind the byte order mark, which its object lacks.
        line = len((error.object[: error.start] + b".").splitlines())
        place = len(content) - len(error.object) + error.start
        issue = Issue(f"line {line}", f"is not UTF-8 text: {error.reason} at byte {place}")
        raise DataError(noun, [issue], source=str(path)) from None


def bundled(name: str, package: str) -> str:
    """Return the content of a text file that ships with a package."""
    return (resources.files(package) / name).read_text(encoding="utf-8")


def _read(opened: int, limit: int) -> bytes:
    """Read to the end, or just past the limit. A file may grow, and files in /proc report no size."""
    content = bytearray()
    while len(content) <= limit and (block := os.read(opened, 1 << 20)):
        content += block
    return bytes(content)


def unreadable(noun: str, path: str | Path, error: OSError | ValueError) -> DataError:
    """Return the error that says why a file or folder cannot be read."""
    reason = getattr(error, "strerror", None) or str(error)
    return DataError(noun, [Issue("", reason)], source=str(path), fault="unreadable")


def replace(target: Path, data: bytes) -> None:
    """Replace the content of a file atomically and durably; its mode is kept, and on any error so is its content.

    Raises:
        OSError: If the file cannot be written.
    """
    part = target.with_name(_part_name(target))
    _remove_stale(target)
    try:
        with part.open("xb") as file:
            file.write(data)
            with suppress(FileNotFoundError):
                os.fchmod(file.fileno(), target.stat().st_mode & 0o7777)
            file.flush()
            os.fsync(file.fileno())
        part.replace(target)
    except BaseException as error:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        if isinstance(error, OSError):  # Name the file that was asked for, not its part.
            raise type(error)(error.errno, error.strerror, str(target)) from None
        raise


def is_written_through(out: Path) -> bool:
    """Return whether a path is a device, a pipe, or a file that is already open, such as `/dev/stdout`."""
    if str(out).startswith(("/dev/std", "/dev/fd/", "/proc/")):
        return True
    return out.exists() and not stat.S_ISREG(out.stat().st_mode)


def write_named(out: Path, data: bytes) -> None:
    """Write a file that a user named; its folder is made.

    A regular file, or the target of a symbolic link, is replaced as by `replace`; a device or a pipe is
    written through.

    Raises:
        OSError: If the file cannot be written.
    """
    if is_written_through(out):
        with place(out).open("wb") as stream:
            stream.write(data)
        return
    target = Path(os.path.realpath(out))
    target.parent.mkdir(parents=True, exist_ok=True)
    if target.exists() and not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(out))
    replace(target, data)


@contextmanager
def writing(target: Path, kind: type[OodscenError] = OodscenError) -> Iterator[None]:
    """Raise errors of the operating system as one of this library that names what cannot be written."""
    try:
        yield
    except OSError as error:
        is_broken = os.path.islink(target) and not os.path.exists(target)
        reason = "it is a broken link" if is_broken else error.strerror or error
        raise kind(f"cannot write {target}: {reason}") from None
    except ValueError as error:  # A name with a null byte, or one that cannot be encoded.
        raise kind(f"cannot write {str(target)!r}: {error}") from None


def _part_name(target: Path) -> str:
    """Return a new name for a partly written file."""
    return f".{os.getpid()}-{_tag(gethostname())}-{_tag(target.name)}-{secrets.token_hex(4)}.oodscen-part"


def _tag(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogateescape")).hexdigest()[:8]


def _remove_stale(target: Path) -> None:
    """Delete partial copies of this file by writers that were killed on this machine."""
    for path in target.parent.glob(f".*-{_tag(gethostname())}-{_tag(target.name)}-*.oodscen-part"):
        match = _PART.fullmatch(path.name)
        if match and not _is_running(int(match["pid"])):
            with suppress(OSError):
                path.unlink()


def _is_running(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        return True  # It belongs to somebody else.
    return True


def remove_parts(folder: Path) -> None:
    """Delete files that other processes left half written in a folder that only this process writes."""
    for path in folder.rglob(".*.oodscen-part"):
        match = _PART.fullmatch(path.name)
        if match and int(match["pid"]) != os.getpid():
            with suppress(OSError):
                path.unlink()


def temporary_folder() -> TemporaryDirectory[str]:
    """Create a temporary folder, which is deleted with the returned context.

    Raises:
        UsageError: If there is no place for temporary files, or it is full.
    """
    try:
        return TemporaryDirectory(prefix="oodscen-", ignore_cleanup_errors=True)
    except OSError as error:
        raise UsageError(
            f"cannot create a temporary folder: {error.strerror or error}; set TMPDIR to a folder that can be "
            "written"
        ) from None


def inside(folder: Path, name: str) -> Path:
    """Return the path of a relative name below a folder.

    Raises:
        ValueError: If the name is empty or leads outside: absolute, with `..`, or through a symbolic link.
    """
    path, shown = PurePosixPath(name), repr(name[:100])
    if not name or "\0" in name or path.is_absolute() or ".." in path.parts:
        raise ValueError(f"{shown} is not the name of a file inside the folder")
    real = os.path.realpath(folder)
    if not os.path.realpath(folder / name).startswith(os.path.join(real, "")):
        raise ValueError(f"{shown} leads outside the folder")
    try:
        (folder / name).exists()
    except OSError as error:
        raise ValueError(f"{shown}: {error.strerror}") from None
    return folder / name
