"""Actions of the entities of an OpenSCENARIO file: at its start, and in its events."""

import math
from collections.abc import Callable
from typing import Literal, NamedTuple

from oodscen.data._scene import MAX_SPEED, MAX_TRIGGER, Trigger
from oodscen.interchange._reading.courses import (
    CoursePoint,
    course_points,
    course_start,
    course_times,
    note_bends,
    note_paces,
    timing_of,
)
from oodscen.interchange._reading.dynamics import deceleration, is_gradual, lane_change_s
from oodscen.interchange._reading.phases import leaves
from oodscen.interchange._reading.positions import EntityPlace, Positions
from oodscen.interchange._reading.tree import Element
from oodscen.interchange._reading.triggers import (
    AT_ONCE,
    STANDING_MPS,
    TriggerReader,
    is_start,
)

Kind = Literal["lane_change", "brake", "course", "start"]

_SHORTEST_COURSE_M = 0.1
_LATER = Trigger(value=MAX_TRIGGER)
"""The trigger of events of the ego that do not start at once: a driver drives it by then."""


class Action(NamedTuple):
    """One action of an entity that changes its motion, and when it starts."""

    kind: Kind
    node: Element
    trigger: Trigger
    parameters: dict[str, float]
    """Parameters of the behaviour that it gives."""
    heading: float | None = None
    """Direction in which a course leads, rad."""


