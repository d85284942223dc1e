"""A connection to a CARLA server through the official client, which must be of the same version."""

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from oodscen.errors import MissingExtra, SimulatorError, UsageError
from oodscen.protocols import Camera, Frame
from oodscen_carla._cameras import Cameras, decode
from oodscen_carla._lights import VehicleLight
from oodscen_carla._weather import WeatherParameters

VERSION = "0.9.16"
"""Version that the adapter accepts, of server and client alike: the instance pictures of older ones name no actors."""
_BODIES = ("vehicle.", "walker.", "static.prop.")
"""Beginnings of the ids of all blueprints with a body."""
_TICKS_PER_FRAME = 3
"""Number of ticks after which a frame that never comes is an error."""
_LAST_PORT = 65_535


@dataclass(frozen=True, eq=False)
class ServerBody:
    """One body on the server."""

    id: int
    """The actor's id."""
    actor: Any
    """The client's actor."""
    lift_m: float
    """Height of the actor's origin above its feet, m."""
    tags: frozenset[int]
    """Semantic tags of its pixels; empty if the server names none."""


def host_and_port(address: str) -> tuple[str, int]:
    """Return the parts of a server's address, `host:port`.

    Raises:
        UsageError: If it is malformed.
    """
    host, _, port = address.rpartition(":")
    is_number = port.isascii() and port.isdecimal() and len(port) <= 5
    if not host or not is_number or not 0 < int(port) <= _LAST_PORT:
        raise UsageError(f"CARLA's address must be host:port, not {address[:80]!r}")
    return host, int(port)


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
        host, port = host_and_port(address)
        self._address, self._timeout_s = address, timeout_s
        self._carla = carla = _load()
        self._cameras = Cameras()
        self._actors: list[int] = []
        self._lights: dict[int, VehicleLight] = {}
        """Lamps that were switched on last, by the ids of vehicles."""
        self._map: str | None = None
        """The OpenDRIVE document that the server is known to show."""
        self._is_blocked = False
        """True if bodies of the last scene stay until another road is loaded."""
        self._earlier_settings: Any = None
        self._frame = 0
        """Number of the last tick."""
        self._is_seen = False
        """True if the last tick's picture was taken."""
        with self._calling("connect"):
            self._client = carla.Client(host, port, 1)  # One worker thread.
            self._client.set_timeout(timeout_s)
            server = self._client.get_server_version()
            client = self._client.get_client_version()
        if (server, client) != (VERSION, VERSION):
            raise SimulatorError(
                f"the CARLA server at {address} has version {server}, the client {client}; both must be {VERSION}"
            )
        with self._calling("get the world"):
            self._world = self._client.get_world()
            self._blueprints = self._world.get_blueprint_library()

    @contextmanager
    def _calling(self, purpose: str) -> Iterator[None]:
        """Raise the client's errors as `SimulatorError`, with the purpose of the calls."""
        try:
            yield
        except RuntimeError as error:
            message = " ".join(str(error).split())[:300]
            raise SimulatorError(
                f"CARLA at {self._address} failed to {purpose}: {message}"
            ) from None

    @property
    def blueprints(self) -> frozenset[str]:
        """Ids of the server's blueprints."""
        return frozenset(blueprint.id for blueprint in self._blueprints)

    def map_text(self) -> str:
        """Return the server's OpenDRIVE map."""
        with self._calling("get the map"):
            return str(self._world.get_map().to_opendrive())

    def open(self, text: str, dt: float) -> None:
        """Show a road, unless the server shows it already and nothing else, and stop the server's own clock.

        Args:
            text: The OpenDRIVE document.
            dt: Duration of a tick, s.
        """
        if self._map != text:
            if self._is_blocked or self.map_text().strip() != text.strip():
                with self._calling("load the road"):
                    self._world = self._client.generate_opendrive_world(text)
                    self._blueprints = self._world.get_blueprint_library()
                self._earlier_settings, self._is_blocked = None, False
            self._map = text
        with self._calling("set the synchronous mode"):
            settings = self._world.get_settings()
            if self._earlier_settings is None:
                self._earlier_settings = self._world.get_settings()
            if not settings.synchronous_mode or settings.fixed_delta_seconds != dt:
                settings.synchronous_mode, settings.fixed_delta_seconds = True, dt
                self._world.apply_settings(settings)

    def set_weather(self, weather: WeatherParameters) -> None:
        """Set the weather."""
        with self._calling("set the weather"):
            self._world.set_weather(self._carla.WeatherParameters(**weather._asdict()))

    def clear(self, *, others: bool) -> None:
        """Destroy everything that this connection has spawned.

        Args:
            others: Also destroy all other bodies, such as those that a broken script left behind.
        """
        with self._calling("remove the last scene"):
            self._follow_episode()
            ids = dict.fromkeys([*self._cameras.ids, *self._actors])
            self._cameras.sleep()
            if others:
                actors = self._world.get_actors()
                ids |= dict.fromkeys(
                    actor.id for actor in actors if actor.type_id.startswith(_BODIES)
                )
            if ids:
                commands = [self._carla.command.DestroyActor(actor_id) for actor_id in ids]
                answers = self._client.apply_batch_sync(commands, False)
                errors = [answer.error for answer in answers if answer.has_error()]
                if any("not found" not in error for error in errors):
                    # What stays, such as a scene that the server has staged, goes with its road.
                    self._map, self._is_blocked = None, True
            self._forget()

    def _follow_episode(self) -> None:
        """Notice that another client has loaded another world, in which nothing of this one is left."""
        world = self._client.get_world()
        if world.id != self._world.id:
            self._forget()
            self._world, self._map, self._earlier_settings = world, None, None

    def _forget(self) -> None:
        """Forget cameras and actors, which the server has lost or will lose."""
        self._cameras.forget()
        self._actors, self._lights = [], {}

    def close(self) -> None:
        """Destroy everything and restore the settings; a server that is gone needs neither."""
        try:
            self.clear(others=False)
            if self._earlier_settings is not None:
                with self._calling("restore the settings"):
                    self._world.apply_settings(self._earlier_settings)
        except SimulatorError:
            pass

    def spawn(
        self, blueprint: str, pose: tuple[float, float, float, float], *, role: str, state: str
    ) -> ServerBody:
        """Add a body without physics.

        Raises:
            RuntimeError: If the server refuses.
        """
        template = self._blueprints.find(blueprint)
        for name, value in (("role_name", role), ("state", state)):
            if value and template.has_attribute(name):
                template.set_attribute(name, value)
        actor = self._world.spawn_actor(template, self._transform(pose, 0.0))
        self._actors.append(actor.id)
        actor.set_simulate_physics(False)
        box = actor.bounding_box
        is_walker = blueprint.startswith("walker.")
        lift = box.extent.z - box.location.z if is_walker else 0.0
        return ServerBody(actor.id, actor, lift, frozenset(actor.semantic_tags))

    def place(
        self,
        bodies: Sequence[ServerBody],
        poses: Sequence[Sequence[float]],
        speeds: Sequence[float],
        lights: Sequence[VehicleLight],
    ) -> None:
        """Move all bodies, switch the lamps of vehicles, and take one tick."""
        command, commands = self._carla.command, []
        for body, pose, speed, lamps in zip(bodies, poses, speeds, lights, strict=True):
            is_changed = self._lights.get(body.id, VehicleLight(0)) != lamps
            if is_changed and hasattr(body.actor, "set_light_state"):
                state = self._carla.VehicleLightState(int(lamps))
                commands.append(command.SetVehicleLightState(body.id, state))
                self._lights[body.id] = lamps
            yaw = pose[3]
            velocity = self._carla.Vector3D(speed * math.cos(yaw), -speed * math.sin(yaw), 0.0)
            commands.append(command.ApplyTransform(body.id, self._transform(pose, body.lift_m)))
            commands.append(command.ApplyTargetVelocity(body.id, velocity))
        with self._calling("move the actors"):
            if not self._is_seen:
                self._cameras.sleep()
            answers = self._client.apply_batch_sync(commands, False)
            failed = [answer.error for answer in answers if answer.has_error()]
        if failed:
            raise SimulatorError(f"CARLA at {self._address} lost an actor: {failed[0][:200]}")
        self._tick()

    def _tick(self) -> None:
        with self._calling("take a step"):
            self._frame = self._world.tick()
        self._is_seen = False

    def _transform(self, pose: Sequence[float], lift_m: float) -> Any:
        x, y, z, yaw = pose
        location = self._carla.Location(x, -y, z + lift_m)
        return self._carla.Transform(location, self._carla.Rotation(yaw=-math.degrees(yaw)))

    def take(self, bodies: Sequence[ServerBody], camera: Camera) -> Frame:
        """Return the picture of the last tick by a camera on the first body; cameras that slept take another tick.

        Raises:
            SimulatorError: If no complete frame arrives.
        """
        cameras, host = self._cameras, bodies[0].actor
        with self._calling("mount the cameras"):
            if not cameras.are_mounted(host, camera):
                cameras.mount(self._carla, self._world, host, camera)
            is_awake = cameras.is_listening
            cameras.listen()
        if not is_awake:
            self._tick()
        for _ in range(_TICKS_PER_FRAME):
            pictures = cameras.pictures(self._frame, self._timeout_s / _TICKS_PER_FRAME)
            if pictures is not None:
                self._is_seen = True
                ids, tags = [body.id for body in bodies], [body.tags for body in bodies]
                return decode(pictures, camera, ids, tags)
            self._tick()
        raise SimulatorError(f"CARLA at {self._address} lost {_TICKS_PER_FRAME} frames in a row")


def _load() -> Any:
    try:
        import carla
    except ModuleNotFoundError:
        raise MissingExtra("a CARLA server", "carla", "carla") from None
    return carla
