"""The wire format of protocol buffers, as far as OSI's ground truth needs it."""

import struct

Value = bytes | int | float
Fields = dict[int, list[Value]]
"""Values of a message's fields by their numbers, in order."""

_VARINT, _DOUBLE, _LENGTH_DELIMITED = 0, 1, 2
"""Wire types."""
_FIXED_SIZE = {_DOUBLE: struct.Struct("<d"), 5: struct.Struct("<f")}
"""Formats of numbers of fixed size, by their wire types."""
_LONGEST_VARINT = 10
_BITS = 64


def fields_of(message: bytes) -> Fields:
    """Return the fields of a message.

    Raises:
        ValueError: If it is no such message.
    """
    fields: Fields = {}
    offset = 0
    while offset < len(message):
        key, offset = _read_varint(message, offset)
        number, wire_type = key >> 3, key & 7
        if not number:
            raise ValueError("a field has the number 0")
        value: Value
        if wire_type == _VARINT:
            value, offset = _read_varint(message, offset)
        elif wire_type in _FIXED_SIZE:
            content, offset = _read_bytes(message, offset, _FIXED_SIZE[wire_type].size)
            (value,) = _FIXED_SIZE[wire_type].unpack(content)
        elif wire_type == _LENGTH_DELIMITED:
            size, offset = _read_varint(message, offset)
            value, offset = _read_bytes(message, offset, size)
        else:
            raise ValueError(f"a field is of the unknown kind {wire_type}")
        fields.setdefault(number, []).append(value)
    return fields


def content(value: Value) -> bytes:
    """Return the bytes of a message or a text."""
    if not isinstance(value, bytes):
        raise ValueError("a number stands for a message or a text")
    return value


def inner_fields(fields: Fields, number: int) -> Fields:
    """Return the fields of the last message in a field; a missing one has none."""
    return fields_of(content(fields.get(number, [b""])[-1]))


def double(fields: Fields, number: int) -> float:
    """Return the last floating-point number in a field, 0 if it is missing."""
    value = fields.get(number, [0.0])[-1]
    if not isinstance(value, float):
        raise ValueError("a place, a size or an angle is not a floating-point number")
    return value


def integer(fields: Fields, number: int) -> int:
    """Return the last integer in a field, with its sign; 0 if it is missing."""
    value = fields.get(number, [0])[-1]
    if not isinstance(value, int):
        raise ValueError("a time or an identifier is not an integer")
    return value - (1 << _BITS) if value >> (_BITS - 1) else value


def _read_bytes(message: bytes, offset: int, size: int) -> tuple[bytes, int]:
    """Return the bytes at an offset, and the offset after them."""
    end = offset + size
    if end > len(message):
        raise ValueError("a field is cut off")
    return message[offset:end], end


def _read_varint(message: bytes, offset: int) -> tuple[int, int]:
    """Return the number at an offset, and the offset after it."""
    value = 0
    for index, byte in enumerate(message[offset : offset + _LONGEST_VARINT]):
        value |= (byte & 0x7F) << 7 * index
        if byte < 0x80:
            return value & ((1 << _BITS) - 1), offset + index + 1
    raise ValueError("a number is cut off or has more than 64 bits")


def number_field(number: int, value: int) -> bytes:
    """Return a field with a number from 0."""
    return bytes([number << 3 | _VARINT]) + _varint(value)


def double_field(number: int, value: float) -> bytes:
    """Return a field with a floating-point number."""
    return bytes([number << 3 | _DOUBLE]) + _FIXED_SIZE[_DOUBLE].pack(value)


def message_field(number: int, message: bytes) -> bytes:
    """Return a field with a message."""
    return bytes([number << 3 | _LENGTH_DELIMITED]) + _varint(len(message)) + message


def text_field(number: int, text: str) -> bytes:
    """Return a field with a text."""
    return message_field(number, text.encode())


def vector_field(number: int, x: float, y: float, z: float) -> bytes:
    """Return a field with a message of three floating-point numbers."""
    return message_field(number, double_field(1, x) + double_field(2, y) + double_field(3, z))


def _varint(value: int) -> bytes:
    parts = bytearray()
    while value > 0x7F:
        parts.append(value & 0x7F | 0x80)
        value >>= 7
    parts.append(value)
    return bytes(parts)
