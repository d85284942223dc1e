"""The streams of sensors: the connections that listen to them, and what is sent there."""

import socket
import struct
import threading
from contextlib import suppress

WORLD_STREAM = 1
"""Stream of the world's state; a sensor's stream has the number of the sensor."""
MAX_STREAMS = 512
STALL_S = 5.0
"""Time after which a client that does not read is disconnected, s."""


class Streams:
    """The connections that listen to streams; calls hold the listener's lock."""

    def __init__(self, heard: threading.Condition) -> None:
        self._heard = heard
        self._open: dict[int, list[socket.socket]] = {}
        self._expected: set[int] = set()
        self.host = "127.0.0.1"
        self.port = 0

    def token(self, stream: int) -> bytes:
        """Return the token by which a client finds a stream."""
        tcp = v4 = 1
        return struct.pack("<IHBB16s", stream, self.port, tcp, v4, socket.inet_aton(self.host))

    def expect(self, stream: int) -> None:
        """Let the next tick wait until a client listens to this stream."""
        if len(self._expected) < MAX_STREAMS:
            self._expected.add(stream)

    def is_complete(self) -> bool:
        """Return whether every expected stream is heard."""
        return all(stream in self._open for stream in self._expected)

    def forget_expected(self) -> None:
        """Expect no stream any longer."""
        self._expected.clear()

    def is_heard(self, stream: int) -> bool:
        """Return whether a client listens."""
        return stream in self._open

    def add(self, stream: int, connection: socket.socket) -> bool:
        """Let a connection listen to a stream; false if there are too many."""
        if sum(map(len, self._open.values())) >= MAX_STREAMS:
            return False
        self._open.setdefault(stream, []).append(connection)
        self._heard.notify_all()
        return True

    def remove(self, connection: socket.socket) -> None:
        """Forget a connection."""
        for stream, listeners in list(self._open.items()):
            if connection in listeners:
                listeners.remove(connection)
                if not listeners:
                    del self._open[stream]

    def drop(self, stream: int) -> None:
        """End a stream."""
        self._expected.discard(stream)
        for connection in self._open.pop(stream, []):
            end(connection)

    def send(self, stream: int, *parts: bytes | memoryview) -> None:
        """Send one message; a connection that does not read in time is ended."""
        length = struct.pack("<I", sum(len(part) for part in parts))
        message = (b"".join([length, *parts[:-1]]), parts[-1])
        for connection in list(self._open.get(stream, ())):
            try:
                _send_both(connection, *message)
            except OSError:
                self.remove(connection)
                end(connection)

    def close(self) -> None:
        """End all streams."""
        for stream in list(self._open):
            self.drop(stream)


def _send_both(connection: socket.socket, first: bytes, last: bytes | memoryview) -> None:
    """Send two buffers, so that the peer wakes once."""
    sent = connection.sendmsg((first, last))
    if sent < len(first):
        connection.sendall(first[sent:])
    if sent < len(first) + len(last):
        connection.sendall(memoryview(last)[max(0, sent - len(first)) :])


def limit_sends(connection: socket.socket) -> None:
    """Let `sendall` fail on a peer that does not read; receiving may take for ever."""
    seconds, microseconds = int(STALL_S), int(STALL_S % 1 * 1e6)
    timeout = struct.pack("ll", seconds, microseconds)
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, timeout)


def end(connection: socket.socket) -> None:
    with suppress(OSError):
        connection.shutdown(socket.SHUT_RDWR)
    connection.close()
