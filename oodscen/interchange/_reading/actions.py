"""Behaviours for what the entities of an OpenSCENARIO file do."""

import math
from collections.abc import Iterator
from typing import Literal, NamedTuple

from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._scene import Behaviour, Trigger
from oodscen.interchange._reading.positions import Pose, Positions
from oodscen.interchange._reading.tree import Node

Kind = Literal["lane_change", "brake", "course", "start"]

_STANDS = 0.1
"""Speed below which an entity counts as standing, m/s."""
_AT_ONCE_S = 0.5
"""Time up to which an event belongs to the start, s."""
_HARD = 3.0
"""Deceleration from which braking is hard, m/s^2."""
_WALK, _DISTANCE_M, _STRAIGHT_M = 1.4, 12.0, 1.0
_KNOWN = {
    "SpeedAction",
    "LaneChangeAction",
    "FollowTrajectoryAction",
    "AcquirePositionAction",
    "AssignRouteAction",
    "SynchronizeAction",
}


class Action(NamedTuple):
    """One thing that an entity does, when, and how."""

    kind: Kind
    node: Node
    trigger: Trigger
    values: dict[str, float]
    heading: float | None = None
    """Direction in which a course leads, rad."""


class ActionReader:
    """Reads what every entity does."""

    def __init__(self, root: Node, positions: Positions, ego: str) -> None:
        self.root = root
        self.positions = positions
        self.ego = ego
        self.speeds: dict[str, float] = {}
        self.actions: dict[str, list[Action]] = {}

    def read(self) -> None:
        """Read the speeds of the start, then the events of all stories."""
        for private in self.root.all("Storyboard", "Init", "Actions", "Private"):
            name = private.get("entityRef")
            for action in private.all("PrivateAction"):
                self._act(name, action, Trigger())
        for group in self.root.within("ManeuverGroup"):
            names = [one.get("entityRef") for one in group.all("Actors", "EntityRef")]
            for event in group.within("Event"):
                for name in names:
                    trigger = self._trigger(event, name)
                    for action in event.all("Action"):
                        self._act(name, action, trigger)

    # ------------------------------------------------------------------ actions

    def _act(self, name: str, action: Node, trigger: Trigger) -> None:
        for node in _leaves(action):
            if node.name == "TeleportAction":
                continue
            if name == self.ego and not (node.name == "SpeedAction" and _is_start(trigger)):
                node.leave_out("the ego is driven by a driver")
                continue
            if node.name not in _KNOWN:
                node.leave_out("no behaviour does this")
            elif node.name == "SpeedAction":
                self._speed(name, node, trigger)
            elif node.name == "LaneChangeAction":
                self._lane_change(name, node, trigger)
            else:
                self._course(name, node, trigger)

    def _add(self, name: str, action: Action) -> None:
        self.actions.setdefault(name, []).append(action)

    def _speed(self, name: str, node: Node, trigger: Trigger) -> None:
        before, target = self.speeds.get(name, 0.0), self._target(node)
        if target is None:
            node.leave_out("the target speed is not read")
        elif _is_start(trigger):
            self.speeds[name] = abs(target)
        elif target < _STANDS and before >= _STANDS:
            values = {"deceleration": _deceleration(node, before)}
            self._add(name, Action("brake", node, trigger, values))
        elif before < _STANDS <= target:
            self._add(name, Action("start", node, trigger, {"speed": target}))
        else:
            node.leave_out(f"no behaviour changes the speed from {before:.1f} to {target:.1f} m/s")

    def _target(self, node: Node) -> float | None:
        absolute = node.first("SpeedActionTarget", "AbsoluteTargetSpeed")
        if absolute is not None:
            return absolute.number("value")
        relative = node.first("SpeedActionTarget", "RelativeTargetSpeed")
        if relative is None:
            return None
        its = self.speeds.get(relative.get("entityRef"), 0.0)
        value = relative.number("value")
        return its * value if relative.get("speedTargetValueType") == "factor" else its + value

    def _lane_change(self, name: str, node: Node, trigger: Trigger) -> None:
        own = self.positions.known.get(name)
        absolute = node.first("LaneChangeTarget", "AbsoluteTargetLane")
        relative = node.first("LaneChangeTarget", "RelativeTargetLane")
        if own is None or not own.road or (absolute is None and relative is None):
            node.leave_out("the lane is not known")
            return
        if absolute is not None:
            target = int(absolute.number("value"))
        else:
            assert relative is not None
            its = self.positions.known.get(relative.get("entityRef"))
            if its is None or not its.road:
                node.leave_out("the lane is not known")
                return
            target = its.lane + int(relative.number("value"))
        lanes = target - own.lane
        if target * own.lane < 0:
            lanes -= 1 if lanes > 0 else -1
        ego = self.positions.known.get(self.ego, own)
        lanes = lanes if ego.lane <= 0 else -lanes
        if lanes == 0:
            node.leave_out("it is in that lane already")
            return
        speed = self.speeds.get(name, 0.0)
        values = {"lanes": float(lanes), "duration": _duration(node, speed)}
        self._add(name, Action("lane_change", node, trigger, values))

    def _course(self, name: str, node: Node, trigger: Trigger) -> None:
        """Add a straight way from the first to the last point of a course."""
        pairs = [
            (vertex.number("time", 0.0), pose)
            for vertex, pose in self._points(node)
            if pose is not None
        ]
        start = self.positions.known.get(name)
        if start is None and pairs:
            start = self.positions.known[name] = pairs[0][1]
        if start is None or not pairs:
            node.leave_out("the course has no points that are read")
            return
        end = pairs[-1][1]
        way = math.hypot(end.x - start.x, end.y - start.y)
        if way < _STANDS:
            node.leave_out("the course leads nowhere")
            return
        heading = math.atan2(end.y - start.y, end.x - start.x)
        values = {"distance": way}
        seconds = pairs[-1][0] - pairs[0][0]
        if node.name == "SynchronizeAction":
            values = self._met(node, way)
            if "speed" in values:
                trigger = Trigger(kind="ttc", value=round(0.5 * way / values["speed"], 3))
                node.leave_out("a meeting is read as a start by time to collision")
        elif seconds > 0.0:
            values["speed"] = way / seconds
        if any(_aside(one, start, heading) > _STRAIGHT_M for _, one in pairs):
            node.leave_out("the course is read as a straight way from its first point to its last")
        self._add(name, Action("course", node, trigger, values, heading))

    def _points(self, node: Node) -> Iterator[tuple[Node, Pose | None]]:
        for kind in ("Vertex", "Waypoint", "ControlPoint"):
            for one in node.within(kind):
                holder = one.first("Position")
                yield one, self.positions.read(holder) if holder is not None else None
        if node.name == "AcquirePositionAction" and (goal := node.first("Position")) is not None:
            yield goal, self.positions.read(goal)

    def _met(self, node: Node, way: float) -> dict[str, float]:
        final = node.first("FinalSpeed", "AbsoluteSpeed")
        values = {"distance": way}
        if final is not None and (speed := final.number("value", 0.0)) > _STANDS:
            values["speed"] = speed
        return values

    # ------------------------------------------------------------------ triggers

    def _trigger(self, event: Node, name: str) -> Trigger:
        groups = event.all("StartTrigger", "ConditionGroup")
        conditions = [one for group in groups for one in group.all("Condition")]
        if len(conditions) > 1:
            event.leave_out("of several conditions the first that is known counts")
        for condition in conditions:
            found = self._condition(condition, name)
            if found is not None:
                return found
        return Trigger()

    def _condition(self, condition: Node, name: str) -> Trigger | None:
        delay = condition.number("delay", 0.0)
        time = condition.first("ByValueCondition", "SimulationTimeCondition")
        if time is not None:
            return _trigger("time", time.number("value") + delay)
        after = condition.first("ByValueCondition", "StoryboardElementStateCondition")
        if after is not None and after.get("state") in ("startTransition", "runningState"):
            return _trigger("time", delay)
        for node in condition.all("ByEntityCondition", "EntityCondition"):
            for one in node.children():
                found = self._ego_condition(one, name)
                if found is not None:
                    return found
        condition.leave_out("this condition is not read; the event starts at once")
        return None

    def _ego_condition(self, node: Node, name: str) -> Trigger | None:
        speed = self.speeds.get(self.ego, 0.0)
        if node.name == "TimeToCollisionCondition":
            return _trigger("ttc", node.number("value"))
        if node.name == "RelativeDistanceCondition":
            return _trigger("distance", node.number("value"))
        if node.name == "TimeHeadwayCondition":
            node.leave_out("a headway is read as a distance at the ego's first speed")
            return _trigger("distance", node.number("value") * speed)
        if node.name == "TraveledDistanceCondition" and speed > _STANDS:
            node.leave_out("a distance travelled is read as a time at the ego's first speed")
            return _trigger("time", node.number("value") / speed)
        if node.name in ("DistanceCondition", "ReachPositionCondition"):
            holder = node.first("Position")
            place = self.positions.read(holder) if holder is not None else None
            its = self.positions.known.get(name)
            if place is not None and its is not None:
                reach = node.number("value" if node.name[0] == "D" else "tolerance", 0.0)
                far = math.hypot(place.x - its.x, place.y - its.y)
                return _trigger("distance", far + reach)
        return None


