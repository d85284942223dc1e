"""Starts of the entities of an OpenSCENARIO file."""

from collections.abc import Iterable
from typing import NamedTuple

from oodscen.interchange._reading.positions import EntityPlace, Positions
from oodscen.interchange._reading.tree import Element


class _Action(NamedTuple):
    """An action that places an entity."""

    entity: str
    position: Element
    reference: str
    """The entity to which the position is relative, or an empty text."""


def read_starts(root: Element, positions: Positions) -> None:
    """Read where all entities start.

    The actions are taken in order, and the last place of an entity counts. An action that is relative to an
    entity without a place waits until that has one.
    """
    taken, waiting = _taken(_actions(root, positions), positions)
    last = {action.entity: action for action in taken if action.entity not in waiting}
    needed: set[_Action | None] = set(last.values())
    for action in reversed(taken):
        if action in needed:
            needed.add(taken[action])
    for action in taken:
        if action in needed and (place := positions.read(action.position)):
            positions.places[action.entity] = place
    for entity in waiting:
        positions.places.pop(entity, None)
    for first, *_ in waiting.values():
        positions.read(first.position)  # Records why it cannot be read.


def _actions(root: Element, positions: Positions) -> list[_Action]:
    """Return all actions that place an entity, in order."""
    return [
        _Action(private.get("entityRef"), position, positions.reference(position))
        for private in root.all("Storyboard", "Init", "Actions", "Private")
        for position in private.all("PrivateAction", "TeleportAction", "Position")
    ]


def _taken(
    actions: Iterable[_Action], positions: Positions
) -> tuple[dict[_Action, _Action | None], dict[str, list[_Action]]]:
    """Return the actions in the order taken, and by entity those that still wait; note which are replaced.

    With each comes the action that placed its reference.
    """
    taken: dict[_Action, _Action | None] = {}
    last: dict[str, _Action] = {}
    waiting: dict[str, list[_Action]] = {}
    replaceable: dict[str, list[_Action]] = {}

    def is_ready(action: _Action) -> bool:
        if not action.reference:
            return positions.can_read(action.position)
        is_known = action.reference == action.entity or action.reference not in waiting
        return is_known and action.reference in last

    for action in actions:
        if action.reference != action.entity:
            waiting.pop(action.entity, None)
            for replaced in replaceable.pop(action.entity, ()):
                reason = f"{action.entity[:40]!r} is placed again later, which counts"
                replaced.position.leave_out(reason)
        replaceable.setdefault(action.entity, []).append(action)
        waiting.setdefault(action.entity, []).append(action)
        while ready := next((own[0] for own in waiting.values() if is_ready(own[0])), None):
            waiting[ready.entity].remove(ready)
            if not waiting[ready.entity]:
                del waiting[ready.entity]
            taken[ready] = last.get(ready.reference)
            last[ready.entity] = ready
    return taken, waiting


def centre_of(name: str, entity: Element, positions: Positions) -> EntityPlace | None:
    """Return the pose of an entity's centre, which is ahead of a vehicle's reference point."""
    place = positions.places.get(name)
    centre = next(entity.within("Center"), None)
    if place is None or centre is None:
        return place
    moved = place.moved(centre.number("x", 0.0), centre.number("y", 0.0))
    return moved._replace(road=place.road, direction=place.direction)
