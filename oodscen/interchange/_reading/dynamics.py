"""Durations of the transitions of actions in an OpenSCENARIO file."""

from typing import NamedTuple

from oodscen.interchange._reading.positions import LANE_M
from oodscen.interchange._reading.tree import Element

_AT_ONCE_MPS2 = 9.0
"""Deceleration of what stops at once in a file, m/s^2."""
_SLOWEST_MPS = 1.0
"""Least mean speed by which a distance is read as a time, m/s."""


class _Transition(NamedTuple):
    """The dynamics of a transition that takes time."""

    dimension: str
    """`rate`, `time` or `distance`."""
    value: float
    """Positive, in SI units."""


def is_gradual(node: Element, name: str) -> bool:
    """Return whether a transition takes time; values that are read otherwise than written are noted."""
    return _transition(node, name) is not None


def deceleration(node: Element, speed: float) -> float:
    """Return the deceleration of a `SpeedAction` that ends a speed, m/s^2."""
    transition = _transition(node, "SpeedActionDynamics")
    if transition is None:
        node.note(f"a stop at once is read as a deceleration of {_AT_ONCE_MPS2:g} m/s^2")
        return _AT_ONCE_MPS2
    if transition.dimension == "rate":
        return transition.value
    if transition.dimension == "time":
        return speed / transition.value
    return 0.5 * speed * speed / transition.value


def speed_change_s(node: Element, before: float, after: float) -> float:
    """Return how long a `SpeedAction` takes, s; 0 if it is at once."""
    transition = _transition(node, "SpeedActionDynamics")
    return _seconds(transition, abs(after - before), 0.5 * (before + after))


def lane_change_s(node: Element, speed: float, lanes: int) -> float:
    """Return how long a `LaneChangeAction` by some lanes to either side takes, s; 0 if it is at once."""
    transition = _transition(node, "LaneChangeActionDynamics")
    return _seconds(transition, abs(lanes) * LANE_M, speed)


def _seconds(transition: _Transition | None, change: float, mean_mps: float) -> float:
    """Return how long a transition takes by which something changes at a mean speed, s."""
    if transition is None:
        return 0.0
    if transition.dimension == "rate":
        return change / transition.value
    if transition.dimension == "distance":
        return transition.value / max(abs(mean_mps), _SLOWEST_MPS)
    return transition.value


def _transition(node: Element, name: str) -> _Transition | None:
    """Return the dynamics of a transition, `None` for one at once."""
    dynamics = node.first(name)
    if dynamics is None:
        return None
    value, dimension = dynamics.number("value"), dynamics.get("dynamicsDimension")
    if dynamics.get("dynamicsShape") == "step":
        return None
    if value < 0.0:
        dynamics.note(f"value={value:g} is read as {-value:g}")
        value = -value
    if dimension not in ("rate", "time", "distance"):
        dynamics.note(f"dynamicsDimension={dimension[:40]!r} is read as at once")
        return None
    if value == 0.0:
        if dimension != "time":
            dynamics.note(f"a {dimension} of 0 is read as at once")
        return None
    return _Transition(dimension, value)
