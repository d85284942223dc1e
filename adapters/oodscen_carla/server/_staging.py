"""A scene of a study that runs inside the served world; the hero is the client's to drive."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from oodscen.data import Asset, Catalogue, Scene
from oodscen.driving import KinematicWorld, action_driver, load_corridor
from oodscen.driving._sight.placement import staging_issues
from oodscen.errors import SceneError
from oodscen.protocols import Control
from oodscen_carla.server._actors import VehicleControl
from oodscen_carla.server._vehicles import demanded, wheels

HERO = "hero"
"""The role name of the ego."""


class StagedBody(NamedTuple):
    """One body of the scene, in right-handed axes."""

    name: str
    """`ego` or the actor's id."""
    asset: Asset
    state: str


class StagedScene:
    """Moves the bodies of one scene; the ego obeys pedals and wheel, or keeps lane and speed."""

    def __init__(self, scene: Scene, catalogue: Catalogue, seed: int) -> None:
        """Stage a scene.

        Raises:
            SceneError: If the catalogue or the road refuses the scene.
        """
        if issues := staging_issues(scene, catalogue):
            raise SceneError(scene.id, issues)
        self.scene = scene
        self.seed = seed
        corridor = load_corridor(scene.map, catalogue)
        self._world = KinematicWorld(corridor, scene, catalogue, seed)
        self._cruise = action_driver("keep_speed")
        self._owed = 0.0

    @property
    def time(self) -> float:
        """Time since the start of the scene, s."""
        return self._world.time

    def bodies(self) -> list[StagedBody]:
        """Return all bodies, the ego first."""
        return [StagedBody(*body) for body in self._world.bodies()]

    def poses(self) -> NDArray[np.float64]:
        """Return x, y, z and yaw of all bodies, [n, 4]."""
        return self._world.poses()

    def speeds(self) -> NDArray[np.float64]:
        """Return the speeds along the headings, m/s, [n]."""
        return self._world.speeds()

    def accelerations(self) -> NDArray[np.float64]:
        """Return the accelerations along the headings, m/s^2, [n]."""
        return self._world.accelerations()

    def touched(self) -> frozenset[str]:
        """Return the bodies that the ego touches, as every simulator judges it."""
        return frozenset(self._world.state().contacts)

    def alter(self, *, friction: float | None = None, speed: float | None = None) -> None:
        """Change the road's friction or the hero's speed, m/s."""
        self._world.alter(friction=friction, speed=speed)

    def advance(self, dt: float, control: VehicleControl | None) -> None:
        """Advance by whole steps of the scene, as many as the time given so far allows.

        Args:
            dt: Duration of the server's tick, s.
            control: The hero's pedals and wheel; `None` before the first.
        """
        self._owed += dt
        while self._owed >= self._world.dt - 1e-9:
            self._owed = max(0.0, self._owed - self._world.dt)
            self._world.step(self._demand(control))

    def _demand(self, control: VehicleControl | None) -> Control:
        if control is None:
            return self._cruise.act(self._world.observe())
        speed = float(self._world.speeds()[0])
        ahead = VehicleControl(**{**vars(control), "reverse": False})
        if control.reverse:
            ahead.throttle = 0.0
        return Control(demanded(ahead, speed), -wheels(control))


def carla_place(pose: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    """Return x, y, z and yaw in CARLA's left-handed axes, m and degrees."""
    x, y, z, yaw = pose
    return x, -y, z, -math.degrees(yaw)
