"""The bytes that sensors send: a header, then pictures, the world's state or msgpack.

The type index is the sensor's place in the `SensorRegistry` of libcarla 0.9.16; other versions
have other places, and a wrong one ends the client's process.
"""

import math
import struct
from collections.abc import Iterable
from typing import Any

import cv2
import msgpack
import numpy as np
from numpy.typing import NDArray

from oodscen.driving._motion.bodies import GRAVITY
from oodscen.protocols import Frame
from oodscen_carla._cameras import DEPTH_CODES, FARTHEST_M
from oodscen_carla.server._actors import ServerActor
from oodscen_carla.server._geometry import matrix
from oodscen_carla.server._values import Transform, Vector

REGISTRY = {
    "sensor.other.collision": 0,
    "sensor.camera.depth": 1,
    "sensor.other.gnss": 4,
    "sensor.other.imu": 5,
    "sensor.camera.rgb": 13,
    "sensor.camera.semantic_segmentation": 14,
    "sensor.camera.instance_segmentation": 15,
}
"""Type index by blueprint."""
WORLD = 17
"""Type index of the world's state."""
ACTIVE = 1
"""`carla.ActorState.Active`."""
SKY, OTHER = 11, 22
"""Semantic tags of the sky and of what the drawing simulator cannot tell."""

_OPAQUE = np.int32(-1 << 24)
_CLIENT_TAGS = np.where(np.arange(256), np.arange(256), OTHER).astype(np.uint8)
"""Tags that clients get, by those of the drawing simulator."""
_AT_REST = Transform((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
_METRES_PER_DEGREE = 111_324.6
"""Length of a degree of latitude, and of longitude at the equator, m."""


def header(kind: int, frame: int, time: float, place: Transform = _AT_REST) -> bytes:
    """Return the header of a measurement."""
    return struct.pack("<QQd6f", kind, frame, time, *place.location, *place.rotation)


def world_state(
    frame: int,
    time: float,
    dt: float,
    episode: int,
    actors: Iterable[tuple[ServerActor, Transform]],
) -> bytes:
    """Return the state of all actors.

    Args:
        frame: Number of the frame.
        time: Time of the simulation, s.
        dt: Duration of the frame, s.
        episode: Number of the episode.
        actors: Every actor and its place in the world.
    """
    parts = [header(WORLD, frame, time), struct.pack("<Qdf3iI", episode, time, dt, 0, 0, 0, 0)]
    for actor, place in actors:
        common = struct.pack(
            "<IB15f",
            actor.id,
            ACTIVE,
            *place.location,
            *place.rotation,
            *actor.velocity,
            *actor.angular,
            *actor.acceleration,
        )
        parts.append(common + _own_state(actor).ljust(54, b"\0"))
    return b"".join(parts)


def _own_state(actor: ServerActor) -> bytes:
    if actor.is_vehicle:
        control = actor.control
        if control is None:
            pedals = struct.pack("<3f3?i", 0.0, 0.0, 0.0, False, False, False, 0)
        else:
            pedals = struct.pack(
                "<3f3?i",
                control.throttle,
                control.steer,
                control.brake,
                control.hand_brake,
                control.reverse,
                control.manual_gear_shift,
                control.gear,
            )
        speed_limit_kmh, no_traffic_light, is_at_traffic_light = 30.0, 4, 0
        traffic = (speed_limit_kmh, no_traffic_light, is_at_traffic_light, 0, 0)
        return pedals + struct.pack("<fBBIB", *traffic)
    if actor.walk is not None:
        return struct.pack("<4f?", *actor.walk.direction, actor.walk.speed, actor.walk.jump)
    return b""


def picture(
    kind: str, frame: Frame, ids: NDArray[np.int32], tags: NDArray[np.uint8]
) -> NDArray[np.uint8]:
    """Return a picture's pixels, [height, width, 4] as blue, green, red, alpha.

    Args:
        kind: One of `CAMERAS`' kinds.
        frame: What the drawing simulator saw.
        ids: Actor id by row of the frame's ids.
        tags: Semantic tag by row of the frame's ids; the first is unused.
    """
    if kind == "rgb":
        return np.asarray(cv2.cvtColor(frame.rgb, cv2.COLOR_RGB2BGRA), np.uint8)
    if kind == "depth":
        share = cv2.min(frame.depth, FARTHEST_M)
        share *= np.float32(DEPTH_CODES / FARTHEST_M)
        code = np.rint(share, out=share).astype("<i4")
        code |= _OPAQUE
        low_first = code.view(np.uint8).reshape(*frame.depth.shape, 4)
        return np.asarray(cv2.cvtColor(low_first, cv2.COLOR_RGBA2BGRA), np.uint8)
    numbers = ids.astype(np.uint32) if kind == "instance" else np.uint32(0)
    table = tags.astype("<u4") << 16 | (numbers & 255) << 8 | (numbers >> 8 & 255) | 255 << 24
    behind = _behind(frame)
    nothing = np.zeros_like(behind)
    pixels = np.asarray(cv2.merge((nothing, nothing, behind, ~nothing)), np.uint8)
    is_body = frame.ids > 0
    pixels.view("<u4")[is_body, 0] = table[frame.ids[is_body]]
    return pixels


def _behind(frame: Frame) -> NDArray[np.uint8]:
    """Return the semantic tags of scenery and sky."""
    if frame.tags is None:
        return np.where(np.isinf(frame.depth), np.uint8(SKY), np.uint8(OTHER))
    return np.asarray(cv2.LUT(frame.tags, _CLIENT_TAGS), np.uint8)


def picture_head(width: int, height: int, fov: float) -> bytes:
    """Return the bytes before the pixels of a picture."""
    return struct.pack("<IIf", width, height, fov)


def collision(actor: list[Any], other: list[Any], impulse: Vector) -> bytes:
    """Return the body of a collision event."""
    return _packed([actor, other, impulse])


def inertial(actor: ServerActor, place: Transform) -> bytes:
    """Return accelerometer, gyroscope and compass, the former two in the sensor's axes.

    Args:
        actor: The actor that carries the sensor.
        place: The sensor's place in the world.
    """
    x, y, z = actor.acceleration
    vectors = np.array([[x, y, z + GRAVITY], np.radians(actor.angular)])
    accelerometer, gyroscope = (vectors @ matrix(place)[:3, :3]).tolist()
    compass = math.radians((place.rotation[1] + 90.0) % 360.0)
    return _packed([accelerometer, gyroscope, compass])


def position(place: Transform) -> bytes:
    """Return latitude, longitude and altitude."""
    x, y, z = place.location
    degrees = [-y / _METRES_PER_DEGREE, x / _METRES_PER_DEGREE, z]
    return bytes(msgpack.packb(degrees))


def _packed(value: Any) -> bytes:
    return bytes(msgpack.packb(value, use_single_float=True))
