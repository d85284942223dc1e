"""Sends what the sensors of the served world measure in a tick."""

import math
from collections.abc import Mapping
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from oodscen.driving._motion.triggers import ROUNDING_S
from oodscen.protocols import Camera, Frame
from oodscen_carla.server import _measurements as wire
from oodscen_carla.server._actors import ServerActor
from oodscen_carla.server._blueprints import CAMERAS, PICTURE
from oodscen_carla.server._cameras import CameraRenderer, PicturedBody, Pose, View
from oodscen_carla.server._geometry import matrix, transform_of
from oodscen_carla.server._streams import WORLD_STREAM, Streams
from oodscen_carla.server._values import CallError, Transform
from oodscen_carla.server._world import World

MAX_SIDE = 4096
"""Maximum pixels along a side of a picture."""
MAX_PIXELS = 4_000_000

Picture = tuple[Frame, NDArray[np.int32], NDArray[np.uint8]]
"""A frame, and the actor's id and semantic tag for each of its ids."""


def camera_of(attributes: Mapping[str, str]) -> Camera:
    """Return the camera, not yet mounted, that a blueprint's attributes describe.

    Raises:
        CallError: If the size or the field of view is no number or out of range.
    """
    values = {
        attribute.name: attributes.get(attribute.name, attribute.default) for attribute in PICTURE
    }
    try:
        width, height = int(values["image_size_x"]), int(values["image_size_y"])
        fov = float(values["fov"])
    except ValueError:
        raise CallError(
            "image_size_x and image_size_y must be whole numbers, fov a number"
        ) from None
    if not (0 < width <= MAX_SIDE and 0 < height <= MAX_SIDE and width * height <= MAX_PIXELS):
        raise CallError(
            f"a picture has 1 to {MAX_SIDE} pixels a side and at most {MAX_PIXELS} in all"
        )
    if not 1.0 <= fov <= 170.0:
        raise CallError("fov must be between 1 and 170 degrees")
    return Camera(width=width, height=height, fov_deg=fov)


