"""Streams to fake connections that take what they are given a few bytes at a time."""

import math
import socket
import struct
import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_carla.server import _sockets
from oodscen_carla.server._sockets import STALL_S, limit_sends, send_message
from oodscen_carla.server._streams import Streams

STREAM = 5


class Narrow:
    """A connection that takes at most `width` bytes at once."""

    def __init__(self, width: int, took=lambda: None) -> None:
        self.width, self.took = width, took
        self.taken, self.is_closed = b"", False

    def sendmsg(self, buffers) -> int:
        self.took()
        taken = b"".join(map(bytes, buffers))[: self.width]
        self.taken += taken
        return len(taken)

    def shutdown(self, how: int) -> None: ...

    def close(self) -> None:
        self.is_closed = True


class Clock:
    """A clock that stands still between calls of `tick`."""

    def __init__(self, step: float) -> None:
        self.now, self.step = 0.0, step

    def monotonic(self) -> float:
        return self.now

    def tick(self) -> None:
        self.now += self.step


def listening(*connections: Narrow) -> Streams:
    streams = Streams(threading.Condition())
    with streams._heard:
        for connection in connections:
            assert streams.add(STREAM, connection)
    return streams


VIEWS = st.lists(st.integers(1, 4), max_size=3).flatmap(
    lambda shape: st.binary(min_size=math.prod(shape), max_size=math.prod(shape)).map(
        lambda content: memoryview(content).cast("B", shape)
    )
)
"""Views of bytes in any number of dimensions."""


@given(
    head=st.binary(min_size=1, max_size=9),
    body=st.binary(max_size=9) | VIEWS,
    width=st.integers(1, 18),
)
def test_head_and_body_arrive_however_few_bytes_are_taken_at_once(head, body, width):
    connection = Narrow(width)
    send_message(connection, head, body)
    assert connection.taken == head + bytes(body)


@given(head=st.binary(max_size=9), body=st.binary(max_size=9) | VIEWS)
def test_a_message_is_preceded_by_its_length(head, body):
    connection = Narrow(100)
    listening(connection).send(STREAM, head, memoryview(body))
    assert connection.taken == struct.pack("<I", len(head + bytes(body))) + head + bytes(body)


def test_only_sends_are_limited():
    mine, theirs = socket.socketpair()
    with mine, theirs:
        limit_sends(mine)
        limits = [
            struct.unpack("ll", mine.getsockopt(socket.SOL_SOCKET, option, 16))
            for option in (socket.SO_SNDTIMEO, socket.SO_RCVTIMEO)
        ]
    assert limits == [(STALL_S, 0), (0, 0)]


@pytest.mark.parametrize(("step", "is_kept"), [(0.04 * STALL_S, True), (0.4 * STALL_S, False)])
def test_a_message_has_one_deadline_however_steadily_its_reader_reads(monkeypatch, step, is_kept):
    clock = Clock(step)
    monkeypatch.setattr(_sockets, "time", clock)
    slow, quick = Narrow(10, clock.tick), Narrow(1000)
    streams = listening(slow, quick)
    streams.send(STREAM, b"", bytes(196))
    assert len(slow.taken) == (200 if is_kept else 30)
    assert slow.is_closed != is_kept
    assert len(quick.taken) == 200
    streams.send(STREAM, b"")
    assert len(quick.taken) == 204
