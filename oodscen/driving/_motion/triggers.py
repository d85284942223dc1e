"""Triggers by time, distance along the road or time to collision."""

import math

from oodscen.data._scene import Trigger
from oodscen.driving._roads.corridor import Corridor
from oodscen.numerics._kernels import part
from oodscen.protocols import State

MAX_APPROACH_S = 15.0
"""Latest time of a decision, in seconds, even if its trigger has not fired."""
ROUNDING_S = 1e-9
"""Difference up to which two times count as the same, s: times are sums of steps."""

TIME, DISTANCE, TTC = 0, 1, 2
CODES = {"time": TIME, "distance": DISTANCE, "ttc": TTC}
"""Codes of triggers in kernels, by `Trigger.kind`."""
TIE = 5e-6
"""Amount by which a trigger's value may be missed, m or s: a few times the rounding of poses, in a world as in a file.

Values taken from a state would otherwise fire there or a step later, as floating-point arithmetic rounds.
"""


@part
def _closing(ahead: float, ego_speed: float, actor_speed: float) -> float:
    """Return the speed at which the ego and an actor ahead, or behind if negative, approach each other, m/s."""
    return ego_speed - actor_speed if ahead > 0.0 else actor_speed - ego_speed


@part
def fires(
    code: int, value: float, time: float, ahead: float, ego_speed: float, actor_speed: float
) -> bool:
    """Return whether a trigger's condition holds.

    Args:
        code: One of `CODES`.
        value: Threshold, s or m.
        time: Time since the start, s.
        ahead: Distance from the ego's centre to the actor's along the road, m; negative if behind.
        ego_speed: The ego's speed along the road, m/s.
        actor_speed: The actor's speed along the road, m/s; negative if it drives against the ego's direction.
    """
    if code == TIME:
        return time >= value - TIE
    distance = abs(ahead) - TIE
    if code == DISTANCE:
        return distance <= value
    return distance <= max(0.0, value * _closing(ahead, ego_speed, actor_speed))


def is_due(trigger: Trigger, owner: str | None, state: State, corridor: Corridor) -> bool:
    """Return whether a trigger fires in a state of any simulator; it measures to `owner` if it names no actor.

    Distances are between centres along the road. The time to collision is that distance divided by the
    closing speed.
    """
    if trigger.kind == "time":
        return fires(TIME, trigger.value, state.time, 0.0, 0.0, 0.0)
    ahead, ego_speed, actor_speed = _between(trigger.actor or owner or "", state, corridor)
    return fires(CODES[trigger.kind], trigger.value, state.time, ahead, ego_speed, actor_speed)


def value_in(trigger: Trigger, state: State, corridor: Corridor) -> float:
    """Return the value with which a decision's trigger fires in a state, rounded up to thousandths."""
    if trigger.kind == "time":
        return round(state.time, 3)
    ahead, ego_speed, actor_speed = _between(trigger.actor or "", state, corridor)
    distance = abs(ahead)
    if trigger.kind == "ttc":
        closing = _closing(ahead, ego_speed, actor_speed)
        distance = distance / closing if closing > 0.0 else 0.0
    return math.ceil(1000.0 * distance) / 1000.0


def _between(actor: str, state: State, corridor: Corridor) -> tuple[float, float, float]:
    """Return the distance from the ego to an actor along the road, and the speeds of both along it."""
    ego_s, ego_speed = _along(0, state, corridor)
    actor_s, actor_speed = _along(state.ids.index(actor), state, corridor)
    return actor_s - ego_s, ego_speed, actor_speed


def _along(row: int, state: State, corridor: Corridor) -> tuple[float, float]:
    """Return s of a body, m, and its speed along the road, m/s."""
    x, y, _, yaw = map(float, state.poses[row])
    s = corridor.locate(x, y)[0] if state.places is None else float(state.places[row, 0])
    return s, float(state.speeds[row]) * corridor.alignment(s, yaw)
