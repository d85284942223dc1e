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
"""Elements that only group actions."""


class PhaseEvent(NamedTuple):
    """An event, with its act and its actors."""

    act: Element
    event: Element
    actors: tuple[str, ...]


def steps(root: Element) -> Iterator[tuple[tuple[str, str], PhaseEvent]]:
    """Yield the events of all stories, by kind and name of the event itself, its actions, and all parts around it."""
    for story in root.all("Storyboard", "Story"):
        for act in story.all("Act"):
            for group in act.within("ManeuverGroup"):
                actors = tuple(
                    element.get("entityRef") for element in group.all("Actors", "EntityRef")
                )
                for maneuver in group.all("Maneuver"):
                    for event in maneuver.all("Event"):
                        parts = (story, act, group, maneuver, event, *event.all("Action"))
                        step = PhaseEvent(act, event, actors)
                        yield from ((_kind_and_name(part), step) for part in parts)


def _kind_and_name(part: Element) -> tuple[str, str]:
    """Return how `StoryboardElementStateCondition` refers to a part."""
    return f"{part.name[0].lower()}{part.name[1:]}", part.get("name")


def leaves(action: Element) -> Iterator[Element]:
    """Yield the actions themselves below their grouping elements."""
    for node in action.children():
        if node.name in _GROUPS:
            yield from leaves(node)
        else:
            yield node


def duration(event: Element, speed: float) -> float | None:
    """Return how long an event of an entity takes, s, or `None` if one of its actions has no known end."""
    durations_s = [
        _action_duration(node.touch(), speed)
        for action in event.all("Action")
        for node in leaves(action)
    ]
    known_s = [duration_s for duration_s in durations_s if duration_s is not None]
    return max(known_s, default=0.0) if len(known_s) == len(durations_s) else None


def _action_duration(node: Element, speed: float) -> float | None:
    if node.name == "LaneChangeAction":
        relative = node.first("LaneChangeTarget", "RelativeTargetLane")
        # An absolute one is taken for the next: the lane of the entity by then is not known.
        return lane_change_s(node, speed, 1 if relative is None else relative.integer("value"))
    target = node.first("SpeedActionTarget", "AbsoluteTargetSpeed")
    if node.name != "SpeedAction" or target is None:
        return None
    return speed_change_s(node, speed, target.number("value"))
