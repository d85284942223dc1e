"""The wire format of protocol buffers: what is written is read."""

import struct

from hypothesis import given
from hypothesis import strategies as st

from oodscen.interchange._traces.wire import (
    content,
    double,
    double_field,
    fields_of,
    inner_fields,
    integer,
    message_field,
    number_field,
    text_field,
    vector_field,
)

NUMBERS = st.integers(1, 15)


@given(NUMBERS, st.integers(0, 2**63 - 1), st.floats(allow_nan=False), st.text(), st.binary())
def test_fields_come_back(number, whole, real, text, message):
    assert integer(fields_of(number_field(number, whole)), number) == whole
    assert double(fields_of(double_field(number, real)), number) == real
    assert content(fields_of(text_field(number, text))[number][0]).decode() == text
    assert fields_of(message_field(number, message)) == {number: [message]}


@given(NUMBERS, *[st.floats(-1e6, 1e6)] * 3)
def test_a_vector_is_a_message_of_three_numbers(number, x, y, z):
    vector = inner_fields(fields_of(vector_field(number, x, y, z)), number)
    assert vector == {1: [x], 2: [y], 3: [z]}


@given(NUMBERS, st.integers(-(2**63), -1))
def test_negative_integers_take_ten_bytes(number, value):
    assert integer(fields_of(number_field(number, value % 2**64)), number) == value


def test_what_is_missing_is_zero():
    assert integer({}, 1) == 0
    assert double({}, 1) == 0.0
    assert inner_fields({}, 1) == {}


@given(NUMBERS, st.floats(width=32, allow_nan=False))
def test_single_precision_is_read(number, value):
    assert double(fields_of(bytes([number << 3 | 5]) + struct.pack("<f", value)), number) == value
