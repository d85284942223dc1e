"""The cameras of a CARLA client, and the frames that their pictures make."""

import queue
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from oodscen.protocols import Camera, Frame

KINDS = ("rgb", "depth", "instance_segmentation")
"""Kinds of camera whose pictures make a frame."""
FARTHEST_M = 1000.0
"""Depth of the sky and of all beyond, m."""
DEPTH_CODES = (1 << 24) - 1
"""Depth code, of three bytes, that stands for `FARTHEST_M`."""
_SKY_M = FARTHEST_M - 0.01
"""Depth from which a pixel counts as sky, m."""
_BODIES = 1 << 16
"""Number of actors that instance pictures tell apart: they hold the last two bytes of an id."""
_BLUE, _GREEN, _RED = range(3)
"""Channels of a picture."""


class Cameras:
    """Cameras that are mounted together on one actor.

    They sleep until a picture is wanted, and again after a tick without such a wish. Every method may raise the
    client's `RuntimeError`.
    """

    def __init__(self) -> None:
        self._sensors: dict[str, tuple[Any, queue.SimpleQueue[Any]]] = {}
        self._mounted: tuple[int, Camera] | None = None
        self.is_listening = False

    @property
    def ids(self) -> list[int]:
        """Ids of the cameras' own actors."""
        return [sensor.id for sensor, _ in self._sensors.values()]

    def are_mounted(self, host: Any, camera: Camera) -> bool:
        """Return whether the cameras hang on an actor and show what `camera` shows."""
        return self._mounted == (host.id, camera)

    def mount(self, carla: Any, world: Any, host: Any, camera: Camera) -> None:
        """Replace the cameras.

        Args:
            carla: The client's module.
            world: The client's world.
            host: The actor that carries the cameras.
            camera: Size, field of view and place of the pictures.
        """
        earlier = self._sensors
        self.forget()
        for sensor, _ in earlier.values():
            sensor.destroy()
        mount = carla.Transform(
            carla.Location(camera.x, -camera.y, camera.z),
            carla.Rotation(pitch=-camera.pitch_deg, yaw=-camera.yaw_deg),
        )
        blueprints = world.get_blueprint_library()
        for kind in KINDS:
            blueprint = blueprints.find(f"sensor.camera.{kind}")
            blueprint.set_attribute("image_size_x", str(camera.width))
            blueprint.set_attribute("image_size_y", str(camera.height))
            blueprint.set_attribute("fov", str(camera.fov_deg))
            sensor = world.spawn_actor(blueprint, mount, attach_to=host)
            self._sensors[kind] = sensor, queue.SimpleQueue()
        self._mounted = host.id, camera

    def forget(self) -> None:
        """Forget the cameras, which the server has lost or will lose."""
        self.sleep()  # A camera that listens when it is forgotten would end the process.
        self._sensors, self._mounted = {}, None

    def listen(self) -> None:
        """Begin to receive pictures, from the next tick on."""
        if not self.is_listening:
            for sensor, images in self._sensors.values():
                sensor.listen(images.put)
            self.is_listening = True

    def sleep(self) -> None:
        """Stop receiving pictures."""
        if self.is_listening:
            for sensor, _ in self._sensors.values():
                sensor.stop()
            self.is_listening = False

    def pictures(self, tick: int, wait_s: float) -> dict[str, Any] | None:
        """Return the pictures of a tick by kind, or `None` if one of them is lost.

        Args:
            tick: Number of the server's last tick.
            wait_s: Longest time to wait for a picture, s.
        """
        pictures = {}
        for kind, (_, images) in self._sensors.items():
            try:
                image = images.get(timeout=wait_s)
                while image.frame < tick:
                    image = images.get(timeout=wait_s)
            except queue.Empty:
                return None
            if image.frame > tick:
                return None
            pictures[kind] = image
        return pictures


def decode(pictures: dict[str, Any], camera: Camera, ids: Sequence[int]) -> Frame:
    """Return the frame that the pictures of one tick make.

    Args:
        pictures: The client's pictures by kind.
        camera: The camera that took them.
        ids: Ids of the actors, in the order of the frame's rows.
    """
    shape = (camera.height, camera.width, 4)
    colours, codes, instances = (
        np.frombuffer(pictures[kind].raw_data, np.uint8).reshape(shape) for kind in KINDS
    )
    codes = codes.astype(np.uint32)
    code = codes[..., _RED] + (codes[..., _GREEN] << 8) + (codes[..., _BLUE] << 16)
    depth = code * (FARTHEST_M / DEPTH_CODES)
    depth[depth >= _SKY_M] = np.inf
    rows: NDArray[np.int32] = np.zeros(_BODIES, np.int32)
    for row, actor_id in enumerate(ids, start=1):
        rows[actor_id % _BODIES] = row
    frame_ids = rows[instances[..., _GREEN] + (instances[..., _BLUE].astype(np.int32) << 8)]
    return Frame(
        rgb=np.ascontiguousarray(colours[..., _RED::-1]),
        depth=depth.astype(np.float32),
        ids=frame_ids,
        tags=np.where(frame_ids > 0, np.uint8(0), instances[..., _RED]),
    )
