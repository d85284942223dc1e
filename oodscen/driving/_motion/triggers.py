"""When triggers fire: at a time, at a distance along the road, at a time to collision."""

from oodscen.data._scene import Trigger
from oodscen.driving._roads.corridor import Corridor
from oodscen.numerics._kernels import part
from oodscen.protocols import State

TIME, DISTANCE, TTC = 0, 1, 2
CODES = {"time": TIME, "distance": DISTANCE, "ttc": TTC}
"""By `Trigger.kind`: how kernels know it."""


@part
def fires(
    code: int, value: float, time: float, ahead: float, ego_speed: float, actor_speed: float
) -> bool:
    """Tell whether one trigger's condition holds; like `is_reached`, for kernels."""
    if code == TIME:
        return time >= value - 1e-9
    distance = abs(ahead)
    if code == DISTANCE:
        return distance <= value
    closing = ego_speed - actor_speed if ahead > 0.0 else actor_speed - ego_speed
    return distance <= max(0.0, value * closing)


def is_reached(
    kind: str, value: float, *, time: float, ahead: float, ego_speed: float, actor_speed: float
) -> bool:
    """Tell whether one trigger's condition holds.

    Args:
        kind: `time`, `distance` or `ttc`.
        value: Seconds or metres.
        time: Since the start, s.
        ahead: From the ego's centre to the actor's along the road, m; negative is behind.
        ego_speed: Along the road, m/s.
        actor_speed: Along the road, m/s; negative when it comes towards an ego behind it.
    """
    return fires(CODES[kind], value, time, ahead, ego_speed, actor_speed)


def is_due(trigger: Trigger, owner: str | None, state: State, corridor: Corridor) -> bool:
    """Tell whether a trigger fires in a state of any simulator.

    Distances are between centres, along the road; the time to collision is that distance over the
    speed at which it shrinks.

    Args:
        trigger: A decision, or an actor's.
        owner: Id of the actor to which it is measured where the trigger names none.
        state: Of the world.
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
    return is_reached(
        trigger.kind,
        trigger.value,
        time=state.time,
        ahead=actor_s - ego_s,
        ego_speed=ego_speed,
        actor_speed=actor_speed,
    )
