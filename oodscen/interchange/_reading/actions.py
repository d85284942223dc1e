"""Behaviours for what the entities of an OpenSCENARIO file do."""

import math
from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Literal, NamedTuple

from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._scene import MAX_SPEED, MAX_TRIGGER, Behaviour, Trigger
from oodscen.interchange._reading.dynamics import deceleration, is_gradual, lane_change_s
from oodscen.interchange._reading.phases import leaves
from oodscen.interchange._reading.positions import EntityPlace, Positions
from oodscen.interchange._reading.tree import Element
from oodscen.interchange._reading.triggers import AT_ONCE, STANDS, TriggerReader, is_start

Kind = Literal["lane_change", "brake", "course", "start"]

_HARD = 3.0
"""Deceleration from which braking is hard, m/s^2."""
_WALK, _DRIVE, _DISTANCE_M, _STRAIGHT_M = 1.4, 8.0, 12.0, 1.0
_PACE_SHARE = 0.05
"""Share of the fastest part of a course by which its parts may differ without a note."""
_LATER = Trigger(value=MAX_TRIGGER)


class Action(NamedTuple):
    """One thing that an entity does, when, and how."""

    kind: Kind
    node: Element
    trigger: Trigger
    values: dict[str, float]
    heading: float | None = None
    """Direction in which a course leads, rad."""


