"""The streams of sensors: the connections that listen to them, and what is sent there."""

import socket
import struct
import threading

from oodscen_carla.server._sockets import end, send_message

WORLD_STREAM = 1
"""Stream of the world's state; a sensor's stream has the number of the sensor."""
MAX_EXPECTED, MAX_CONNECTIONS = 512, 512
"""Numbers of streams that a tick waits for, and of connections that listen to streams."""


class Streams:
    """The connections that listen to streams; callers must hold the listener's lock."""

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
        if len(self._expected) < MAX_EXPECTED:
            self._expected.add(stream)

    def are_expected_heard(self) -> bool:
        """Return whether every expected stream is heard."""
        return all(stream in self._open for stream in self._expected)

    def forget_expected(self) -> None:
        """Expect no stream any longer."""
        self._expected.clear()

    def is_heard(self, stream: int) -> bool:
        """Return whether a client listens."""
        return stream in self._open

    def add(self, stream: int, connection: socket.socket) -> bool:
        """Let a connection listen to a stream; return false if too many connections are open."""
        if sum(map(len, self._open.values())) >= MAX_CONNECTIONS:
            return False
        self._open.setdefault(stream, []).append(connection)
        self._heard.notify_all()
        return True

    def remove(self, connection: socket.socket) -> None:
        """Forget a connection, without closing it."""
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

    def send(self, stream: int, head: bytes, body: bytes | memoryview = b"") -> None:
        """Send one message; a connection that does not take it in time is ended."""
        first = struct.pack("<I", len(head) + memoryview(body).nbytes) + head
        for connection in list(self._open.get(stream, ())):
            try:
                send_message(connection, first, body)
            except OSError:
                self.remove(connection)
                end(connection)

    def close(self) -> None:
        """End all streams."""
        for stream in list(self._open):
            self.drop(stream)
