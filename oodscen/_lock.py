"""One writer at a time: locks on folders and files that the operating system lets go with their process."""

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

from filelock import FileLock, Timeout

from oodscen.errors import InUse, StudyError
from oodscen.llms.redaction import redact

NAME = ".oodscen.lock"
"""Lock file inside a locked folder; that of a file lies beside it and begins with the file's name."""

_GRACE_S = 0.3
"""A holder that is just leaving, or has not yet written who it is, is waited for so long."""


@dataclass
class _Hold:
    """A lock that this process holds."""

    thread: int
    lock: FileLock
    depth: int = 1
    """How often the thread has taken it."""


_holds: dict[Path, _Hold] = {}
"""By lock file."""
_guard = threading.Lock()


@contextmanager
def locked(path: Path, what: str, *, wait_s: float = _GRACE_S) -> Iterator[None]:
    """Be the only one who writes a folder or a file; the thread that holds a lock may take it again.

    The lock ends with its process, however that ends: a lock file left behind locks nothing. While it is
    held the file says who holds it; it is deleted at the end.

    Args:
        path: An existing folder, or a file, which need not exist.
        what: What is locked, as an error calls it, e.g. `study`.
        wait_s: Seconds in which another holder may end.

    Raises:
        InUse: When another process, or another thread, holds it; nothing is changed then.
        StudyError: When no lock can be had there: no permission, or a file system without locks.
    """
    file, me = lock_file(path), threading.get_ident()
    with _guard:
        hold = _holds.get(file)
        if hold is not None and hold.thread == me:
            hold.depth += 1
        else:
            hold = None
    if hold is None:
        hold = _Hold(me, _taken(file, path, what, wait_s))
        _holds[file] = hold
    try:
        yield
    finally:
        with _guard:
            hold.depth -= 1
            is_last = not hold.depth
            if is_last:
                del _holds[file]
        if is_last:
            # While it is still held: whoever waits with the old file open sees that it is gone.
            with suppress(OSError):
                file.unlink(missing_ok=True)
            hold.lock.release()


def lock_file(path: Path) -> Path:
    """Return the lock file of a folder or a file."""
    path = Path(os.path.realpath(path))
    return path / NAME if path.is_dir() else path.with_name(f".{path.name}{NAME}")


def _taken(file: Path, path: Path, what: str, wait_s: float) -> FileLock:
    # Where there are no locks a file that merely exists would outlive a process that is killed.
    lock = FileLock(
        file, timeout=wait_s, poll_interval=0.02, fallback_to_soft=False, thread_local=False
    )
    try:
        lock.acquire()
        file.write_text(json.dumps(_holder()) + "\n", encoding="utf-8")
    except Timeout:
        raise InUse(str(path), what, *_read(file)) from None
    except OSError as error:
        lock.release(force=True)
        reason = error.strerror or str(error)
        raise StudyError(f"cannot lock {path} for writing: {reason}") from error
    return lock


def _holder() -> dict[str, str | int]:
    words = [Path(sys.argv[0]).name, *sys.argv[1:]] if sys.argv else ["python"]
    return {
        "pid": os.getpid(),
        "host": socket.gethostname(),
        "command": redact(shlex.join(words))[:300],
        "since": datetime.now(UTC).strftime("%Y-%m-%d %H:%M:%S UTC"),
    }


def _read(file: Path) -> tuple[str, str]:
    """Return who holds a lock and since when, as far as the file says."""
    try:
        said = json.loads(file.read_text(encoding="utf-8"))
        holder = f"process {said['pid']} on {said['host']} ({said['command']})"
        return holder, str(said["since"])
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return "another process", ""
