"""Reads msgpack-rpc messages from untrusted bytes within limits on size, depth and number of values."""

import threading
from collections.abc import Iterator
from typing import Any

import msgpack

MAX_BYTES = 32 << 20
"""Maximum size of one message; a map arrives as one string."""
MAX_DEPTH = 24
"""Maximum depth of nested arrays and maps."""
MAX_VALUES = 400_000
"""Maximum number of values in one message."""

_REQUEST, _NOTIFICATION = 0, 2
"""The kinds of messages that msgpack-rpc sends to a server."""
_LONGEST_METHOD = 80
"""Characters of the longest name of a method."""


class ProtocolError(Exception):
    """The bytes are not a message that this server accepts; the connection ends."""


class MemoryPool:
    """A limit on the bytes that all connections together keep of unfinished messages."""

    def __init__(self, limit: int = 3 * MAX_BYTES) -> None:
        self._left = limit
        self._lock = threading.Lock()

    def take(self, count: int) -> None:
        """Reserve memory; a negative count gives it back.

        Raises:
            ProtocolError: If too little is left.
        """
        with self._lock:
            if count > self._left:
                raise ProtocolError("too many bytes of unfinished messages")
            self._left -= count


def _heads() -> tuple[list[int], list[int], list[int]]:
    """Return for each first byte: the bytes of its length field, its fixed size, values per element.

    The third is 0 for scalars and strings, 1 for arrays and 2 for maps; -1 marks refused types.
    """
    fields, sizes, kinds = [0] * 256, [0] * 256, [0] * 256
    for byte in range(0x80, 0x90):
        sizes[byte], kinds[byte] = byte & 0x0F, 2
    for byte in range(0x90, 0xA0):
        sizes[byte], kinds[byte] = byte & 0x0F, 1
    for byte in range(0xA0, 0xC0):
        sizes[byte] = byte & 0x1F
    for byte, field in ((0xC4, 1), (0xC5, 2), (0xC6, 4), (0xD9, 1), (0xDA, 2), (0xDB, 4)):
        fields[byte] = field
    for byte, size in ((0xCA, 4), (0xCB, 8), (0xCC, 1), (0xCD, 2), (0xCE, 4), (0xCF, 8)):
        sizes[byte] = size
    for byte, size in ((0xD0, 1), (0xD1, 2), (0xD2, 4), (0xD3, 8)):
        sizes[byte] = size
    for byte, field, kind in ((0xDC, 2, 1), (0xDD, 4, 1), (0xDE, 2, 2), (0xDF, 4, 2)):
        fields[byte], kinds[byte] = field, kind
    for byte in (0xC1, 0xC7, 0xC8, 0xC9, 0xD4, 0xD5, 0xD6, 0xD7, 0xD8):
        kinds[byte] = -1
    return fields, sizes, kinds


_FIELDS, _SIZES, _KINDS = _heads()


class MessageReader:
    """Cuts a stream of bytes into messages.

    Lengths are checked before anything is kept or built, so a message costs no more memory than the
    bytes that really arrived, and at most some hundred bytes for each of its values.
    """

    def __init__(self, pool: MemoryPool | None = None) -> None:
        self._pool = pool or MemoryPool()
        self._data = bytearray()
        self._restart()

    def _restart(self) -> None:
        self._at, self._values = 0, 0
        self._open = [1]

    def close(self) -> None:
        """Give the memory back."""
        self._pool.take(-len(self._data))
        self._data = bytearray()
        self._restart()

    def feed(self, data: bytes) -> Iterator[list[Any]]:
        """Add bytes and yield every message that is complete now.

        Raises:
            ProtocolError: If the bytes are not a message within the limits.
        """
        self._pool.take(len(data))
        self._data += data
        while self._is_complete():
            message = bytes(self._data[: self._at])
            del self._data[: self._at]
            self._pool.take(-len(message))
            self._restart()
            yield _unpacked(message)

    def _is_complete(self) -> bool:
        """Advance over whole values; return whether a message ends in the bytes at hand."""
        data, opened, at, size = self._data, self._open, self._at, len(self._data)
        try:
            while opened:
                if at >= size:
                    return False
                byte = data[at]
                field, count, kind = _FIELDS[byte], _SIZES[byte], _KINDS[byte]
                if field and at + field >= size:
                    return False
                if field:
                    count = int.from_bytes(data[at + 1 : at + 1 + field], "big")
                opened[-1] -= 1
                if kind == 0:
                    at += 1 + field + count
                    if at > MAX_BYTES:
                        raise ProtocolError(f"a message of more than {MAX_BYTES >> 20} MiB")
                elif kind > 0:
                    at += 1 + field
                    self._enter(count * kind)
                else:
                    raise ProtocolError(f"the type 0x{byte:02x} is not used in this protocol")
                while opened and not opened[-1]:
                    opened.pop()
            return at <= size
        finally:
            self._at = at

    def _enter(self, count: int) -> None:
        self._values += count
        if self._values > MAX_VALUES:
            raise ProtocolError(f"a message of more than {MAX_VALUES} values")
        if len(self._open) > MAX_DEPTH:
            raise ProtocolError(f"values are nested more than {MAX_DEPTH} deep")
        self._open.append(count)


def _unpacked(message: bytes) -> list[Any]:
    """Return a request `[0, id, method, arguments]` or a notification `[2, method, arguments]`."""
    try:
        value = msgpack.unpackb(message, raw=False, strict_map_key=False)
    except (ValueError, TypeError, RecursionError) as error:
        raise ProtocolError(f"not msgpack: {error}") from None
    if not isinstance(value, list) or not _is_call(value):
        raise ProtocolError("not a request of msgpack-rpc")
    return value


def _is_call(message: list[Any]) -> bool:
    """Return whether a message is a request or a notification."""
    if len(message) not in (3, 4) or type(message[0]) is not int:
        return False
    kind, *number, method, arguments = message
    if kind != (_REQUEST if number else _NOTIFICATION):
        return False
    if number and not (type(number[0]) is int and 0 <= number[0] < 1 << 32):
        return False
    is_name = isinstance(method, str) and len(method) <= _LONGEST_METHOD
    return is_name and isinstance(arguments, list)
