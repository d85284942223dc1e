"""The parts of a storyboard that wait for each other, and how long they take."""

from collections.abc import Iterator
from typing import NamedTuple

from oodscen.interchange._reading.dynamics import lane_change_s, speed_change_s
from oodscen.interchange._reading.tree import Element

_GROUPS = {
    "Action",
    "PrivateAction",
    "LongitudinalAction",
    "LateralAction",
    "RoutingAction",
}


class PhaseEvent(NamedTuple):
    """An event, with the act that it is in and those who do it."""

    act: Element
    event: Element
    actors: tuple[str, ...]


def steps(root: Element) -> Iterator[tuple[tuple[str, str], PhaseEvent]]:
    """Yield the events of all stories by kind and name of every part that they are, have, or are in."""
    for story in root.all("Storyboard", "Story"):
        for act in story.all("Act"):
            for group in act.within("ManeuverGroup"):
                names = tuple(
                    element.get("entityRef") for element in group.all("Actors", "EntityRef")
                )
                for maneuver in group.all("Maneuver"):
                    for event in maneuver.all("Event"):
                        parts = (story, act, group, maneuver, event, *event.all("Action"))
                        step = PhaseEvent(act, event, names)
                        yield from ((_key(part), step) for part in parts)


def _key(part: Element) -> tuple[str, str]:
    return f"{part.name[0].lower()}{part.name[1:]}", part.get("name")


def leaves(action: Element) -> Iterator[Element]:
    """Yield the actions themselves below their grouping elements."""
    for node in action.children():
        if node.name in _GROUPS:
            yield from leaves(node)
        else:
            yield node


def duration(event: Element, speed: float) -> float | None:
    """Return how long an event of an entity takes, s, or `None` if an action of it has no known end."""
    found = [
        _lasts(node.touch(), speed) for action in event.all("Action") for node in leaves(action)
    ]
    known = [one for one in found if one is not None]
    return max(known, default=0.0) if len(known) == len(found) else None


def _lasts(node: Element, speed: float) -> float | None:
    if node.name == "LaneChangeAction":
        return lane_change_s(node, speed)
    target = node.first("SpeedActionTarget", "AbsoluteTargetSpeed")
    if node.name != "SpeedAction" or target is None:
        return None
    return speed_change_s(node, speed, target.number("value"))
