"""The ego of an OpenSCENARIO file: which entity it is, and its speed and lane."""

import re
from collections.abc import Iterable
from itertools import islice

from oodscen.data._scene import Ego
from oodscen.driving._roads.corridor import Corridor
from oodscen.errors import Issue
from oodscen.interchange._reading.tree import Element

_NAMES = ("ego", "hero")
_NOT_EGO = 4
"""Unlikeness to the ego's name from which a name is another's."""
_NAMED, _LONGEST_NAME = 20, 40
"""Number of entities that an error names, and characters of each name."""


def no_entity(name: str, entities: Iterable[str]) -> Issue:
    """Return the fault that no entity has the name of the ego."""
    names = ", ".join(repr(entity[:_LONGEST_NAME]) for entity in islice(entities, _NAMED))
    return Issue("ego", f"there is no entity {name[:_LONGEST_NAME]!r}; the file has: {names}")


def likely_ego(root: Element, entities: Iterable[str]) -> str:
    """Return the entity that is the ego by its name, or else the first, and record a choice that may be wrong.

    Raises:
        DataError: If there are no entities.
    """
    likely = sorted(entities, key=_unlike_ego)
    if not likely:
        raise root.fault("has no entities")
    ego, *others = likely
    unlikeness = _unlike_ego(ego)
    is_rivalled = bool(others) and _unlike_ego(others[0]) == unlikeness
    if unlikeness >= _NOT_EGO:
        root.note(f"no entity is called ego; {ego} is taken to be it")
    elif unlikeness > 0 or is_rivalled:
        root.note(f"{ego} is taken to be the ego; name another one to change that")
    return ego


def _unlike_ego(name: str) -> int:
    """Return how unlike the ego's a name is: 0 is the name itself, then it begins with it, ends with it, or neither."""
    if name.lower() in _NAMES:
        return 0
    words = re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+", name)
    if not any(word.lower() in _NAMES for word in words):
        return _NOT_EGO
    if words[0].lower() not in _NAMES:
        return 3
    return 1 if len(words) == 1 or words[1].lower() in ("vehicle", "car") else 2


def ego_of(entity: Element, speed: float, corridor: Corridor, strip: int) -> Ego:
    """Return the ego, at the limit of its road if it has no first speed."""
    if speed == 0.0:
        speed = round(corridor.speed_limit, 2)
        entity.note(
            f"without a first speed above 0 the ego starts at the limit of its road, {speed:g} m/s"
        )
    return Ego(speed=round(speed, 3), lane=corridor.ego_lanes.index(strip))
