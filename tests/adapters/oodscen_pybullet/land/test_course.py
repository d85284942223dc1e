"""Courses of a straight road and of one with a bend."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._land.course import RoadCourse, is_fast

from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor, LaneStrip
from oodscen.driving.maps._shipped import SHIPPED_MAPS

LENGTH_M = 240.0
PLACES = st.floats(-100.0, LENGTH_M + 100.0)


def road(radius_m: float = 0.0, speed_limit: float = 8.0) -> Corridor:
    """Return a road that begins at the origin along x, and bends to the left with a radius; 0 is straight."""
    s = np.linspace(0.0, LENGTH_M, 481)
    flat = np.zeros(len(s))
    curvature = flat + (1.0 / radius_m if radius_m else 0.0)
    yaw = s * curvature
    x, y = (np.sin(yaw) * radius_m, (1.0 - np.cos(yaw)) * radius_m) if radius_m else (s, flat)
    return Corridor(
        s=s, x=x, y=y, z=flat, cos=np.cos(yaw), sin=np.sin(yaw), curvature=curvature,
        strips=(LaneStrip("driving", 1, flat - 3.5, flat, "solid"),), start=60.0,
        speed_limit=speed_limit,
    )  # fmt: skip


@given(PLACES, st.floats(0.0, 300.0), st.sampled_from([0.0, 50.0, 400.0]))
def test_samples_rise_from_the_first_place_to_the_last(first, length, radius) -> None:
    course = RoadCourse.between(road(radius), first, first + length)
    assert course.s[0] == first
    assert course.s[-1] == pytest.approx(first + length) or length == 0.0
    assert (np.diff(course.s) > 0.0).all()
    assert (np.diff(course.s) <= 3.0 * 1.5 + 1e-9).all()
    assert np.allclose(course.cos**2 + course.sin**2, 1.0)


def test_a_tight_bend_and_a_slow_road_have_more_samples() -> None:
    counts = [
        len(RoadCourse.between(one, 0.0, LENGTH_M).s)
        for one in (road(50.0), road(), road(speed_limit=30.0))
    ]
    assert counts == [241, 81, 41]
    assert [is_fast(road(speed_limit=limit)) for limit in (19.0, 19.1)] == [False, True]


def test_a_course_goes_on_straight_beyond_the_road() -> None:
    bend = road(50.0)
    course = RoadCourse.between(bend, LENGTH_M - 3.0, LENGTH_M + 90.0)
    beyond = course.s > LENGTH_M
    ahead = course.s[beyond] - LENGTH_M
    end = np.array([bend.x[-1], bend.y[-1]])
    heading = np.array([bend.cos[-1], bend.sin[-1]])
    assert np.allclose(course.points(0.0)[beyond, :2], end + ahead[:, None] * heading)


@given(st.floats(20.0, 220.0), st.floats(-6.0, 6.0), st.sampled_from([0.0, 400.0]))
def test_a_point_beside_a_course_is_found_again(s, t, radius) -> None:
    one = road(radius)
    x, y, _, _ = one.point(s, t)
    found_s, found_t = RoadCourse.of(one).locate(np.array([x]), np.array([y]))
    assert found_s[0] == pytest.approx(s, abs=0.05)
    assert found_t[0] == pytest.approx(t, abs=0.05)


@pytest.mark.parametrize("shipped", SHIPPED_MAPS, ids=lambda shipped: shipped.id)
def test_structures_begin_and_end_at_samples(shipped) -> None:
    corridor = load_corridor(shipped)
    course = RoadCourse.of(corridor)
    for structure in corridor.structures:
        for end in (structure.start, structure.end):
            assert not course.s[0] < end < course.s[-1] or end in course.s


@given(st.integers(10, 470))
def test_a_lane_that_ends_at_once_on_a_fast_road_ends_between_two_samples(row) -> None:
    straight = road(speed_limit=30.0)
    flat = np.zeros(len(straight.s))
    exit_lane = LaneStrip(
        "driving", 1, flat - 7.0, np.where(np.arange(481) < row, -3.5, -7.0), "none"
    )
    corridor = replace(straight, strips=(exit_lane, *straight.strips))
    course = RoadCourse.between(corridor, 0.0, LENGTH_M)
    assert {straight.s[row - 1], straight.s[row]} <= set(course.s.tolist())
