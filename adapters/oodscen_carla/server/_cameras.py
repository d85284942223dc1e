"""The cameras' pictures, drawn by one of the library's simulators."""

import math
from collections.abc import Sequence
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from oodscen.data import Asset, Catalogue, Scene
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor
from oodscen.protocols import Camera, Frame

Pose = tuple[float, float, float, float]

_AWAY_M = 5_000.0
"""Distance at which a stand-in waits where a picture has no vehicle of its own, m."""
_STAND_IN = "(stand-in)"
"""Name of the stand-in, which no actor can have."""


@runtime_checkable
class BodyRenderer(Protocol):
    """The part of a simulator that draws without a world of its own."""

    def catalogue(self) -> Catalogue:
        """Return the assets that it draws."""
        ...

    def load(self, corridor: Corridor, scene: Scene, seed: int) -> None:
        """Clear everything and prepare a road."""

    def spawn(self, actor_id: str, asset: Asset, state: str, pose: Pose) -> None:
        """Add a body, the ego first."""

    def place(self, poses: NDArray[np.float64], speeds: NDArray[np.float64]) -> None:
        """Move all bodies."""

    def draw_from(
        self,
        camera: Camera,
        mount: Pose,
        *,
        accelerations: Sequence[float],
        time: float,
        roll_deg: float = 0.0,
    ) -> Frame:
        """Return the picture of a camera; on the ego, it sees by the ego's low beams."""
        ...

    def close(self) -> None:
        """Release all resources."""


class PicturedBody(NamedTuple):
    """One body of a picture, in right-handed axes."""

    key: int
    """The actor's id."""
    name: str
    """The name by which its paint, lamps and details are chosen."""
    asset: Asset
    state: str
    pose: Pose
    speed: float
    acceleration_along: float
    """Acceleration along the heading, m/s^2."""


class View(NamedTuple):
    """The camera of a picture, its place and the time."""

    camera: Camera
    mount: Pose
    roll_deg: float
    time: float
    """Time since the start, s."""


class CameraRenderer:
    """Keeps the drawing simulator's bodies in step with the served world."""

    def __init__(self, renderer: BodyRenderer) -> None:
        self._renderer = renderer
        self._loaded: object = None
        """The scene, the seed and the looks of bodies that the simulator has loaded."""

    def close(self) -> None:
        """Release the simulator."""
        self._renderer.close()

    def warm_up(self, scene: Scene) -> None:
        """Take a small picture, so that no client waits while kernels are compiled."""
        road = load_corridor(scene.map, self._renderer.catalogue())
        x, y, z, yaw = road.point(road.start, 0.0)
        view = View(Camera(width=64, height=48), (x, y, z, yaw), 0.0, 0.0)
        self.take(scene, 0, [], view, has_host=False)

    def take(
        self, scene: Scene, seed: int, bodies: Sequence[PicturedBody], view: View, *, has_host: bool
    ) -> tuple[Frame, NDArray[np.int32]]:
        """Return a picture, and the id of the actor for each of its ids.

        Args:
            scene: Gives the map and the weather.
            seed: Seed of scenery and paints.
            bodies: All bodies; the first carries the camera if `has_host`.
            view: The camera.
            has_host: Whether the first body carries the camera.
        """
        road = load_corridor(scene.map, self._renderer.catalogue())
        shown = list(bodies)
        if not has_host:
            shown.insert(0, self._stand_in(view.mount, road))
        self._load(scene, seed, road, shown)
        self._renderer.place(
            np.array([body.pose for body in shown], np.float64),
            np.array([body.speed for body in shown], np.float64),
        )
        frame = self._renderer.draw_from(
            view.camera,
            view.mount,
            accelerations=[body.acceleration_along for body in shown],
            time=view.time,
            roll_deg=view.roll_deg,
        )
        return frame, np.array([0, *(body.key for body in shown)], np.int32)

    def _stand_in(self, mount: Pose, road: Corridor) -> PicturedBody:
        """Return the ego of a picture that has none: far behind the camera, its lamps and itself out of sight."""
        x, y, _, yaw = mount
        ground = road.point(road.locate(x, y)[0], 0.0)[2]
        pose = (x - _AWAY_M * math.cos(yaw), y - _AWAY_M * math.sin(yaw), ground, 0.0)
        return PicturedBody(0, _STAND_IN, self._renderer.catalogue().ego, "", pose, 0.0, 0.0)

    def _load(self, scene: Scene, seed: int, road: Corridor, shown: Sequence[PicturedBody]) -> None:
        """Load the scene and its bodies, unless the last picture showed the same with the same host."""
        looks = tuple((body.key, body.name, body.asset.id, body.state) for body in shown)
        if (scene, seed, looks) == self._loaded:
            return
        self._loaded = None
        self._renderer.load(road, scene, seed)
        for body in shown:
            self._renderer.spawn(body.name, body.asset, body.state, body.pose)
        self._loaded = (scene, seed, looks)
