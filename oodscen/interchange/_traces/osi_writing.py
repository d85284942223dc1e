"""Runs as traces of OSI ground truth: protocol buffers in `.osi` files or in MCAP."""

import math
import struct
from collections.abc import Iterator, Sequence
from typing import Literal

import numpy as np

from oodscen._arguments import checked
from oodscen.data._catalogue import Catalogue
from oodscen.data._scene import Scene
from oodscen.errors import UnknownComponent
from oodscen.interchange._recording import RecordedRun, UnrenderedSimulator, replayed
from oodscen.interchange._traces.mcap_files import mcap_trace
from oodscen.interchange._writing.entities import Entity, entities
from oodscen.interchange._writing.roads import road_file
from oodscen.numerics._exact import Floats

Container = Literal["osi", "mcap"]
CONTAINERS: tuple[Container, ...] = ("osi", "mcap")

_VERSION = (3, 7, 0)
_TYPES = {"MiscObject": 1, "Vehicle": 2, "Pedestrian": 3}
_ANIMAL = 4
_VEHICLE_TYPES = {
    "car": 4,
    "van": 6,
    "truck": 7,
    "trailer": 9,
    "motorbike": 10,
    "bicycle": 11,
    "bus": 12,
}
"""`VehicleClassification.Type` by category."""
_NANO = 1_000_000_000


@checked
def osi_trace(
    scene: Scene,
    catalogue: Catalogue,
    *,
    action: str = "keep_speed",
    seed: int = 0,
    container: Container = "osi",
) -> bytes:
    """Return a scene's run as a trace of OSI ground truth; `Scene.to_osi` tells arguments and errors."""
    if container not in CONTAINERS:
        raise UnknownComponent("container", container, CONTAINERS)
    recording = replayed(scene, UnrenderedSimulator(catalogue), action, seed)
    found = _messages(recording, entities(scene, catalogue))
    if container == "mcap":
        return mcap_trace(found, road_file(scene, catalogue))
    return b"".join(struct.pack("<I", len(truth)) + truth for _, truth in found)


def _messages(recording: RecordedRun, bodies: Sequence[Entity]) -> Iterator[tuple[int, bytes]]:
    """Yield time in ns and ground truth of every step."""
    fixed = [_unchanging(row, entity) for row, entity in enumerate(bodies)]
    velocities = np.gradient(recording.poses[:, :, :3], recording.dt, axis=0)
    motions = np.stack([velocities, np.gradient(velocities, recording.dt, axis=0)], axis=2)
    version = b"".join(_number(index, part) for index, part in enumerate(_VERSION, start=1))
    for step, time in enumerate(recording.time.tolist()):
        nanos = round(time * _NANO)
        stamp = _number(1, nanos // _NANO) + _number(2, nanos % _NANO)
        truth = _message(1, version) + _message(2, stamp) + _message(3, _number(1, 0))
        for row, one in enumerate(bodies):
            base = _base(one, recording.poses[step, row], motions[step, row])
            truth += _message(5, fixed[row] + _message(2, base))
        yield nanos, truth


def _unchanging(row: int, one: Entity) -> bytes:
    """Return the fields of a moving object that do not change: id, kind and entity."""
    kind = _ANIMAL if one.category == "animal" else _TYPES[one.kind]
    found = _message(1, _number(1, row)) + _number(3, kind)
    if one.kind == "Vehicle":
        found += _message(6, _number(1, _VEHICLE_TYPES.get(one.category, 1)))
    reference = _text(2, "net.asam.openscenario") + _text(3, f"entity_name:{one.name}")
    return found + _message(10, reference)


def _base(one: Entity, pose: Floats, motion: Floats) -> bytes:
    """Return size, pose, velocity and acceleration; OSI's position is the centre of the box."""
    size = one.asset
    x, y, z, heading = map(float, pose)
    turned = math.remainder(heading, math.tau)
    return (
        _message(1, _vector(size.length, size.width, size.height))
        + _message(2, _vector(x, y, z + 0.5 * size.height))
        + _message(3, _vector(0.0, 0.0, turned))
        + _message(4, _vector(*motion[0].tolist()))
        + _message(5, _vector(*motion[1].tolist()))
    )


def _vector(x: float, y: float, z: float) -> bytes:
    return b"".join(
        bytes([number << 3 | 1]) + struct.pack("<d", value)
        for number, value in ((1, x), (2, y), (3, z))
    )


def _number(field: int, value: int) -> bytes:
    return bytes([field << 3]) + _varint(value)


def _text(field: int, text: str) -> bytes:
    return _message(field, text.encode())


def _message(field: int, data: bytes) -> bytes:
    return bytes([field << 3 | 2]) + _varint(len(data)) + data


def _varint(value: int) -> bytes:
    parts = bytearray()
    while value > 0x7F:
        parts.append(value & 0x7F | 0x80)
        value >>= 7
    parts.append(value)
    return bytes(parts)
