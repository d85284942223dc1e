"""Checks of states and observations from outside; states are copied into arrays that no later call changes."""

import math
from dataclasses import fields
from numbers import Integral, Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from oodscen._numbers import said
from oodscen.errors import SimulatorError
from oodscen.protocols import Observation, State

_SHAPES: dict[str, tuple[int, ...]] = {
    "poses": (4,), "speeds": (), "gaps": (), "accelerations": (), "places": (2,),
}  # fmt: skip
"""Shapes of a state's arrays after their first axis, the bodies."""
_OPTIONAL = ("accelerations", "places")
"""The arrays that may be unknown."""
_NUMBERS = tuple(field.name for field in fields(Observation) if field.name != "frame")
"""The fields of an observation that are numbers."""
_LANES = ("lane_left_m", "lane_right_m")
"""The numbers that are `None` where there is no lane."""


def own_state(state: State, ids: tuple[str, ...], method: str) -> State:
    """Return a copy of a state whose values have the types, shapes and ranges that `State` promises.

    Args:
        state: The state that the method returned.
        ids: The ids of the bodies: `ego`, then the actors in the scene's order.
        method: The simulator's name and method, for messages.

    Raises:
        SimulatorError: If it is something else; the message names the method and the fault.
    """
    if not isinstance(state, State):
        raise SimulatorError(f"{method} returned a {type(state).__name__}, not a State")
    if state.ids != ids:
        raise SimulatorError(
            f"{method} returned the ids {state.ids!r:.200}, not {ids!r:.200}: "
            "the ego, then the actors in the scene's order"
        )
    if not (isinstance(state.step, Integral) and state.step >= 0):
        raise SimulatorError(f"{method} returned the step {said(state.step)}, not a whole number")
    if not _is_number(state.time) or math.isinf(state.time):
        raise SimulatorError(f"{method} returned the time {said(state.time)}, not a number")
    if not isinstance(state.off_road, bool | np.bool_):
        raise SimulatorError(f"{method} returned off_road: {said(state.off_road)}, not a bool")
    arrays = {}
    for name, shape in _SHAPES.items():
        value = getattr(state, name)
        if value is not None or name not in _OPTIONAL:
            arrays[name] = _own_array(name, value, (len(ids), *shape), method)
    return State(int(state.step), float(state.time), ids, off_road=bool(state.off_road), **arrays)


def _own_array(name: str, value: Any, shape: tuple[int, ...], method: str) -> NDArray[np.float64]:
    """Return a read-only copy of an array of a state, which must have a shape and hold numbers."""
    if not (isinstance(value, np.ndarray) and value.dtype.kind == "f"):
        kind = value.dtype if isinstance(value, np.ndarray) else type(value).__name__
        raise SimulatorError(f"{method} returned {name}: {kind}, not an array of float64")
    if value.shape != shape:
        raise SimulatorError(f"{method} returned {name} of shape {value.shape}, not {shape}")
    # Gaps are infinite to bodies that are far away.
    is_bad = np.isnan(value) if name == "gaps" else ~np.isfinite(value)
    if is_bad.any():
        raise SimulatorError(f"{method} returned {name} that are not finite numbers")
    copy = np.array(value, dtype=np.float64, order="C")
    copy.setflags(write=False)
    return copy


def check_observation(observation: Observation, method: str) -> None:
    """Do nothing if a simulator's observation is one, of numbers.

    Raises:
        SimulatorError: If it is something else; the message names the method and the fault.
    """
    if not isinstance(observation, Observation):
        kind = type(observation).__name__
        raise SimulatorError(f"{method} returned a {kind}, not an Observation")
    for name in _NUMBERS:
        value = getattr(observation, name)
        if value is None and name in _LANES:
            continue
        if not _is_number(value):
            raise SimulatorError(f"{method} returned {name}: {said(value)}, not a number")


def _is_number(value: Any) -> bool:
    """Return whether a value is a real number that a float can hold; infinity is one."""
    try:
        return isinstance(value, Real) and not math.isnan(value)
    except OverflowError:
        return False
