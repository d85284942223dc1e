"""OSI traces that contradict the scene about the ego: refused, or judged with a note."""

import struct
from functools import cache

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.errors import DataError
from oodscen.interchange import verdict
from oodscen.interchange._moving import UnrenderedSimulator
from oodscen.interchange._recording import replayed
from oodscen.interchange._traces.wire import (
    message_field,
    number_field,
    text_field,
    vector_field,
)
from oodscen.interchange._verdicts.poses import read_poses
from tests.interchange.staging import SCENES, catalogue

SCENE = SCENES[0]
BODIES = catalogue().bodies(SCENE)


@cache
def run():
    return replayed(SCENE, UnrenderedSimulator(catalogue()), "stop", 0)


def trace(*, host=0, size=None, place=None, since=0):
    """Return a trace with another host, size of the ego or place of a body from a step on."""
    played, messages = run(), []
    for step, time in enumerate(played.time.tolist()):
        nanos = round(time * 10**9)
        stamp = number_field(1, nanos // 10**9) + number_field(2, nanos % 10**9)
        truth = message_field(2, stamp)
        if host is not None:
            truth += message_field(3, number_field(1, host if step >= since else 0))
        for row, (name, asset, _) in enumerate(BODIES):
            x, y, z, heading = played.poses[step, row].tolist()
            box = (asset.length, asset.width)
            if size is not None and row == 0 and step >= since:
                box = size
            base = vector_field(3, 0.0, 0.0, heading)
            if row != place or step < since:
                base += vector_field(2, x, y, z + 0.5 * asset.height)
            if box:
                base += vector_field(1, *box, asset.height)
            reference = message_field(10, text_field(3, f"entity_name:{name}"))
            body = message_field(1, number_field(1, row)) + message_field(2, base)
            truth += message_field(5, body + reference)
        messages.append(struct.pack("<I", len(truth)) + truth)
    return b"".join(messages)


@pytest.fixture
def judged(tmp_path):
    """Return a function that judges a trace."""

    def judge(**changed):
        path = tmp_path / "run.osi"
        path.write_bytes(trace(**changed))
        return verdict(SCENE, path, catalogue())

    return judge


def test_a_trace_that_agrees_or_tells_nothing_has_no_notes(judged):
    expected = judged()
    assert expected.notes == ()
    assert judged(host=None) == judged(size=()) == expected


@pytest.mark.parametrize(("host", "words"), [(1, BODIES[1][0]), (77, "no named body")])
@pytest.mark.parametrize("since", [0, 3])
def test_another_host_vehicle_is_noted_with_its_time(judged, host, words, since):
    (note,) = judged(host=host, since=since).notes
    assert f"host_vehicle_id is that of {words} at {run().time[since]:g} s, not of ego" in note


@pytest.mark.parametrize("since", [0, 3])
@pytest.mark.parametrize("size", [(12.0, 6.0), (0.0, 0.0), (float("nan"), 1.9)])
def test_another_size_of_the_ego_is_noted_and_the_scenes_is_judged(judged, size, since):
    found = judged(size=size, since=since)
    (note,) = found.notes
    assert f"ego is {size[0]:g} x {size[1]:g} m in the file" in note
    assert found.outcome == judged().outcome


@settings(max_examples=10, deadline=None)
@given(st.floats(-0.2, 0.2), st.floats(-0.2, 0.2))
def test_rounded_sizes_are_not_noted(tmp_path_factory, longer, wider):
    path = tmp_path_factory.mktemp("run") / "run.osi"
    own = catalogue().ego
    path.write_bytes(trace(size=(own.length + longer, own.width + wider)))
    assert verdict(SCENE, path, catalogue()).notes == ()


@pytest.mark.parametrize("row", range(len(BODIES)))
@pytest.mark.parametrize("since", [0, 3])
def test_a_body_without_a_position_is_refused_by_name_and_time(tmp_path, row, since):
    path = tmp_path / "run.osi"
    path.write_bytes(trace(place=row, since=since))
    with pytest.raises(DataError) as caught:
        read_poses(path)
    (issue,) = caught.value.issues
    assert f"position of {BODIES[row][0]} at {run().time[since]:g} s is missing" in issue.message
