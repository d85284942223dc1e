"""Connections to clients: sending within a time limit, and ending."""

import socket
import struct
import time
from contextlib import suppress

STALL_S = 5
"""Time that a client has to take a message, whole seconds."""


def limit_sends(connection: socket.socket) -> None:
    """Let a send fail when the peer reads nothing for `STALL_S`; receiving may wait indefinitely."""
    timeout = struct.pack("ll", STALL_S, 0)
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, timeout)


def send_message(connection: socket.socket, head: bytes, body: bytes | memoryview) -> None:
    """Send a head and a body as one message, so that the peer wakes once.

    Args:
        connection: A connection whose sends are limited.
        head: The first bytes.
        body: The rest; a view may have any number of dimensions.

    Raises:
        OSError: If the connection fails, or the peer has not taken the message after `STALL_S`; twice
            that, if it stops reading late.
    """
    deadline = time.monotonic() + STALL_S
    left = [memoryview(part).cast("B") for part in (head, body)]
    while left:
        sent = connection.sendmsg(left)
        while left and sent >= len(left[0]):
            sent -= len(left.pop(0))
        if left:
            left[0] = left[0][sent:]
            if time.monotonic() > deadline:
                raise TimeoutError("the peer reads too slowly")


def end(connection: socket.socket) -> None:
    """Close a connection, whichever thread waits for it."""
    with suppress(OSError):
        connection.shutdown(socket.SHUT_RDWR)
    connection.close()
