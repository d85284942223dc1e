"""Triggers of a scene for the conditions of an OpenSCENARIO file."""

import math
from collections.abc import Callable
from contextlib import suppress
from typing import Literal

from lxml import etree

from oodscen.data._scene import MAX_TRIGGER, Trigger
from oodscen.interchange._reading.boxes import EgoDistances, box_of
from oodscen.interchange._reading.phases import PhaseEvent, duration, steps
from oodscen.interchange._reading.positions import EntityPlace, Positions
from oodscen.interchange._reading.tree import Element

AT_ONCE = Trigger()
_START_S = 0.5
"""Time up to which an event belongs to the start, s."""
STANDING_MPS = 0.1
"""Speed below which an entity counts as standing, m/s."""
_NEAR_M = 0.1
"""Difference of two distances that is not worth a note, m."""
_UPPER_BOUNDS = ("lessThan", "lessOrEqual")
_LOWER_BOUNDS = ("greaterThan", "greaterOrEqual", "equalTo")
_STARTED = ("startTransition", "runningState")
_ENDED = ("endTransition", "completeState")
_MAX_CHAINED = 20
"""Number of events that wait for each other up to which their starts are followed."""
_ALONG = ("longitudinal", "cartesianDistance", "euclidianDistance")
"""Kinds of distances that are taken along the road; the others are not read."""
_COORDINATE_SYSTEMS = ("entity", "lane", "road")


class _UnreadError(Exception):
    """A condition for which a scene has no trigger, with the reason."""


