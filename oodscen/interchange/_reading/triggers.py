"""Triggers of a scene for the conditions of an OpenSCENARIO file."""

import math
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Literal, NamedTuple

from lxml import etree

from oodscen.data._scene import MAX_TRIGGER, Trigger
from oodscen.interchange._reading.phases import PhaseEvent, duration, steps
from oodscen.interchange._reading.positions import EntityPlace, Positions
from oodscen.interchange._reading.tree import Element

AT_ONCE = Trigger()
AT_ONCE_S = 0.5
"""Time up to which an event belongs to the start, s."""

STANDS = 0.1
"""Speed below which an entity counts as standing, m/s."""
_NEAR_M = 0.1
"""Difference of two distances that is not worth a note, m."""
_SOON = ("lessThan", "lessOrEqual")
_LATE = ("greaterThan", "greaterOrEqual", "equalTo")
_STARTED = ("startTransition", "runningState")
_ENDED = ("endTransition", "completeState")
_MOST_CHAINED = 20
"""Number of events that wait for each other up to which their starts are followed."""
_ALONG = ("longitudinal", "cartesianDistance", "euclidianDistance")
"""Kinds of distances that are taken along the road; the others are not read."""
_OF_LANES = ("entity", "lane", "road")


class _UnreadError(Exception):
    """A condition for which a scene has no trigger, with the reason."""


class EntityBox(NamedTuple):
    """The box of an entity, as far as a file tells it."""

    ahead: float
    """From its reference point to its centre, m."""
    length: float | None
    width: float | None

    def reach(self, turn: float) -> float | None:
        """Return half its extent along a road from which it is turned, m."""
        if self.length is None or self.width is None:
            return None
        return 0.5 * (self.length * abs(math.cos(turn)) + self.width * abs(math.sin(turn)))