class ActionReader:
    """Reads what every entity does."""

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
            if name not in self.triggers.bodies:
                private.leave_out(f"there is no entity {name[:40]!r}")
                continue
            for action in private.all("PrivateAction"):
                self._act(name, action, AT_ONCE)
        for act in self.root.all("Storyboard", "Story", "Act"):
            for group in act.within("ManeuverGroup"):
                self._group(act, group)
        self._settle_unstarted()

    def _group(self, act: Element, group: Element) -> None:
        """Read the events of a group for its entities, of which a scene may hold nothing."""
        names = self._actors(group)
        if not names:
            group.leave_out("nobody who is in the file does this")
            return
        for event in group.within("Event"):
            kept = [self._event(act, event, name) for name in names]
            if not any(kept):
                event.settle()

    def _actors(self, group: Element) -> list[str]:
        names = []
        for element in group.all("Actors", "EntityRef"):
            name = element.get("entityRef")
            if name in self.triggers.bodies:
                names.append(name)
            else:
                element.leave_out(f"there is no entity {name[:40]!r}")
        return names

    def _event(self, act: Element, event: Element, name: str) -> bool:
        """Read what an entity does in an event, and return whether a scene holds any of it."""
        trigger = self._start(act, event, name)
        if trigger is None:
            self.unstarted.append((name, event))
            return True
        return self._does(event, name, trigger)

    def _does(self, event: Element, name: str, trigger: Trigger) -> bool:
        kept = [self._act(name, action, trigger) for action in event.all("Action")]
        return any(kept)

    def _start(self, act: Element, event: Element, name: str) -> Trigger | None:
        """Return when an event starts, `None` if that is not known."""
        if name == self.ego:
            at_once = all(map(self.triggers.is_at_once, (act, event)))
            return AT_ONCE if at_once else _LATER
        return self.triggers.start(act, event, name)

    def _settle_unstarted(self) -> None:
        """Start the events whose start is not known at once where an entity does nothing else, or leave them out."""
        for name, event in self.unstarted:
            if name in self.actions or self.speeds.get(name, 0.0) >= STANDS:
                event.leave_out(f"when it starts is not known: {name[:40]} does not do this")
            else:
                event.note(f"when it starts is not known: {name[:40]} does this at once")
                self._does(event, name, AT_ONCE)

    # ------------------------------------------------------------------ actions

    def _act(self, name: str, action: Element, trigger: Trigger) -> bool:
        """Read the actions in an element, and return whether a scene holds any of them."""
        kept = [self._leaf(name, node, trigger) for node in leaves(action)]
        return any(kept)

    def _leaf(self, name: str, node: Element, trigger: Trigger) -> bool:
        if node.name == "TeleportAction":
            if trigger != AT_ONCE:
                node.leave_out("no behaviour does this")
            return trigger == AT_ONCE
        if name == self.ego and not (node.name == "SpeedAction" and is_start(trigger)):
            node.leave_out("the ego is driven by a driver")
        elif node.name not in _READERS:
            node.leave_out("no behaviour does this")
        else:
            _READERS[node.name](self, name, node.touched(), trigger)
        return node.element not in node.tree.settled

    def _add(self, name: str, action: Action) -> None:
        self.actions.setdefault(name, []).append(action)

    def _speed(self, name: str, node: Element, trigger: Trigger) -> None:
        before, target = self.speeds.get(name, 0.0), self._target(node)
        if target is None:
            node.leave_out("the target speed is not read")
            return
        target = node.bounded(target, 0.0, MAX_SPEED, "a speed of")
        is_stop = target < STANDS <= before
        if is_start(trigger) and not (is_stop and is_gradual(node, "SpeedActionDynamics")):
            self._set_speed(name, node, target)
        elif name == self.ego:
            node.leave_out("the ego is driven by a driver")
        elif is_stop:
            values = {"deceleration": deceleration(node, before)}
            self._add(name, Action("brake", node, trigger, values))
        elif before < STANDS <= target:
            self._add(name, Action("start", node, trigger, {"speed": target}))
            _leave_out_dynamics(node)
        else:
            node.leave_out(f"no behaviour changes the speed from {before:.1f} to {target:.1f} m/s")

    def _set_speed(self, name: str, node: Element, speed: float) -> None:
        """Set the first speed of an entity, and record which one it replaces."""
        before = self.speeds.get(name, 0.0)
        if before >= STANDS and before != speed:
            node.note(f"the first speed is {speed:g} m/s, in place of {before:g} m/s")
        self.speeds[name] = speed
        _leave_out_dynamics(node)

    def _target(self, node: Element) -> float | None:
        absolute = node.first("SpeedActionTarget", "AbsoluteTargetSpeed")
        if absolute is not None:
            return absolute.number("value")
        relative = node.first("SpeedActionTarget", "RelativeTargetSpeed")
        if relative is None:
            return None
        other = relative.get("entityRef")
        if other not in self.triggers.bodies:
            relative.note(f"there is no entity {other[:40]!r}")
            return None
        its = self.speeds.get(other, 0.0)
        value = relative.number("value")
        return (
            its * value
            if relative.word("speedTargetValueType", "delta", "factor") == "factor"
            else its + value
        )

    def _lane_change(self, name: str, node: Element, trigger: Trigger) -> None:
        own = self.positions.in_lane(name)
        target = None if own is None or not own.lane else self._target_lane(node)
        if own is None or target is None:
            node.leave_out("the lane is not known")
        elif target == own.lane:
            node.leave_out("it is in that lane already")
        elif not self.positions.roads.has_lane(own.road, own.s, target):
            node.leave_out(f"road {own.road[:40]!r} has no lane {target} at {own.s:g} m")
        else:
            lanes = own.lanes_to(target) * self._ego_direction(own)
            speed = self.speeds.get(name, 0.0)
            values = {"lanes": float(lanes), "duration": lane_change_s(node, speed)}
            self._add(name, Action("lane_change", node, trigger, values))

    def _ego_direction(self, own: EntityPlace) -> int:
        """Return +1 if the ego drives along the reference line of an entity's road, else -1."""
        ego = self.positions.known.get(self.ego)
        return own.direction if ego is None else self.positions.roads.direction_beside(ego, own)

    def _target_lane(self, node: Element) -> int | None:
        """Return the id of the lane into which an entity changes, if it is known."""
        absolute = node.first("LaneChangeTarget", "AbsoluteTargetLane")
        relative = node.first("LaneChangeTarget", "RelativeTargetLane")
        if absolute is not None:
            return absolute.integer("value")
        if relative is None:
            return None
        its = self.positions.in_lane(relative.get("entityRef"))
        if its is None or not its.lane:
            return None
        return its.lane_beside(relative.integer("value"))

    def _course(self, name: str, node: Element, trigger: Trigger) -> None:
        """Add a straight way from the first to the last point of a course."""
        points = [(vertex, pose) for vertex, pose in self._points(node) if pose is not None]
        start = self.positions.known.get(name)
        if start is None and points:
            start = self.positions.known[name] = points[0][1]
        if start is None or not points:
            node.leave_out("the course has no points that are read")
            return
        end = points[-1][1]
        way = math.hypot(end.x - start.x, end.y - start.y)
        if way < STANDS:
            node.leave_out("the course leads nowhere")
            return
        heading = math.atan2(end.y - start.y, end.x - start.x)
        values = {"distance": way}
        begin, seconds = _timed(node, [vertex for vertex, _ in points])
        if seconds > 0.0:
            _note_paces(node, points)
        if seconds > 0.0 and self._is_timed(name, node):
            values["speed"] = way / seconds
            trigger = self._begun(node, trigger, begin)
        if any(_aside(place, start, heading) > _STRAIGHT_M for _, place in points):
            node.note("the course is read as a straight way from its first point to its last")
        self._add(name, Action("course", node, trigger, values, heading))

    def _is_timed(self, name: str, node: Element) -> bool:
        """Return whether the times of a course count: without a time reference only for what stands."""
        if _timing(node) is not None:
            return True
        if self.speeds.get(name, 0.0) >= STANDS:
            return False
        node.note("the times of the course count though the entity has no speed of its own")
        return True

    def _begun(self, node: Element, trigger: Trigger, begin: float) -> Trigger:
        """Return when an entity leaves the first point of a course with times of its own."""
        timing = _timing(node)
        if timing is None:
            return trigger
        is_absolute = timing.word("domainAbsoluteRelative", "relative", "absolute") == "absolute"
        if not begin:
            return trigger
        if trigger.kind != "time":
            timing.note(f"the course begins at its {trigger.kind}, not at {begin:g} s")
            return trigger
        start = max(begin, trigger.value) if is_absolute else trigger.value + begin
        return Trigger(value=round(timing.bounded(start, 0.0, MAX_TRIGGER, "a time of"), 3))

    def _points(self, node: Element) -> Iterator[tuple[Element, EntityPlace | None]]:
        for kind in ("Vertex", "Waypoint", "ControlPoint"):
            for element in node.within(kind):
                holder = element.first("Position")
                yield element, self.positions.read(holder) if holder is not None else None
        if node.name == "AcquirePositionAction" and (goal := node.first("Position")) is not None:
            yield goal, self.positions.read(goal)


