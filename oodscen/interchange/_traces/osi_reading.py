"""Reads ground truth from OSI traces: protocol buffers in `.osi` files, each after its length, or in MCAP."""

import math
import struct
from collections.abc import Iterator
from typing import NamedTuple

from oodscen.errors import DataError, Issue
from oodscen.interchange._traces.mcap_files import mcap_messages

Pose = tuple[float, float, float, float]


class Row(NamedTuple):
    """One body at one time."""

    time: float
    name: str
    """The entity; empty if the body has no name."""
    pose: Pose
    size: tuple[float, float] | None = None
    """Length and width as the file tells them, m."""
    is_host: bool | None = None
    """True if the file says that the body is the ego, False if it says that another one is."""


Fields = dict[int, list["bytes | int | float"]]

_NOUN = "OSI trace"
_TIMESTAMP, _HOST, _MOVING, _STATIONARY = 2, 3, 5, 4
"""Numbers of `timestamp`, `host_vehicle_id`, `moving_object` and `stationary_object` in `GroundTruth`."""
_MOVING_REFERENCE, _STATIONARY_REFERENCE = 10, 5
"""Numbers of `source_reference` in `MovingObject` and `StationaryObject`."""
_ID, _BASE, _DIMENSION, _POSITION, _ORIENTATION = 1, 2, 1, 2, 3
_YAW = 3
_LENGTH = struct.Struct("<I")
_PLAIN = {1: struct.Struct("<d"), 5: struct.Struct("<f")}
"""Formats of numbers of fixed size, by their wire types."""
_MOST = (1 << 64) - 1
_ENTITY = "entity_name:"
"""Beginning of the reference by which players name the scenario's entity."""
_NANOSECOND = 1e-9


def read_osi_trace(data: bytes, source: str) -> Iterator[Row]:
    """Yield a row for every object, with the pose of its footprint's centre.

    Stationary objects that refer to something else, such as an object of the road, are left out.

    `source` is the file's name; that of an MCAP file ends in `.mcap`.

    Raises:
        DataError: If the bytes are not a trace of ground truth.
        MissingExtra: If it is an MCAP file, and the packages for those are not installed.
    """
    is_packed = source.endswith(".mcap")
    for where, message in _packed(data, source) if is_packed else _framed(data, source):
        try:
            yield from _ground_truth(message)
        except ValueError as error:
            raise _fault(where, f"cannot be read as ground truth of OSI: {error}", source) from None


def _packed(data: bytes, source: str) -> Iterator[tuple[str, bytes]]:
    """Yield place and content of the messages in an MCAP file."""
    for number, message in enumerate(mcap_messages(data, source)):
        yield f"message {number}", message


def _framed(data: bytes, source: str) -> Iterator[tuple[str, bytes]]:
    """Yield place and content of messages that follow their lengths."""
    place = 0
    while place < len(data):
        begin = place + _LENGTH.size
        size = _LENGTH.unpack_from(data, place)[0] if begin <= len(data) else 0
        if begin + size > len(data):
            raise _fault(f"byte {place}", "the last message is cut off", source)
        if not size:
            raise _fault(f"byte {place}", "the message is empty", source)
        yield f"byte {place}", data[begin : begin + size]
        place = begin + size


def _ground_truth(message: bytes) -> Iterator[Row]:
    fields = _fields(message)
    stamp = _fields(_inner(fields, _TIMESTAMP))
    time = round(_integer(stamp, 1) + _NANOSECOND * _integer(stamp, 2), 6)
    host = _identifier(fields, _HOST)
    for number, reference in ((_MOVING, _MOVING_REFERENCE), (_STATIONARY, _STATIONARY_REFERENCE)):
        for one in fields.get(number, []):
            parts = _fields(_content(one))
            name = _entity_name(parts, reference)
            if name or number == _MOVING or reference not in parts:
                base = _fields(_inner(parts, _BASE))
                pose = _pose(base)
                if name and _POSITION not in base:
                    raise ValueError(f"the position of {name} at {time:g} s is missing")
                if name and not all(map(math.isfinite, pose)):
                    raise ValueError(f"the pose of {name} at {time:g} s is not finite")
                is_host = None if host is None else _identifier(parts, _ID) == host
                yield Row(time, name, pose, _size(base), is_host)


def _pose(base: Fields) -> Pose:
    """Return the pose on the ground: OSI's position is the centre of the box."""
    at, size, turned = (
        _fields(_inner(base, number)) for number in (_POSITION, _DIMENSION, _ORIENTATION)
    )
    x, y, z = (_double(at, number) for number in (1, 2, 3))
    return x, y, z - 0.5 * _double(size, 3), _double(turned, _YAW)


def _size(base: Fields) -> tuple[float, float] | None:
    """Return length and width, m; `None` if the body has none."""
    size = _fields(_inner(base, _DIMENSION))
    return (_double(size, 1), _double(size, 2)) if size else None


def _identifier(fields: Fields, number: int) -> int | None:
    """Return the value of an identifier; `None` if there is none."""
    return _integer(_fields(_inner(fields, number)), 1) if number in fields else None


def _entity_name(parts: Fields, reference: int) -> str:
    for one in parts.get(reference, []):
        for text in map(_content, _fields(_content(one)).get(3, [])):
            if text.startswith(_ENTITY.encode()):
                return text.decode("utf-8", "replace")[len(_ENTITY) :].strip()
    return ""


def _inner(fields: Fields, number: int) -> bytes:
    return _content(fields.get(number, [b""])[-1])


def _content(value: "bytes | int | float") -> bytes:
    if not isinstance(value, bytes):
        raise ValueError("a number stands for a message or a text")
    return value


def _double(fields: Fields, number: int) -> float:
    value = fields.get(number, [0.0])[-1]
    if not isinstance(value, float):
        raise ValueError("a place, a size or an angle is not a floating-point number")
    return value


def _integer(fields: Fields, number: int) -> int:
    """Return an integer with its sign."""
    value = fields.get(number, [0])[-1]
    if not isinstance(value, int):
        raise ValueError("a time or an identifier is not an integer")
    return value - (1 << 64) if value >> 63 else value


def _fields(message: bytes) -> Fields:
    """Return the fields of a message by number, by the wire format of protocol buffers.

    Raises:
        ValueError: If it is no such message.
    """
    fields: Fields = {}
    place = 0
    while place < len(message):
        key, place = _varint(message, place)
        number, kind = key >> 3, key & 7
        if not number:
            raise ValueError("a field has the number 0")
        value: bytes | int | float
        if kind == 0:
            value, place = _varint(message, place)
        elif kind in _PLAIN:
            held, place = _cut(message, place, _PLAIN[kind].size)
            (value,) = _PLAIN[kind].unpack(held)
        elif kind == 2:
            size, place = _varint(message, place)
            value, place = _cut(message, place, size)
        else:
            raise ValueError(f"a field is of the unknown kind {kind}")
        fields.setdefault(number, []).append(value)
    return fields


def _cut(message: bytes, place: int, size: int) -> tuple[bytes, int]:
    """Return the bytes at a place, and the place after them."""
    end = place + size
    if end > len(message):
        raise ValueError("a field is cut off")
    return message[place:end], end


def _varint(message: bytes, place: int) -> tuple[int, int]:
    value = 0
    for index, byte in enumerate(message[place : place + 10]):
        value |= (byte & 0x7F) << 7 * index
        if byte < 0x80:
            return value & _MOST, place + index + 1
    raise ValueError("a number is cut off or has more than 64 bits")


def _fault(where: str, message: str, source: str) -> DataError:
    return DataError(_NOUN, [Issue(where, message)], source=source)
