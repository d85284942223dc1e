"""A complete simulator that needs only NumPy: boxes on a plane.

It is the reference for adapters, and quick tests run on it.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._scene import Scene
from oodscen.data._weather import Weather
from oodscen.driving._flat_frame import flat_frame
from oodscen.driving._mirror_simulator import MirrorSimulator
from oodscen.driving._roads.corridor import Corridor
from oodscen.protocols import Camera, Frame
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE

Floats = NDArray[np.float64]


class FlatSimulator(MirrorSimulator):
    """Renders the kinematic world as shaded boxes on a plane."""

    name = "flat"

    def __init__(self) -> None:
        super().__init__()
        self._road: Corridor | None = None
        self._weather = Weather()
        self._assets: list[Asset] = []
        self._poses: list[list[float]] = []

    def catalogue(self) -> Catalogue:
        """Return the catalogue of all shared assets."""
        return FLAT_CATALOGUE

    def load(self, corridor: Corridor, scene: Scene, seed: int) -> None:
        """Discard the last scene; keep the new road and weather."""
        self._road = corridor
        self._weather = scene.weather
        self._assets, self._poses = [], []

    def spawn(
        self, actor_id: str, asset: Asset, state: str, pose: tuple[float, float, float, float]
    ) -> None:
        """Add one box."""
        self._assets.append(asset)
        self._poses.append(list(pose))

    def place(self, poses: Floats, speeds: Floats) -> None:
        """Move the boxes."""
        self._poses = poses.tolist()

    def release(self) -> None:
        """Discard the scene."""
        self._road = None
        self._assets, self._poses = [], []

    def draw(self, camera: Camera) -> Frame:
        """Cast one ray through the centre of every pixel."""
        return self._frame(camera, None)

    def draw_from(
        self,
        camera: Camera,
        mount: tuple[float, float, float, float],
        *,
        accelerations: Sequence[float],
        time: float,
        roll_deg: float = 0.0,
    ) -> Frame:
        """Return the picture of a camera anywhere; needs `load`, `spawn` and `place`, but no world.

        Args:
            camera: The camera, relative to `mount`.
            mount: x, y, z, m, and yaw, rad, of what the camera is mounted on.
            accelerations: Unused: boxes have no lamps.
            time: Unused: nothing flickers.
            roll_deg: Unused: the camera stays level.
        """
        return self._frame(camera, mount)

    def _frame(self, camera: Camera, mount: Sequence[float] | None) -> Frame:
        assert self._road is not None
        return flat_frame(camera, self._road, self._weather, self._assets, self._poses, mount)
