"""Shows scenes in a running CARLA server; the motion is the kinematic world's."""

import math
import os
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from oodscen import make_catalogue
from oodscen.data import Asset, Catalogue, Scene
from oodscen.driving import MirrorSimulator
from oodscen.driving._roads.building import find_map, read_map
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._sight.lamps import has_lamps_on, is_braking, waits_in_traffic
from oodscen.errors import SimulatorError, SpawnError
from oodscen.protocols import Camera, Frame
from oodscen_carla._blueprints import blueprint_of
from oodscen_carla._catalogue import load_catalogue
from oodscen_carla._connection import Connection, ServerBody, host_and_port
from oodscen_carla._lights import LAMPS_OF_STATE, VehicleLight
from oodscen_carla._opendrive import decoded, for_carla
from oodscen_carla._weather import to_carla

ADDRESS_VARIABLE = "OODSCEN_CARLA"
"""Environment variable with the server's `host:port`."""
_ABOVE_M = 500.0
"""Height above the road at which bodies are spawned, out of everything's way, m."""
_APART_M = 50.0
"""Distance in height between two bodies that are spawned, m."""


class _ShownBody(NamedTuple):
    """One body on the server, and what its lamps depend on."""

    body: ServerBody
    lights: VehicleLight
    """The lamps that are on in any case."""
    waits: bool
    """True if it waits in traffic, with its brake lamps on."""


class CarlaSimulator(MirrorSimulator):
    """Drives a CARLA server of version 0.9.16 in synchronous mode.

    The server shows the scenes: it gets the road as OpenDRIVE, a blueprint for every body, the
    poses of each step, the weather, and cameras for colour, depth and instances. Episodes therefore
    equal those of every other kinematic simulator. Everything is removed at the end, and the server's
    settings return to what they were. The server is needed alone: bodies of other clients are removed, too.
    The first scene connects; a server that was restarted is found again by the next scene.
    """

    name = "carla"
    packages = ("carla",)

    def __init__(
        self,
        address: str | None = None,
        *,
        catalogue: str | Path | Catalogue | None = None,
        timeout_s: float = 20.0,
    ) -> None:
        """Connect to nothing yet.

        Args:
            address: The server's `host:port`; by default the environment variable OODSCEN_CARLA, or
                127.0.0.1:2000.
            catalogue: The vocabulary of the scenes, if it is not CARLA's own: a name such as
                `pybullet`, whose assets get blueprints by their names and sizes.
            timeout_s: Time that every call may take, s; loading a road in CARLA takes some.
        """
        super().__init__()
        self._address = address or os.environ.get(ADDRESS_VARIABLE) or "127.0.0.1:2000"
        host_and_port(self._address)
        self._source = catalogue
        self._timeout_s = timeout_s
        self._connection: Connection | None = None
        self._shown: list[_ShownBody] = []
        self._scene: Scene | None = None

    @cached_property
    def _catalogue(self) -> Catalogue:
        if self._source is not None:
            return make_catalogue(self._source)
        catalogue = load_catalogue()
        return Catalogue(
            simulator=self.name,
            version=catalogue.version,
            ego=catalogue.ego,
            assets=tuple(asset for asset in catalogue.assets if "@" not in asset.id),
            behaviours=self.BEHAVIOURS,
            maps=self.MAPS,
            weather=catalogue.weather,
        )

    def catalogue(self) -> Catalogue:
        """Return the vocabulary; no server is asked."""
        return self._catalogue

    def save_map(self, file: str | Path) -> None:
        """Write the OpenDRIVE map that the server shows now.

        Scenes that name the file as their map are then staged in the server's own town.

        Args:
            file: A path that ends in `.xodr`.
        """
        Path(file).write_text(self._connected().map_text(), encoding="utf-8")

    def load(self, corridor: Corridor, scene: Scene, seed: int) -> None:
        """Remove the last scene, and set road, weather and clock.

        Raises:
            MissingExtra: If the `carla` package is not installed.
            SimulatorError: If there is no server, or it is of another version.
        """
        self._shown, self._scene = [], scene
        connection = self._connected()
        try:
            connection.clear(others=True)
        except SimulatorError:
            connection = self._reconnected()
            connection.clear(others=True)
        text = for_carla(decoded(read_map(find_map(scene.map, self.catalogue()).file)))
        connection.open(text, self.dt)
        connection.set_weather(to_carla(scene.weather))

    def spawn(
        self, actor_id: str, asset: Asset, state: str, pose: tuple[float, float, float, float]
    ) -> None:
        """Add one body, in the air; `place` puts it down.

        Raises:
            SpawnError: If the pose is invalid, no blueprint fits, or the server refuses.
        """
        if not all(map(math.isfinite, pose)):
            raise SpawnError(actor_id, asset.id, pose, "the pose is not finite")
        connection = self._open()
        catalogue = load_catalogue()
        name = blueprint_of(asset, connection.blueprints, (catalogue.ego, *catalogue.assets))
        if name is None:
            raise SpawnError(actor_id, asset.id, pose, "the server has no blueprint of this kind")
        x, y, z, yaw = pose
        above = (x, y, z + _ABOVE_M + _APART_M * len(self._shown), yaw)
        role = actor_id if self._shown else "hero"
        try:
            body = connection.spawn(name, above, role=role, state=state)
        except RuntimeError as error:
            raise SpawnError(actor_id, asset.id, pose, str(error)) from None
        lights = LAMPS_OF_STATE.get(state, VehicleLight(0))
        if state == "brake":
            lights = VehicleLight.BRAKE
        waits = False
        if self._scene is not None:
            waits = waits_in_traffic(self._scene, actor_id)
            if has_lamps_on(self._scene, actor_id):
                lights |= VehicleLight.POSITION | VehicleLight.LOW_BEAM
        self._shown.append(_ShownBody(body, lights, waits))

    def place(self, poses: NDArray[np.float64], speeds: NDArray[np.float64]) -> None:
        """Send poses, speeds and lights, and let the server take one tick."""
        lights = []
        for shown, speed, acceleration in zip(
            self._shown, speeds.tolist(), self.world.accelerations().tolist(), strict=True
        ):
            is_stopping = is_braking(speed, acceleration, waits=shown.waits)
            lights.append(shown.lights | VehicleLight.BRAKE if is_stopping else shown.lights)
        bodies = [shown.body for shown in self._shown]
        self._open().place(bodies, poses.tolist(), speeds.tolist(), lights)

    def draw(self, camera: Camera) -> Frame:
        """Return what the cameras of the same tick show."""
        return self._open().take([shown.body for shown in self._shown], camera)

    def release(self) -> None:
        """Remove everything, and give the server its settings back."""
        connection, self._connection, self._shown = self._connection, None, []
        if connection is not None:
            connection.close()

    def _connected(self) -> Connection:
        """Return the connection, which the first call opens."""
        if self._connection is None:
            self._connection = Connection(self._address, self._timeout_s)
        return self._connection

    def _reconnected(self) -> Connection:
        """Return a new connection, to a server that was restarted."""
        self._connection = None
        return self._connected()

    def _open(self) -> Connection:
        """Return the connection that the last reset left open."""
        if self._connection is None:
            raise SimulatorError(f"{self.name}: call reset before anything else")
        return self._connection
