"""Locks on folders and files that allow one writer; the operating system releases them with the process."""

import json
import os
import shlex
import socket
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from oodscen._io import flock
from oodscen._io.files import read_bytes
from oodscen._words.redaction import redact
from oodscen.errors import InUse, StudyError

NAME = ".oodscen.lock"
"""The lock file inside a locked folder. A file's lock file lies beside it and starts with its name."""

_UNKNOWN = "another process", ""
"""Holder and start time where a lock file does not record them."""
_GRACE_S = 0.3
"""Default wait, in seconds, for a holder that is about to leave or has not yet written its name."""


@dataclass
class _Hold:
    """A lock that this process holds."""

    thread: int
    descriptor: int
    depth: int = 1
    """Number of times that the owning thread holds the lock."""


_holds: dict[Path, _Hold] = {}
"""Locks held by this process, by lock file."""
_guard = threading.Lock()


@contextmanager
def locked(path: Path, what: str, *, wait_s: float = _GRACE_S) -> Iterator[None]:
    """Hold the exclusive lock of a folder or file; it is re-entrant within a thread.

    The lock ends with its process, however the process ends: a lock file left behind locks nothing. While
    the lock is held, its file names the holder; the file is deleted on release.

    Args:
        path: An existing folder, or a file, which need not exist.
        what: The word for the locked thing in error messages, e.g. `study`.
        wait_s: Seconds to wait for another holder.

    Raises:
        InUse: If another process or thread holds the lock; nothing has changed.
        StudyError: If the lock cannot be created: no permission, or a file system without locks.
    """
    file, me = lock_file(path), threading.get_ident()
    with _guard:
        hold = _holds.get(file)
        if hold is not None and hold.thread == me:
            hold.depth += 1
        else:
            hold = None
    if hold is None:
        hold = _Hold(me, _acquire(file, path, what, wait_s))
        _holds[file] = hold
    try:
        yield
    finally:
        with _guard:
            hold.depth -= 1
            # A forked process leaves the lock to its parent.
            is_last = not hold.depth and _holds.get(file) is hold
            if is_last:
                del _holds[file]
        if is_last:
            # Delete before release: a process waiting on the old file then sees that it is gone.
            with suppress(OSError):
                file.unlink(missing_ok=True)
            flock.release(hold.descriptor)


def lock_file(path: Path) -> Path:
    """Return the path of the lock file of a folder or file."""
    path = Path(os.path.realpath(path))
    return path / NAME if path.is_dir() else path.with_name(f".{path.name}{NAME}")


def _acquire(file: Path, path: Path, what: str, wait_s: float) -> int:
    """Return the descriptor of the lock, whose file names this process."""
    is_new = not os.path.lexists(file)
    descriptor = None
    try:
        descriptor = flock.acquire(file, wait_s)
        if descriptor is not None:
            # Only now does the file stay as it is: the one of a holder who leaves may vanish at any moment.
            if os.fstat(descriptor).st_size and _read(file) == _UNKNOWN:
                flock.release(descriptor)
                raise StudyError(f"{file} is not a lock file of oodscen: move it away")
            file.write_text(json.dumps(_holder()) + "\n", encoding="utf-8")
            return descriptor
    except OSError as error:
        with suppress(OSError):
            if descriptor is not None or (is_new and not file.stat().st_size):
                file.unlink()
        if descriptor is not None:
            flock.release(descriptor)
        reason = error.strerror or str(error)
        raise StudyError(f"cannot lock {path} for writing: {reason}") from error
    raise InUse(str(path), what, *_read(file))


def _holder() -> dict[str, str | int]:
    program = Path(sys.argv[0] if sys.argv else "python")
    # `python -m PACKAGE` runs the package's __main__.py.
    name = program.parent.name if program.name == "__main__.py" else program.name
    words = [name, *sys.argv[1:]]
    return {
        "pid": os.getpid(),
        "host": socket.gethostname(),
        "command": redact(shlex.join(words))[:300],
        "since": datetime.now(UTC).strftime("%Y-%m-%d %H:%M:%S UTC"),
    }


def _read(file: Path) -> tuple[str, str]:
    """Return the holder of a lock and its start time, as far as the file records them."""
    try:
        record = json.loads(read_bytes(file, limit=10_000))
        holder = f"process {record['pid']} on {record['host']} ({record['command']})"
        return holder, str(record["since"])
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return _UNKNOWN


def _forget() -> None:
    """Forget the locks in a forked process: they are its parent's."""
    global _guard
    _guard = threading.Lock()
    _holds.clear()


os.register_at_fork(after_in_child=_forget)
