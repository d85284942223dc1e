"""Checks of the types of arguments that take one kind of thing."""

from typing import Any

from oodscen.errors import UsageError


def instance_of(name: str, value: Any, *kinds: type) -> None:
    """Do nothing if an argument is of one of some types.

    Raises:
        UsageError: If it is not; the message names the argument and the types.
    """
    if not isinstance(value, kinds):
        wanted = " or ".join(kind.__name__ for kind in kinds)
        raise UsageError(f"{name} must be a {wanted}, not {value!r:.80}")
