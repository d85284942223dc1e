"""A scene of a study that runs inside the served world; the hero is the client's to drive."""

import math
from dataclasses import replace

from oodscen.data import Catalogue, Scene
from oodscen.driving import KinematicWorld
from oodscen.driving._motion.actions import action_driver
from oodscen.driving._motion.triggers import ROUNDING_S
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._sight.placement import staging_issues, vocabulary_advice
from oodscen.errors import SceneError
from oodscen.protocols import Control
from oodscen_carla.server._actors import VehicleControl
from oodscen_carla.server._vehicles import demanded, wheels

HERO = "hero"
"""The role name of the ego."""


class ServedScene:
    """Moves the bodies of one scene; the ego obeys pedals and wheel, or keeps lane and speed."""

    def __init__(self, scene: Scene, catalogue: Catalogue, seed: int) -> None:
        """Stage a scene.

        Raises:
            SceneError: If the catalogue or the road refuses the scene.
        """
        if issues := staging_issues(scene, catalogue):
            raise SceneError(scene.id, [*issues, *vocabulary_advice(scene, catalogue)])
        self.scene = scene
        self.world = KinematicWorld(load_corridor(scene.map, catalogue), scene, catalogue, seed)
        self._cruise = action_driver("keep_speed")
        self._owed = 0.0

    def set_speed(self, speed: float) -> None:
        """Give the ego a speed, m/s, which it keeps until the first control; a negative one is 0."""
        self.world.alter(speed=speed)
        self._cruise = action_driver("keep_speed")

    def advance(self, dt: float, control: VehicleControl | None) -> None:
        """Advance by whole steps of the scene, as many as the time given so far allows.

        Args:
            dt: Duration of the server's tick, s.
            control: The hero's pedals and wheel; `None` before the first.
        """
        self._owed += dt
        while self._owed >= self.world.dt - ROUNDING_S:
            self._owed = max(0.0, self._owed - self.world.dt)
            self.world.step(self._demand(control))

    def _demand(self, control: VehicleControl | None) -> Control:
        """Return what the pedals and the wheel demand; the hero of a scene never reverses."""
        if control is None:
            return self._cruise.act(self.world.observe())
        speed = float(self.world.speeds()[0])
        throttle = 0.0 if control.reverse else control.throttle
        ahead = replace(control, reverse=False, throttle=throttle)
        return Control(demanded(ahead, speed), -wheels(control))


def carla_place(pose: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    """Return x, y, z and yaw in CARLA's left-handed axes, m and degrees."""
    x, y, z, yaw = pose
    return x, -y, z, -math.degrees(yaw)