def body_of(entity: Element) -> EntityBox:
    """Return the box of a scenario object."""
    box = next(entity.within("BoundingBox"), None)
    if box is None:
        return EntityBox(0.0, None, None)
    middle, size = box.first("Center"), box.first("Dimensions")
    ahead = middle.number("x", 0.0) if middle is not None else 0.0
    if size is None:
        return EntityBox(ahead, None, None)
    return EntityBox(ahead, size.number("length"), size.number("width"))


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
        self.bodies = {name: body_of(entity) for name, entity in entities.items()}
        self.ego = ego
        self.speeds: dict[str, float] = {}
        """Speeds at the start, m/s."""
        self.identifier = identifier
        self.steps: dict[tuple[str, str], list[PhaseEvent]] = {}
        for key, step in steps(root):
            self.steps.setdefault(key, []).append(step)
        self._starts: dict[etree._Element, Trigger | None] = {}
        self._followed: list[etree._Element] = []

    def start(self, act: Element, event: Element, owner: str) -> Trigger | None:
        """Return when an event of an entity starts, which is after its act, or `None` if that is not known."""
        first, then = self._read(act, owner), self._read(event, owner)
        if first is None or then is None:
            return None
        both = later(first, then)
        if both is None:
            event.note(f"the act starts by a {first.kind}, the event by a {then.kind}: that counts")
        return both or then

    def _read(self, holder: Element, owner: str) -> Trigger | None:
        """Return when an event or act starts for an entity: what has no condition, at once; `None` if none is read."""
        conditions = holder.all("StartTrigger", "ConditionGroup", "Condition")
        if len(conditions) > 1:
            holder.note("of several conditions the first that is known counts")
        found = None
        for condition in conditions:
            if found is None:
                found = self._condition(condition, owner)
            else:
                condition.settle()
        return found if conditions else AT_ONCE

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
        other = condition.first("ByValueCondition", "StoryboardElementStateCondition")
        return None if other is None else self._by_state(other, owner)

    # ------------------------------------------------------------------ conditions on other events

    def _by_state(self, other: Element, owner: str) -> Trigger:
        """Return the trigger for the state of another part of the storyboard."""
        kind, name = other.get("storyboardElementType"), other.get("storyboardElementRef")
        state = other.get("state")
        events = self.steps.get((kind, name), [])
        if state in _ENDED:
            return self._ended(other, events)
        if state not in _STARTED:
            raise _UnreadError(f"the state {state[:40]!r} is not read")
        if kind in ("event", "action") and len(events) == 1:
            return self._started(events[0], owner)
        if kind not in ("story", "storyboard"):
            if not events:
                raise _UnreadError(f"there is no {kind[:40]} {name[:40]!r}")
            other.note(f"the start of {kind[:40]} {name[:40]!r} is read as that of the scene")
        return AT_ONCE

    def _started(self, step: PhaseEvent, owner: str) -> Trigger:
        """Return the trigger of another event, for an entity."""
        trigger = self._followed_to(step)
        if trigger is None:
            raise _UnreadError("the start of this is not known")
        if trigger.kind == "time" or trigger.actor or step.actors[0] in (owner, self.ego):
            return trigger
        return trigger.model_copy(update={"actor": self.identifier(step.actors[0])})

    def _ended(self, other: Element, found: list[PhaseEvent]) -> Trigger:
        """Return the time at which all of some events have ended."""
        ends = [end for step in found if (end := self._end(step)) is not None]
        if not ends or len(ends) < len(found):
            raise _UnreadError("the end of this is not known")
        latest = _trigger("time", max(ends), other)
        other.note(f"its end is read as the time {latest.value:g} s")
        return latest

    def _end(self, step: PhaseEvent) -> float | None:
        """Return when an event ends, s, if it starts at a time and what it does has an end."""
        start = self._followed_to(step)
        if start is None or start.kind != "time":
            return None
        lasts = duration(step.event, self.speeds.get(step.actors[0], 0.0))
        return None if lasts is None else start.value + lasts

    def _followed_to(self, step: PhaseEvent) -> Trigger | None:
        """Return when an event starts, `None` if it waits for itself, for too many others, or for nothing known."""
        element = step.event.element
        if element in self._starts:
            return self._starts[element]
        is_ring = element in self._followed
        if (
            is_ring
            or len(self._followed) >= _MOST_CHAINED
            or not self.bodies.keys() >= set(step.actors[:1])
        ):
            return None
        self._followed.append(element)
        self._starts[element] = self.start(step.act, step.event, step.actors[0])
        self._followed.pop()
        return self._starts[element]

    # ------------------------------------------------------------------ conditions on entities

    def _by_entity(self, condition: Element, owner: str) -> Trigger:
        """Return the trigger for a condition on one entity."""
        for node in _children(condition.first("ByEntityCondition", "EntityCondition")):
            if node.name in _READERS:
                name = self._subject(condition)
                return _READERS[node.name](self, node.touched(), name, owner)
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

    def _other(self, name: str, reference: Element) -> str:
        """Return the entity to which the ego's distance is meant."""
        other = reference.get("entityRef")
        for one in (name, other):
            if one not in self.bodies:
                raise _UnreadError(f"there is no entity {one[:40]!r}")
        if self.ego not in (name, other) or name == other:
            raise _UnreadError(
                f"a condition of {name[:40]} and {other[:40]}, not of the ego, is not read"
            )
        return other if name == self.ego else name

    def _first_speed(self, name: str) -> float:
        """Return the speed by which a distance is read as a time, or the reverse."""
        speed = self.speeds.get(name, 0.0)
        if speed < STANDS:
            raise _UnreadError(f"{name[:40]!r} has no speed by which this could be read")
        return speed

    def _distance(self, node: Element, name: str, owner: str) -> Trigger:
        other = self._other(name, node)
        _check_along(node)
        return self._to(other, owner, "distance", node, self._centres(node, other, 1.0))

    def _headway(self, node: Element, name: str, owner: str) -> Trigger:
        other, speed = self._other(name, node), self._first_speed(name)
        _check_along(node)
        node.note(f"a headway is read as a distance at the first speed of {name[:40]}")
        return self._to(other, owner, "distance", node, self._centres(node, other, speed))

    def _time_to_collision(self, node: Element, name: str, owner: str) -> Trigger:
        _check_along(node)
        target = node.first("TimeToCollisionConditionTarget", "EntityRef")
        goal = node.first("TimeToCollisionConditionTarget", "Position")
        if target is not None:
            other = self._other(name, target)
        elif goal is not None and name == self.ego:
            other = owner
            goal.leave_out(f"the time to this place is read as that to {owner[:40]}")
        else:
            raise _UnreadError("a time to collision without the ego is not read")
        if node.is_true("freespace"):
            node.note("the time to contact is read as that of the centres")
        return self._to(other, owner, "ttc", node, node.number("value"))

    def _travelled(self, node: Element, name: str, owner: str) -> Trigger:
        speed = self._first_speed(name)
        node.note(f"a distance travelled is read as a time at the first speed of {name[:40]}")
        return _trigger("time", node.number("value") / speed, node)

    def _near_place(self, node: Element, name: str, owner: str) -> Trigger:
        """Read a place that the ego comes near to: as a distance to its owner if that stands, else as a time."""
        if name != self.ego:
            raise _UnreadError(f"a place that {name[:40]} comes near to is not read")
        holder, ego = node.first("Position"), self.positions.known[self.ego]
        place = self.positions.read(holder) if holder is not None else None
        if place is None:
            raise _UnreadError("the place is not read")
        if node.name == "DistanceCondition":
            _check_along(node)
        reach = self._reach(node)
        its = self.positions.known.get(owner)
        if its is not None and self.speeds.get(owner, 0.0) < STANDS:
            return self._to_standing(node, its, place, reach, owner)
        ahead, aside = place.offset_from(ego)
        if ahead < 0.0:
            raise _UnreadError("a place that is not ahead is not read")
        speed = self._first_speed(name)
        node.note("a place that the ego comes near to is read as a time at its first speed")
        return _trigger("time", max(math.hypot(ahead, aside) - reach, 0.0) / speed, node)

    def _reach(self, node: Element) -> float:
        """Return the distance from a place to the ego's reference point at which a condition holds, m."""
        if node.name == "ReachPositionCondition":
            return node.number("tolerance")
        body = self.bodies[self.ego]
        if node.is_true("freespace"):
            return node.number("value") + body.ahead + (body.reach(0.0) or 0.0)
        return node.number("value")

    def _to_standing(
        self, node: Element, its: EntityPlace, place: EntityPlace, reach: float, owner: str
    ) -> Trigger:
        """Return the ego's distance to an owner that stands when it is near a place."""
        ego = self.positions.known[self.ego]
        apart = its.offset_from(ego)[0] - place.offset_from(ego)[0]
        value = apart + reach - self._shift(owner)
        if abs(value - reach) > _NEAR_M:
            node.note(f"a place is read as a distance to {owner[:40]}, {value:.1f} m")
        return self._to(owner, owner, "distance", node, value)

    # ------------------------------------------------------------------ distances

    def _to(
        self, other: str, owner: str, kind: Literal["distance", "ttc"], node: Element, value: float
    ) -> Trigger:
        """Return a trigger on the ego and another entity."""
        trigger = _trigger(kind, value, node)
        if other in (owner, self.ego):
            return trigger
        return trigger.model_copy(update={"actor": self.identifier(other)})

    def _turn(self, other: str) -> float:
        its, ego = self.positions.known.get(other), self.positions.known.get(self.ego)
        return 0.0 if its is None or ego is None else its.heading - ego.heading

    def _shift(self, other: str) -> float:
        """Return the distance of the reference points of the ego and another less that of their centres, m."""
        its, ego = self.positions.known.get(other), self.positions.known.get(self.ego)
        ahead = self.bodies[other].ahead * math.cos(self._turn(other))
        shift = self.bodies[self.ego].ahead - ahead
        if its is not None and ego is not None and its.offset_from(ego)[0] < 0.0:
            return -shift
        return shift

    def _centres(self, node: Element, other: str, scale: float) -> float:
        """Return the distance of the centres for that of the boxes or reference points that a condition means."""
        value = node.number("value") * scale
        if not node.is_true("freespace"):
            return value - self._shift(other)
        halves = (
            self.bodies[self.ego].reach(0.0),
            self.bodies[other].reach(self._turn(other)),
        )
        if halves[0] is None or halves[1] is None:
            node.note("the distance between boxes without dimensions is read as that of centres")
            return value
        return value + halves[0] + halves[1]


