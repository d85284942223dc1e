import math
from pathlib import Path

import numpy as np
import pytest

from oodscen.data._catalogue import RoadMap
from oodscen.driving._roads.building import find_map, load_corridor, read_map
from oodscen.driving._roads.opendrive import read_network
from oodscen.driving._roads.routes import Leg, find_route
from oodscen.driving._roads.sampling import build_corridor, build_route
from oodscen.driving._roads.surroundings import roads_by_distance
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.errors import DataError, UnknownComponent
from tests.driving import networks
from tests.driving.networks import lane, read_road
from tests.driving.staging import CATALOGUE

SECTIONS = """<OpenDRIVE><road id="7" length="200" rule="{rule}"><planView>
<geometry s="0" x="0" y="0" hdg="0.3" length="200"><line/></geometry></planView>
<lanes><laneOffset s="100" a="0" b="0.01" c="0" d="0"/>
<laneSection s="0">
  <left><lane id="1" type="driving"><width sOffset="0" a="3" b="0" c="0" d="0"/></lane></left>
  <center><lane id="0" type="none"><roadMark sOffset="0" type="broken"/></lane></center>
  <right><lane id="-1" type="driving"><link><successor id="-2"/></link>
    <width sOffset="0" a="3.5" b="0" c="0" d="0"/><roadMark sOffset="0" type="solid"/></lane></right>
</laneSection>
<laneSection s="120">
  <left><lane id="1" type="driving"><width sOffset="0" a="3" b="0" c="0" d="0"/></lane></left>
  <center><lane id="0" type="none"/></center>
  <right><lane id="-1" type="driving"><width sOffset="0" a="0" b="0.05" c="0" d="0"/></lane>
         <lane id="-2" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane></right>
</laneSection></lanes></road></OpenDRIVE>"""


@pytest.mark.parametrize("road_map", SHIPPED_MAPS, ids=lambda road: road.id)
def test_shipped_maps_are_what_they_say(road_map: RoadMap) -> None:
    road = load_corridor(road_map)
    assert road.start >= 160.0
    assert road.length - road.start >= road_map.length_m >= 450.0
    assert len(road.ego_lanes) == road_map.lanes
    assert len(road.driving) - len(road.ego_lanes) == road_map.oncoming_lanes
    assert math.isclose(road.speed_limit, road_map.speed_limit, abs_tol=0.05)
    assert road_map.has_shoulder == any(
        strip.kind == "shoulder" and strip.direction > 0 for strip in road.strips
    )
    assert ("oncoming" in road_map.traits) == (
        road.neighbour(road.ego_lanes[-1], road.start, 1) is not None
    )


@pytest.mark.parametrize("road_map", SHIPPED_MAPS, ids=lambda road: road.id)
def test_samples_are_evenly_spaced(road_map: RoadMap) -> None:
    road = load_corridor(road_map)
    steps = np.sqrt(np.diff(road.x) ** 2 + np.diff(road.y) ** 2)
    assert road.step <= 0.5
    assert np.allclose(steps, road.step, atol=1e-4)
    assert np.allclose(road.cos**2 + road.sin**2, 1.0, atol=5e-6)


SINGLE_ROADS = [road for road in SHIPPED_MAPS if not road.route]


@pytest.mark.parametrize("road_map", SINGLE_ROADS, ids=lambda road: road.id)
def test_the_other_direction_mirrors_the_road(road_map: RoadMap) -> None:
    ahead = load_corridor(road_map)
    back = load_corridor(road_map.model_copy(update={"forward": False}))
    assert len(back.ego_lanes) == road_map.oncoming_lanes
    for s, t in ((10.0, 1.0), (333.0, -4.0), (700.0, 3.0)):
        x, y, z, yaw = ahead.point(s, t)
        other = back.point(back.length - s, -t)
        assert np.allclose((x, y, z), other[:3], atol=1e-5)
        assert abs(math.remainder(yaw + math.pi - other[3], math.tau)) < 1e-5
    right_to_left = [strip.kind for strip in ahead.strips]
    assert [strip.kind for strip in back.strips] == right_to_left[::-1]
    marks = [(strip.right_mark, strip.mark) for strip in ahead.strips]
    assert [(strip.mark, strip.right_mark) for strip in back.strips] == marks[::-1]


def test_lanes_are_followed_through_sections() -> None:
    road = build_corridor(read_road(SECTIONS.format(rule="RHT").encode()))
    assert [strip.direction for strip in road.strips] == [1, 1, -1]
    outer, new, left = range(3)
    assert road.edges(outer, 50.0) == (-3.5, 0.0)
    assert road.edges(new, 50.0) == (0.0, 0.0)
    offset = 0.6
    assert np.allclose(road.edges(new, 160.0), (offset - 2.0, offset), atol=1e-6)
    assert np.allclose(road.edges(outer, 160.0), (offset - 5.5, offset - 2.0), atol=1e-6)
    assert np.allclose(road.edges(left, 160.0), (offset, offset + 3.0), atol=1e-6)
    assert road.driving == (outer, left)
    assert road.neighbour(outer, 50.0, 1) == left
    assert road.neighbour(outer, 190.0, 1) == new


def test_left_hand_traffic_drives_on_the_left() -> None:
    road = build_corridor(read_road(SECTIONS.format(rule="LHT").encode()))
    assert [strip.direction for strip in road.strips] == [-1, -1, 1]


@pytest.mark.parametrize("rule", ["RHT", "LHT"])
def test_a_reversed_lane_is_driven_the_other_way(rule: str) -> None:
    text = SECTIONS.format(rule=rule)
    usual = build_corridor(read_road(text.encode()))
    turned = text.replace('type="driving"', 'type="driving" direction="reversed"')
    other = build_corridor(read_road(turned.encode()))
    assert [strip.direction for strip in other.strips] == [-one.direction for one in usual.strips]


