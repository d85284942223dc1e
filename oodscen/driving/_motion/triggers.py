"""Triggers by time, distance along the road or time to collision."""

from oodscen.data._scene import Trigger
from oodscen.driving._roads.corridor import Corridor
from oodscen.numerics._kernels import part
from oodscen.protocols import State

TIME, DISTANCE, TTC = 0, 1, 2
CODES = {"time": TIME, "distance": DISTANCE, "ttc": TTC}
"""Codes of triggers in kernels, by `Trigger.kind`."""


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
        return time >= value - 1e-9
    distance = abs(ahead)
    if code == DISTANCE:
        return distance <= value
    closing = ego_speed - actor_speed if ahead > 0.0 else actor_speed - ego_speed
    return distance <= max(0.0, value * closing)


def is_due(trigger: Trigger, owner: str | None, state: State, corridor: Corridor) -> bool:
    """Return whether a trigger fires in a state of any simulator.

    Distances are between centres along the road. The time to collision is that distance divided by the
    closing speed.

    Args:
        trigger: A trigger of a decision or an actor.
        owner: Id of the actor to measure to if the trigger names none.
        state: The world's state.
        corridor: The scene's road.
    """
    if trigger.kind == "time":
        return fires(TIME, trigger.value, state.time, 0.0, 0.0, 0.0)
    row = state.ids.index(trigger.actor or owner or "")
    places = []
    for index in (0, row):
        x, y, _, yaw = map(float, state.poses[index])
        s = corridor.locate(x, y)[0] if state.places is None else float(state.places[index, 0])
        places.append((s, float(state.speeds[index]) * corridor.alignment(s, yaw)))
    (ego_s, ego_speed), (actor_s, actor_speed) = places
    code = CODES[trigger.kind]
    return fires(code, trigger.value, state.time, actor_s - ego_s, ego_speed, actor_speed)
