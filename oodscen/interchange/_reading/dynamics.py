"""Durations of the transitions of actions in an OpenSCENARIO file."""

from oodscen.interchange._reading.positions import LANE_M
from oodscen.interchange._reading.tree import Element

_AT_ONCE_MPS2 = 9.0
"""Deceleration of what stops at once in a file, m/s^2."""


def is_gradual(node: Element, name: str) -> bool:
    """Return whether a transition takes time, after recording a way of telling it that is not known."""
    return bool(_dynamics(node, name)[0])


def deceleration(node: Element, speed: float) -> float:
    """Return the deceleration of a `SpeedAction` that ends a speed, m/s^2."""
    kind, value = _dynamics(node, "SpeedActionDynamics")
    if kind == "rate":
        return value
    if kind == "time":
        return speed / value
    if kind == "distance":
        return 0.5 * speed * speed / value
    node.note(f"a stop at once is read as a deceleration of {_AT_ONCE_MPS2:g} m/s^2")
    return _AT_ONCE_MPS2


def speed_change_s(node: Element, before: float, after: float) -> float:
    """Return how long a `SpeedAction` takes, s."""
    kind, value = _dynamics(node, "SpeedActionDynamics")
    if kind == "rate":
        return abs(after - before) / value
    if kind == "distance":
        return 2.0 * value / max(before + after, 1.0)
    return value


def lane_change_s(node: Element, speed: float) -> float:
    """Return how long a `LaneChangeAction` takes, s; 0 if it is at once."""
    kind, value = _dynamics(node, "LaneChangeActionDynamics")
    if kind == "rate":
        return LANE_M / value
    return value / max(speed, 1.0) if kind == "distance" else value


def _dynamics(node: Element, name: str) -> tuple[str, float]:
    """Return the dimension and the value in which a transition is told, `""` for one at once."""
    dynamics = node.first(name)
    if dynamics is None:
        return "", 0.0
    value = dynamics.number("value")
    if value < 0.0:
        dynamics.note(f"value={value:g} is read as {-value:g}")
        value = -value
    kind = dynamics.get("dynamicsDimension")
    if kind not in ("rate", "time", "distance"):
        dynamics.note(f"dynamicsDimension={kind[:40]!r} is read as at once")
        return "", 0.0
    if dynamics.get("dynamicsShape") == "step":
        return "", 0.0
    if value == 0.0:
        if kind != "time":
            dynamics.note(f"a {kind} of 0 is read as at once")
        return "", 0.0
    return kind, value
