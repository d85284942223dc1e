"""Start and stop triggers: conditions on the ego, on time, or on other events."""

import math
from functools import cached_property

import numpy as np

from oodscen.data._scene import Trigger
from oodscen.driving._roads.corridor import Corridor
from oodscen.interchange._recording import RecordedRun
from oodscen.interchange._writing.elements import Element, Value, child, within
from oodscen.interchange._writing.entities import Entity
from oodscen.interchange._writing.trajectories import reference_poses, world_position
from oodscen.numerics._exact import Floats

_ALONG: dict[str, Value] = {
    "freespace": False,
    "coordinateSystem": "road",
    "relativeDistanceType": "longitudinal",
}
_STANDING_M = 0.05
"""Way along the road up to which an actor counts as standing, as a crossing one does, m."""
_TIE = 1e-4
"""Least difference of a condition's value from the nominal run's values at the steps around it, m or s.

Rounding, which differs between players, would decide an exact tie.
"""
_SLOWEST_MPS = 1.0
"""Least closing speed by which a distance is converted into a time, m/s."""
_EARLY_S = 0.001
"""Time before its step from which a time condition holds, against rounding in players, s."""


def _condition(parent: Element, tag: str, name: str, delay_s: float) -> Element:
    """Append a trigger of one condition, which must hold but need not begin to hold."""
    group = within(parent, tag, "ConditionGroup")
    return child(group, "Condition", name=name, delay=delay_s, conditionEdge="none")


def at_time(
    parent: Element, tag: str, name: str, time_s: float, rule: str = "greaterOrEqual"
) -> None:
    """Append a trigger by simulation time."""
    value = max(0.0, time_s - _EARLY_S) if rule == "greaterOrEqual" else time_s
    holder = child(_condition(parent, tag, name, 0.0), "ByValueCondition")
    child(holder, "SimulationTimeCondition", value=float(value), rule=rule)


def of_entity(parent: Element, name: str, entity: str) -> Element:
    """Append a start trigger by an entity, and return the condition to complete."""
    holder = child(_condition(parent, "StartTrigger", name, 0.0), "ByEntityCondition")
    triggering = child(holder, "TriggeringEntities", triggeringEntitiesRule="any")
    child(triggering, "EntityRef", entityRef=entity)
    return child(holder, "EntityCondition")


def after_event(
    parent: Element, name: str, event: str, state: str = "endTransition", delay_s: float = 0.0
) -> None:
    """Append a start trigger by another event's change of state."""
    holder = child(_condition(parent, "StartTrigger", name, delay_s), "ByValueCondition")
    child(
        holder,
        "StoryboardElementStateCondition",
        storyboardElementType="event",
        storyboardElementRef=event,
        state=state,
    )


class EgoConditions:
    """Writes triggers of a scene as conditions on the ego.

    Distances of a scene are between centres along the road, those of OpenSCENARIO between reference points:
    each is shifted by what lies between them.
    """

    def __init__(self, entities: list[Entity], nominal: RecordedRun, corridor: Corridor) -> None:
        self.rows = {entity.name: row for row, entity in enumerate(entities)}
        self.entities = entities
        self.nominal = nominal
        self.corridor = corridor

    @cached_property
    def ego_course(self) -> Floats:
        """Poses of the ego's reference point in the nominal run."""
        return reference_poses(self.nominal, 0, self.entities[0], self.corridor)

    def write(self, parent: Element, name: str, trigger: Trigger, owner: str, step: int) -> None:
        """Append the start trigger of an actor's reaction, by distance or time to collision.

        `step` is the one at which the owner's trigger fires in the nominal run.
        """
        row = self.rows[trigger.actor or owner]
        condition = of_entity(parent, name, "ego")
        s = self.nominal.places[: step + 1, row, 0]
        is_standing = bool(np.abs(s - s[0]).max() <= _STANDING_M)
        value = self._untied(trigger, row, step)
        if trigger.kind == "distance" and is_standing:
            near = child(condition, "DistanceCondition", value=value, rule="lessOrEqual", **_ALONG)
            self._write_place(near, row, step)
        elif trigger.kind == "distance":
            self._write_distance(condition, value, row)
        else:
            self._write_time_to_collision(condition, value, row, step, is_standing=is_standing)

    def _untied(self, trigger: Trigger, row: int, step: int) -> float:
        """Return a trigger's value, off the values that the nominal run has at its step and the one before."""
        after = self._measured(trigger, row, step) + _TIE
        before = self._measured(trigger, row, max(step - 1, 0)) - _TIE
        return min(max(trigger.value, after), before) if after < before else trigger.value

    def _measured(self, trigger: Trigger, row: int, step: int) -> float:
        """Return the distance, or the time to collision, to an actor at a step of the nominal run."""
        places = self.nominal.places[step]
        ahead = float(places[row, 0] - places[0, 0])
        if trigger.kind == "distance":
            return abs(ahead)
        approach = self._speed_along(step, 0) - self._speed_along(step, row)
        closing = math.copysign(approach, approach * ahead)
        return abs(ahead) / closing if closing > 0.0 else math.inf

    def _speed_along(self, step: int, row: int) -> float:
        """Return the speed of a body along the road at a step of the nominal run, m/s."""
        s, heading = self.nominal.places[step, row, 0], self.nominal.poses[step, row, 3]
        alignment = self.corridor.alignment(float(s), float(heading))
        return float(self.nominal.speeds[step, row]) * alignment

    def _write_distance(self, condition: Element, value: float, row: int) -> None:
        child(
            condition,
            "RelativeDistanceCondition",
            entityRef=self.entities[row].name,
            value=max(0.0, value + self._shift(row)),
            rule="lessOrEqual",
            **_ALONG,
        )

    def _write_time_to_collision(
        self, condition: Element, value: float, row: int, step: int, *, is_standing: bool
    ) -> None:
        if not is_standing:
            speeds, poses = self.nominal.speeds[0], self.nominal.poses[0]
            closing = float(speeds[0] - speeds[row] * math.cos(poses[row, 3] - poses[0, 3]))
            value = max(0.0, value + self._shift(row) / max(closing, _SLOWEST_MPS))
        collision = child(
            condition, "TimeToCollisionCondition", value=value, rule="lessOrEqual", **_ALONG
        )
        target = child(collision, "TimeToCollisionConditionTarget")
        if is_standing:
            self._write_place(target, row, step)
        else:
            child(target, "EntityRef", entityRef=self.entities[row].name)

    def _write_place(self, parent: Element, row: int, step: int) -> None:
        """Append an actor's place, moved back along the road by the ego's distance from its axle to its centre.

        In a bend or on a slope, that is not the straight distance between the two.
        """
        s, t = map(float, self.nominal.places[0, row])
        axle = self.ego_course[step]
        lag = float(self.nominal.places[step, 0, 0]) - self.corridor.locate(axle[0], axle[1])[0]
        x, y, z, heading = self.corridor.point(s - lag, t)
        world_position(child(parent, "Position"), np.array([x, y, z, heading, 0.0]))

    def _shift(self, row: int) -> float:
        """Return the distance of the reference points less that of the centres, m."""
        first = self.nominal.places[0]
        turn = float(self.nominal.poses[0, row, 3] - self.nominal.poses[0, 0, 3])
        shift = self.entities[0].ahead_m - self.entities[row].ahead_m * math.cos(turn)
        return shift if first[row, 0] >= first[0, 0] else -shift
