"""Starts of the entities of an OpenSCENARIO file."""

from collections import deque
from collections.abc import Iterable
from typing import NamedTuple

from oodscen.interchange._reading.boxes import bounding_box
from oodscen.interchange._reading.positions import EntityPlace, Positions
from oodscen.interchange._reading.tree import Element


class _Action(NamedTuple):
    """An action that places an entity."""

    entity: str
    position: Element
    reference: str
    """The entity to which the position is relative, or an empty text."""

    @property
    def is_move(self) -> bool:
        """True if it is relative to its own entity: it needs the earlier place, and so replaces nothing."""
        return self.reference == self.entity


def read_starts(root: Element, positions: Positions) -> None:
    """Read where all entities start.

    The actions are taken in order, and the last place of an entity counts. An action that is relative to an
    entity without a place waits until that has one.
    """
    actions = _actions(root, positions)
    _note_replaced(actions)
    order = _Order(positions)
    for action in actions:
        order.add(action)
    for action in order.needed():
        if place := positions.read(action.position):
            positions.places[action.entity] = place
    for entity in order.waiting:
        positions.places.pop(entity, None)
    for own in order.waiting.values():
        positions.read(own[0].position)  # Records why it cannot be read.


def _actions(root: Element, positions: Positions) -> list[_Action]:
    """Return all actions that place an entity, in order."""
    return [
        _Action(private.get("entityRef"), position, positions.reference(position))
        for private in root.all("Storyboard", "Init", "Actions", "Private")
        for position in private.all("PrivateAction", "TeleportAction", "Position")
    ]


def _note_replaced(actions: Iterable[_Action]) -> None:
    """Note the actions that count no more because their entity is placed again."""
    earlier: dict[str, list[_Action]] = {}
    for action in actions:
        if not action.is_move:
            for replaced in earlier.pop(action.entity, ()):
                reason = f"{action.entity[:40]!r} is placed again later, which counts"
                replaced.position.leave_out(reason)
        earlier.setdefault(action.entity, []).append(action)


class _Order:
    """The order in which actions are taken, each after the one that places its reference."""

    def __init__(self, positions: Positions) -> None:
        self._positions = positions
        self._taken: dict[_Action, _Action | None] = {}
        """The actions in order, each with the one that placed its reference."""
        self._last: dict[str, _Action] = {}
        """The last action taken of each entity."""
        self.waiting: dict[str, deque[_Action]] = {}
        """The actions of each entity that still wait, in order."""
        self._followers: dict[str, list[str]] = {}
        """By entity: those whose first waiting action waited for it when it was last looked at."""

    def add(self, action: _Action) -> None:
        """Take an action, and all that waited for it; or let it wait."""
        if not action.is_move:
            self.waiting.pop(action.entity, None)
        self.waiting.setdefault(action.entity, deque()).append(action)
        entities = [action.entity]
        while entities:
            entities += self._take(entities.pop())

    def _take(self, entity: str) -> Iterable[str]:
        """Take the actions of an entity that are ready, and return the entities that waited for the last."""
        own = self.waiting.get(entity, deque())
        while own and self._is_ready(own[0]):
            ready = own.popleft()
            self._taken[ready] = self._last.get(ready.reference)
            self._last[entity] = ready
        if own:
            self._followers.setdefault(own[0].reference, []).append(entity)
            return ()
        self.waiting.pop(entity, None)
        return self._followers.pop(entity, ())

    def _is_ready(self, action: _Action) -> bool:
        if not action.reference:
            return self._positions.can_read(action.position)
        is_known = action.is_move or action.reference not in self.waiting
        return is_known and action.reference in self._last

    def needed(self) -> list[_Action]:
        """Return the actions that give the last places, in order, with those that they are relative to.

        Others are not read, so that what a later place replaces may be beyond the roads.
        """
        needed: set[_Action | None] = {
            action for entity, action in self._last.items() if entity not in self.waiting
        }
        for action in reversed(self._taken):
            if action in needed:
                needed.add(self._taken[action])
        return [action for action in self._taken if action in needed]


def centre_of(name: str, entity: Element, positions: Positions) -> EntityPlace | None:
    """Return the pose of an entity's centre, which is ahead of a vehicle's reference point."""
    place = positions.places.get(name)
    box = bounding_box(entity)
    centre = None if box is None else box.first("Center")
    if place is None or centre is None:
        return place
    moved = place.moved(centre.number("x", 0.0), centre.number("y", 0.0))
    # The lane and s that the file names are those of the reference point, not of the centre.
    return moved._replace(road=place.road, direction=place.direction)
