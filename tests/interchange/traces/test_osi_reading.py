"""OSI traces: read by the wire format, or refused in plain words."""

import math
import re
import struct
from functools import cache

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data import Actor, Placement, Trigger
from oodscen.errors import DataError
from oodscen.interchange._traces.osi_reading import read_osi_trace
from oodscen.interchange._traces.osi_writing import osi_trace
from oodscen.interchange._traces.wire import (
    double,
    fields_of,
    inner_fields,
    message_field,
    number_field,
    text_field,
    vector_field,
)
from tests.driving.networks import file, lane, road
from tests.interchange.staging import SCENES, catalogue

MOVING, STATIONARY = 5, 4
ENTITY, ROAD = "entity_name:box", "road_object:7"
PLAIN_WORDS = (
    r"(cut off|is empty|the number 0|of the unknown kind \d|more than 64 bits|not an integer|not finite"
    r"|is missing|a number stands for a message or a text|not a floating-point number)$"
)


def body(kind, reference, x):
    """Return the field of one object."""
    reference_field = b""
    if reference:
        number = {MOVING: 10, STATIONARY: 5}[kind]
        reference_field = message_field(number, text_field(3, reference))
    return message_field(kind, message_field(2, vector_field(2, x, 0.0, 0.0)) + reference_field)


def fault(data):
    """Return the fault for which a trace is refused, `None` if it is read."""
    try:
        list(read_osi_trace(data, "run.osi"))
    except DataError as error:
        (issue,) = error.issues
        return issue
    return None


@cache
def whole_trace():
    return osi_trace(SCENES[0], catalogue())


def trace(*objects, seconds=0, nanos=0):
    """Return a trace of one moment."""
    stamp = number_field(1, seconds % 2**64) + number_field(2, nanos)
    truth = message_field(2, stamp) + b"".join(objects)
    return struct.pack("<I", len(truth)) + truth


@given(st.integers(-(10**9), 10**9), st.integers(0, 10**9 - 1))
def test_seconds_have_a_sign(seconds, nanos):
    data = trace(body(MOVING, ENTITY, 1.0), seconds=seconds, nanos=nanos)
    ((time, name, *_),) = read_osi_trace(data, "run.osi")
    assert (time, name) == (pytest.approx(seconds + 1e-9 * nanos, abs=1e-5), "box")


@pytest.mark.parametrize(
    ("kind", "reference", "names"),
    [
        (MOVING, ENTITY, ["box"]),
        (STATIONARY, ENTITY, ["box"]),
        (MOVING, ROAD, [""]),
        (STATIONARY, ROAD, []),
        (MOVING, "", [""]),
        (STATIONARY, "", [""]),
    ],
)
def test_bodies_without_a_name_are_read_but_for_things_of_the_road(kind, reference, names):
    found = read_osi_trace(trace(body(kind, reference, 1.0)), "run.osi")
    assert [row.name for row in found] == names


@given(st.binary())
def test_bytes_are_read_or_refused_in_plain_words(data):
    for found in map(fault, (data, struct.pack("<I", len(data)) + data)):
        assert found is None or re.search(PLAIN_WORDS, found.message)


@given(st.data())
def test_a_changed_trace_is_read_or_refused_in_plain_words(data):
    whole = whole_trace()
    place = data.draw(st.integers(0, len(whole) - 8))
    found = fault(whole[:place] + data.draw(st.binary(max_size=8)) + whole[place + 8 :])
    assert found is None or re.search(PLAIN_WORDS, found.message)


def test_a_file_of_zeros_is_refused_at_its_first_byte():
    with pytest.raises(DataError, match="byte 0: the message is empty"):
        list(read_osi_trace(bytes(1_000), "run.osi"))


def test_a_vehicle_on_a_slope_has_the_pitch_of_its_course():
    """It goes along its own axis, nose up as its height grows; a body without a rear axle stays level."""
    walker = next(asset.id for asset in catalogue().assets if asset.category == "pedestrian")
    actors = tuple(
        Actor(id=name, asset=name, placement=Placement(ahead_m=ahead))
        for name, ahead in (("car", 140.0), (walker, 160.0))
    )
    hill = {"map": "rural_hill", "actors": actors, "decision": Trigger(value=6.0)}
    data = osi_trace(SCENES[0].model_copy(update=hill), catalogue(), action="stop")
    pitches = []
    for message in messages(data):
        ego, car, person = (inner_fields(fields_of(one), 2) for one in fields_of(message)[MOVING])
        rise = double(inner_fields(ego, 4), 3)
        length_mps = math.dist(
            (0.0,) * 3, [double(inner_fields(ego, 4), axis) for axis in (1, 2, 3)]
        )
        pitch = double(inner_fields(ego, 3), 2)
        if length_mps > 1.0:
            assert math.sin(-pitch) == pytest.approx(rise / length_mps, abs=0.01)
        assert double(inner_fields(car, 3), 2) != 0.0
        assert double(inner_fields(person, 3), 2) == 0.0
        pitches.append(pitch)
    assert min(pitches) < -0.03


def messages(data):
    """Yield the messages of a trace."""
    while data:
        (size,) = struct.unpack_from("<I", data)
        yield data[4 : 4 + size]
        data = data[4 + size :]


def test_a_run_that_ends_at_its_start_has_one_moment(tmp_path):
    path = tmp_path / "narrow.xodr"
    path.write_bytes(file(road("1", 400.0, right=lane(-1, width=1.6))))  # The ego is wider.
    alone = {"map": str(path), "actors": (), "decision": Trigger(value=1.0)}
    scene = SCENES[0].model_copy(update=alone)
    data = osi_trace(scene, catalogue())
    (pose,) = read_osi_trace(data, "run.osi")
    assert pose.name == "ego"
    base = inner_fields(inner_fields(fields_of(data[4:]), MOVING), 2)
    velocity, acceleration = inner_fields(base, 4), inner_fields(base, 5)
    assert double(velocity, 1) == pytest.approx(scene.ego.speed)
    assert [double(acceleration, axis) for axis in (1, 2, 3)] == [0.0, 0.0, 0.0]
