"""A connection to a CARLA server through the official client, which must be of the same version."""

import math
import queue
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from oodscen.errors import MissingExtra, SimulatorError, UsageError
from oodscen.protocols import Camera, Frame
from oodscen_carla._weather import WeatherParameters

VERSIONS = ("0.9.15", "0.9.16")
"""Versions that the adapter accepts, of server and client alike."""
KINDS = ("rgb", "depth", "instance_segmentation")
"""Cameras of a frame."""
_BODIES = ("vehicle.", "walker.", "static.prop.")
"""Beginnings of the ids of all blueprints with a body."""
_TRIES = 3
"""Number of ticks after which a frame that never comes is an error."""
_SKY_M = 999.99
"""Depth from which a pixel is sky, m."""


@dataclass(frozen=True, eq=False)
class Placed:
    """One body on the server."""

    id: int
    """The actor's id."""
    actor: Any
    """The client's actor."""
    lift: float
    """Height of the actor's origin above its feet, m."""


class Connection:
    """One client of one server; its failures become `SimulatorError`, but for a refused spawn."""

    def __init__(self, address: str, timeout_s: float) -> None:
        """Connect.

        Args:
            address: The server's `host:port`.
            timeout_s: Time that every call may take, s.

        Raises:
            UsageError: If the address is malformed.
            MissingExtra: If the `carla` package is not installed.
            SimulatorError: If there is no server, or it is of another version.
        """
        host, _, port = address.rpartition(":")
        if not host or not port.isdigit() or not 0 < int(port) < 65536:
            raise UsageError(f"CARLA's address must be host:port, not {address[:80]!r}")
        self._address, self._timeout_s = address, timeout_s
        self._carla = carla = _load()
        self._forget()
        self._map: str | None = None
        self._before: Any = None
        self._frame = 0
        self._is_listening = self._is_seen = False
        with self._calling("connect"):
            self._client = carla.Client(host, int(port), 1)  # One worker thread.
            self._client.set_timeout(timeout_s)
            server, own = self._client.get_server_version(), self._client.get_client_version()
        if server != own or own not in VERSIONS:
            raise SimulatorError(
                f"the CARLA server at {address} has version {server}, the client {own}; both must be "
                f"the same, one of {', '.join(VERSIONS)}"
            )
        with self._calling("get the world"):
            self._world = self._client.get_world()
            self._blueprints = self._world.get_blueprint_library()

    @contextmanager
    def _calling(self, doing: str) -> Iterator[None]:
        try:
            yield
        except RuntimeError as error:
            message = " ".join(str(error).split())[:300]
            raise SimulatorError(f"CARLA at {self._address} failed to {doing}: {message}") from None

    # ------------------------------------------------------------------ world

    @property
    def blueprints(self) -> frozenset[str]:
        """Ids of the server's blueprints."""
        return frozenset(one.id for one in self._blueprints)

    def map_text(self) -> str:
        """Return the server's OpenDRIVE map."""
        with self._calling("get the map"):
            return str(self._world.get_map().to_opendrive())

    def open(self, text: str, dt: float) -> None:
        """Show a road, unless the server shows it already, and stop the server's own clock.

        Args:
            text: The OpenDRIVE document.
            dt: Duration of a tick, s.
        """
        if self._map != text:
            if self.map_text().strip() != text.strip():
                with self._calling("load the road"):
                    self._world = self._client.generate_opendrive_world(text)
                    self._blueprints = self._world.get_blueprint_library()
                self._before = None
            self._map = text
        with self._calling("set the synchronous mode"):
            settings = self._world.get_settings()
            if self._before is None:
                self._before = self._world.get_settings()
            if not settings.synchronous_mode or settings.fixed_delta_seconds != dt:
                settings.synchronous_mode, settings.fixed_delta_seconds = True, dt
                self._world.apply_settings(settings)

    def set_weather(self, weather: WeatherParameters) -> None:
        """Set the weather."""
        with self._calling("set the weather"):
            self._world.set_weather(self._carla.WeatherParameters(**weather._asdict()))

    def clear(self, *, others: bool = False) -> None:
        """Destroy everything that this connection has spawned.

        Args:
            others: Also destroy all other bodies, such as those that a broken script left behind.
        """
        with self._calling("remove the last scene"):
            self._follow_episode()
            doomed = [camera.id for camera, _ in self._cameras.values()] + self._actors
            self._listen(False)
            if others:
                every = self._world.get_actors()
                own = set(doomed)
                doomed += [
                    one.id for one in every if one.type_id.startswith(_BODIES) and one.id not in own
                ]
            if doomed:
                commands = [self._carla.command.DestroyActor(number) for number in doomed]
                self._client.apply_batch_sync(commands, False)
        self._forget()

    def _follow_episode(self) -> None:
        """Notice that another client has loaded another world, in which nothing of this one is left."""
        world = self._client.get_world()
        if world.id != self._world.id:
            # A camera that still listens when it is forgotten would end the process.
            self._listen(False)
            self._world, self._map = world, None
            self._forget()

    def _forget(self) -> None:
        """Forget cameras and actors, of which the server has none."""
        self._cameras: dict[str, tuple[Any, queue.SimpleQueue[Any]]] = {}
        self._mounted: tuple[int, Camera] | None = None
        self._actors: list[int] = []
        self._lit: dict[int, int] = {}

    def close(self) -> None:
        """Destroy everything and restore the settings; a server that is gone needs neither."""
        try:
            self.clear()
            if self._before is not None:
                with self._calling("restore the settings"):
                    self._world.apply_settings(self._before)
        except SimulatorError:
            pass

    # ------------------------------------------------------------------ bodies

    def spawn(
        self, blueprint: str, pose: tuple[float, float, float, float], *, role: str, state: str
    ) -> Placed:
        """Add a body without physics.

        Raises:
            RuntimeError: If the server refuses.
        """
        chosen = self._blueprints.find(blueprint)
        for name, value in (("role_name", role), ("state", state)):
            if value and chosen.has_attribute(name):
                chosen.set_attribute(name, value)
        actor = self._world.spawn_actor(chosen, self._transform(pose, 0.0))
        self._actors.append(actor.id)
        actor.set_simulate_physics(False)
        box = actor.bounding_box
        is_walker = blueprint.startswith("walker.")
        return Placed(actor.id, actor, box.extent.z - box.location.z if is_walker else 0.0)

    def place(
        self,
        bodies: Sequence[Placed],
        poses: Sequence[Sequence[float]],
        speeds: Sequence[float],
        lights: Sequence[int],
    ) -> None:
        """Move all bodies, switch the lamps of vehicles, and take one tick."""
        command, commands = self._carla.command, []
        for body, pose, speed, lit in zip(bodies, poses, speeds, lights, strict=True):
            if self._lit.get(body.id, 0) != lit and hasattr(body.actor, "set_light_state"):
                state = self._carla.VehicleLightState(lit)
                commands.append(command.SetVehicleLightState(body.id, state))
                self._lit[body.id] = lit
            yaw = pose[3]
            velocity = self._carla.Vector3D(speed * math.cos(yaw), -speed * math.sin(yaw), 0.0)
            commands.append(command.ApplyTransform(body.id, self._transform(pose, body.lift)))
            commands.append(command.ApplyTargetVelocity(body.id, velocity))
        with self._calling("move the actors"):
            if self._is_listening and not self._is_seen:
                self._listen(False)
            answers = self._client.apply_batch_sync(commands, False)
            failed = [one.error for one in answers if one.has_error()]
        if failed:
            raise SimulatorError(f"CARLA at {self._address} lost an actor: {failed[0][:200]}")
        self._tick()

    def _tick(self) -> None:
        with self._calling("take a step"):
            self._frame = self._world.tick()
        self._is_seen = False

    def _transform(self, pose: Sequence[float], lift: float) -> Any:
        x, y, z, yaw = pose
        place = self._carla.Location(x, -y, z + lift)
        return self._carla.Transform(place, self._carla.Rotation(yaw=-math.degrees(yaw)))

    # ------------------------------------------------------------------ cameras

    def take(self, bodies: Sequence[Placed], camera: Camera) -> Frame:
        """Return the picture of the last tick; another tick is taken if the cameras slept.

        Raises:
            SimulatorError: If no complete frame arrives.
        """
        if self._mounted != (bodies[0].id, camera):
            self._mount(bodies[0], camera)
        if not self._is_listening:
            self._listen(True)
            self._tick()
        for _ in range(_TRIES):
            images = self._images()
            if images is not None:
                self._is_seen = True
                return _frame(images, bodies, camera)
            self._tick()
        raise SimulatorError(f"CARLA at {self._address} lost {_TRIES} frames in a row")

    def _mount(self, host: Placed, camera: Camera) -> None:
        """Replace the cameras."""
        with self._calling("mount the cameras"):
            self._listen(False)
            for old, _ in self._cameras.values():
                old.destroy()
            self._cameras = {}
            place = self._carla.Transform(
                self._carla.Location(camera.x, -camera.y, camera.z),
                self._carla.Rotation(pitch=-camera.pitch_deg, yaw=-camera.yaw_deg),
            )
            for kind in KINDS:
                blueprint = self._blueprints.find(f"sensor.camera.{kind}")
                for name, value in (
                    ("image_size_x", camera.width),
                    ("image_size_y", camera.height),
                    ("fov", camera.fov_deg),
                ):
                    blueprint.set_attribute(name, str(value))
                sensor = self._world.spawn_actor(blueprint, place, attach_to=host.actor)
                self._cameras[kind] = sensor, queue.SimpleQueue()
        self._mounted = (host.id, camera)

    def _listen(self, wanted: bool) -> None:
        """Begin or end to receive pictures."""
        for sensor, images in self._cameras.values():
            if wanted and not self._is_listening:
                sensor.listen(images.put)
            elif self._is_listening and not wanted:
                sensor.stop()
        self._is_listening = wanted and bool(self._cameras)

    def _images(self) -> dict[str, Any] | None:
        """Return the pictures of the last tick, or `None` if one of them is lost."""
        found = {}
        for kind, (_, images) in self._cameras.items():
            try:
                image = images.get(timeout=self._timeout_s / _TRIES)
                while image.frame < self._frame:
                    image = images.get(timeout=self._timeout_s / _TRIES)
            except queue.Empty:
                return None
            if image.frame > self._frame:
                return None
            found[kind] = image
        return found