class ActionReader:
    """Reads the first speeds of all entities, and their actions."""

    def __init__(
        self, root: Element, positions: Positions, triggers: TriggerReader, ego: str
    ) -> None:
        self.root = root
        self.positions = positions
        self.triggers = triggers
        self.ego = ego
        self.speeds = triggers.speeds
        self.actions: dict[str, list[Action]] = {}
        self.unstarted: list[tuple[str, Element]] = []
        """Entities and events of which no condition is read."""

    def read(self) -> None:
        """Read the speeds of the start, then the events of all stories."""
        for private in self.root.all("Storyboard", "Init", "Actions", "Private"):
            name = private.get("entityRef")
            if name not in self.triggers.boxes:
                private.leave_out(f"there is no entity {name[:40]!r}")
                continue
            for action in private.all("PrivateAction"):
                self._read_action(name, action, AT_ONCE)
        for act in self.root.all("Storyboard", "Story", "Act"):
            for group in act.within("ManeuverGroup"):
                self._read_group(act, group)
        self._settle_unstarted()

    def _read_group(self, act: Element, group: Element) -> None:
        """Read the events of a group for its entities, and settle those of which a scene holds nothing."""
        names = self._actors(group)
        if not names:
            group.leave_out("nobody who is in the file does this")
            return
        for event in group.within("Event"):
            is_held = [self._read_event(act, event, name) for name in names]
            if not any(is_held):
                event.settle()

    def _actors(self, group: Element) -> list[str]:
        names = []
        for element in group.all("Actors", "EntityRef"):
            name = element.get("entityRef")
            if name in self.triggers.boxes:
                names.append(name)
            else:
                element.leave_out(f"there is no entity {name[:40]!r}")
        return names

    def _read_event(self, act: Element, event: Element, name: str) -> bool:
        """Read the actions of an entity in an event, and return whether a scene holds any of them."""
        trigger = self._start(act, event, name)
        if trigger is None:
            self.unstarted.append((name, event))
            return True
        return self._read_actions(event, name, trigger)

    def _read_actions(self, event: Element, name: str, trigger: Trigger) -> bool:
        is_held = [self._read_action(name, action, trigger) for action in event.all("Action")]
        return any(is_held)

    def _start(self, act: Element, event: Element, name: str) -> Trigger | None:
        """Return when an event starts, `None` if that is not known."""
        if name == self.ego:
            starts_at_once = all(map(self.triggers.is_at_once, (act, event)))
            return AT_ONCE if starts_at_once else _LATER
        return self.triggers.start(act, event, name)

    def _settle_unstarted(self) -> None:
        """Start the events whose start is not known at once where an entity does nothing else, or leave them out."""
        for name, event in self.unstarted:
            if name in self.actions or self.speeds.get(name, 0.0) >= STANDING_MPS:
                event.leave_out(f"when it starts is not known: {name[:40]} does not do this")
            else:
                event.note(f"when it starts is not known: {name[:40]} does this at once")
                self._read_actions(event, name, AT_ONCE)

    def _read_action(self, name: str, action: Element, trigger: Trigger) -> bool:
        """Read the actions in an element, and return whether a scene holds any of them."""
        is_held = [self._read_leaf(name, node, trigger) for node in leaves(action)]
        return any(is_held)

    def _read_leaf(self, name: str, node: Element, trigger: Trigger) -> bool:
        if node.name == "TeleportAction":
            if trigger != AT_ONCE:
                node.leave_out("no behaviour does this")
            return trigger == AT_ONCE
        if name == self.ego and not (node.name == "SpeedAction" and is_start(trigger)):
            node.leave_out("the ego is driven by a driver")
        elif node.name not in _READERS:
            node.leave_out("no behaviour does this")
        else:
            _READERS[node.name](self, name, node.touch(), trigger)
        return node.element not in node.tree.settled

    def _add(self, name: str, action: Action) -> None:
        self.actions.setdefault(name, []).append(action)

    def _speed(self, name: str, node: Element, trigger: Trigger) -> None:
        before, target = self.speeds.get(name, 0.0), self._target_speed(node)
        if target is None:
            node.leave_out("the target speed is not read")
            return
        target = node.bounded(target, 0.0, MAX_SPEED, "a speed of")
        is_stop = target < STANDING_MPS <= before
        is_braking = is_stop and is_gradual(node, "SpeedActionDynamics")
        if is_start(trigger) and not is_braking:
            self._set_speed(name, node, target)
        elif name == self.ego:
            node.leave_out("the ego is driven by a driver")
        elif is_stop:
            parameters = {"deceleration": deceleration(node, before)}
            self._add(name, Action("brake", node, trigger, parameters))
        elif before < STANDING_MPS <= target:
            self._add(name, Action("start", node, trigger, {"speed": target}))
            _leave_out_dynamics(node)
        else:
            node.leave_out(f"no behaviour changes the speed from {before:.1f} to {target:.1f} m/s")

    def _set_speed(self, name: str, node: Element, speed: float) -> None:
        """Set the first speed of an entity, and record which one it replaces."""
        before = self.speeds.get(name, 0.0)
        if before >= STANDING_MPS and before != speed:
            node.note(f"the first speed is {speed:g} m/s, in place of {before:g} m/s")
        self.speeds[name] = speed
        _leave_out_dynamics(node)

    def _target_speed(self, node: Element) -> float | None:
        absolute = node.first("SpeedActionTarget", "AbsoluteTargetSpeed")
        if absolute is not None:
            return absolute.number("value")
        relative = node.first("SpeedActionTarget", "RelativeTargetSpeed")
        if relative is None:
            return None
        other = relative.get("entityRef")
        if other not in self.triggers.boxes:
            relative.note(f"there is no entity {other[:40]!r}")
            return None
        other_speed, value = self.speeds.get(other, 0.0), relative.number("value")
        if relative.word("speedTargetValueType", "delta", "factor") == "factor":
            return other_speed * value
        return other_speed + value

    def _lane_change(self, name: str, node: Element, trigger: Trigger) -> None:
        place = self.positions.in_lane(name)
        target = None if place is None or not place.lane else self._target_lane(node)
        if place is None or target is None:
            node.leave_out("the lane is not known")
        elif target == place.lane:
            node.leave_out("it is in that lane already")
        elif not self.positions.roads.has_lane(place.road, place.s, target):
            node.leave_out(f"road {place.road[:40]!r} has no lane {target} at {place.s:g} m")
        else:
            lanes = place.lanes_to(target) * self._ego_direction(place)
            duration_s = lane_change_s(node, self.speeds.get(name, 0.0), lanes)
            parameters = {"lanes": float(lanes), "duration": duration_s}
            self._add(name, Action("lane_change", node, trigger, parameters))

    def _ego_direction(self, place: EntityPlace) -> int:
        """Return +1 if the ego drives along the reference line of the road of a place, else -1."""
        ego = self.positions.places.get(self.ego)
        return place.direction if ego is None else self.positions.roads.direction_beside(ego, place)

    def _target_lane(self, node: Element) -> int | None:
        """Return the id of the lane into which an entity changes, if it is known."""
        absolute = node.first("LaneChangeTarget", "AbsoluteTargetLane")
        if absolute is not None:
            return absolute.integer("value")
        relative = node.first("LaneChangeTarget", "RelativeTargetLane")
        if relative is None:
            return None
        place = self.positions.in_lane(relative.get("entityRef"))
        if place is None or not place.lane:
            return None
        return place.lane_beside(relative.integer("value"))

    def _course(self, name: str, node: Element, trigger: Trigger) -> None:
        """Add a straight way from the first to the last point of a course."""
        points = course_points(node, self.positions)
        start = self._course_origin(name, points)
        if start is None or not points:
            node.leave_out("the course has no points that are read")
            return
        end = points[-1].place
        length_m = math.hypot(end.x - start.x, end.y - start.y)
        if length_m < _SHORTEST_COURSE_M:
            node.leave_out("the course leads nowhere")
            return
        heading = math.atan2(end.y - start.y, end.x - start.x)
        parameters = {"distance": length_m}
        times = course_times(node, points)
        if times is not None:
            note_paces(node, points)
            if self._has_times(name, node):
                parameters["speed"] = length_m / times.duration_s
                trigger = course_start(node, trigger, times.begin_s)
        note_bends(node, points, start, heading)
        self._add(name, Action("course", node, trigger, parameters, heading))

    def _course_origin(self, name: str, points: list[CoursePoint]) -> EntityPlace | None:
        """Return the place of an entity at the start, which is that of a course's first point if it has no other."""
        if name not in self.positions.places and points:
            self.positions.places[name] = points[0].place
        return self.positions.places.get(name)

    def _has_times(self, name: str, node: Element) -> bool:
        """Return whether the times of a course count: without a time reference only for what stands."""
        if timing_of(node) is not None:
            return True
        if self.speeds.get(name, 0.0) >= STANDING_MPS:
            return False
        node.note("the times of the course count though the entity has no speed of its own")
        return True


_READERS: dict[str, Callable[[ActionReader, str, Element, Trigger], None]] = {
    "SpeedAction": ActionReader._speed,
    "LaneChangeAction": ActionReader._lane_change,
    "FollowTrajectoryAction": ActionReader._course,
    "AcquirePositionAction": ActionReader._course,
    "AssignRouteAction": ActionReader._course,
}


def _leave_out_dynamics(node: Element) -> None:
    """Record that it is left out how a speed is reached, unless that is at once."""
    if is_gradual(node, "SpeedActionDynamics"):
        node.note("how the speed is reached is left out")
