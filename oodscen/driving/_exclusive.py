"""Use of a simulator by one thread at a time."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

from oodscen.errors import UsageError
from oodscen.protocols import Simulator

_lock = threading.Lock()
_users: dict[int, int] = {}
"""The thread that uses a simulator, both by id, while it does."""


@contextmanager
def exclusive(simulator: Simulator) -> Iterator[None]:
    """Keep other threads from using a simulator: it holds one scene, which they would replace.

    Raises:
        UsageError: When another thread uses it.
    """
    thread, key = threading.get_ident(), id(simulator)
    with _lock:
        is_free = key not in _users
        user = _users.setdefault(key, thread)
    if user != thread:
        raise UsageError(
            f"the simulator {simulator.name!r} runs a scene in another thread; give each thread a simulator of its own"
        )
    try:
        yield
    finally:
        if is_free:  # Otherwise an outer use of this thread goes on.
            del _users[key]
