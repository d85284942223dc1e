import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import DRIVABLE, Corridor
from oodscen.driving._roads.coverage import union_of
from oodscen.driving.maps._shipped import SHIPPED_MAPS

MAPS = {road.id: load_corridor(road) for road in SHIPPED_MAPS}
JUNCTIONS = st.sampled_from([MAPS[name] for name in ("urban_junction", "t_junction")])
CORRIDORS = st.sampled_from(list(MAPS.values()))
ranges = st.lists(st.tuples(st.floats(-50, 50), st.floats(0.1, 20)), max_size=6).map(
    lambda pairs: [(low, low + width) for low, width in sorted(pairs)]
)


@given(ranges, ranges, st.floats(-60, 80))
def test_a_union_holds_what_either_holds(own, others, place) -> None:
    union = union_of(own, others)
    assert all(a[1] < b[0] for a, b in pairwise(union))
    if any(low <= place <= high for low, high in [*own, *others]):
        assert any(low <= place <= high for low, high in union)


@settings(max_examples=150, deadline=None)
@given(JUNCTIONS, st.floats(60, 160), st.floats(-60, 60))
def test_the_lanes_of_other_roads_are_road(corridor: Corridor, ahead: float, t: float) -> None:
    s = corridor.start + ahead
    x, y, _, _ = corridor.point(s, t)
    beneath = False
    for other in corridor.others:
        place = other.corridor.locate(x, y)
        if not 0.3 < place[0] < other.corridor.length - 0.3:
            continue
        for index, strip in enumerate(other.corridor.strips):
            right, left = other.corridor.edges(index, place[0])
            if strip.kind in DRIVABLE and right + 0.3 < place[1] < left - 0.3:
                beneath = True
    if beneath:
        assert corridor.is_drivable(s, t, t)
        assert corridor.is_on_map(s, t)


def test_far_from_junctions_only_the_own_road_is_road() -> None:
    corridor = MAPS["urban_junction"]
    for t in (-40.0, 40.0):
        assert not corridor.is_drivable(corridor.start, t, t)
        assert not corridor.is_on_map(corridor.start, t)
    middle = float(corridor.s[corridor.in_junction].mean())
    assert corridor.is_on_map(middle, 100.0)
    assert corridor.is_drivable(middle, -12.0, 12.0)


@settings(max_examples=40, deadline=None)
@given(
    CORRIDORS,
    st.lists(st.tuples(st.floats(-0.02, 1.02), st.floats(-9, 9)), min_size=1, max_size=20),
)
def test_many_points_are_located_like_each_of_them(corridor: Corridor, places) -> None:
    points = [corridor.point(part * corridor.length, t)[:2] for part, t in places]
    s, t = corridor.locate_all(*(np.array(axis) for axis in zip(*points, strict=True)))
    assert list(zip(s.tolist(), t.tolist(), strict=True)) == [
        corridor.locate(x, y) for x, y in points
    ]


@pytest.mark.parametrize(
    ("name", "kind", "number"),
    [("urban_junction", "traffic_light", 8), ("roundabout", "sign", 4), ("t_junction", "sign", 1)],
)
def test_signals_face_those_whom_they_address(name: str, kind: str, number: int) -> None:
    corridor = MAPS[name]
    assert [signal.kind for signal in corridor.signals] == [kind] * number
    for signal in corridor.signals:
        x, y, _, _ = corridor.point(signal.s, signal.t)
        assert math.dist((x, y), (signal.x, signal.y)) < 1e-3
    facing = [one for one in corridor.signals if corridor.alignment(one.s, one.yaw) < -0.99]
    assert all(one.t < 0 or one.id.startswith("far") for one in facing)


def test_structures_and_paint_lie_on_the_road() -> None:
    assert [
        (structure.kind, structure.start, structure.end) for structure in MAPS["tunnel"].structures
    ] == [("tunnel", 260.0, 460.0)]
    assert [structure.kind for structure in MAPS["bridge"].structures] == ["bridge"]
    paint = MAPS["urban_junction"].crosswalks
    assert {one.kind for one in paint} == {"crosswalk", "stop_line"}
    for one in paint:
        for x, y in one.points.tolist():
            s, t = MAPS["urban_junction"].locate(0.99 * x, 0.99 * y)
            assert MAPS["urban_junction"].is_on_map(s, t)
