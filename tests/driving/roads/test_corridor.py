import math
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving.maps._shipped import SHIPPED_MAPS

ROADS = {road.id: road for road in SHIPPED_MAPS}


@cache
def road_of(name: str) -> Corridor:
    return load_corridor(ROADS[name])


corridors = st.builds(road_of, st.sampled_from(sorted(ROADS)))
"""Drawn by name: Hypothesis prints what it draws from, and a corridor is long."""
fractions = st.floats(-0.05, 1.05)
offsets = st.floats(-25, 25)


@given(corridors, fractions, offsets, st.floats(-60, 60))
def test_point_and_locate_are_inverse(
    road: Corridor, fraction: float, t: float, error: float
) -> None:
    s = fraction * road.length
    x, y, _, _ = road.point(s, t)
    for found_s, found_t in (road.locate(x, y, s + error), road.locate(x, y)):
        assert math.isclose(found_s, s, abs_tol=1e-6)
        assert math.isclose(found_t, t, abs_tol=1e-6)


@given(corridors, fractions, offsets)
def test_the_heading_is_the_direction_of_travel(road: Corridor, fraction: float, t: float) -> None:
    s = fraction * road.length
    assume(abs(road.bend(s) * t) < 0.5)  # Lines beside the road cross at the middle of a bend.
    x0, y0, _, _ = road.point(s - 0.5, t)
    x1, y1, _, _ = road.point(s + 0.5, t)
    _, _, _, heading = road.point(s, t)
    assert abs(math.remainder(math.atan2(y1 - y0, x1 - x0) - heading, math.tau)) < 1e-3


@given(corridors, st.floats(0, 1))
def test_curvature_is_the_change_of_heading(road: Corridor, fraction: float) -> None:
    s = fraction * road.length
    turn = math.remainder(road.point(s + 1, 0)[3] - road.point(s - 1, 0)[3], math.tau)
    if 2 < s < road.length - 2:
        assert math.isclose(turn / 2, road.bend(s), abs_tol=2e-4)


@given(corridors, st.floats(0, 1))
def test_strips_share_their_edges(road: Corridor, fraction: float) -> None:
    s = fraction * road.length
    edges = [road.edges(index, s) for index in range(len(road.strips))]
    for (_, left), (right, _) in pairwise(edges):
        assert left == right
    for index, (right, left) in enumerate(edges):
        if left - right > 1e-6:
            assert road.strip_at(s, 0.5 * (right + left)) == index


@given(corridors, st.floats(0, 1), offsets, st.floats(0.1, 3))
def test_drivable_means_that_only_drivable_strips_lie_between(
    road: Corridor, fraction: float, t: float, width: float
) -> None:
    s = fraction * road.length
    places = np.linspace(t - width, t + width, 41)
    kinds = [
        None if (strip := road.strip_at(s, place)) is None else road.strips[strip].kind
        for place in places
    ]
    if road.is_drivable(s, t - width, t + width):
        assert set(kinds[1:-1]) <= {"driving", "shoulder", "parking"}
    elif all(kind in ("driving", "shoulder", "parking") for kind in kinds):
        limits = road.drivable_range(s, t)
        assert limits is not None
        assert t - width <= limits[0] + 0.2 or t + width >= limits[1] - 0.2


@pytest.mark.parametrize("road_map", SHIPPED_MAPS, ids=lambda road: road.id)
def test_neighbours_are_mutual_driving_lanes(road_map) -> None:
    road = load_corridor(road_map)
    for strip in road.driving:
        for side in (-1, 1):
            other = road.neighbour(strip, road.start, side)
            if other is not None:
                assert road.neighbour(other, road.start, -side) == strip


def test_the_median_separates_the_highway() -> None:
    road = load_corridor(next(one for one in SHIPPED_MAPS if one.id == "highway"))
    assert road.neighbour(road.ego_lanes[-1], road.start, 1) is None


def test_arrays_cannot_be_changed() -> None:
    road = load_corridor(SHIPPED_MAPS[0])
    with pytest.raises(ValueError, match="read-only"):
        road.x[0] = 1.0
