"""Boxes of entities: distances between their centres for those that conditions name."""

import math
from collections.abc import Mapping
from typing import NamedTuple

from oodscen.interchange._reading.positions import Positions
from oodscen.interchange._reading.tree import Element


class EntityBox(NamedTuple):
    """The box of an entity, as far as a file tells it."""

    ahead_m: float
    """Distance from its reference point to its centre, m."""
    length_m: float | None
    width_m: float | None

    def half_extent_m(self, turn: float) -> float | None:
        """Return half its extent along a road from which it is turned, m."""
        if self.length_m is None or self.width_m is None:
            return None
        along = self.length_m * abs(math.cos(turn)) + self.width_m * abs(math.sin(turn))
        return 0.5 * along


def bounding_box(entity: Element) -> Element | None:
    """Return the element of a scenario object's own box, which is not that of its trailer."""
    boxes = (body.first("BoundingBox") for body in entity.children())
    return next((box for box in boxes if box is not None), None)


def box_of(entity: Element) -> EntityBox:
    """Return the box of a scenario object."""
    box = bounding_box(entity)
    if box is None:
        return EntityBox(0.0, None, None)
    centre, size = box.first("Center"), box.first("Dimensions")
    ahead_m = centre.number("x", 0.0) if centre is not None else 0.0
    if size is None:
        return EntityBox(ahead_m, None, None)
    return EntityBox(ahead_m, size.number("length"), size.number("width"))


class EgoDistances:
    """Distances between the ego's centre and others', for those between boxes or reference points.

    Scenes measure between centres; conditions of OpenSCENARIO between reference points, or between boxes.
    """

    def __init__(self, positions: Positions, boxes: Mapping[str, EntityBox], ego: str) -> None:
        self.positions = positions
        self.boxes = boxes
        self.ego = ego

    def shift_m(self, other: str) -> float:
        """Return the distance of the reference points of the ego and another less that of their centres, m."""
        place, ego = self.positions.places.get(other), self.positions.places.get(self.ego)
        ahead_m = self.boxes[other].ahead_m * math.cos(self._turn(other))
        shift_m = self.boxes[self.ego].ahead_m - ahead_m
        if place is not None and ego is not None and place.offset_from(ego)[0] < 0.0:
            return -shift_m
        return shift_m

    def between_centres_m(self, condition: Element, other: str, value_m: float) -> float:
        """Return the distance of the centres at which a condition on a distance holds, m."""
        if not condition.is_true("freespace"):
            return value_m - self.shift_m(other)
        ego_half_m = self.boxes[self.ego].half_extent_m(0.0)
        other_half_m = self.boxes[other].half_extent_m(self._turn(other))
        if ego_half_m is None or other_half_m is None:
            condition.note(
                "the distance between boxes without dimensions is read as that of centres"
            )
            return value_m
        return value_m + ego_half_m + other_half_m

    def _turn(self, other: str) -> float:
        place, ego = self.positions.places.get(other), self.positions.places.get(self.ego)
        return 0.0 if place is None or ego is None else place.heading - ego.heading