class TriggerReader:
    """Reads when things start: a scene knows times, and distances and times to collision from the ego."""

    def __init__(
        self,
        root: Element,
        positions: Positions,
        entities: dict[str, Element],
        ego: str,
        identifier: Callable[[str], str],
    ) -> None:
        self.positions = positions
        self.boxes = {name: box_of(entity) for name, entity in entities.items()}
        self.distances = EgoDistances(positions, self.boxes, ego)
        self.ego = ego
        self.speeds: dict[str, float] = {}
        """Speeds at the start, m/s."""
        self.identifier = identifier
        self.steps: dict[tuple[str, str], list[PhaseEvent]] = {}
        for key, step in steps(root):
            self.steps.setdefault(key, []).append(step)
        self._starts: dict[etree._Element, Trigger | None] = {}
        self._following: list[etree._Element] = []
        """Events whose starts are being worked out, each waiting for the next."""

    def start(self, act: Element, event: Element, owner: str) -> Trigger | None:
        """Return when an event of an entity starts, which is after its act, or `None` if that is not known."""
        of_act, of_event = self._read(act, owner), self._read(event, owner)
        if of_act is None or of_event is None:
            return None
        both = later(of_act, of_event)
        if both is None:
            event.note(
                f"the act starts by a {of_act.kind}, the event by a {of_event.kind}: that counts"
            )
            return of_event
        return both

    def _read(self, holder: Element, owner: str) -> Trigger | None:
        """Return when an event or act starts for an entity: at once without a condition; `None` if none is read."""
        conditions = holder.all("StartTrigger", "ConditionGroup", "Condition")
        if not conditions:
            return AT_ONCE
        if len(conditions) > 1:
            holder.note("of several conditions the first that is known counts")
        trigger = None
        for condition in conditions:
            if trigger is None:
                trigger = self._condition(condition, owner)
            else:
                condition.settle()
        return trigger

    def is_at_once(self, holder: Element) -> bool:
        """Return whether something starts at once, or within the time that belongs to the start."""
        conditions = holder.all("StartTrigger", "ConditionGroup", "Condition")
        if len(conditions) != 1:
            return not conditions
        with suppress(_UnreadError):
            trigger = self._by_value(conditions[0], self.ego)
            return trigger is not None and is_start(_delayed(conditions[0], trigger))
        return False

    def _condition(self, condition: Element, owner: str) -> Trigger | None:
        """Return the trigger for a condition, or `None` after recording why there is none."""
        try:
            trigger = self._by_value(condition, owner) or self._by_entity(condition, owner)
        except _UnreadError as error:
            condition.leave_out(str(error))
            return None
        return _delayed(condition, trigger)

    def _by_value(self, condition: Element, owner: str) -> Trigger | None:
        """Return the trigger for a condition on the time or on another element, `None` for one on entities."""
        time = condition.first("ByValueCondition", "SimulationTimeCondition")
        if time is not None:
            return _after(time)
        state = condition.first("ByValueCondition", "StoryboardElementStateCondition")
        return None if state is None else self._by_state(state, owner)

    def _by_state(self, condition: Element, owner: str) -> Trigger:
        """Return the trigger for the state of another part of the storyboard."""
        kind = condition.get("storyboardElementType")
        name = condition.get("storyboardElementRef")
        state = condition.get("state")
        events = self.steps.get((kind, name), [])
        if state in _ENDED:
            return self._ended(condition, events)
        if state not in _STARTED:
            raise _UnreadError(f"the state {state[:40]!r} is not read")
        if kind in ("event", "action") and len(events) == 1:
            return self._started(events[0], owner)
        if kind not in ("story", "storyboard"):
            if not events:
                raise _UnreadError(f"there is no {kind[:40]} {name[:40]!r}")
            condition.note(f"the start of {kind[:40]} {name[:40]!r} is read as that of the scene")
        return AT_ONCE

    def _started(self, step: PhaseEvent, owner: str) -> Trigger:
        """Return the trigger of another event, for an entity."""
        trigger = self._followed_start(step)
        if trigger is None:
            raise _UnreadError("the start of this is not known")
        if trigger.kind == "time" or trigger.actor or step.actors[0] in (owner, self.ego):
            return trigger
        return trigger.model_copy(update={"actor": self.identifier(step.actors[0])})

    def _ended(self, condition: Element, events: list[PhaseEvent]) -> Trigger:
        """Return the time at which all of some events have ended."""
        ends_s = [end_s for event in events if (end_s := self._end_s(event)) is not None]
        if not ends_s or len(ends_s) < len(events):
            raise _UnreadError("the end of this is not known")
        latest = _trigger("time", max(ends_s), condition)
        condition.note(f"its end is read as the time {latest.value:g} s")
        return latest

    def _end_s(self, step: PhaseEvent) -> float | None:
        """Return when an event ends, s, if it starts at a time and its actions have an end."""
        start = self._followed_start(step)
        if start is None or start.kind != "time":
            return None
        duration_s = duration(step.event, self.speeds.get(step.actors[0], 0.0))
        return None if duration_s is None else start.value + duration_s

    def _followed_start(self, step: PhaseEvent) -> Trigger | None:
        """Return when an event starts.

        It is `None` for an event without entities, and for one that waits for itself, for too many others, or
        for something unknown.
        """
        element = step.event.element
        if element in self._starts:
            return self._starts[element]
        is_ring = element in self._following
        if is_ring or len(self._following) >= _MAX_CHAINED:
            return None
        if not step.actors or step.actors[0] not in self.boxes:
            return None
        self._following.append(element)
        self._starts[element] = self.start(step.act, step.event, step.actors[0])
        self._following.pop()
        return self._starts[element]

    def _by_entity(self, condition: Element, owner: str) -> Trigger:
        """Return the trigger for a condition on one entity."""
        holder = condition.first("ByEntityCondition", "EntityCondition")
        for node in holder.children() if holder is not None else ():
            if node.name in _READERS:
                subject = self._subject(condition)
                return _READERS[node.name](self, node.touch(), subject, owner)
        raise _UnreadError("this condition is not read")

    def _subject(self, condition: Element) -> str:
        """Return the entity that meets a condition."""
        triggering = condition.first("ByEntityCondition", "TriggeringEntities")
        subjects = [] if triggering is None else triggering.all("EntityRef")
        if len(subjects) != 1:
            raise _UnreadError("a condition of several entities is not read")
        if triggering is not None and triggering.get("triggeringEntitiesRule") == "none":
            raise _UnreadError("a condition that no entity may meet is not read")
        return subjects[0].get("entityRef")

    def _other(self, subject: str, reference: Element) -> str:
        """Return the entity whose distance to the ego is meant."""
        referred = reference.get("entityRef")
        for name in (subject, referred):
            if name not in self.boxes:
                raise _UnreadError(f"there is no entity {name[:40]!r}")
        if self.ego not in (subject, referred) or subject == referred:
            raise _UnreadError(
                f"a condition of {subject[:40]} and {referred[:40]}, not of the ego, is not read"
            )
        return referred if subject == self.ego else subject

    def _first_speed(self, name: str) -> float:
        """Return the speed by which a distance is read as a time, or the reverse."""
        speed = self.speeds.get(name, 0.0)
        if speed < STANDING_MPS:
            raise _UnreadError(f"{name[:40]!r} has no speed by which this could be read")
        return speed

    def _distance(self, node: Element, subject: str, owner: str) -> Trigger:
        other = self._other(subject, node)
        _check_along(node)
        distance_m = self.distances.between_centres_m(node, other, node.number("value"))
        return self._to(other, owner, "distance", node, distance_m)

    def _headway(self, node: Element, subject: str, owner: str) -> Trigger:
        other, speed = self._other(subject, node), self._first_speed(subject)
        _check_along(node)
        node.note(f"a headway is read as a distance at the first speed of {subject[:40]}")
        headway_m = speed * node.number("value")
        distance_m = self.distances.between_centres_m(node, other, headway_m)
        return self._to(other, owner, "distance", node, distance_m)

    def _time_to_collision(self, node: Element, subject: str, owner: str) -> Trigger:
        _check_along(node)
        target = node.first("TimeToCollisionConditionTarget", "EntityRef")
        goal = node.first("TimeToCollisionConditionTarget", "Position")
        if target is not None:
            other = self._other(subject, target)
        elif goal is not None and subject == self.ego:
            other = owner
            goal.leave_out(f"the time to this place is read as that to {owner[:40]}")
        else:
            raise _UnreadError("a time to collision without the ego is not read")
        if node.is_true("freespace"):
            node.note("the time to contact is read as that of the centres")
        return self._to(other, owner, "ttc", node, node.number("value"))

    def _travelled(self, node: Element, subject: str, owner: str) -> Trigger:
        speed = self._first_speed(subject)
        node.note(f"a distance travelled is read as a time at the first speed of {subject[:40]}")
        return _trigger("time", node.number("value") / speed, node)

    def _near_place(self, node: Element, subject: str, owner: str) -> Trigger:
        """Read a place that the ego comes near to: as a distance to its owner if that stands, else as a time."""
        if subject != self.ego:
            raise _UnreadError(f"a place that {subject[:40]} comes near to is not read")
        position = node.first("Position")
        place = self.positions.read(position) if position is not None else None
        if place is None:
            raise _UnreadError("the place is not read")
        if node.name == "DistanceCondition":
            _check_along(node)
        reach_m = self._reach_m(node)
        own_place = self.positions.places.get(owner)
        if own_place is not None and self.speeds.get(owner, 0.0) < STANDING_MPS:
            return self._to_standing(node, own_place, place, reach_m, owner)
        ahead_m, left_m = place.offset_from(self.positions.places[self.ego])
        if ahead_m < 0.0:
            raise _UnreadError("a place that is not ahead is not read")
        speed = self._first_speed(subject)
        node.note("a place that the ego comes near to is read as a time at its first speed")
        return _trigger("time", max(math.hypot(ahead_m, left_m) - reach_m, 0.0) / speed, node)

    def _reach_m(self, node: Element) -> float:
        """Return the distance from a place to the ego's reference point at which a condition holds, m."""
        if node.name == "ReachPositionCondition":
            return node.number("tolerance")
        if node.is_true("freespace"):
            box = self.boxes[self.ego]
            return node.number("value") + box.ahead_m + (box.half_extent_m(0.0) or 0.0)
        return node.number("value")

    def _to_standing(
        self, node: Element, own_place: EntityPlace, place: EntityPlace, reach_m: float, owner: str
    ) -> Trigger:
        """Return the ego's distance to an owner that stands when it is near a place."""
        ego = self.positions.places[self.ego]
        apart_m = own_place.offset_from(ego)[0] - place.offset_from(ego)[0]
        distance_m = apart_m + reach_m - self.distances.shift_m(owner)
        if abs(distance_m - reach_m) > _NEAR_M:
            node.note(f"a place is read as a distance to {owner[:40]}, {distance_m:.1f} m")
        return self._to(owner, owner, "distance", node, distance_m)

    def _to(
        self, other: str, owner: str, kind: Literal["distance", "ttc"], node: Element, value: float
    ) -> Trigger:
        """Return a trigger on the ego and another entity."""
        trigger = _trigger(kind, value, node)
        if other in (owner, self.ego):
            return trigger
        return trigger.model_copy(update={"actor": self.identifier(other)})


