"""Streams to fake connections that take what they are given a few bytes at a time."""

import struct
import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_carla.server import _sockets
from oodscen_carla.server._sockets import STALL_S, send_both
from oodscen_carla.server._streams import Streams

STREAM = 5


class Narrow:
    """A connection that takes at most `width` bytes at once."""

    def __init__(self, width: int, took=lambda: None) -> None:
        self.width, self.took = width, took
        self.taken, self.is_closed = b"", False

    def sendmsg(self, buffers) -> int:
        self.took()
        taken = b"".join(buffers)[: self.width]
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


@given(
    first=st.binary(min_size=1, max_size=9), last=st.binary(max_size=9), width=st.integers(1, 18)
)
def test_both_buffers_arrive_however_few_bytes_are_taken_at_once(first, last, width):
    connection = Narrow(width)
    send_both(connection, first, last)
    assert connection.taken == first + last


@given(head=st.binary(max_size=9), body=st.binary(max_size=9))
def test_a_message_is_preceded_by_its_length(head, body):
    connection = Narrow(100)
    listening(connection).send(STREAM, head, memoryview(body))
    assert connection.taken == struct.pack("<I", len(head + body)) + head + body


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