def _load() -> Any:
    try:
        import carla
    except ModuleNotFoundError:
        raise MissingExtra("a CARLA server", "carla", "carla") from None
    return carla


def _frame(images: dict[str, Any], bodies: Sequence[Placed], camera: Camera) -> Frame:
    """Decode the three pictures of one tick."""
    shape = (camera.height, camera.width, 4)
    raw = {k: np.frombuffer(image.raw_data, np.uint8).reshape(shape) for k, image in images.items()}
    code = raw["depth"].astype(np.uint32)
    depth = (code[..., 2] + 256 * code[..., 1] + 65536 * code[..., 0]) * (1000.0 / 16_777_215.0)
    depth[depth >= _SKY_M] = np.inf
    tags = raw["instance_segmentation"].astype(np.int32)
    number = tags[..., 1] + 256 * tags[..., 0]
    rows: NDArray[np.int32] = np.zeros(1 << 16, np.int32)
    for row, body in enumerate(bodies):
        rows[body.id & 0xFFFF] = row + 1
    ids = rows[number]
    return Frame(
        rgb=np.ascontiguousarray(raw["rgb"][..., 2::-1]),
        depth=depth.astype(np.float32),
        ids=ids,
        tags=np.where(ids > 0, np.uint8(0), raw["instance_segmentation"][..., 2]),
    )