_READERS: dict[str, Callable[[TriggerReader, Element, str, str], Trigger]] = {
    "TimeToCollisionCondition": TriggerReader._time_to_collision,
    "RelativeDistanceCondition": TriggerReader._distance,
    "TimeHeadwayCondition": TriggerReader._headway,
    "TraveledDistanceCondition": TriggerReader._travelled,
    "DistanceCondition": TriggerReader._near_place,
    "ReachPositionCondition": TriggerReader._near_place,
}
"""Readers of the conditions on entities: of the condition, the entity that meets it, and the one that then acts."""


def is_start(trigger: Trigger) -> bool:
    """Return whether a trigger belongs to the start of a scene."""
    return trigger.kind == "time" and trigger.value <= _START_S


def later(first: Trigger, second: Trigger) -> Trigger | None:
    """Return when both of two triggers have fired, or `None` if no single one says that."""
    if first == AT_ONCE:
        return second
    if second == AT_ONCE:
        return first
    if first.kind == second.kind == "time":
        return max(first, second, key=lambda trigger: trigger.value)
    return None


def _trigger(kind: Literal["time", "distance", "ttc"], value: float, node: Element) -> Trigger:
    nearest = node.bounded(value, 0.0, MAX_TRIGGER, f"a {kind} of")
    return Trigger(kind=kind, value=round(nearest, 3))


