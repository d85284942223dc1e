"""Runs as traces of OSI ground truth: length-prefixed protocol buffers, as `.osi` files hold them."""

import struct
from collections.abc import Sequence

from oodscen.data._catalogue import Catalogue
from oodscen.data._scene import Scene
from oodscen.interchange._recording import Recording, UnrenderedSimulator, replayed
from oodscen.interchange._writing.entities import Entity, entities

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


def osi_trace(
    scene: Scene, catalogue: Catalogue, *, action: str = "keep_speed", seed: int = 0
) -> bytes:
    """Return a scene's run as a trace of OSI ground truth, one message for each step.

    Every body is a moving object whose source reference names the entity (`entity_name:NAME`); the ego is the host.

    Args:
        scene: The scene or twin.
        catalogue: The catalogue of its assets and maps.
        action: The ego's action after the decision.
        seed: Seed of the scene's random streams.

    Raises:
        SceneError: If the catalogue or the road refuses the scene.
    """
    recording = replayed(scene, UnrenderedSimulator(catalogue), action, seed)
    bodies = entities(scene, catalogue)
    fixed = [_unchanging(row, one) for row, one in enumerate(bodies)]
    trace = bytearray()
    for step in range(len(recording.time)):
        truth = _ground_truth(recording, step, bodies, fixed)
        trace += struct.pack("<I", len(truth)) + truth
    return bytes(trace)


def _ground_truth(
    recording: Recording, step: int, bodies: Sequence[Entity], fixed: Sequence[bytes]
) -> bytes:
    nanos = round(float(recording.time[step]) * _NANO)
    version = b"".join(_number(index, part) for index, part in enumerate(_VERSION, start=1))
    stamp = _number(1, nanos // _NANO) + _number(2, nanos % _NANO)
    truth = _message(1, version) + _message(2, stamp) + _message(3, _number(1, 0))
    for row, one in enumerate(bodies):
        truth += _message(5, fixed[row] + _message(2, _base(recording, step, row, one)))
    return truth


def _unchanging(row: int, one: Entity) -> bytes:
    """Return the fields of a moving object that do not change: id, kind and entity."""
    kind = _ANIMAL if one.category == "animal" else _TYPES[one.kind]
    found = _message(1, _number(1, row)) + _number(3, kind)
    if one.kind == "Vehicle":
        found += _message(6, _number(1, _VEHICLE_TYPES.get(one.category, 1)))
    reference = _text(2, "net.asam.openscenario") + _text(3, f"entity_name:{one.name}")
    return found + _message(10, reference)


def _base(recording: Recording, step: int, row: int, one: Entity) -> bytes:
    """Return size, pose and motion; OSI's position is the centre of the box."""
    size = one.asset
    x, y, z, heading = map(float, recording.poses[step, row])
    vx, vy = _velocity(recording, step, row)
    return (
        _message(1, _vector(size.length, size.width, size.height))
        + _message(2, _vector(x, y, z + 0.5 * size.height))
        + _message(3, _vector(0.0, 0.0, heading))
        + _message(4, _vector(vx, vy, 0.0))
        + _message(5, _vector(0.0, 0.0, 0.0))
    )


def _velocity(recording: Recording, step: int, row: int) -> tuple[float, float]:
    """Return the mean velocity over the last step, at the start over the first."""
    last = max(step, 1)
    if last >= len(recording.time):
        return 0.0, 0.0
    moved = recording.poses[last, row] - recording.poses[last - 1, row]
    return float(moved[0]) / recording.dt, float(moved[1]) / recording.dt


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
