"""The cameras of a CARLA client, and the frames that their pictures make."""

import queue
from collections.abc import Collection, Sequence
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
_IDS = 1 << 16
"""Number of ids that instance pictures tell apart. They hold the last two bytes of an actor's id from CARLA 0.9.16 on
(carla-simulator/carla, pull request 8334); what is no actor of CARLA's has a number of the engine there."""
_UNTAGGED = 0
"""Tag of a mesh to which CARLA gives no class."""
_BLUE, _GREEN, _RED = range(3)
"""Channels of a picture."""


class Cameras:
    """Cameras that are mounted together on one actor.

    Every method may raise the client's `RuntimeError`.
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
        self.sleep()
        self._mounted = None
        for kind, (sensor, _) in list(self._sensors.items()):
            sensor.destroy()
            del self._sensors[kind]
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


def decode(
    pictures: dict[str, Any],
    camera: Camera,
    ids: Sequence[int],
    tags: Sequence[Collection[int]],
) -> Frame:
    """Return the frame that the pictures of one tick make.

    A pixel belongs to a body if it has the body's id and one of its semantic tags, or none: scenery may have the same
    number as an actor.

    Args:
        pictures: The client's pictures by kind.
        camera: The camera that took them.
        ids: Ids of the actors, in the order of the frame's rows.
        tags: The actors' semantic tags; an actor without any may have all.
    """
    shape = (camera.height, camera.width, 4)
    colours, codes, instances = (
        np.frombuffer(pictures[kind].raw_data, np.uint8).reshape(shape) for kind in KINDS
    )
    codes = codes.astype(np.uint32)
    code = codes[..., _RED] + (codes[..., _GREEN] << 8) + (codes[..., _BLUE] << 16)
    depth = code * (FARTHEST_M / DEPTH_CODES)
    depth[depth >= _SKY_M] = np.inf
    rows: NDArray[np.int32] = np.zeros(_IDS, np.int32)
    has_tag = np.zeros((len(ids) + 1, 256), np.bool_)
    for row, (number, own) in enumerate(zip(ids, tags, strict=True), start=1):
        rows[number % _IDS] = row
        has_tag[row, [_UNTAGGED, *own] if own else slice(None)] = True
    row_of = rows[instances[..., _GREEN] + (instances[..., _BLUE].astype(np.int32) << 8)]
    seen = instances[..., _RED]
    shown = np.where(has_tag[row_of, seen], row_of, 0)
    return Frame(
        rgb=np.ascontiguousarray(colours[..., (_RED, _GREEN, _BLUE)]),
        depth=depth.astype(np.float32),
        ids=shown,
        tags=np.where(shown > 0, np.uint8(0), seen),
    )
