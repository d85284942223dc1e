"""The simulator: highway-env's road and bodies, the library's triggers and pictures."""

import copy
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from oodscen.data import Catalogue
from oodscen.driving import RestorableSimulator, StagedScene
from oodscen.errors import MissingExtra
from oodscen.protocols import Camera, Control, Frame
from oodscen_highway._catalogue import load_catalogue


class HighwaySimulator(RestorableSimulator):
    """Moves scenes with highway-env: bicycles, the intelligent driver model, and controlled lane changes.

    Pictures are the flat rasteriser's. highway-env is imported with the first scene.
    """

    name = "highway"
    packages = ("highway-env", "gymnasium")

    def __init__(self) -> None:
        """Start nothing yet."""
        super().__init__()
        self._road: Any = None
        self._bodies: list[Any] = []

    def catalogue(self) -> Catalogue:
        """Return the available assets, behaviours, maps and weather."""
        return load_catalogue()

    def begin(self, staged: StagedScene, seed: int) -> None:
        """Build the road and put all bodies on it.

        Raises:
            MissingExtra: If highway-env is not installed.
        """
        try:
            from oodscen_highway import _traffic
        except ModuleNotFoundError:
            raise MissingExtra("the highway-env simulator", "highway", "highway_env") from None
        self._road = _traffic.road_of(staged, seed)
        self._bodies = [
            _traffic.add_body(self._road, staged, body, self.dt) for body in staged.bodies
        ]

    def triggered(self, body: StagedScene.Body) -> None:
        """Start the time since an actor's trigger."""
        self._bodies[self.staged.ids.index(body.id)].since_s = 0.0

    def move(self, control: Control) -> None:
        """Let all drivers decide, then move all bodies."""
        ego = self._bodies[0]
        control = self.staged.within_grip(control, ego.speed)
        # The axles of a body of highway-env are its length apart.
        turn = math.tan(control.steering) * ego.LENGTH / self.wheelbase
        acceleration = max(control.acceleration, -ego.speed / self.dt)
        ego.act({"acceleration": acceleration, "steering": math.atan(turn)})
        self._road.act()
        self._road.step(self.dt)

    def bodies(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return x, y and yaw of all bodies, and their speeds."""
        poses = [(*body.position, math.remainder(body.heading, math.tau)) for body in self._bodies]
        return np.array(poses), np.array([body.speed for body in self._bodies])

    def save(self) -> Any:
        """Return a copy of all that changes."""
        return [_copied(body.__dict__) for body in self._bodies]

    def resume(self, saved: Any) -> None:
        """Return to a copy."""
        for body, values in zip(self._bodies, saved, strict=True):
            body.__dict__ = _copied(values)

    def draw(self, camera: Camera) -> Frame:
        """Draw boxes on a plane."""
        return self.staged.draw(camera, self.state().poses)

    def release(self) -> None:
        """Forget the road."""
        self._road, self._bodies = None, []


def _copied(values: dict[str, Any]) -> dict[str, Any]:
    """Return a copy of a body's attributes that shares road and lane."""
    return {
        name: value if name in ("road", "lane") else copy.copy(value)
        for name, value in values.items()
    }