_READERS: dict[str, Callable[[TriggerReader, Element, str, str], Trigger]] = {
    "TimeToCollisionCondition": TriggerReader._time_to_collision,
    "RelativeDistanceCondition": TriggerReader._distance,
    "TimeHeadwayCondition": TriggerReader._headway,
    "TraveledDistanceCondition": TriggerReader._travelled,
    "DistanceCondition": TriggerReader._near_place,
    "ReachPositionCondition": TriggerReader._near_place,
}


def is_start(trigger: Trigger) -> bool:
    """Return whether a trigger belongs to the start of a scene."""
    return trigger.kind == "time" and trigger.value <= AT_ONCE_S


def later(first: Trigger, then: Trigger) -> Trigger | None:
    """Return when both of two triggers have fired, or `None` if no single one says that."""
    if first == AT_ONCE:
        return then
    if then == AT_ONCE:
        return first
    if first.kind == then.kind == "time":
        return max(first, then, key=lambda trigger: trigger.value)
    return None


def _trigger(kind: Literal["time", "distance", "ttc"], value: float, node: Element) -> Trigger:
    kept = node.bounded(value, 0.0, MAX_TRIGGER, f"a {kind} of")
    return Trigger(kind=kind, value=round(kept, 3))


def _after(time: Element) -> Trigger:
    """Return the trigger for a condition on the time."""
    rule = time.get("rule")
    if rule in _LATE:
        return _trigger("time", time.number("value"), time)
    if rule in (*_SOON, "notEqualTo") and time.number("value") > 0.0:
        time.note(f"rule={rule!r} holds from the start")
        return AT_ONCE
    raise _UnreadError(f"rule={rule[:40]!r} is not read")


def _delayed(condition: Element, trigger: Trigger) -> Trigger:
    """Return a trigger with the delay of its condition, which only a time can have."""
    delay = condition.number("delay", 0.0)
    if trigger.kind == "time":
        return _trigger("time", trigger.value + delay, condition) if delay else trigger
    if delay:
        condition.note(f"the delay of {delay:g} s after a {trigger.kind} is left out")
    return trigger


def _check_along(node: Element) -> None:
    """Refuse a condition that does not hold from a distance or time along the road on."""
    rule = node.get("rule")
    if rule not in _SOON:
        raise _UnreadError(f"rule={rule[:40]!r} is not read")
    kind = node.get("relativeDistanceType") or "longitudinal"
    if kind not in _ALONG:
        raise _UnreadError(f"a {kind[:40]} distance is not read")
    if kind != "longitudinal" and node.name == "RelativeDistanceCondition":
        node.note(f"a {kind} is read as a distance along the road")
    system = node.get("coordinateSystem", "entity")
    if system not in _OF_LANES:
        raise _UnreadError(f"coordinateSystem={system[:40]!r} is not read")
    node.get("alongRoute")


def _children(holder: Element | None) -> Iterator[Element]:
    return iter(()) if holder is None else holder.children()
