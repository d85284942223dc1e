"""Simulators whose states and observations are checked, and the scenes that they may be shown."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Self

from oodscen._abilities import Rehearses, Snapshots
from oodscen._members import as_catalogue
from oodscen.data._catalogue import Catalogue
from oodscen.data._scene import Scene
from oodscen.data._scene_uses import fitting
from oodscen.driving._base_simulator import BaseSimulator
from oodscen.driving._dynamic_simulator import DynamicSimulator, RestorableSimulator
from oodscen.driving._mirror_simulator import MirrorSimulator
from oodscen.driving._states import check_observation, own_state
from oodscen.errors import SceneError, SimulatorError
from oodscen.protocols import Camera, Control, Frame, Observation, Simulator, State

_TIME_TOLERANCE = 0.01
"""Share of a step by which a state's time may be off."""
_BASES = (BaseSimulator, MirrorSimulator, DynamicSimulator, RestorableSimulator)


def checked_simulator(simulator: Simulator) -> Simulator:
    """Return a simulator whose states and observations are what the protocol promises, or errors.

    A simulator whose states the library's base classes build is returned as it is: they check what the adapter
    gives them.
    """
    if isinstance(simulator, CheckedSimulator) or _is_checked_by_bases(simulator):
        return simulator
    return CheckedSimulator(simulator)


def moves_as_world(simulator: Simulator) -> bool:
    """Return whether a simulator's bodies move as those of the kinematic world."""
    return isinstance(simulator, MirrorSimulator) and _is_checked_by_bases(simulator)


@contextmanager
def scene_copy(scene: Scene, simulator: str) -> Iterator[Scene]:
    """Give a copy of a scene that the simulator of this name may be shown: the scene stays as it is.

    Raises:
        SceneError: If the scene has values that no scene can have.
        SimulatorError: If the copy was changed; what was run is then not the scene.
    """
    copy = fitting(scene).model_copy(deep=True)
    fault = None
    try:
        yield copy
    except SceneError as error:
        fault = error
    if copy != scene:
        raise SimulatorError(f"{simulator} changed the scene that it was given") from fault
    if fault is not None:
        raise fault


def _is_checked_by_bases(simulator: Simulator) -> bool:
    """Return whether all states and observations of a simulator come from the base classes."""
    if not isinstance(simulator, BaseSimulator):
        return False
    methods = ["reset", "step", "observe"]
    if isinstance(simulator, Snapshots):
        methods.append("restore")
    return not any(_is_overridden(simulator, method) for method in methods)


def _is_overridden(simulator: BaseSimulator, method: str) -> bool:
    """Return whether a method is not that of a base class, but the object's own or that of a class between."""
    function = getattr(type(simulator), method, None)
    return method in vars(simulator) or all(
        function is not vars(base).get(method) for base in _BASES
    )


class CheckedSimulator:
    """Checks the states and observations of a simulator, whose other abilities stay.

    Args:
        simulator: The simulator.
    """

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator
        self.name, self.dt = simulator.name, simulator.dt
        self._ids: tuple[str, ...] = ()
        self._time = 0.0
        if isinstance(simulator, Snapshots):
            self.snapshot = simulator.snapshot
            self.restore = self._restore
            self._restore_unchecked = simulator.restore
        if isinstance(simulator, Rehearses):
            self.rehearse = simulator.rehearse

    def catalogue(self) -> Catalogue:
        """Return the simulator's vocabulary."""
        return as_catalogue(self._simulator.catalogue(), self.name)

    def reset(self, scene: Scene, seed: int) -> State:
        """Load a scene and return its first state, at time 0."""
        self._ids = ("ego", *(actor.id for actor in scene.actors))
        return self._check(self._simulator.reset(scene, seed), "reset()", 0.0)

    def step(self, control: Control) -> State:
        """Advance by exactly one `dt`."""
        return self._check(self._simulator.step(control), "step()", self._time + self.dt)

    def render(self, camera: Camera) -> Frame:
        """Render the current state; `render_checked` checks the frame."""
        return self._simulator.render(camera)

    def observe(self) -> Observation:
        """Return the driver's observation of the current state."""
        observation = self._simulator.observe()
        check_observation(observation, f"{self.name}: observe()")
        return observation

    def close(self) -> None:
        """Release all resources."""
        self._simulator.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def _restore(self, snapshot: Any) -> State:
        return self._check(self._restore_unchecked(snapshot), "restore()", None)

    def _check(self, state: State, method: str, time: float | None) -> State:
        """Return a copy of a state that a method returned, which must be that of a time, s, if one is given."""
        source = f"{self.name}: {method}"
        copy = own_state(state, self._ids, source)
        if time is not None and not abs(copy.time - time) <= _TIME_TOLERANCE * self.dt:
            raise SimulatorError(f"{source} returned the time {copy.time:g} s, not {time:g} s")
        self._time = copy.time
        return copy
