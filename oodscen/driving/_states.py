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
_UNBOUNDED = ("visual_range_m", "curve_speed")
"""The numbers that are infinite where nothing limits them."""


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
    if not (isinstance(state.ids, tuple) and state.ids == ids):
        raise SimulatorError(
            f"{method} returned the ids {state.ids!r:.200}, not {ids!r:.200}: "
            "the ego, then the actors in the scene's order"
        )
    if isinstance(state.step, bool) or not (isinstance(state.step, Integral) and state.step >= 0):
        fault = "not a whole number that is 0 or more"
        raise SimulatorError(f"{method} returned the step {said(state.step)}, {fault}")
    if not (_is_number(state.time) and 0.0 <= state.time < math.inf):
        fault = "not a finite number that is 0 or more"
        raise SimulatorError(f"{method} returned the time {said(state.time)}, {fault}")
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
    with np.errstate(over="ignore"):
        copy = np.array(value, dtype=np.float64, order="C")
    if fault := _fault_of_gaps(copy) if name == "gaps" else _fault_of_finite(copy):
        raise SimulatorError(f"{method} returned {name} {fault}")
    copy.setflags(write=False)
    return copy


def _fault_of_finite(values: NDArray[np.float64]) -> str:
    """Return why some values are not finite numbers, or an empty text."""
    return "" if np.isfinite(values).all() else "that are not finite numbers"


def _fault_of_gaps(gaps: NDArray[np.float64]) -> str:
    """Return why some numbers are not a state's gaps, or an empty text."""
    if not (gaps[1:] >= 0.0).all():
        return "that are not numbers from 0 to infinity"
    if gaps[0] != np.inf:
        return f"whose first is {gaps[0]:g}, not infinity: the ego has no gap to itself"
    return ""


def check_observation(observation: Observation, method: str) -> None:
    """Check that a simulator returned an observation whose numbers are real ones, finite where something limits them.

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
        if math.isinf(value) and not (name in _UNBOUNDED and value > 0.0):
            raise SimulatorError(f"{method} returned {name}: {said(value)}, not a finite number")


def _is_number(value: Any) -> bool:
    """Return whether a value is a real number that a float can hold; infinity is one, a truth value is not."""
    try:
        return isinstance(value, Real) and not isinstance(value, bool) and not math.isnan(value)
    except OverflowError:
        return False
