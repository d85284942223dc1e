"""Ids that a scene accepts, for the names of files and entities."""

import re
from collections.abc import Iterable

from oodscen._wording import is_left_out

_LONGEST = 40


def identifier(name: str) -> str:
    """Return an id that a scene accepts."""
    plain = re.sub(r"[^a-z0-9_-]+", "-", name.lower()).strip("-_")[:_LONGEST]
    return plain or "entity"


def identifiers(names: Iterable[str]) -> dict[str, str]:
    """Return an id for every name; none is the ego's, and no two are the same."""
    ids: dict[str, str] = {}
    taken = {"ego"}
    for name in names:
        plain = unique = identifier(name)
        number = 2
        while unique in taken or is_left_out(unique):
            unique = f"{plain[: _LONGEST - 6]}-{number}"
            number += 1
        ids[name] = unique
        taken.add(unique)
    return ids
