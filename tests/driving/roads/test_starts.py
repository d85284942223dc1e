import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.driving._roads.opendrive import read_network
from oodscen.driving._roads.starts import find_start
from tests.driving.networks import file, lane, road, single_lane_junction


@given(st.floats(1.0, 5_000.0))
def test_a_start_has_a_quarter_of_its_way_or_160_m_behind_it(length):
    start = find_start(read_network(file(road("1", length, right=lane(-1)))))
    assert start.leg.road.id == "1"
    assert start.leg.forward
    assert start.s == start.driven_m == pytest.approx(min(160.0, 0.25 * length))
    assert start.onward == ()


def test_lanes_against_the_line_are_driven_against_it():
    start = find_start(
        read_network(file(road("1", 200.0, left=lane(1), right=lane(-1, "sidewalk"))))
    )
    assert not start.leg.forward
    assert (start.driven_m, start.s) == (pytest.approx(50.0), pytest.approx(150.0))


def test_of_several_ways_the_longest_is_taken():
    roads = [road(name, length, right=lane(-1)) for name, length in (("a", 90.0), ("b", 120.0))]
    assert find_start(read_network(file(*roads))).leg.road.id == "b"


def test_it_lies_outside_junctions_and_its_way_leads_through_them():
    start = find_start(read_network(single_lane_junction(0.0)))
    assert not start.leg.road.junction
    assert {leg.road.junction for leg in start.onward} <= {"", "J"}
    total = start.leg.road.length + sum(leg.road.length for leg in start.onward)
    assert total >= start.driven_m


def test_without_a_driving_lane_there_is_no_start():
    assert find_start(read_network(file(road("1", 100.0, right=lane(-1, "sidewalk"))))) is None