# ------------------------------------------------------------------ behaviours


def behaviour(
    asset: Asset, actions: list[Action], speed: float, is_against: bool, catalogue: Catalogue
) -> tuple[Behaviour, float | None]:
    """Return an actor's one behaviour, and the direction of its course if it has one.

    The rarest kind of action counts; the others are recorded as left out.
    """
    is_driver = asset.category in ("vehicle", "cyclist")
    order = {"lane_change": 0, "brake": 1, "course": 2, "start": 3}
    ranked = sorted(actions, key=lambda action: (order[action.kind], "speed" not in action.values))
    if not is_driver:
        ranked = [one for one in ranked if one.kind in ("course", "start")]
    for one in actions:
        if not ranked or one is not ranked[0]:
            one.node.leave_out("an actor does one thing")
    name, values, trigger, heading = _plain(asset, speed, is_against), {"speed": speed}, None, None
    if ranked:
        action = ranked[0]
        trigger, heading = action.trigger, action.heading
        name, values = (_driving if is_driver else _walking)(action, speed)
        if asset.category not in catalogue.behaviour(name).categories:
            action.node.leave_out(f"a {asset.category} cannot {name}")
            name, values, trigger, heading = "stand", {}, None, None
    limits = catalogue.behaviour(name).parameters
    kept = {
        key: round(min(max(value, limits[key].minimum), limits[key].maximum), 3)
        for key, value in values.items()
        if key in limits
    }
    return Behaviour(name=name, parameters=kept, trigger=trigger or Trigger()), heading


