"""Conflict measures: laws that hold for any two boxes."""

import math
import tracemalloc

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from oodscen.driving._motion.boxes import Footprint, gap
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
boxes = st.builds(Footprint, place, place, angle, size, size)


def prints(box: Footprint) -> Footprints:
    columns = (box.x, box.y, math.cos(box.yaw), math.sin(box.yaw), box.length / 2, box.width / 2)
    return Footprints(*(np.array([value]) for value in columns))


def collision(a: Footprint, b: Footprint, vx: float, vy: float) -> float:
    return float(time_to_collision(prints(a), prints(b), np.array([vx]), np.array([vy]))[0])


@given(boxes, boxes)
def test_boxes_overlap_exactly_where_their_gap_is_zero(a, b):
    apart = gap(a, b)
    assume(apart == 0.0 or apart > 1e-9)
    assert bool(overlap(prints(a), prints(b))[0]) == (apart == 0.0)


@given(boxes, angle, size, size, angle)
def test_boxes_overlap_up_to_the_place_where_they_touch(a, yaw, length, width, direction):
    def at(distance: float) -> Footprint:
        x, y = a.x + distance * math.cos(direction), a.y + distance * math.sin(direction)
        return Footprint(x, y, yaw, length, width)

    near, far = 0.0, 20.0
    while far - near > 1e-7:
        middle = 0.5 * (near + far)
        near, far = (middle, far) if gap(a, at(middle)) == 0.0 else (near, middle)
    for one, other in ((a, at(near - 1e-6)), (at(near - 1e-6), a)):
        assert overlap(prints(one), prints(other))[0]
    for one, other in ((a, at(far + 1e-6)), (at(far + 1e-6), a)):
        assert not overlap(prints(one), prints(other))[0]


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(("x", "y"), [(4.0, 0.5), (-4.0, 0.5), (1.0, 2.0), (1.0, -2.0), (4.0, 2.0)])
def test_boxes_that_just_touch_overlap(x, y, turned):
    a, b = row(0, 0), row(x, y)
    if turned:
        # A square at a right angle to `a`, so that only the normals of `b` are turned.
        b = row(x, y, heading=math.pi / 2, length=2.0, width=4.0)._replace(cos=0.0, sin=1.0)
    assert overlap(a, b)
    assert overlap(b, a)
    apart = b._replace(x=b.x + 1e-9 * (abs(x) == 4.0) * x, y=b.y + 1e-9 * (abs(y) == 2.0) * y)
    assert not overlap(a, apart)
    assert not overlap(apart, a)


@pytest.mark.parametrize(
    ("x", "y", "vx", "vy", "time"),
    [
        (64.0, 0.0, -1.0, 0.0, 60.0),
        (64.5, 0.0, -1.0, 0.0, math.inf),
        (10.0, 2.0, -1.0, 0.0, 6.0),
        (1.0, -9.0, 0.0, 2.0, 3.5),
        (8.0, 0.0, -2.0, 1.0, 2.0),
        (8.0, 0.0, -2.0, 1.01, math.inf),
        (3.0, 1.0, 1.0, 1.0, 0.0),
        (10.0, 0.0, 0.0, 0.0, math.inf),
        (10.0, 0.0, 1.0, 0.0, math.inf),
        (10.0, 2.5, -1.0, 0.0, math.inf),
    ],
)
def test_a_touch_counts_at_an_edge_at_a_corner_and_at_the_end_of_the_minute(x, y, vx, vy, time):
    assert collision(Footprint(0, 0, 0, 4, 2), Footprint(x, y, 0, 4, 2), vx, vy) == time


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
    met = post_encroachment(ego, Footprints(*(c[:, None] for c in crossing)), times)
    # The actor's rear leaves the ego's path at y = 3, t = 3.3 s; the ego's front arrives at 4.7 s.
    assert met[0] == pytest.approx(4.7 - 3.3, abs=0.11)


def test_paths_without_common_ground_have_no_post_encroachment_time():
    times = np.arange(0.0, 5.0, 0.1)
    ego = row(10.0 * times, 0.0 * times)
    beside = row(10.0 * times, 0.0 * times + 3.5)
    both = Footprints(*(np.stack([c, c], axis=1) for c in beside))
    assert np.isinf(post_encroachment(ego, both, times)).all()
    alone = Footprints(*(c[:, None][:, :0] for c in beside))
    assert post_encroachment(ego, alone, times).shape == (0,)


