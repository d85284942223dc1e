"""Starts of the entities of an OpenSCENARIO file."""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

from oodscen.interchange._reading.positions import EntityPlace, Positions
from oodscen.interchange._reading.tree import Element


class _Step(NamedTuple):
    """One action that places an entity."""

    name: str
    """The entity."""
    holder: Element
    """Its `Position`."""
    reference: str
    """The entity to which that is relative, or an empty text."""


def read_starts(root: Element, positions: Positions) -> None:
    """Read where all entities start.

    The actions are taken in order, and the last place of an entity counts. An action that is relative to an
    entity without a place waits until that has one.
    """
    waiting: list[_Step] = []
    for step in _needed(_steps(root, positions)):
        if step.reference != step.name:
            waiting = [one for one in waiting if one.name != step.name]
        waiting.append(step)
        while ready := next((one for one in waiting if _is_ready(one, waiting, positions)), None):
            waiting.remove(ready)
            place = positions.read(ready.holder)
            positions.places.pop(ready.name, None)
            if place is not None:
                positions.places[ready.name] = place
    for step in waiting:
        positions.places.pop(step.name, None)
    for step in {step.name: step for step in reversed(waiting)}.values():
        positions.read(step.holder)  # Records why it cannot be read.


def _steps(root: Element, positions: Positions) -> list[_Step]:
    """Return all actions that place an entity, in order."""
    return [
        _Step(private.get("entityRef"), holder, positions.reference(holder))
        for private in root.all("Storyboard", "Init", "Actions", "Private")
        for holder in private.all("PrivateAction", "TeleportAction", "Position")
    ]


def _needed(steps: Sequence[_Step]) -> list[_Step]:
    """Return the actions that count, and replaced ones to which another entity's is relative; note the replaced."""
    needed = dict.fromkeys(range(len(steps)), True)
    placing: dict[str, list[int]] = {}
    referring: dict[str, list[int]] = {}
    for index, step in enumerate(steps):
        placing.setdefault(step.name, []).append(index)
        if step.reference != step.name:
            referring.setdefault(step.reference, []).append(index)
    for name, own in placing.items():
        begins = [index for index in own if steps[index].reference != name]
        for begin, end in pairwise([own[0], *(index for index in begins if index != own[0])]):
            first = 0 if begin == own[0] else begin
            is_used = any(first <= index < end for index in referring.get(name, ()))
            for index in own:
                if begin <= index < end:
                    steps[index].holder.leave_out(
                        f"{name[:40]!r} is placed again later, which counts"
                    )
                    needed[index] = is_used
    return [step for index, step in enumerate(steps) if needed[index]]


def _is_ready(step: _Step, waiting: Sequence[_Step], positions: Positions) -> bool:
    """Return whether the place to which an action is relative is known, and does not wait to be replaced."""
    if not step.reference:
        return True
    before = waiting[: waiting.index(step)] if step.reference == step.name else waiting
    return step.reference in positions.places and all(one.name != step.reference for one in before)


def centre_of(name: str, entity: Element, positions: Positions) -> EntityPlace | None:
    """Return the pose of an entity's centre, which is ahead of a vehicle's reference point."""
    place = positions.places.get(name)
    centre = next(entity.within("Center"), None)
    if place is None or centre is None:
        return place
    moved = place.moved(centre.number("x", 0.0), centre.number("y", 0.0))
    return moved._replace(road=place.road, direction=place.direction)
