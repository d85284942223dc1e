"""Reads ground truth from OSI traces: protocol buffers in `.osi` files, each after its length, or in MCAP."""

import math
import struct
from collections.abc import Iterator
from typing import NamedTuple

from oodscen.errors import DataError, Issue
from oodscen.interchange._traces.mcap_files import mcap_messages
from oodscen.interchange._traces.wire import (
    Fields,
    content,
    double,
    fields_of,
    inner_fields,
    integer,
)

Pose = tuple[float, float, float, float]
"""x, y, z of a footprint's centre, m, and its heading, rad."""


class BodyPose(NamedTuple):
    """One body at one time."""

    time: float
    name: str
    """The entity; empty if the body has no name."""
    pose: Pose
    size: tuple[float, float] | None = None
    """Length and width as the file tells them, m."""
    is_host: bool | None = None
    """True if the file says that the body is the ego, False if it says that another one is."""


_NOUN = "OSI trace"
_TIMESTAMP, _HOST, _MOVING, _STATIONARY = 2, 3, 5, 4
"""Numbers of `timestamp`, `host_vehicle_id`, `moving_object` and `stationary_object` in `GroundTruth`."""
_MOVING_REFERENCE, _STATIONARY_REFERENCE = 10, 5
"""Numbers of `source_reference` in `MovingObject` and `StationaryObject`."""
_REFERENCE_TEXT = 3
"""Number of `identifier` in `ExternalReference`."""
_ID, _BASE, _DIMENSION, _POSITION, _ORIENTATION = 1, 2, 1, 2, 3
_YAW = 3
_LENGTH = struct.Struct("<I")
"""Format of the length before a message."""
_ENTITY = "entity_name:"
"""Beginning of the reference by which players name the scenario's entity."""
_NANOSECOND_S = 1e-9


def read_osi_trace(data: bytes, source: str) -> Iterator[BodyPose]:
    """Yield the pose of every object at every time.

    Stationary objects that refer to something else, such as an object of the road, are left out.

    `source` is the file's name; that of an MCAP file ends in `.mcap`.

    Raises:
        DataError: If the bytes are not a trace of ground truth.
        MissingExtra: If it is an MCAP file, and the packages for those are not installed.
    """
    is_mcap = source.lower().endswith(".mcap")
    for where, message in _mcap(data, source) if is_mcap else _length_prefixed(data, source):
        try:
            yield from _ground_truth(message)
        except ValueError as error:
            raise _fault(where, f"cannot be read as ground truth of OSI: {error}", source) from None


def _mcap(data: bytes, source: str) -> Iterator[tuple[str, bytes]]:
    """Yield place and content of the messages in an MCAP file."""
    for number, message in enumerate(mcap_messages(data, source)):
        yield f"message {number}", message


def _length_prefixed(data: bytes, source: str) -> Iterator[tuple[str, bytes]]:
    """Yield place and content of messages that follow their lengths."""
    offset = 0
    while offset < len(data):
        where = f"byte {offset}"
        begin = offset + _LENGTH.size
        size = _LENGTH.unpack_from(data, offset)[0] if begin <= len(data) else 0
        if begin + size > len(data):
            raise _fault(where, "the last message is cut off", source)
        if not size:
            raise _fault(where, "the message is empty", source)
        yield where, data[begin : begin + size]
        offset = begin + size


def _ground_truth(message: bytes) -> Iterator[BodyPose]:
    truth = fields_of(message)
    stamp = inner_fields(truth, _TIMESTAMP)
    time = round(integer(stamp, 1) + _NANOSECOND_S * integer(stamp, 2), 6)
    host = _identifier(truth, _HOST)
    for value in truth.get(_MOVING, []):
        yield _body_pose(fields_of(content(value)), _MOVING_REFERENCE, time, host)
    for value in truth.get(_STATIONARY, []):
        body = fields_of(content(value))
        if _entity_name(body, _STATIONARY_REFERENCE) or _STATIONARY_REFERENCE not in body:
            yield _body_pose(body, _STATIONARY_REFERENCE, time, host)


def _body_pose(body: Fields, reference: int, time: float, host: int | None) -> BodyPose:
    """Return the pose of an object.

    Raises:
        ValueError: If it has a name, and its position is missing or not finite.
    """
    name = _entity_name(body, reference)
    base = inner_fields(body, _BASE)
    pose = _pose(base)
    if name and _POSITION not in base:
        raise ValueError(f"the position of {name} at {time:g} s is missing")
    if name and not all(map(math.isfinite, pose)):
        raise ValueError(f"the pose of {name} at {time:g} s is not finite")
    is_host = None if host is None else _identifier(body, _ID) == host
    return BodyPose(time, name, pose, _size(base), is_host)


def _pose(base: Fields) -> Pose:
    """Return the pose on the ground: OSI's position is the centre of the box."""
    position, size = inner_fields(base, _POSITION), inner_fields(base, _DIMENSION)
    x, y, z = (double(position, number) for number in (1, 2, 3))
    return x, y, z - 0.5 * double(size, 3), double(inner_fields(base, _ORIENTATION), _YAW)


def _size(base: Fields) -> tuple[float, float] | None:
    """Return length and width, m; `None` if the body has none."""
    size = inner_fields(base, _DIMENSION)
    return (double(size, 1), double(size, 2)) if size else None


def _identifier(fields: Fields, number: int) -> int | None:
    """Return the value of an identifier; `None` if there is none."""
    return integer(inner_fields(fields, number), 1) if number in fields else None


def _entity_name(body: Fields, reference: int) -> str:
    for value in body.get(reference, []):
        for text in map(content, fields_of(content(value)).get(_REFERENCE_TEXT, [])):
            if text.startswith(_ENTITY.encode()):
                return text.decode("utf-8", "replace")[len(_ENTITY) :].strip()
    return ""


def _fault(where: str, message: str, source: str) -> DataError:
    return DataError(_NOUN, [Issue(where, message)], source=source)
