"""Every lane of every shipped map lies where CARLA's own map puts it.

Runs where the `carla` client is installed (`pip install 'oodscen[carla]'`); no server is
needed. CARLA's world is left-handed: its y and its yaw have the other sign.
"""

import math
from importlib.resources import files

import pytest

from oodscen.driving._roads.geometry import piecewise
from oodscen.driving._roads.network import Network
from oodscen.driving._roads.opendrive import read_network
from oodscen.driving._roads.sampling import build_corridor
from oodscen.driving.maps._shipped import SHIPPED_MAPS

carla = pytest.importorskip("carla")

CENTRE_M = 0.05
HEADING_RAD = math.radians(1.0)


def differences(network: Network, client_map) -> list[tuple[float, float, str]]:
    """Return distance, difference in heading and place for many places on all driving lanes."""
    found = []
    for road in network.roads.values():
        corridor = build_corridor(road)
        ends = [section.s for section in road.sections[1:]] + [road.length]
        for section, end in zip(road.sections, ends, strict=True):
            margin = min(1.0, 0.2 * (end - section.s))
            count = max(4, round((end - section.s) / 3.0))
            for number in range(count):
                s = section.s + margin + (end - section.s - 2 * margin) * number / (count - 1)
                for lane in section.lanes:
                    if lane.type == "driving":
                        place = f"road {road.id} lane {lane.id} s {s:.2f}"
                        waypoint = client_map.get_waypoint_xodr(int(road.id), lane.id, s)
                        assert waypoint is not None, place
                        found.append((*difference(corridor, section, lane, s, waypoint), place))
    return found


def difference(corridor, section, lane, s: float, waypoint) -> tuple[float, float]:
    """Return distance and angle between a lane's centre line and CARLA's."""
    strip = strip_of(corridor, section, lane, s)
    before, t, after = (corridor.centre(strip, at) for at in (s - 0.25, s, s + 0.25))
    x, y, _, heading = corridor.point(s, t)
    heading += math.atan2((after - before) / 0.5, 1.0 - corridor.bend(s) * t)
    where, yaw = waypoint.transform.location, -math.radians(waypoint.transform.rotation.yaw)
    turn = yaw - heading + (math.pi if lane.id > 0 else 0.0)
    return math.dist((x, y), (where.x, -where.y)), abs(math.remainder(turn, math.tau))


def strip_of(corridor, section, lane, s: float) -> int:
    """Return the strip of a lane: the n-th that exists there."""
    edges = [corridor.edges(index, s) for index in range(len(corridor.strips))]
    shown = [index for index, (right, left) in enumerate(edges) if left - right > 1e-5]
    lanes = [
        one.id for one in section.lanes if one.id and piecewise(one.widths, s - section.s) > 1e-5
    ]
    assert len(lanes) == len(shown)
    return shown[lanes[::-1].index(lane.id)]


@pytest.mark.parametrize("road_map", SHIPPED_MAPS, ids=lambda road: road.id)
def test_lanes_lie_where_carla_puts_them(road_map) -> None:
    package, _, inside = road_map.file.partition(":")
    data = files(package).joinpath(inside).read_bytes()
    found = differences(read_network(data), carla.Map(road_map.id, data.decode()))
    assert len(found) > 100
    offset, turn = max(found), max(found, key=lambda one: one[1])
    print(f"{road_map.id}: {len(found)} places, at most {offset[0] * 1000:.2f} mm and "
          f"{math.degrees(turn[1]):.4f} deg; {offset[2]}; {turn[2]}")  # fmt: skip
    assert offset[0] <= CENTRE_M, offset
    assert turn[1] <= HEADING_RAD, turn
