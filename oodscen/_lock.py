"""One writer at a time: locks on folders and files that the operating system lets go with their process."""

import json
import os
import shlex
import socket
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from datetime import UTC, datetime
from pathlib import Path

from filelock import FileLock, Timeout

from oodscen.errors import InUse, StudyError
from oodscen.llms.redaction import redact

NAME = ".oodscen.lock"
"""Lock file inside a locked folder; that of a file lies beside it and begins with the file's name."""

_GRACE_S = 0.3
"""A holder that is just leaving, or has not yet written who it is, is waited for so long."""

_mine: dict[Path, tuple[int, int]] = {}
"""By lock file that this process holds: the thread that took it, and how often."""
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
    file = lock_file(path)
    key, me = Path(os.path.realpath(file)), threading.get_ident()
    with _guard:
        thread, depth = _mine.get(key, (me, 0))
        is_again = bool(depth) and thread == me
        if is_again:
            _mine[key] = (me, depth + 1)
    if not is_again:
        lock = _taken(file, path, what, wait_s)
        _mine[key] = (me, 1)
    try:
        yield
    finally:
        with _guard:
            depth = _mine[key][1] - 1
            _mine[key] = (me, depth)
            if not depth:
                del _mine[key]
        if not depth:
            # While it is still held: whoever waits with the old file open sees that it is gone.
            with suppress(OSError):
                file.unlink(missing_ok=True)
            lock.release()


def lock_file(path: Path) -> Path:
    """Return the lock file of a folder or a file."""
    path = Path(os.path.realpath(path))
    return path / NAME if path.is_dir() else path.with_name(f".{path.name}{NAME}")


def _taken(file: Path, path: Path, what: str, wait_s: float) -> FileLock:
    # Where there are no locks a file that merely exists would outlive a process that is killed.
    lock = FileLock(file, timeout=wait_s, poll_interval=0.02, fallback_to_soft=False)
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
