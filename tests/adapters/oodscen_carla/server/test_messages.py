"""Messages come back as they were packed; whatever else arrives costs little and is refused."""

import msgpack
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oodscen_carla.server._messages import (
    MAX_BYTES,
    MAX_DEPTH,
    MAX_VALUES,
    MemoryPool,
    MessageReader,
    ProtocolError,
)

VALUES = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**63), 2**64 - 1)
    | st.floats(allow_nan=False)
    | st.text(max_size=300)
    | st.binary(max_size=300),
    lambda inner: st.lists(inner, max_size=20) | st.dictionaries(st.text(max_size=9), inner),
    max_leaves=30,
)


def request(arguments: object, number: int = 1, method: str = "tick_cue") -> bytes:
    return msgpack.packb([0, number, method, arguments])


@settings(max_examples=15)
@given(st.lists(st.lists(VALUES, max_size=5), max_size=4), st.data())
def test_messages_come_back_however_the_bytes_are_cut(calls, data):
    sent = b"".join(request(arguments, number) for number, arguments in enumerate(calls))
    reader, got = MessageReader(), []
    while sent:
        count = data.draw(st.integers(1, len(sent)))
        got += reader.feed(sent[:count])
        sent = sent[count:]
    assert got == [[0, number, "tick_cue", one] for number, one in enumerate(calls)]


@given(st.binary(max_size=4000))
def test_random_bytes_wait_or_are_refused(data):
    pool = MemoryPool(1 << 20)
    reader = MessageReader(pool)
    try:
        for message in reader.feed(data):
            assert message[0] in (0, 2)
    except ProtocolError:
        pass
    reader.close()
    pool.take(1 << 20)


HOSTILE = {
    "length of a string": b"\x94\x00\x01\xa1x\xdb\xff\xff\xff\xff",
    "length of an array": b"\x94\x00\x01\xa1x\xdd\xff\xff\xff\xff",
    "length of a map": b"\x94\x00\x01\xa1x\xdf\x7f\xff\xff\xff",
    "depth": b"\x94\x00\x01\xa1x" + b"\x91" * (MAX_DEPTH + 2),
    "preallocated arrays": b"\x94\x00\x01\xa1x" + b"\xdc\xff\xff" * 20,
    "values": b"\x94\x00\x01\xa1x\xdd" + (MAX_VALUES + 1).to_bytes(4, "big"),
    "extension": b"\x94\x00\x01\xa1x\xc7\x01\x01\x00",
    "unused type": b"\xc1",
    "no array": b"\x01",
    "another protocol": b"GET / HTTP/1.1\r\n\r\n",
    "a response": msgpack.packb([1, 1, None, 1]),
    "method": msgpack.packb([0, 1, 7, []]),
    "a long method": request([], method="m" * 99),
    "arguments": msgpack.packb([0, 1, "x", {}]),
    "number": msgpack.packb([0, -1, "x", []]),
    "bad text": b"\x94\x00\x01\xa1\xff\x90",
    "unhashable key": b"\x94\x00\x01\xa1x\x91\x81\x90\x01",
}


@pytest.mark.parametrize("data", HOSTILE.values(), ids=HOSTILE)
def test_hostile_bytes_are_refused_at_once(data):
    with pytest.raises(ProtocolError):
        list(MessageReader().feed(data))


def test_unfinished_messages_share_a_limit():
    pool = MemoryPool(1000)
    one, two = MessageReader(pool), MessageReader(pool)
    start = b"\x94\x00\x01\xa1x\xdb" + (MAX_BYTES // 2).to_bytes(4, "big")
    assert list(one.feed(start + b"x" * 900)) == []
    with pytest.raises(ProtocolError, match="unfinished"):
        list(two.feed(start + b"x" * 200))
    one.close()
    two.close()
    assert list(MessageReader(pool).feed(start + b"x" * 900)) == []