_READERS: dict[str, Callable[[ActionReader, str, Element, Trigger], None]] = {
    "SpeedAction": ActionReader._speed,
    "LaneChangeAction": ActionReader._lane_change,
    "FollowTrajectoryAction": ActionReader._course,
    "AcquirePositionAction": ActionReader._course,
    "AssignRouteAction": ActionReader._course,
}


# ------------------------------------------------------------------ behaviours


def behaviour(
    entity: Element,
    asset: Asset,
    actions: list[Action],
    speed: float,
    is_against: bool,
    catalogue: Catalogue,
) -> tuple[Behaviour, float | None]:
    """Return an actor's one behaviour, and the direction of its course if it has one.

    The rarest kind of action counts; the others are recorded as left out.
    """
    is_driver = asset.category in ("vehicle", "cyclist")
    action = _rarest(actions, is_driver=is_driver)
    if action is None:
        name = _plain(asset, speed, is_against)
        if name == "stand" and speed >= STANDS:
            entity.note(f"its first speed, {speed:g} m/s, is left out: a {asset.category} stands")
        return _within(entity, name, {"speed": speed}, AT_ONCE, catalogue), None
    is_waiting = _waits(asset, action, speed)
    name, values = (_driving if is_driver and not is_waiting else _walking)(action, speed)
    if asset.category not in catalogue.behaviour(name).categories:
        action.node.note(f"a {asset.category} cannot {name}: this is left out")
        return Behaviour(name="stand"), None
    if speed >= STANDS and not is_driver and action.trigger != AT_ONCE:
        action.node.note(f"its first speed, {speed:g} m/s, is left out: it stands until this")
    trigger = AT_ONCE if name == "run_red" else action.trigger
    return _within(action.node, name, values, trigger, catalogue), action.heading


def _rarest(actions: list[Action], *, is_driver: bool) -> Action | None:
    """Return the one thing that an actor does, after recording the others as left out."""
    order = {"lane_change": 0, "brake": 1, "course": 2, "start": 3}
    ranked = sorted(actions, key=lambda action: (order[action.kind], "speed" not in action.values))
    if not is_driver:
        ranked = [one for one in ranked if one.kind in ("course", "start")]
    found = ranked[0] if ranked else None
    for one in actions:
        if one is not found:
            one.node.note("an actor does one thing: this is left out")
    return found


