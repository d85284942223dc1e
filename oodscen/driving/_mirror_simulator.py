"""The base class of simulators that render the kinematic world and compute no motion of their own."""

import math
from abc import abstractmethod
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from oodscen._numbers import said
from oodscen.data._catalogue import Asset
from oodscen.data._scene import Scene
from oodscen.driving._base_simulator import BaseSimulator, checked_control
from oodscen.driving._motion.rollouts import Variation
from oodscen.driving._motion.world import KinematicWorld, WorldSnapshot
from oodscen.driving._roads.corridor import Corridor
from oodscen.errors import SimulatorError
from oodscen.protocols import Control, State

NEAR_M = 12.0
"""Distance between the circles of two bodies up to which the simulator measures their gap itself, m."""
LEAST_M = 1e-4
"""Smallest measured gap, m: 0 means contact, which only the catalogue's boxes decide."""
DEEPEST_M = 1.0
"""Depth to which an engine's own shapes may be in each other while the boxes do not touch, m."""


class MirrorSimulator(BaseSimulator):
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

    name: str = "mirror"

    def __init__(self) -> None:
        super().__init__()
        self._box_gaps: NDArray[np.float64] | None = None

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

        Called only for rows near the ego that do not touch it and stand upright; infinity is farther than it looked.
        The catalogue's boxes decide contact, as well as time to collision and all other measures. Override this method
        only to let the simulator's own engine measure the gaps.
        """
        assert self._box_gaps is not None, "called in reset, step and restore only"
        return [float(self._box_gaps[row]) for row in rows]

    def reset(self, scene: Scene, seed: int) -> State:
        """Load a scene. The same scene and seed give the same bytes, whatever ran before.

        Raises:
            SceneError: If the catalogue or the road refuses the scene.
            SpawnError: If an actor cannot be placed.
        """
        self._box_gaps = None
        corridor, catalogue = self._opened(scene)
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
        self.world.step(checked_control(control))
        return self._publish()

    def snapshot(self) -> WorldSnapshot:
        """Return the current state of all motion as plain data for `restore`."""
        return self.world.snapshot()

    def restore(self, snapshot: WorldSnapshot) -> State:
        """Return to an earlier state of the current scene; the run then repeats exactly.

        Raises:
            UsageError: If it is no snapshot, or one of another scene or seed.
        """
        self.world.restore(snapshot)
        return self._publish()

    def rehearse(
        self,
        action: str,
        seconds: float,
        *,
        reaction_s: float,
        friction: float = 1.0,
        speed: float = 1.0,
    ) -> bool:
        """Return whether an action, begun now, passes: no contact, on the road, not past a red light.

        Nothing is moved or published; the simulator stays in its current state.

        Args:
            action: Id of a discrete action.
            seconds: Time for which the action is watched, s.
            reaction_s: Time for which the driver keeps lane and speed first, s.
            friction: Share of the scene's friction.
            speed: Share of the ego's current speed at which it drives on.
        """
        return self.world.is_passed(action, Variation(reaction_s, friction, speed), seconds)

    def close(self) -> None:
        """Release all resources; may be called twice."""
        self._box_gaps = None
        super().close()

    def _publish(self) -> State:
        """Show the bodies where the world has them, and return its state with the gaps that the engine measures."""
        world = self.world
        state, apart = world.publish()
        self.place(state.poses.copy(), state.speeds.copy())  # It may work in its arrays.
        gaps = self._box_gaps = state.gaps
        tilted = world.tilts() if world.scene.motions else {}
        rows = [
            row
            for row, (about, gap) in enumerate(zip(apart.tolist(), gaps.tolist(), strict=True))
            if about <= NEAR_M and 0.0 < gap < math.inf and row not in tilted
        ]
        if rows:
            for row, distance in zip(rows, self._engine_gaps(rows), strict=True):
                gaps[row] = max(LEAST_M, round(distance, 4))
        return self._keep_state(state)

    def _engine_gaps(self, rows: Sequence[int]) -> list[float]:
        """Return what `gaps` measures.

        Raises:
            SimulatorError: If it is not one distance per row, or bodies whose boxes do not touch are deep in
                each other.
        """
        gaps = self.gaps(rows)
        try:
            distances = [float(gap) for gap in gaps]
        except (TypeError, ValueError, OverflowError):
            distances = []
        if len(distances) != len(rows) or not all(distance >= -DEEPEST_M for distance in distances):
            raise SimulatorError(
                f"{self.name}: gaps() returned {said(gaps, 80)}, not {len(rows)} distances of bodies that do not "
                "touch, m"
            )
        return distances
