"""Paint of roads, on straight ones that are made here."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oodscen_pybullet._land import marks
from oodscen_pybullet._land.course import RoadCourse, piece_length
from oodscen_pybullet._land.ground import Ground
from oodscen_pybullet._land.ribbons import Ribbons
from oodscen_pybullet._land.ways import Way

from oodscen.driving._roads.corridor import Corridor, LaneStrip, PaintedArea

LENGTH_M = 240.0
WIDTH_M = 3.5
PIECE_M = 3.0


def road(*strips: LaneStrip, crosswalks: tuple[PaintedArea, ...] = ()) -> Corridor:
    """Return a straight road along x, with its lanes side by side from t = 0 on."""
    s = np.linspace(0.0, LENGTH_M, 241)
    flat = np.zeros(len(s))
    placed = tuple(
        replace(strip, right=flat + index * WIDTH_M, left=flat + (index + 1) * WIDTH_M)
        for index, strip in enumerate(strips)
    )
    return Corridor(
        s=s, x=s, y=flat, z=flat, cos=flat + 1.0, sin=flat, curvature=flat,
        strips=placed, start=60.0, speed_limit=8.0, in_junction=flat > 0.0, crosswalks=crosswalks,
    )  # fmt: skip


def lane(mark: str, changes=(), *, direction: int = 1, right_mark: str = "none") -> LaneStrip:
    return LaneStrip(
        "driving", direction, np.zeros(0), np.zeros(0), mark, right_mark, tuple(changes)
    )


def way_of(corridor: Corridor) -> Way:
    course = RoadCourse.between(corridor, 0.0, LENGTH_M)
    return Way.of(corridor, course, is_ego=True, is_connecting=False)


def area(points) -> PaintedArea:
    points = [*points, points[0]]
    return PaintedArea("crosswalk", np.array(points, np.float64))


PAINT = st.sampled_from(["solid", "broken", "curb", "none"])
PLACES = st.lists(st.floats(1.0, LENGTH_M - 1.0), max_size=4, unique=True).map(sorted)


@given(PLACES, st.data())
def test_every_piece_has_the_paint_that_is_in_force_there(places, data):
    rows = [(s, data.draw(PAINT), data.draw(PAINT)) for s in (0.0, *places)]
    _, mark, right_mark = next(row for row in reversed(rows) if row[0] <= 60.0)
    changes = rows if places else ()
    way = way_of(road(lane(mark, changes, right_mark=right_mark), lane("none")))
    dashes = np.arange(len(way.course.middles)) % 3 == 0
    right, left, _ = marks._edge_marks(way)
    for edge, column in ((left, 1), (right, 2)):
        assert not edge.double.any()
        for painted, dash, middle in zip(edge.single, dashes, way.course.middles, strict=True):
            there = next(row[column] for row in reversed(rows) if row[0] <= middle)
            assert painted == (there == "solid" or (there == "broken" and dash))


def test_a_line_between_directions_is_double_where_it_is_solid():
    changes = [(0.0, "broken", "none"), (120.0, "solid", "none")]
    way = way_of(road(lane("broken", changes), lane("none", direction=-1)))
    _, middle, _ = marks._edge_marks(way)
    is_late = way.course.middles >= 120.0
    assert (middle.double == is_late).all()
    assert middle.single[~is_late].any()
    assert not middle.single[is_late].any()


@given(st.floats(0.0, 100.0), st.floats(6.0, 150.0), st.sampled_from([8.0, 30.0]))
def test_dashes_and_gaps_have_one_length_on_any_road(first, length, speed_limit):
    bent = replace(road(lane("broken")), speed_limit=speed_limit)
    is_tight = (bent.s > 90.0) & (bent.s < 110.0)
    bent = replace(bent, curvature=np.where(is_tight, 0.02, 0.0))
    course = RoadCourse.between(bent, first, first + length)
    dash = piece_length(bent)
    ends = np.flatnonzero(np.diff(np.concatenate([[False], marks._dashes(course, dash), [False]])))
    # The last piece, which takes what is left of the road, may be longer.
    lengths = np.diff([s for s in course.s[ends] if s < course.s[-1] - 1.6 * dash])
    assert lengths[::2] == pytest.approx(dash)
    assert lengths[1::2] == pytest.approx(2.0 * dash)


CROSSWALK = [(100.0, 0.0), (104.0, 0.0), (104.0, 7.0), (100.0, 7.0)]


@given(st.permutations([0, 1, 2, 3]).map(lambda order: order[0]))
def test_marks_end_at_a_crosswalk_whichever_corner_comes_first(first):
    way = way_of(road(lane("solid"), lane("none")))
    outline = area(CROSSWALK[first:] + CROSSWALK[:first])
    middles = way.course.middles[marks._interrupted(way, [outline])]
    assert middles.tolist() == [100.5, 103.5]


def painted(points, kind: str = "crosswalk") -> np.ndarray:
    """Return the triangles, [n, 3, 2], of a painted area on a road."""
    outline = replace(area(points), kind=kind)
    ground = Ground(road(lane("none"), lane("none"), crosswalks=(outline,)))
    ribbons = Ribbons(ground.ego.course)
    marks.paint_crossings(ground, ribbons)
    mesh = ribbons.mesh()
    return mesh.vertices[mesh.triangles][:, :, :2]


def area_of(triangles: np.ndarray) -> float:
    a, b = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    signed = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    assert (signed > 0.0).all()
    return float(signed.sum() / 2.0)


@given(st.lists(st.tuples(st.integers(0, 3), st.floats(0.01, 0.99)), max_size=6))
def test_corners_on_the_sides_of_a_crosswalk_change_nothing(more):
    points = []
    for side, (start, end) in enumerate(zip(CROSSWALK, CROSSWALK[1:] + CROSSWALK[:1], strict=True)):
        shares = sorted(share for index, share in more if index == side)
        (ax, ay), (bx, by) = start, end
        points += [(ax + share * (bx - ax), ay + share * (by - ay)) for share in (0.0, *shares)]
    triangles = painted(points)
    assert area_of(triangles) == pytest.approx(14.0)
    assert np.ptp(triangles[:, :, 0]) == pytest.approx(4.0)
    assert (np.ptp(triangles[:, :, 1], axis=1) <= 0.5 + 1e-6).all()


ARROW = [(100.0, 0.0), (104.0, 0.0), (102.0, 3.0), (104.0, 7.0), (100.0, 7.0)]


def test_areas_that_are_not_convex_are_painted_as_the_rectangle_around_them():
    assert area_of(painted(ARROW)) == pytest.approx(14.0)
    assert area_of(painted(ARROW, "stop_line")) == pytest.approx(28.0)


def test_an_outline_with_a_spike_is_painted_as_the_rectangle_around_it():
    spiked = [*CROSSWALK, CROSSWALK[0], (CROSSWALK[0][0], CROSSWALK[0][1] - 1.0)]
    alone, around = painted(CROSSWALK), painted(spiked)
    assert area_of(around) > area_of(alone)


def test_a_convex_stop_line_is_painted_as_it_is():
    slanted = [(100.0, 0.0), (100.5, 0.0), (101.0, 2.0), (100.7, 3.5), (100.2, 3.5)]
    triangles = painted(slanted, "stop_line")
    x, y = np.array(slanted).T
    expected = abs(float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())) / 2.0
    assert area_of(triangles) == pytest.approx(expected)


def test_an_outline_without_area_is_not_painted():
    assert len(painted([(100.0, 0.0), (102.0, 0.0), (104.0, 0.0)], "stop_line")) == 0


@given(st.integers(0, 100), st.floats(0.0, 200.0))
def test_bays_have_lines_every_six_metres(first, bend):
    strip = replace(lane("none"), kind="parking", direction=0)
    straight = road(lane("none"), strip)
    # Pieces are shorter where a road bends.
    is_tight = (straight.s > bend) & (straight.s < bend + 20.0)
    corridor = replace(straight, curvature=np.where(is_tight, 0.02, 0.0))
    course = RoadCourse.between(corridor, float(first), LENGTH_M)
    way = Way.of(corridor, course, is_ego=True, is_connecting=False)
    ribbons = Ribbons(course)
    marks.mark_lanes(way, ribbons, 0.0, (), "urban")
    mesh = ribbons.mesh()
    middles = mesh.vertices[mesh.triangles].reshape(-1, 6, 3)[:, :, 0].mean(axis=1)
    assert middles == pytest.approx(np.arange(first, LENGTH_M + 1e-9, 6.0))
    assert np.ptp(mesh.vertices[:, 1]) == pytest.approx(WIDTH_M)
