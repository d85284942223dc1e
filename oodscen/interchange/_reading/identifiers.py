"""Ids that a scene accepts, for the names of files and entities."""

import re
from collections.abc import Iterable

from oodscen._words.wording import is_left_out

_LONGEST = 40
"""Characters of the id of an entity."""
_LONGEST_SCENE = 200
"""Characters of the id of a scene."""


def identifier(name: str, longest: int = _LONGEST) -> str:
    """Return an id that an actor of a scene accepts."""
    plain = re.sub(r"[^a-z0-9_-]+", "-", name.lower()).strip("-_")[:longest]
    return plain or "entity"


def scene_identifier(name: str) -> str:
    """Return an id that a scene accepts."""
    return identifier(name, _LONGEST_SCENE)


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