def _after(time: Element) -> Trigger:
    """Return the trigger for a condition on the time."""
    rule = time.get("rule")
    if rule in _LOWER_BOUNDS:
        return _trigger("time", time.number("value"), time)
    if rule in (*_UPPER_BOUNDS, "notEqualTo") and time.number("value") > 0.0:
        time.note(f"rule={rule!r} holds from the start")
        return AT_ONCE
    raise _UnreadError(f"rule={rule[:40]!r} is not read")


def _delayed(condition: Element, trigger: Trigger) -> Trigger:
    """Return a trigger with the delay of its condition, which only a time can have."""
    delay_s = condition.number("delay", 0.0)
    if trigger.kind == "time":
        return _trigger("time", trigger.value + delay_s, condition) if delay_s else trigger
    if delay_s:
        condition.note(f"the delay of {delay_s:g} s after a {trigger.kind} is left out")
    return trigger


def _check_along(node: Element) -> None:
    """Refuse a condition that does not hold from a distance or time along the road on."""
    rule = node.get("rule")
    if rule not in _UPPER_BOUNDS:
        raise _UnreadError(f"rule={rule[:40]!r} is not read")
    kind = node.get("relativeDistanceType") or "longitudinal"
    if kind not in _ALONG:
        raise _UnreadError(f"a {kind[:40]} distance is not read")
    if kind != "longitudinal" and node.name == "RelativeDistanceCondition":
        node.note(f"a {kind} is read as a distance along the road")
    system = node.get("coordinateSystem", "entity")
    if system not in _COORDINATE_SYSTEMS:
        raise _UnreadError(f"coordinateSystem={system[:40]!r} is not read")
    node.get("alongRoute")
