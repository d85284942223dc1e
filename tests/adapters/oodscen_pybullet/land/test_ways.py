import numpy as np
import pytest
from oodscen_pybullet._land.course import RoadCourse
from oodscen_pybullet._land.ways import Way

from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor, LaneStrip
from oodscen.driving.maps._shipped import SHIPPED_MAPS


def footpath(right: float, left: float) -> Corridor:
    """Return a straight road of 60 m whose only strip is a pavement."""
    s = np.linspace(0.0, 60.0, 61)
    flat = np.zeros(61)
    strip = LaneStrip("sidewalk", 0, flat + right, flat + left, "none")
    return Corridor(
        s=s, x=s, y=flat, z=flat, cos=flat + 1.0, sin=flat, curvature=flat,
        strips=(strip,), start=10.0, speed_limit=8.0,
    )  # fmt: skip


def way_of(corridor: Corridor) -> Way:
    course = RoadCourse.of(corridor)
    return Way.of(corridor, course, is_ego=True, is_connecting=False)


@pytest.mark.parametrize(("right", "left"), [(4.0, 7.0), (-7.0, -4.0)])
def test_a_pavement_without_a_carriageway_reaches_no_further_than_itself(right, left) -> None:
    way = way_of(footpath(right, left))
    assert np.all(way.paved.right == right)
    assert np.all(way.paved.left == left)
    between, s = np.array([right, left]) / 2.0, np.full(2, 20.0)
    assert np.all(way.distances(s, between).paved > 0.0)


@pytest.mark.parametrize("road", SHIPPED_MAPS, ids=lambda road: road.id)
def test_what_is_paved_includes_the_carriageway(road) -> None:
    way = way_of(load_corridor(road))
    is_there = way.carriageway.left > way.carriageway.right
    assert is_there.any()
    assert np.all((way.paved.right <= way.carriageway.right)[is_there])
    assert np.all((way.paved.left >= way.carriageway.left)[is_there])