def test_files_of_ones_own_are_found(tmp_path: Path) -> None:
    file = tmp_path / "own.xodr"
    file.write_text(SECTIONS.format(rule="RHT"))
    road_map = find_map(str(file), CATALOGUE)
    assert (road_map.lanes, road_map.oncoming_lanes, road_map.forward) == (1, 1, True)
    assert load_corridor(road_map).start == 50.0


def test_a_missing_map_names_close_matches() -> None:
    with pytest.raises(UnknownComponent) as caught:
        find_map("highwy", CATALOGUE)
    assert "highway" in caught.value.matches


@pytest.mark.parametrize(
    "change",
    [
        {"file": "/no/such/file.xodr"},
        {"file": "oodscen.driving:maps/none.xodr"},
        {"file": "no_such_package:maps/none.xodr"},
        {"file": "json.decoder:none.xodr"},
        {"file": "__main__:none.xodr"},
        {"file": "\0"},
        {"road": "17"},
        {"start_m": 1e6},
    ],
    ids=str,
)
def test_unusable_maps_are_data_errors(change: dict[str, object]) -> None:
    with pytest.raises(DataError):
        load_corridor(SHIPPED_MAPS[0].model_copy(update=change))


def test_a_module_that_holds_no_maps_is_not_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "with_effects.py").write_text("raise SystemExit(1)")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(DataError, match="no package named 'with_effects'"):
        find_map("with_effects:own.xodr")


@pytest.mark.parametrize(("start_m", "limit"), [(0.0, 13.9), (60.0, 50 / 3.6), (150.0, 30 / 3.6)])
@pytest.mark.parametrize("forward", [True, False])
def test_the_speed_limit_is_the_one_where_the_ego_starts(
    tmp_path: Path, start_m: float, limit: float, forward: bool
) -> None:
    kinds = (
        '<type s="0" type="town"/><type s="50" type="town"><speed max="50" unit="km/h"/></type>'
        '<type s="120" type="town"><speed max="30" unit="km/h"/></type>'
    )
    file = tmp_path / "limits.xodr"
    file.write_bytes(
        networks.file(networks.road("1", 200.0, left=lane(1), right=lane(-1), more=kinds))
    )
    road_map = SHIPPED_MAPS[0].model_copy(
        update={"file": str(file), "start_m": start_m, "forward": forward}
    )
    assert load_corridor(road_map).speed_limit == pytest.approx(limit)


@pytest.mark.parametrize("gap_m", [0.0, 0.05, 20.0])
def test_a_tunnel_goes_on_over_the_joint_of_two_roads(tmp_path: Path, gap_m: float) -> None:
    tunnel = '<objects><tunnel s="{}" length="60"/><bridge s="10" length="0.05"/></objects>'
    link = '<{} elementType="road" elementId="{}" contactPoint="{}"/>'
    roads = (
        networks.road(
            "1",
            200.0,
            right=lane(-1),
            link=link.format("successor", 2, "start"),
            more=tunnel.format(140.0),
        ),
        networks.road(
            "2",
            200.0,
            at=(200.0, 0.0, 0.0),
            right=lane(-1),
            link=link.format("predecessor", 1, "end"),
            more=tunnel.format(gap_m),
        ),
    )
    file = tmp_path / "tunnel.xodr"
    file.write_bytes(networks.file(*roads))
    road_map = SHIPPED_MAPS[0].model_copy(
        update={"file": str(file), "road": "1", "start_m": 0.0, "route": ()}
    )
    found = [(one.kind, one.start, one.end) for one in load_corridor(road_map).structures]
    joined = [("tunnel", 140.0, 260.0 + gap_m)]
    apart = [("tunnel", 140.0, 200.0), ("tunnel", 200.0 + gap_m, 260.0 + gap_m)]
    assert found == (apart if gap_m > 1.0 else joined)


@pytest.mark.parametrize("kind", ["entry", "exit", "mwyEntry", "mwyExit", "onRamp", "offRamp"])
def test_traffic_drives_on_the_lanes_that_lead_onto_a_motorway_and_off_it(kind: str) -> None:
    road = networks.road("1", 100.0, right=lane(-1) + lane(-2, kind))
    corridor = build_corridor(read_road(networks.file(road)))
    assert [strip.kind for strip in corridor.strips] == ["driving", "driving"]


@pytest.mark.parametrize("kept", [0, 1, 5, 13])
def test_other_roads_are_kept_up_to_a_total_length_the_nearest_first(
    monkeypatch: pytest.MonkeyPatch, kept: int
) -> None:
    road_map = CATALOGUE.map("urban_junction")
    network = read_network(read_map(road_map.file), source="")
    leg = Leg(network.roads[road_map.road], road_map.forward)
    legs, index, _ = find_route(network, leg, road_map.start_m, road_map.route)
    everything = build_route(network, legs, index=index, start_m=road_map.start_m)
    taken = {leg.road.id for leg in legs}
    others = [road for road in network.roads.values() if road.id not in taken]
    near = roads_by_distance(others, everything)
    assert len(near) == len(everything.others) == 13
    room_m = sum(road.length for road in near[:kept]) + 1e-6
    monkeypatch.setattr("oodscen.driving._roads.sampling._MAX_OTHERS_M", room_m)
    corridor = build_route(network, legs, index=index, start_m=road_map.start_m)
    ids = {road.id for road in near[:kept]}
    assert [other.road_id for other in corridor.others] == [r.id for r in others if r.id in ids]