def _within(
    node: Element, name: str, values: dict[str, float], trigger: Trigger, catalogue: Catalogue
) -> Behaviour:
    """Return a behaviour with the parameters that it has, within their limits."""
    limits = catalogue.behaviour(name).parameters
    kept = {
        key: round(node.bounded(value, limits[key].minimum, limits[key].maximum, f"a {key} of"), 3)
        for key, value in values.items()
        if key in limits
    }
    return Behaviour(name=name, parameters=kept, trigger=trigger)


def _plain(asset: Asset, speed: float, is_against: bool) -> str:
    if speed < STANDS:
        return "stand"
    if asset.category in ("vehicle", "cyclist"):
        return "wrong_way" if is_against else "follow_lane"
    return "walk_along" if asset.category in ("pedestrian", "animal") else "stand"


def _waits(asset: Asset, action: Action, speed: float) -> bool:
    """Return whether a cyclist stands until a course of its own begins."""
    is_later = action.kind == "course" and action.trigger != AT_ONCE
    return asset.category == "cyclist" and is_later and speed < STANDS


def _driving(action: Action, speed: float) -> tuple[str, dict[str, float]]:
    values = {"speed": speed, **action.values}
    if action.kind == "lane_change":
        return "cut_in", values
    if action.kind == "brake":
        return ("hard_brake" if values["deceleration"] >= _HARD else "stall"), values
    if action.kind == "start":
        return "pull_out", values
    if values["speed"] < STANDS:
        values["speed"] = _DRIVE
        action.node.note(f"the course has no speed; {_DRIVE:g} m/s is taken")
    if action.trigger != AT_ONCE:
        action.node.note(
            f"the course is driven from the start of the scene at {values['speed']:g} m/s: its own start, "
            f"a {action.trigger.kind} of {action.trigger.value:g}, and the first speed, {speed:g} m/s, are left out"
        )
    return "run_red", values


def _walking(action: Action, speed: float) -> tuple[str, dict[str, float]]:
    values = {"speed": speed, **action.values}
    if values["speed"] < STANDS:
        values["speed"] = _WALK
        action.node.note(f"the course has no speed; {_WALK:g} m/s is taken")
    if "distance" not in values:
        values["distance"] = _DISTANCE_M
        action.node.note(f"the way has no end; {_DISTANCE_M:g} m are taken")
    return "cross_road", values


def _aside(point: EntityPlace, start: EntityPlace, heading: float) -> float:
    """Return how far a point is beside a straight line, m."""
    return abs((point.y - start.y) * math.cos(heading) - (point.x - start.x) * math.sin(heading))


def _leave_out_dynamics(node: Element) -> None:
    """Record that it is left out how a speed is reached, unless that is at once."""
    if is_gradual(node, "SpeedActionDynamics"):
        node.note("how the speed is reached is left out")


def _note_paces(node: Element, points: list[tuple[Element, EntityPlace]]) -> None:
    """Record the slowest and the fastest stretch of a course that is read at its mean speed."""
    paces = [
        math.hypot(two.x - place.x, two.y - place.y)
        / (after.number("time", 0.0) - before.number("time", 0.0))
        for (before, place), (after, two) in pairwise(points)
    ]
    if max(paces) - min(paces) > _PACE_SHARE * max(paces):
        node.note(
            f"the course has parts of {min(paces):.1f} and of {max(paces):.1f} m/s and is read at its mean speed"
        )


def _timing(node: Element) -> Element | None:
    """Return how the times of a course are meant, or `None` if they do not count."""
    reference = node.first("TimeReference")
    return None if reference is None else reference.first("Timing")


def _timed(node: Element, vertices: list[Element]) -> tuple[float, float]:
    """Return the time at which a course begins and how long it takes, s; 0 if its times cannot be used."""
    times = [vertex.number("time", 0.0) for vertex in vertices]
    timing = _timing(node)
    scale, offset = 1.0, 0.0
    if timing is not None:
        scale, offset = timing.number("scale", 1.0), timing.number("offset", 0.0)
    if any(later <= earlier for earlier, later in pairwise(times)) and any(times):
        node.note("the times of the course do not grow and are left out")
        return 0.0, 0.0
    if scale <= 0.0 and timing is not None:
        timing.note(f"times cannot be scaled by {scale:g} and are left out")
        return 0.0, 0.0
    return offset + scale * times[0], scale * (times[-1] - times[0])
