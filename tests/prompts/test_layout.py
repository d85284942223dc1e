"""The words about a road agree with where things can be placed on it."""

import re

import pytest

from oodscen.driving._roads.building import load_corridor, read_map
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.prompts._layout import layout
from tests.mirrors import mirrored_map

STRIP = re.compile(r"([a-z ]+) (-?[\d.]+) to (-?[\d.]+)")


@pytest.mark.parametrize("road", SHIPPED_MAPS, ids=lambda road: road.id)
def test_offsets_lead_to_the_strips_that_are_named(road):
    corridor = load_corridor(road)
    zero = corridor.centre(corridor.ego_lanes[0], corridor.start)
    section = layout(corridor).partition(";")[0].removeprefix("offsets from right to left: ")
    strips = STRIP.findall(section)
    kinds = {"pavement": "sidewalk", "verge": "border", "parking bays": "parking"}
    assert sum(name.endswith("lane") for name, _, _ in strips) == road.lanes + road.oncoming_lanes
    for name, right, left in strips:
        at = corridor.strip_at(corridor.start, zero + 0.5 * (float(right) + float(left)))
        kind = "driving" if name.endswith("lane") else kinds.get(name.strip(), name.strip())
        assert corridor.strips[at].kind == kind
        assert (corridor.strips[at].direction < 0) == name.strip().startswith("oncoming") or (
            kind != "driving"
        )


def test_bends_and_side_roads_are_where_they_are_said_to_be():
    roads = {road.id: road for road in SHIPPED_MAPS}
    assert "bends left from 96" in layout(load_corridor(roads["rural_curve"]))
    assert "bends" not in layout(load_corridor(roads["urban_avenue"]))
    joined = load_corridor(roads["t_junction"])
    told = layout(joined)
    assert "side road on the right" in told
    assert "side road on the left" not in told
    ahead = float(re.search(r"towards the ego's road ([\d.]+) m", told)[1])
    zero = joined.centre(joined.ego_lanes[0], joined.start)
    assert joined.is_drivable(joined.start + ahead, zero - 25.0, zero - 24.0)
    assert "stop line 90 m ahead" in layout(load_corridor(roads["urban_junction"]))


def test_stop_lines_for_oncoming_traffic_are_left_out_on_both_sides_of_the_road(tmp_path):
    roads = {road.id: road for road in SHIPPED_MAPS}
    road = roads["urban_junction"]
    path = tmp_path / "mirrored.xodr"
    path.write_bytes(mirrored_map(read_map(road.file)))
    mirrored = road.model_copy(update={"file": str(path)})
    told = [re.findall(r"stop line \d+ m", layout(load_corridor(one))) for one in (road, mirrored)]
    assert told[0] == told[1] == ["stop line 90 m"]