def _plain(asset: Asset, speed: float, is_against: bool) -> str:
    if speed < _STANDS:
        return "stand"
    if asset.category in ("vehicle", "cyclist"):
        return "wrong_way" if is_against else "follow_lane"
    return "walk_along" if asset.category in ("pedestrian", "animal") else "stand"


def _driving(action: Action, speed: float) -> tuple[str, dict[str, float]]:
    values = {"speed": speed, **action.values}
    if action.kind == "lane_change":
        return "cut_in", values
    if action.kind == "brake":
        return ("hard_brake" if values["deceleration"] >= _HARD else "stall"), values
    if action.kind == "start":
        return "pull_out", values
    if values["speed"] < _STANDS:
        values["speed"] = 8.0
    return "run_red", values


def _walking(action: Action, speed: float) -> tuple[str, dict[str, float]]:
    pace = action.values.get("speed", speed)
    far = action.values.get("distance", _DISTANCE_M)
    return "cross_road", {"speed": pace if pace >= _STANDS else _WALK, "distance": far}


def _leaves(action: Node) -> Iterator[Node]:
    """Yield the actions themselves below their grouping elements."""
    groups = {
        "Action",
        "PrivateAction",
        "LongitudinalAction",
        "LateralAction",
        "RoutingAction",
    }
    for node in action.children():
        if node.name in groups:
            yield from _leaves(node)
        else:
            yield node


def _trigger(kind: Literal["time", "distance", "ttc"], value: float) -> Trigger:
    return Trigger(kind=kind, value=round(min(max(value, 0.0), 500.0), 3))


def _is_start(trigger: Trigger) -> bool:
    return trigger.kind == "time" and trigger.value <= _AT_ONCE_S


def _aside(point: Pose, start: Pose, heading: float) -> float:
    """Return how far a point is beside a straight line, m."""
    return abs((point.y - start.y) * math.cos(heading) - (point.x - start.x) * math.sin(heading))


def _deceleration(node: Node, speed: float) -> float:
    dynamics = node.first("SpeedActionDynamics")
    if dynamics is None or dynamics.get("dynamicsShape") == "step":
        return 9.0
    value = abs(dynamics.number("value"))
    kind = dynamics.get("dynamicsDimension")
    if value <= 0.0:
        return 9.0
    if kind == "rate":
        return value
    return speed / value if kind == "time" else 0.5 * speed * speed / value


def _duration(node: Node, speed: float) -> float:
    dynamics = node.first("LaneChangeActionDynamics")
    if dynamics is None:
        return 2.0
    value = abs(dynamics.number("value"))
    kind = dynamics.get("dynamicsDimension")
    if kind == "time" or value <= 0.0:
        return value
    return value / max(speed, 1.0) if kind == "distance" else 3.5 / value
