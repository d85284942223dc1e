"""Reads ground truth from OSI traces: protocol buffers in `.osi` files, each after its length, or in MCAP."""

import math
import struct
from collections.abc import Iterator

from oodscen.errors import DataError, Issue
from oodscen.interchange._traces.mcap_files import mcap_messages

Row = tuple[float, str, tuple[float, float, float, float]]

Fields = dict[int, list["bytes | int | float"]]

_NOUN = "OSI trace"
_TIMESTAMP, _MOVING, _STATIONARY = 2, 5, 4
"""Numbers of `timestamp`, `moving_object` and `stationary_object` in `GroundTruth`."""
_MOVING_REFERENCE, _STATIONARY_REFERENCE = 10, 5
"""Numbers of `source_reference` in `MovingObject` and `StationaryObject`."""
_BASE, _DIMENSION, _POSITION, _ORIENTATION = 2, 1, 2, 3
_YAW = 3
_ENTITY = "entity_name:"
"""Beginning of the reference by which players name the scenario's entity."""
_NANOSECOND = 1e-9


def read_osi_trace(data: bytes, source: str) -> Iterator[Row]:
    """Yield time, entity and pose of the footprint's centre for every object with a name.

    `source` is the file's name; that of an MCAP file ends in `.mcap`.

    Raises:
        DataError: If the bytes are not a trace of ground truth.
        MissingExtra: If it is an MCAP file, and the packages for those are not installed.
    """
    if source.endswith(".mcap"):
        yield from _mcap_objects(data, source)
        return
    place = 0
    try:
        while place < len(data):
            (size,) = struct.unpack_from("<I", data, place)
            message = data[place + 4 : place + 4 + size]
            if len(message) != size:
                raise ValueError("the last message is cut off")
            place += 4 + size
            yield from _ground_truth(message)
    except (ValueError, struct.error, IndexError) as error:
        raise DataError(_NOUN, [Issue(f"byte {place}", str(error))], source=source) from None


def _mcap_objects(data: bytes, source: str) -> Iterator[Row]:
    for number, message in enumerate(mcap_messages(data, source)):
        try:
            yield from _ground_truth(message)
        except (ValueError, struct.error, IndexError) as error:
            raise DataError(
                _NOUN, [Issue(f"message {number}", str(error))], source=source
            ) from None


def _ground_truth(message: bytes) -> Iterator[Row]:
    fields = _fields(message)
    stamp = _fields(_inner(fields, _TIMESTAMP))
    time = float(stamp.get(1, [0])[0]) + _NANOSECOND * float(stamp.get(2, [0])[0])
    for number, reference in ((_MOVING, _MOVING_REFERENCE), (_STATIONARY, _STATIONARY_REFERENCE)):
        for one in fields.get(number, []):
            if isinstance(one, bytes):
                parts = _fields(one)
                name = _entity_name(parts, reference)
                if name:
                    yield round(time, 6), name, _pose(_fields(_inner(parts, _BASE)))


def _pose(base: Fields) -> tuple[float, float, float, float]:
    """Return the pose on the ground: OSI's position is the centre of the box."""
    at, size, turned = (
        _fields(_inner(base, number)) for number in (_POSITION, _DIMENSION, _ORIENTATION)
    )
    x, y, z = (_double(at, number) for number in (1, 2, 3))
    pose = (x, y, z - 0.5 * _double(size, 3), _double(turned, _YAW))
    if not all(map(math.isfinite, pose)):
        raise ValueError("a pose is not finite")
    return pose


def _entity_name(parts: Fields, reference: int) -> str:
    for one in parts.get(reference, []):
        if isinstance(one, bytes):
            for text in _fields(one).get(3, []):
                if isinstance(text, bytes) and text.startswith(_ENTITY.encode()):
                    return text.decode("utf-8", "replace")[len(_ENTITY) :].strip()
    return ""


def _inner(fields: Fields, number: int) -> bytes:
    found = fields.get(number, [b""])[-1]
    if not isinstance(found, bytes):
        raise ValueError(f"field {number} is not a message")
    return found


def _double(fields: Fields, number: int) -> float:
    return float(fields.get(number, [0.0])[-1])


def _fields(message: bytes) -> Fields:
    """Return the fields of a message by number, by the wire format of protocol buffers."""
    fields: Fields = {}
    place = 0
    while place < len(message):
        key, place = _varint(message, place)
        number, kind = key >> 3, key & 7
        value: bytes | int | float
        if kind == 0:
            value, place = _varint(message, place)
        elif kind == 1:
            (value,) = struct.unpack_from("<d", message, place)
            place += 8
        elif kind == 2:
            size, place = _varint(message, place)
            value = message[place : place + size]
            if len(value) != size:
                raise ValueError("a field is cut off")
            place += size
        elif kind == 5:
            (value,) = struct.unpack_from("<f", message, place)
            place += 4
        else:
            raise ValueError(f"wire type {kind} is unknown")
        fields.setdefault(number, []).append(value)
    return fields


def _varint(message: bytes, place: int) -> tuple[int, int]:
    value = shift = 0
    while True:
        byte = message[place]
        value |= (byte & 0x7F) << shift
        place += 1
        if byte < 0x80:
            return value, place
        shift += 7
        if shift > 63:
            raise ValueError("a number has more than 64 bits")