class SensorSender:
    """Sends the world's state and what sensors measure; one picture serves all cameras of a mount."""

    def __init__(self, world: World, renderer: CameraRenderer, streams: Streams) -> None:
        self._world, self._renderer, self._streams = world, renderer, streams
        self._due_at = WeakKeyDictionary[ServerActor, float]()
        """Time of the simulation from which a sensor sends again, s."""

    def observe(self, dt: float) -> None:
        """Send the state of all actors."""
        if self._streams.is_heard(WORLD_STREAM):
            world = self._world
            rows = [(actor, world.place_of(actor)) for actor in world.actors.values()]
            state = wire.world_state(world.frame, world.time, dt, world.episode, rows)
            self._streams.send(WORLD_STREAM, state)

    def sense(self) -> None:
        """Send the measurements of all sensors that a client listens to."""
        pictures: dict[object, Picture] = {}
        bodies: list[PicturedBody] | None = None
        for actor in list(self._world.actors.values()):
            if not (actor.is_sensor and self._streams.is_heard(actor.id) and self._is_due(actor)):
                continue
            if actor.type_id in CAMERAS:
                bodies = self._world.bodies() if bodies is None else bodies
                self._send_picture(actor, bodies, pictures)
            elif actor.type_id == "sensor.other.imu":
                carrier, place = self._world.carrier_of(actor), self._world.place_of(actor)
                self._send(actor, wire.inertial(carrier, place))
            elif actor.type_id == "sensor.other.gnss":
                self._send(actor, wire.position(self._world.place_of(actor)))
        self._send_collisions()

    def _is_due(self, actor: ServerActor) -> bool:
        now, tick = self._world.time, actor.number("sensor_tick", 0.0)
        due_at = self._due_at.get(actor, now)
        if now < due_at - ROUNDING_S:
            return False
        is_kept_up = due_at + tick > now
        self._due_at[actor] = (due_at if is_kept_up else now) + tick
        return True

    def _send(self, actor: ServerActor, head: bytes, body: bytes | memoryview = b"") -> None:
        place = self._world.place_of(actor)
        kind = wire.REGISTRY[actor.type_id]
        header = wire.header(kind, self._world.frame, self._world.time, place)
        self._streams.send(actor.id, header + head, body)

    def _send_picture(
        self,
        actor: ServerActor,
        bodies: list[PicturedBody],
        pictures: dict[object, Picture],
    ) -> None:
        """Send the picture of one camera; that of a mount is taken once, and kept for all kinds of camera."""
        camera = camera_of(actor.attributes)
        mount = (actor.parent, actor.place, camera)
        if mount not in pictures:
            pictures[mount] = self._take(actor, bodies, camera)
        frame, ids, tags = pictures[mount]
        pixels = wire.picture(CAMERAS[actor.type_id], frame, ids, tags)
        head = wire.picture_head(camera.width, camera.height, camera.fov_deg)
        self._send(actor, head, pixels.data.cast("B"))

    def _take(self, actor: ServerActor, bodies: list[PicturedBody], size: Camera) -> Picture:
        """Return the picture of a camera, whose host comes first among the bodies if it is one of them."""
        world = self._world
        shown = sorted(bodies, key=lambda body: body.key != actor.parent)
        has_host = bool(shown) and shown[0].key == actor.parent
        host = world.actors[actor.parent] if has_host else None
        level = shown[0].pose if host is not None and _is_level(world.place_of(host)) else None
        time = world.picture_time(host)
        view = aimed(size, actor.place, world.place_of(actor), level, time)
        frame, ids = self._renderer.take(world.scene(), world.seed, shown, view, has_host=has_host)
        tags = [world.actors[key].blueprint.tag if key else 0 for key in ids.tolist()]
        return frame, ids, np.array(tags, np.uint8)

    def _send_collisions(self) -> None:
        world = self._world
        listening: dict[int, list[ServerActor]] = {}
        for actor in world.actors.values():
            if actor.type_id == "sensor.other.collision" and self._streams.is_heard(actor.id):
                listening.setdefault(actor.parent, []).append(actor)
        for (car, other), impulse in world.collisions.items() if listening else ():
            for sensor in listening.get(car.id, ()):
                self._send(sensor, wire.collision(car.row(b""), other.row(b""), impulse))


def _is_level(place: Transform) -> bool:
    pitch, _, roll = place.rotation
    return round(pitch, 6) == round(roll, 6) == 0.0


def aimed(
    size: Camera, mount: Transform, place: Transform, level: Pose | None, time: float
) -> View:
    """Return the view of a camera, in right-handed axes.

    A level camera on a level vehicle is mounted on the vehicle's exact pose, without the noise of
    32-bit floats; any other stands free in the world.

    Args:
        size: The camera, not yet mounted.
        mount: Its place relative to what it is attached to.
        place: Its place in the world.
        level: The pose of the level vehicle that it is attached to, if it is.
        time: The clock of rain and flashing lamps, s.
    """
    if level is not None and not mount.rotation[2] and abs(mount.rotation[0]) <= 90.0:
        x, y, z = (round(value, 6) for value in mount.location)
        pitch, yaw, _ = (round(angle, 6) for angle in mount.rotation)
        camera = _moved(size, x, -y, z, -pitch, math.remainder(-yaw, 360.0))
        return View(camera, level, 0.0, time)
    if abs(place.rotation[0]) > 90.0:  # It looks over its back, as a lower one does that is turned.
        place = transform_of(matrix(place))
    x, y, z = place.location
    pitch, yaw, roll = place.rotation
    camera = _moved(size, 0.0, 0.0, 0.0, -pitch, 0.0)
    return View(camera, (x, -y, z, math.radians(-yaw)), roll, time)


def _moved(size: Camera, x: float, y: float, z: float, pitch_deg: float, yaw_deg: float) -> Camera:
    return Camera(size.width, size.height, size.fov_deg, x, y, z, pitch_deg, yaw_deg)
