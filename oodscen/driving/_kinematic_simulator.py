"""The base class of simulators that render the kinematic world and compute no motion of their own."""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from types import TracebackType
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from oodscen._display import Brief
from oodscen.data._catalogue import Asset, BehaviourKind, Catalogue, RoadMap
from oodscen.data._scene import Scene
from oodscen.driving._motion.behaviours import BEHAVIOURS
from oodscen.driving._motion.world import KinematicWorld, Published, WorldSnapshot
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._sight.placement import staging_issues
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.errors import SceneError, SimulatorError, UsageError
from oodscen.protocols import Camera, Control, Frame, Observation, State

NEAR_M = 12.0
"""Distance between the circles of two bodies up to which the simulator measures their gap itself, m."""
LEAST_M = 1e-4
"""Smallest measured gap, m: 0 means contact, which only the catalogue's boxes decide."""


class KinematicSimulator(Brief, ABC):
    """Implements the `Simulator` protocol on top of `KinematicWorld`.

    A subclass sets `name` and implements `catalogue`, `load`, `spawn`, `place` and `draw`. It may
    override `gaps`, and should override `release` if it holds resources. Calls come in this order::

        catalogue()                        at any time, also before anything is started
        load, spawn (ego), spawn ..., place, gaps        in reset
        place, gaps                                      in every step and restore
        draw                                             in render
        release                                          in close, at most once per opening

    Resources are acquired late: a constructor must not start anything. `load` is called on every
    reset and must remove everything that an earlier scene left behind.
    """

    BEHAVIOURS: ClassVar[tuple[BehaviourKind, ...]] = BEHAVIOURS
    """The behaviours that the world moves, for the catalogue."""
    MAPS: ClassVar[tuple[RoadMap, ...]] = SHIPPED_MAPS
    """The shipped maps, for the catalogue."""
    _repr_fields: ClassVar[tuple[str, ...]] = ("name", "dt")

    name: str = "mirror"
    dt: float = 0.05
    """Seconds per step."""

    def __init__(self) -> None:
        self._world: KinematicWorld | None = None
        self._state: State | None = None
        self._seen: Published | None = None
        self._corridor: Corridor | None = None

    # ------------------------------------------------------------------ for the adapter

    @abstractmethod
    def catalogue(self) -> Catalogue:
        """Return the simulator's vocabulary: static, cheap to call again, without starting anything."""

    @abstractmethod
    def load(self, corridor: Corridor, scene: Scene, seed: int) -> None:
        """Clear everything and build the static world: ground, road, scenery, light and weather.

        Args:
            corridor: The road; its coordinates are the world's.
            scene: Source of the weather and the map's id; actors follow through `spawn`.
            seed: Seed for scenery; streams must be keyed, e.g. `stream(seed, "scenery", scene.map)`.
        """

    @abstractmethod
    def spawn(
        self, actor_id: str, asset: Asset, state: str, pose: tuple[float, float, float, float]
    ) -> None:
        """Add one body to the world: first the ego, then the actors in the scene's order.

        Args:
            actor_id: `ego`, or the actor's id.
            asset: The body's asset in the catalogue.
            state: One of the asset's states; empty if it has none.
            pose: x, y, z of the footprint's centre on the ground, m, and yaw, rad.

        Raises:
            SpawnError: If the body cannot be placed.
        """

    @abstractmethod
    def place(self, poses: NDArray[np.float64], speeds: NDArray[np.float64]) -> None:
        """Move all bodies.

        Args:
            poses: [n, 4], x, y, z, yaw; rows in the order of `spawn`.
            speeds: [n], m/s along the headings.
        """

    def gaps(self, rows: Sequence[int]) -> list[float]:
        """Return the distances between the ego's box (row 0) and the boxes of these rows, m.

        Called only for rows near the ego that do not touch it. The catalogue's boxes decide contact, as well as
        time to collision and all other measures. Override this method only to let the simulator's own engine
        measure the gaps.
        """
        assert self._seen is not None, "called in reset, step and restore only"
        return [float(self._seen.gaps[row]) for row in rows]

    @abstractmethod
    def draw(self, camera: Camera) -> Frame:
        """Render the ego camera's view; `ids` as in `Frame`: row r of the poses has id r + 1."""

    def release(self) -> None:
        """Release all resources; a later `load` may acquire them again. May be called twice."""

    # ------------------------------------------------------------------ the protocol

    @property
    def world(self) -> KinematicWorld:
        """The simulated kinematic world.

        Raises:
            SimulatorError: Before the first `reset` or after `close`.
        """
        if self._world is None:
            raise SimulatorError(f"{self.name}: call reset before anything else")
        return self._world

    @property
    def corridor(self) -> Corridor:
        """The road of the current scene."""
        return self.world.corridor

    def reset(self, scene: Scene, seed: int) -> State:
        """Load a scene. The same scene and seed give the same bytes, whatever ran before.

        Raises:
            SceneError: If the catalogue or the road refuses the scene.
            SpawnError: If an actor cannot be placed.
        """
        self._world = self._state = self._seen = None
        catalogue = self.catalogue()
        issues = staging_issues(scene, catalogue)
        if issues:
            raise SceneError(scene.id, issues)
        corridor = load_corridor(scene.map, catalogue)
        world = KinematicWorld(corridor, scene, catalogue, seed, dt=self.dt)
        self.load(corridor, scene, seed)
        poses = world.poses()
        for row, (actor_id, asset, state) in enumerate(world.bodies()):
            x, y, z, yaw = map(float, poses[row])
            self.spawn(actor_id, asset, state, (x, y, z, yaw))
        self._world = world
        return self._publish()

    def step(self, control: Control) -> State:
        """Advance by exactly one `dt`.

        Raises:
            UsageError: If the control is not finite, which means that its driver is broken.
        """
        for name, value in (
            ("acceleration", control.acceleration),
            ("steering", control.steering),
        ):
            if not math.isfinite(value):
                raise UsageError(f"control: {name} must be finite, not {value}")
        self.world.step(control)
        return self._publish()

    def render(self, camera: Camera) -> Frame:
        """Render the current state."""
        _ = self.world
        return self.draw(camera)

    def observe(self) -> Observation:
        """Return the driver's observation of the current state."""
        return self.world.observe()

    def state(self) -> State:
        """Return the current state again."""
        if self._state is None:
            raise SimulatorError(f"{self.name}: call reset before anything else")
        return self._state

    def snapshot(self) -> WorldSnapshot:
        """Return the current state of all motion as plain data for `restore`."""
        return self.world.snapshot()

    def restore(self, snapshot: WorldSnapshot) -> State:
        """Return to an earlier state of the current scene; the run then repeats exactly."""
        self.world.restore(snapshot)
        return self._publish()

    def close(self) -> None:
        """Release all resources; may be called twice."""
        self._world = self._state = self._seen = None
        self.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    # ------------------------------------------------------------------ internals

    def _publish(self) -> State:
        world = self.world
        seen = self._seen = world.publish()
        self.place(seen.poses, seen.speeds)
        gaps = seen.gaps
        near = np.flatnonzero((seen.apart <= NEAR_M) & (gaps > 0.0) & np.isfinite(gaps)).tolist()
        if near:
            for row, distance in zip(near, self.gaps(near), strict=True):
                gaps[row] = max(LEAST_M, round(float(distance), 4))
        for array in (seen.poses, seen.speeds, gaps, seen.accelerations, seen.places):
            array.setflags(write=False)
        self._state = State(
            world.step_count,
            world.time,
            world.ids,
            seen.poses,
            seen.speeds,
            gaps,
            seen.is_off_road,
            seen.accelerations,
            seen.places,
        )
        return self._state
