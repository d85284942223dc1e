"""Conflict measures: laws that hold for any two boxes."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from oodscen.driving import Box, gap
from oodscen.driving._surrogate_safety import (
    TTC_LIMIT_S,
    Footprints,
    overlap,
    post_encroachment,
    time_headway,
    time_to_collision,
)

place = st.floats(-30, 30)
speed = st.floats(-15, 15)
angle = st.floats(-math.pi, math.pi)
size = st.floats(0.3, 9)
boxes = st.builds(Box, place, place, angle, size, size)


def prints(box: Box) -> Footprints:
    columns = (box.x, box.y, math.cos(box.yaw), math.sin(box.yaw), box.length / 2, box.width / 2)
    return Footprints(*(np.array([value]) for value in columns))


def collision(a: Box, b: Box, vx: float, vy: float) -> float:
    return float(time_to_collision(prints(a), prints(b), np.array([vx]), np.array([vy]))[0])


@given(boxes, boxes)
def test_boxes_overlap_exactly_where_their_gap_is_zero(a, b):
    apart = gap(a, b)
    assume(apart == 0.0 or apart > 1e-9)
    assert bool(overlap(prints(a), prints(b))[0]) == (apart == 0.0)


@given(boxes, boxes, st.floats(1, 10), st.floats(-1, 1), st.floats(-1, 1))
def test_bodies_touch_at_the_time_to_collision_and_not_before(a, b, after, wx, wy):
    vx, vy = (a.x - b.x) / after + wx, (a.y - b.y) / after + wy
    time = collision(a, b, vx, vy)
    if math.isinf(time):
        return
    assert gap(a, b._replace(x=b.x + vx * time, y=b.y + vy * time)) < 1e-6
    for share in (0.0, 0.5, 0.99):
        moved = b._replace(x=b.x + share * vx * time, y=b.y + share * vy * time)
        assert time == 0.0 or gap(a, moved) > 0.0


@given(boxes, boxes, speed, speed)
def test_what_never_touches_has_no_time_to_collision(a, b, vx, vy):
    assume(math.isinf(collision(a, b, vx, vy)))
    for time in np.linspace(0.0, TTC_LIMIT_S, 50).tolist():
        assert gap(a, b._replace(x=b.x + vx * time, y=b.y + vy * time)) > 0.0


@given(boxes, boxes, speed, speed)
def test_time_to_collision_is_the_same_for_both(a, b, vx, vy):
    one, other = collision(a, b, vx, vy), collision(b, a, -vx, -vy)
    assert one == pytest.approx(other, rel=1e-6, abs=1e-6) or TTC_LIMIT_S in (
        pytest.approx(one, rel=1e-6),
        pytest.approx(other, rel=1e-6),
    )


def row(x, y, *, heading=0.0, length=4.0, width=2.0) -> Footprints:
    x, y = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
    ones = np.ones(x.shape)
    return Footprints(
        x,
        y,
        math.cos(heading) * ones,
        math.sin(heading) * ones,
        0.5 * length * ones,
        0.5 * width * ones,
    )


def test_post_encroachment_is_the_time_between_leaving_and_arriving():
    times = np.arange(0.0, 10.0, 0.1)
    ego = row(10.0 * times - 50.0, 0.0 * times)
    crossing = row(0.0 * times, 10.0 * times - 30.0, heading=math.pi / 2)
    met = post_encroachment(ego, Footprints(*(c[:, None] for c in crossing)), 0.1)
    # The actor's rear leaves the ego's path at y = 3, t = 3.3 s; the ego's front arrives at 4.7 s.
    assert met[0] == pytest.approx(4.7 - 3.3, abs=0.11)


def test_paths_without_common_ground_have_no_post_encroachment_time():
    times = np.arange(0.0, 5.0, 0.1)
    ego = row(10.0 * times, 0.0 * times)
    beside = row(10.0 * times, 0.0 * times + 3.5)
    both = Footprints(*(np.stack([c, c], axis=1) for c in beside))
    assert np.isinf(post_encroachment(ego, both, 0.1)).all()
    alone = Footprints(*(c[:, None][:, :0] for c in beside))
    assert post_encroachment(ego, alone, 0.1).shape == (0,)


def test_headway_counts_only_what_is_ahead_in_the_path():
    ahead = np.array([30.0, -30.0, 30.0, 3.0])
    aside = np.array([0.5, 0.0, 3.5, 0.0])
    found = time_headway(ahead, np.array(10.0), np.full(4, 5.0), aside, np.full(4, 2.0))
    np.testing.assert_allclose(found, [2.5, np.inf, np.inf, 0.0])
    assert np.isinf(time_headway(ahead, np.array(0.0), np.full(4, 5.0), aside, np.full(4, 2.0)))[0]
