"""Use of a simulator by one open environment at a time."""

import os
from typing import TYPE_CHECKING
from weakref import WeakValueDictionary

from oodscen.errors import UsageError

if TYPE_CHECKING:
    from oodscen.gymnasium._env import SceneEnv

_users: WeakValueDictionary[tuple[int, int], "SceneEnv"] = WeakValueDictionary()
"""The open environments by process and id of their simulator."""


def claim(env: "SceneEnv") -> None:
    """Make an environment's simulator its own until it is released.

    Raises:
        UsageError: If another open environment uses the same object.
    """
    if _users.setdefault(_key(env), env) is not env:
        raise UsageError(
            f"another open environment uses this simulator, {env.simulator.name!r}: give its name, or one "
            "object per environment"
        )


def release(env: "SceneEnv") -> None:
    """Leave an environment's simulator to others; nothing happens if another one uses it."""
    if _users.get(_key(env)) is env:
        del _users[_key(env)]


def _key(env: "SceneEnv") -> tuple[int, int]:
    return os.getpid(), id(env.simulator)
