from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.data._catalogue import RoadMap
from oodscen.driving._roads.building import find_map, load_corridor
from oodscen.driving._roads.opendrive import read_network
from oodscen.driving._roads.routes import Leg, find_route, followers, lane_links
from oodscen.driving._roads.sampling import build_route
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.errors import DataError
from tests.driving.networks import file, lane, road, single_lane_junction
from tests.driving.staging import CATALOGUE

JUNCTIONS = [one for one in SHIPPED_MAPS if "junction" in one.traits]


def changed(road_map: RoadMap, **fields: object) -> RoadMap:
    return road_map.model_copy(update=fields)


@settings(max_examples=30, deadline=None)
@given(st.floats(-4, 4), st.booleans())
def test_lanes_go_on_where_connecting_roads_hold_one_lane_beside_their_line(
    beside: float, takes_second: bool
) -> None:
    network = read_network(single_lane_junction(beside))
    wanted = ("12" if takes_second else "11", "2")
    legs, index, issues = find_route(network, Leg(network.roads["1"], True), 50.0, wanted)
    assert not issues
    corridor = build_route(network, legs, index=index, start_m=50.0)
    assert corridor.length == pytest.approx(420.0)
    assert [strip.direction for strip in corridor.strips] == [1, 1, -1, -1]
    for number, strip in enumerate(corridor.strips):
        low = -7.0 + 3.5 * number
        assert np.allclose(strip.right, low, atol=2e-3), number
        assert np.allclose(strip.left, low + 3.5, atol=2e-3), number
    assert np.allclose(corridor.y, 0.0, atol=2e-3)
    assert corridor.in_junction.sum() in (40, 41)


@pytest.mark.parametrize("road_map", JUNCTIONS, ids=lambda one: one.id)
def test_the_edges_of_the_egos_lanes_never_jump(road_map: RoadMap) -> None:
    corridor = load_corridor(road_map)
    for index in corridor.ego_lanes:
        strip = corridor.strips[index]
        assert (strip.left - strip.right).min() > 3.0
        for edge in (strip.right, strip.left):
            assert np.abs(np.diff(edge)).max() < 0.16


@pytest.mark.parametrize("road_map", JUNCTIONS, ids=lambda one: one.id)
def test_the_shipped_route_is_what_straight_on_gives_except_in_the_roundabout(
    road_map: RoadMap,
) -> None:
    given_route = load_corridor(road_map)
    free = load_corridor(changed(road_map, route=()))
    same = len(given_route.x) == len(free.x) and np.array_equal(given_route.x, free.x)
    assert same or road_map.id == "roundabout"


@pytest.mark.parametrize("direction", ["13", "12", "11"])
def test_every_way_over_the_crossing_is_one_line(direction: str) -> None:
    crossing = next(one for one in SHIPPED_MAPS if one.id == "urban_junction")
    corridor = load_corridor(changed(crossing, route=(direction,)))
    steps = np.sqrt(np.diff(corridor.x) ** 2 + np.diff(corridor.y) ** 2)
    assert np.allclose(steps, corridor.step, atol=1e-3)
    assert corridor.length - corridor.start > 300.0


@pytest.mark.parametrize("route", [("99",), ("3",), ("12", "4"), ("12", "3", "1")])
def test_impossible_routes_say_what_would_be_possible(route: tuple[str, ...]) -> None:
    crossing = next(one for one in SHIPPED_MAPS if one.id == "urban_junction")
    with pytest.raises(DataError) as caught:
        load_corridor(changed(crossing, route=route))
    assert caught.value.issues[0].path == f"route[{len(route) - 1}]"


def test_followers_are_mutual() -> None:
    for road_map in JUNCTIONS:
        folder = Path(__file__).parents[3] / "oodscen/driving/maps"
        network = read_network((folder / f"{road_map.id}.xodr").read_bytes())
        for one in network.roads.values():
            for leg in (Leg(one, True), Leg(one, False)):
                for after in followers(network, leg):
                    assert leg.turned in followers(network, after.turned)


def test_circles_end_where_they_began(tmp_path: Path) -> None:
    link = (
        '<predecessor elementType="road" elementId="{0}" contactPoint="end"/>'
        '<successor elementType="road" elementId="{0}" contactPoint="start"/>'
    )
    half = 3.141592653589793 * 50
    parts = [
        road(str(n), half, at=(0.0, y, h), right=lane(-1), link=link.format(1 - n),
             shape='<arc curvature="0.02"/>')
        for n, y, h in ((0, -50.0, 0.0), (1, 50.0, 3.141592653589793))
    ]  # fmt: skip
    path = tmp_path / "ring.xodr"
    path.write_bytes(file(*parts))
    corridor = load_corridor(str(path), CATALOGUE)
    assert corridor.length == pytest.approx(2 * half)


def test_an_own_junction_file_starts_outside_the_junction(tmp_path: Path) -> None:
    path = tmp_path / "own.xodr"
    path.write_bytes(single_lane_junction(1.75))
    found = find_map(str(path), CATALOGUE)
    assert (found.road, found.start_m, found.route) == ("1", 80.0, ("11", "2"))
    corridor = load_corridor(found)
    assert not corridor.in_junction[round(corridor.start / corridor.step)]
    assert found.lanes == 2


def test_lanes_of_a_connection_at_the_other_end_are_ignored() -> None:
    data = single_lane_junction(0.0)
    wrong = (
        b'<connection id="9" incomingRoad="1" connectingRoad="11" contactPoint="end">'
        b'<laneLink from="-2" to="-1"/></connection></junction>'
    )
    found = []
    for text in (data, data.replace(b"</junction>", wrong)):
        network = read_network(text)
        before, through = Leg(network.roads["1"], True), Leg(network.roads["11"], True)
        found.append(set(lane_links(network, before, through)))
    assert found[0] == found[1] == {(-1, -1)}
