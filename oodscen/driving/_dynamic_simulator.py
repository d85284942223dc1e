"""The base classes of simulators that own motion."""

from abc import abstractmethod
from dataclasses import replace
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from oodscen._arguments import instance_of
from oodscen.data._scene import Scene
from oodscen.driving._base_simulator import BaseSimulator, checked_control
from oodscen.driving._motion.bodies import WHEELBASE
from oodscen.driving._motion.world import KinematicWorld, WorldSnapshot
from oodscen.driving._staged_scene import StagedBody, StagedScene, with_heights
from oodscen.errors import SimulatorError
from oodscen.protocols import Control, Observation, State

_FASTEST_MPS = 1e4
"""Greatest speed that a body can have, m/s."""


class DynamicSimulator(BaseSimulator):
    """Implements the `Simulator` protocol for a simulator with dynamics of its own.

    A subclass sets `name` and implements `catalogue`, `begin`, `move`, `bodies` and `draw`. It should
    override `triggered` if its catalogue has behaviours that wait for a trigger, and `release` if it holds
    resources. Calls come in this order::

        catalogue()                                 at any time, also before anything is started
        begin, triggered ..., bodies                in reset
        move, bodies, triggered ...                 in every step
        draw                                        in render
        release                                     in close

    The library refuses scenes that cannot be staged, decides when triggers fire, and derives the rest of the
    state and the observation from the poses and the catalogue's boxes: gaps, contact, places on the road,
    leaving it, and accelerations. Poses are rounded to 1e-6, so that their bytes can repeat.

    Axes are those of ISO 8855: x forward, y to the left, z up, yaw counter-clockwise from x; units are
    metres, seconds, m/s and radians. Convert at this boundary.

    Bodies keep moving after a contact. Any exception but an `OodscenError` costs only the scene, as a
    `SimulatorCrash`. Resources are acquired late: a constructor must not start anything.
    """

    plays_motions: ClassVar[bool] = False
    wheelbase: float = WHEELBASE
    """Distance between the ego's axles, m, which drivers use to steer."""

    def __init__(self) -> None:
        super().__init__()
        self._staged: StagedScene | None = None

    @abstractmethod
    def begin(self, staged: StagedScene, seed: int) -> None:
        """Clear everything and build the scene: road, weather, and every body of `staged.bodies`.

        Args:
            staged: The scene, its road, and the bodies at their start with speeds and behaviours.
            seed: Seed of everything random; the same scene and seed must give the same motion.

        Raises:
            SpawnError: If a body cannot be placed.
        """

    @abstractmethod
    def move(self, control: Control) -> None:
        """Advance everything by exactly one `dt`.

        Args:
            control: The ego's acceleration along its heading, m/s^2, and front wheel angle, rad, left
                positive; finite. The ego must not reverse, and must not use more than the tyres transmit
                (`staged.within_grip` limits a control).
        """

    @abstractmethod
    def bodies(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the present poses and speeds of all bodies, in the order of `staged.ids`.

        Returns:
            Poses: [n, 4], x, y, z of the footprint's centre on the ground and yaw, or [n, 3] without z for
            bodies on the road. Speeds: [n], m/s along the headings, negative in reverse.
        """

    def triggered(self, body: StagedBody) -> None:
        """Start the behaviour of an actor whose trigger has just fired; called once per actor and run."""

    @property
    def staged(self) -> StagedScene:
        """The current scene on its road.

        Raises:
            SimulatorError: Before the first `reset` or after `close`.
        """
        if self._staged is None:
            raise SimulatorError(f"{self.name}: call reset before anything else")
        return self._staged

    def reset(self, scene: Scene, seed: int) -> State:
        """Load a scene. The same scene and seed give the same bytes, whatever ran before.

        Raises:
            SceneError: If the catalogue or the road refuses the scene.
            SpawnError: If an actor cannot be placed.
        """
        self._staged = None
        corridor, catalogue = self._opened(scene)
        world = KinematicWorld(corridor, scene, catalogue, seed, dt=self.dt)
        staged = StagedScene(scene, catalogue, seed, dt=self.dt)
        self._staged = staged
        self.begin(staged, seed)
        self._fire(world, -1.0)
        world.set_poses(*self._measured())
        self._world = world
        return self._keep_state(world.state())

    def step(self, control: Control) -> State:
        """Advance by exactly one `dt`.

        Raises:
            UsageError: If the control is not finite, which means that its driver is broken.
            SimulatorError: If `bodies` returns something else than it should.
        """
        world, before = self.world, self.world.time
        self.move(checked_control(control))
        world.follow(*self._measured())
        self._fire(world, before)
        return self._keep_state(world.state())

    def observe(self) -> Observation:
        """Return the driver's observation of the current state."""
        return replace(self.world.observe(), wheelbase=self.wheelbase)

    def since(self, actor_id: str) -> float | None:
        """Return the time since an actor's trigger fired, s; `None` before."""
        fired = self.world.motion(actor_id).triggered
        return None if fired < 0.0 else self.world.time - fired

    def close(self) -> None:
        """Release all resources; may be called twice."""
        self._staged = None
        super().close()

    def _fire(self, world: KinematicWorld, before: float) -> None:
        """Tell the adapter about the triggers that have fired after a time."""
        for body in self.staged.bodies[1:]:
            fired = world.motion(body.id).triggered
            if fired >= 0.0 and fired > before:
                self.triggered(body)

    def _measured(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the adapter's poses and speeds, rounded.

        Raises:
            SimulatorError: If they are of another shape, not finite or beyond all sense.
        """
        count = len(self.staged.ids)
        given = self.bodies()
        try:
            poses, speeds = given
            poses = with_heights(poses, count)
            speeds = np.asarray(speeds, dtype=np.float64)
        except (TypeError, ValueError, OverflowError) as error:
            raise SimulatorError(
                f"{self.name}: bodies() returned no poses and speeds: {error}"
            ) from error
        if speeds.shape != (count,) or not (np.abs(speeds) <= _FASTEST_MPS).all():
            raise SimulatorError(
                f"{self.name}: bodies() returned speeds that are not {count} numbers up to {_FASTEST_MPS:g} m/s"
            )
        return _rounded(poses), _rounded(speeds)


class Snapshot(NamedTuple):
    """The state of a simulator that can go back: the library's part and the adapter's."""

    world: WorldSnapshot
    saved: Any


class RestorableSimulator(DynamicSimulator):
    """A `DynamicSimulator` that can return to an earlier step, which makes episodes several times faster.

    A subclass implements `save` and `resume` in addition.
    """

    @abstractmethod
    def save(self) -> Any:
        """Return a copy of all changing state: poses, speeds, timers, random streams, triggers seen."""

    @abstractmethod
    def resume(self, saved: Any) -> None:
        """Return to a state of the current scene that `save` returned; it may be used again later."""

    def snapshot(self) -> Snapshot:
        """Return the current state of all motion as plain data for `restore`."""
        return Snapshot(self.world.snapshot(), self.save())

    def restore(self, snapshot: Snapshot) -> State:
        """Return to an earlier state of the current scene; the run then repeats exactly.

        Raises:
            UsageError: If it is no snapshot, or one of another scene or seed.
        """
        instance_of("snapshot", snapshot, Snapshot)
        self.world.restore(snapshot.world)
        self.resume(snapshot.saved)
        return self._keep_state(self.world.state())


def _rounded(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return values rounded to 1e-6, as the kinematic world's are."""
    return np.floor(values * 1e6 + 0.5) / 1e6