MOVES = st.floats(-3, 3)


@given(
    st.lists(st.tuples(MOVES, MOVES, angle), min_size=1, max_size=5),
    st.lists(
        st.lists(st.tuples(MOVES, MOVES, angle), min_size=5, max_size=5), min_size=1, max_size=3
    ),
    st.lists(st.floats(0.1, 3), min_size=8, max_size=8),
    st.lists(st.sampled_from([0.05, 0.1, 0.5]), min_size=5, max_size=5),
)
def test_post_encroachment_is_the_least_over_all_pairs_of_steps(path, paths, sizes, steps):
    """The steps of a recording may be uneven."""
    time = np.cumsum(steps)

    def boxes(number, places):
        length, width = sizes[2 * number : 2 * number + 2]
        return [Footprint(x, y, yaw, length, width) for x, y, yaw in places]

    ego, others = boxes(0, path), [boxes(n, p[: len(path)]) for n, p in enumerate(paths, 1)]
    mine = Footprints(*(np.array([prints(box)[i][0] for box in ego]) for i in range(6)))
    theirs = Footprints(
        *(np.array([[prints(box)[i][0] for box in track] for track in others]).T for i in range(6))
    )
    found = post_encroachment(mine, theirs, time[: len(path)])
    for value, track in zip(found, others, strict=True):
        times = [
            abs(time[i] - time[j])
            for i, one in enumerate(ego)
            for j, other in enumerate(track)
            if overlap(prints(one), prints(other))[0]
        ]
        assert value == pytest.approx(min(times, default=math.inf))


def test_post_encroachment_of_many_bodies_over_many_steps_takes_little_memory():
    step, actor = np.arange(1000), np.arange(20)
    ego = row(np.where(step < 500, 0.0, 100.0), 0.0)
    others = row(np.where(step[:, None] < 600 + actor, -100.0, 0.0), 0.0)
    tracemalloc.start()
    found = post_encroachment(ego, others, 0.5 * step)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert found.tolist() == [0.5 * (101 + number) for number in actor]
    assert peak < 200e6


@pytest.mark.parametrize("scale", [1.0, 0.125])
def test_corners_that_touch_share_ground_and_bodies_far_apart_none(scale):
    # Boxes of 8 by 6 have corners exactly 5 from their centres, so no rounding decides.
    size = {"length": 8.0 * scale, "width": 6.0 * scale}
    ego, steps = row([0.0, 0.0], 0.0, **size), np.array([0.0, 0.5])
    for x, time in ((8.0, 0.0), (80.0, math.inf)):
        other = row([[100.0], [x * scale]], 6.0 * scale, **size)
        assert post_encroachment(ego, other, steps) == [time]
    early = row([[8.0 * scale], [100.0]], 6.0 * scale, **size)
    assert post_encroachment(ego._replace(x=np.array([100.0, 0.0])), early, steps) == [0.5]
    assert post_encroachment(ego.at(slice(0)), early.at(slice(0)), steps[:0]) == [math.inf]


def test_headway_counts_only_what_is_ahead_in_the_path():
    ahead = np.array([30.0, -30.0, 30.0, 3.0])
    aside = np.array([0.5, 0.0, 3.5, 0.0])
    found = time_headway(ahead, np.array(10.0), np.full(4, 5.0), aside, np.full(4, 2.0))
    np.testing.assert_allclose(found, [2.5, np.inf, np.inf, 0.0])
    assert np.isinf(time_headway(ahead, np.array(0.0), np.full(4, 5.0), aside, np.full(4, 2.0)))[0]


@pytest.mark.parametrize(
    ("ahead", "speed", "aside", "headway"),
    [
        (0.0, 10.0, 0.0, math.inf),
        (0.001, 10.0, 0.0, 0.0),
        (25.0, 10.0, 2.0, math.inf),
        (25.0, 10.0, -1.999, 2.0),
        (25.0, 0.1, 0.0, math.inf),
        (25.0, 0.125, 0.0, 160.0),
    ],
)
def test_headway_ends_at_the_centre_the_edge_and_a_tenth_of_a_metre_per_second(
    ahead, speed, aside, headway
):
    columns = (np.array([value]) for value in (ahead, speed, 5.0, aside, 2.0))
    assert time_headway(*columns)[0] == headway
