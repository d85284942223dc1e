"""Exclusive locks of the operating system on files; they end with the process, however it ends."""

import fcntl
import os
import time
from pathlib import Path

_INTERVAL_S = 0.02
"""Time between two tries, s."""
_held: set[int] = set()
"""File descriptors of the locks of this process."""


def acquire(file: Path, wait_s: float) -> int | None:
    """Lock a file, which is created if it does not exist.

    Args:
        file: The file; a symbolic link is refused.
        wait_s: Seconds to wait for another holder.

    Returns:
        The descriptor that `release` takes, or `None` if another holder did not leave in time.

    Raises:
        OSError: If the file cannot be opened, or its file system has no locks.
    """
    deadline = time.monotonic() + wait_s
    while True:
        descriptor = os.open(file, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666)
        if _is_locked(descriptor):
            _held.add(descriptor)
            return descriptor
        os.close(descriptor)
        if time.monotonic() >= deadline:
            return None
        time.sleep(_INTERVAL_S)


def release(descriptor: int) -> None:
    """End a lock."""
    if descriptor in _held:
        _held.remove(descriptor)
        os.close(descriptor)


def _is_locked(descriptor: int) -> bool:
    """Lock an open file, and return whether that succeeded and the file was not deleted meanwhile."""
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except BaseException:
        os.close(descriptor)
        raise
    return os.fstat(descriptor).st_nlink > 0


def _leave_to_parent() -> None:
    """Close the descriptors in a forked process, which would otherwise hold the locks beyond its parent's end."""
    while _held:
        os.close(_held.pop())


os.register_at_fork(after_in_child=_leave_to_parent)
