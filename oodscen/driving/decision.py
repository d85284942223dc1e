"""When the ego must choose: the decision's trigger, read from a state of any simulator."""

import math

from oodscen.protocols import State
from oodscen.scene import Scene

_SLACK = 1e-9


def decision_reached(scene: Scene, state: State) -> bool:
    """Whether the scene's decision trigger fires in this state.

    Distances are between centres in the plane; the time to collision is that distance divided by
    the speed at which it shrinks, infinite while it grows.
    """
    trigger = scene.decision
    if trigger.kind == "time":
        return state.time >= trigger.value - _SLACK
    row = state.ids.index(scene.decision_actor or "")
    dx = float(state.poses[row, 0] - state.poses[0, 0])
    dy = float(state.poses[row, 1] - state.poses[0, 1])
    distance = math.sqrt(dx * dx + dy * dy)
    if trigger.kind == "distance":
        return distance <= trigger.value + _SLACK
    closing = -(dx * _velocity(state, row, 0) + dy * _velocity(state, row, 1)) / max(distance, 1e-6)
    return closing > 0 and distance <= trigger.value * closing + _SLACK


def _velocity(state: State, row: int, axis: int) -> float:
    """Component of an actor's velocity relative to the ego's, m/s, along x (0) or y (1)."""
    wave = math.sin if axis else math.cos
    own = float(state.speeds[0]) * wave(float(state.poses[0, 3]))
    return float(state.speeds[row]) * wave(float(state.poses[row, 3])) - own
