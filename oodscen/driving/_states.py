"""States and observations from outside: checked, and states copied into arrays that no later call changes."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import fields
from numbers import Integral, Real
from typing import Any, Self

import numpy as np

from oodscen._abilities import Rehearses, Snapshots
from oodscen._members import as_catalogue
from oodscen.data._catalogue import Catalogue
from oodscen.data._scene import Scene
from oodscen.data._scene_uses import fitting
from oodscen.driving._base_simulator import BaseSimulator
from oodscen.driving._dynamic_simulator import DynamicSimulator, RestorableSimulator
from oodscen.driving._mirror_simulator import MirrorSimulator
from oodscen.errors import SimulatorError
from oodscen.protocols import Camera, Control, Frame, Observation, Simulator, State

_SHAPES: dict[str, tuple[int, ...]] = {
    "poses": (4,), "speeds": (), "gaps": (), "accelerations": (), "places": (2,),
}  # fmt: skip
"""Shapes of a state's arrays after their first axis, the bodies."""
_MEASURED = ("accelerations", "places")
"""The arrays that may be unknown."""
_NUMBERS = tuple(field.name for field in fields(Observation) if field.name != "frame")
_LANES = ("lane_left_m", "lane_right_m")
"""The numbers that are `None` where there is no lane."""
_TOLERANCE = 0.01
"""Share of a step by which a state's time may be off."""
_OWN = (BaseSimulator, MirrorSimulator, DynamicSimulator, RestorableSimulator)


def watched(simulator: Simulator) -> Simulator:
    """Return a simulator whose states and observations are what the protocol promises, or errors.

    A simulator whose states the library's base classes build is returned as it is: they check what the adapter
    gives them.
    """
    return simulator if isinstance(simulator, Watched) or _is_own(simulator) else Watched(simulator)


@contextmanager
def kept(scene: Scene, simulator: str) -> Iterator[Scene]:
    """Give a copy of a scene that a simulator may be shown: the scene stays as it is.

    Raises:
        SceneError: If the scene has values that no scene can have.
        SimulatorError: If the copy was changed; what was run is then not the scene.
    """
    given = fitting(scene).model_copy(deep=True)
    yield given
    if given != scene:
        raise SimulatorError(f"{simulator} changed the scene that it was given")


def _is_own(simulator: Simulator) -> bool:
    """Return whether the states and observations of a simulator come from the base classes."""
    return isinstance(simulator, BaseSimulator) and not any(
        name in vars(simulator)
        or all(getattr(type(simulator), name, None) is not vars(base).get(name) for base in _OWN)
        for name in ("reset", "step", "observe", *(("restore",) * isinstance(simulator, Snapshots)))
    )


class Watched:
    """Checks the states and observations of a simulator.

    Args:
        simulator: The simulator; its abilities stay.
    """

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator
        self.name, self.dt = simulator.name, simulator.dt
        self._ids: tuple[str, ...] = ()
        self._time = 0.0
        if isinstance(simulator, Snapshots):
            self.snapshot = simulator.snapshot
            self._restore, self.restore = simulator.restore, self._restored
        if isinstance(simulator, Rehearses):
            self.rehearse = simulator.rehearse

    def catalogue(self) -> Catalogue:
        """Return the simulator's vocabulary."""
        return as_catalogue(self._simulator.catalogue(), self.name)

    def reset(self, scene: Scene, seed: int) -> State:
        """Load a scene and return its first state, at time 0."""
        self._ids = ("ego", *(actor.id for actor in scene.actors))
        return self._own(self._simulator.reset(scene, seed), "reset()", 0.0)

    def step(self, control: Control) -> State:
        """Advance by exactly one `dt`."""
        return self._own(self._simulator.step(control), "step()", self._time + self.dt)

    def render(self, camera: Camera) -> Frame:
        """Render the current state; `render_checked` checks the frame."""
        return self._simulator.render(camera)

    def observe(self) -> Observation:
        """Return the driver's observation of the current state."""
        seen = self._simulator.observe()
        check_observation(seen, f"{self.name}: observe()")
        return seen

    def close(self) -> None:
        """Release all resources."""
        self._simulator.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def _restored(self, snapshot: Any) -> State:
        return self._own(self._restore(snapshot), "restore()", None)

    def _own(self, state: State, method: str, time: float | None) -> State:
        said = f"{self.name}: {method}"
        mine = own_state(state, self._ids, said)
        if time is not None and not abs(mine.time - time) <= _TOLERANCE * self.dt:
            raise SimulatorError(f"{said} returned the time {mine.time:g} s, not {time:g} s")
        self._time = mine.time
        return mine


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
        raise SimulatorError(f"{method} returned the step {state.step!r:.40}, not a whole number")
    if not (isinstance(state.time, Real) and math.isfinite(state.time)):
        raise SimulatorError(f"{method} returned the time {state.time!r:.40}, not a number")
    if not isinstance(state.off_road, bool | np.bool_):
        raise SimulatorError(f"{method} returned off_road: {state.off_road!r:.40}, not a bool")
    arrays = {}
    for name, shape in _SHAPES.items():
        value = getattr(state, name)
        if value is None and name in _MEASURED:
            continue
        if not (isinstance(value, np.ndarray) and value.dtype.kind == "f"):
            kind = value.dtype if isinstance(value, np.ndarray) else type(value).__name__
            raise SimulatorError(f"{method} returned {name}: {kind}, not an array of float64")
        if value.shape != (len(ids), *shape):
            raise SimulatorError(
                f"{method} returned {name} of shape {value.shape}, not {(len(ids), *shape)}"
            )
        # Gaps are infinite to bodies that are far away.
        if (np.isnan(value) if name == "gaps" else ~np.isfinite(value)).any():
            raise SimulatorError(f"{method} returned {name} that are not finite numbers")
        arrays[name] = np.array(value, dtype=np.float64, order="C")
        arrays[name].setflags(write=False)
    return State(int(state.step), float(state.time), ids, off_road=bool(state.off_road), **arrays)


def check_observation(seen: Observation, method: str) -> None:
    """Do nothing if a simulator's observation is one, of numbers.

    Raises:
        SimulatorError: If it is something else; the message names the method and the fault.
    """
    if not isinstance(seen, Observation):
        raise SimulatorError(f"{method} returned a {type(seen).__name__}, not an Observation")
    for name in _NUMBERS:
        value = getattr(seen, name)
        if value is None and name in _LANES:
            continue
        if not isinstance(value, Real) or math.isnan(value):
            raise SimulatorError(f"{method} returned {name}: {value!r:.40}, not a number")
