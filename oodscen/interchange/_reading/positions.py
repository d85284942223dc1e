"""Positions in scenarios of other tools as poses, on their own roads or on an imagined straight one."""

import math
from typing import NamedTuple, Protocol

from oodscen.driving._roads.geometry import piecewise
from oodscen.driving._roads.network import Network, Road
from oodscen.driving._roads.routes import road_point
from oodscen.interchange._reading.tree import Node

LANE_M = 3.5
"""Width of a lane of an imagined road, m."""
_ROUNDING_M = 1e-6
"""Distance before a lane section from which a place belongs to it, m."""


class Pose(NamedTuple):
    """The place of an entity, with its lane if the file names one."""

    x: float
    y: float
    heading: float
    road: str = ""
    lane: int = 0
    s: float = 0.0

    def moved(self, ahead: float, left: float, turn: float = 0.0) -> "Pose":
        """Return a pose relative to this one."""
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        x, y = self.x + ahead * cos - left * sin, self.y + ahead * sin + left * cos
        return Pose(x, y, self.heading + turn)

    def offset_from(self, origin: "Pose") -> tuple[float, float]:
        """Return the distances ahead of another pose and to its left, m."""
        cos, sin = math.cos(origin.heading), math.sin(origin.heading)
        dx, dy = self.x - origin.x, self.y - origin.y
        return dx * cos + dy * sin, dy * cos - dx * sin


class Roads(Protocol):
    """The places of lanes."""

    def at(self, node: Node, road: str, s: float, lane: int, offset: float) -> Pose:
        """Return the pose at an offset from a lane's centre; lane 0 is the reference line."""
        ...


class StraightRoad:
    """One straight road, for scenarios without the file of their own roads."""

    def at(self, node: Node, road: str, s: float, lane: int, offset: float) -> Pose:
        """Return the pose on a road along x whose right lanes have negative ids."""
        middle = (lane + 0.5 if lane < 0 else lane - 0.5) * LANE_M if lane else 0.0
        turned = math.pi if lane > 0 else 0.0
        return Pose(s, middle + offset, turned, road, lane, s)


class MappedRoads:
    """The roads of an OpenDRIVE file."""

    def __init__(self, network: Network) -> None:
        self.network = network

    def at(self, node: Node, road: str, s: float, lane: int, offset: float) -> Pose:
        """Return the pose on a road of the file.

        Raises:
            DataError: If there is no such road or lane.
        """
        found = self.network.roads.get(road)
        if found is None:
            raise node.fault(f"the map has no road {road[:40]!r}")
        s = min(max(s, 0.0), found.length)
        point = road_point(found, s)
        t = _lane_centre(node, found, s, lane) + offset
        x, y = point.x - t * math.sin(point.heading), point.y + t * math.cos(point.heading)
        against = lane > 0 if not found.left_hand else lane < 0
        return Pose(x, y, point.heading + (math.pi if against else 0.0), road, lane, s)

    def nearest(self, pose: Pose) -> tuple[Road, float, bool]:
        """Return the road under a pose, s on it, and true if the pose heads along it."""
        best: tuple[float, Road, float, bool] | None = None
        for road in self.network.roads.values():
            if road.junction:
                continue
            steps = max(1, int(road.length / 2.0))
            for index in range(steps + 1):
                s = road.length * index / steps
                point = road_point(road, s)
                far = math.hypot(point.x - pose.x, point.y - pose.y)
                if best is None or far < best[0]:
                    best = (far, road, s, math.cos(point.heading - pose.heading) >= 0.0)
        assert best is not None, "a network has roads"
        return best[1:]


def _lane_centre(node: Node, road: Road, s: float, lane: int) -> float:
    """Return t of a lane's centre."""
    base = piecewise(road.lane_offset, s)
    if lane == 0:
        return base
    section = [one for one in road.sections if one.s <= s + _ROUNDING_M][-1]
    side = 1 if lane > 0 else -1
    widths = {one.id: piecewise(one.widths, s - section.s) for one in section.lanes}
    if lane not in widths:
        raise node.fault(f"road {road.id[:40]!r} has no lane {lane} at {s:g} m")
    inner = sum(width for one, width in widths.items() if one * side in range(1, abs(lane)))
    return base + side * (inner + 0.5 * widths[lane])


class Positions:
    """Reads positions, also those relative to entities whose poses are known."""

    def __init__(self, roads: Roads, *, is_mirrored: bool = False) -> None:
        """Start without entities.

        World positions have y to the right if they are mirrored, as those for CARLA may be.
        """
        self.roads = roads
        self.side = -1.0 if is_mirrored else 1.0
        self.known: dict[str, Pose] = {}

    def read(self, holder: Node) -> Pose | None:
        """Return the pose of a `Position`, or `None` after recording that it cannot be used."""
        for node in holder.children():
            found = self._pose(node)
            if found is None:
                node.leave_out("this kind of position is not read")
            return None if found is None else _turned(node, found)
        return None

    def _pose(self, node: Node) -> Pose | None:
        kind = node.name
        if kind == "WorldPosition":
            y, heading = self.side * node.number("y"), self.side * node.number("h", 0.0)
            return Pose(node.number("x"), y, heading)
        if kind == "LanePosition":
            road, s, lane = node.get("roadId"), node.number("s"), int(node.number("laneId"))
            return self.roads.at(node, road, s, lane, node.number("offset", 0.0))
        if kind == "RoadPosition":
            road, s, t = node.get("roadId"), node.number("s"), node.number("t")
            return self.roads.at(node, road, s, 0, t)
        origin = self.known.get(node.get("entityRef"))
        if origin is None:
            return None
        if kind in ("RelativeObjectPosition", "RelativeWorldPosition"):
            dx, dy = node.number("dx"), node.number("dy")
            if kind == "RelativeObjectPosition":
                return origin.moved(dx, dy)
            return origin._replace(x=origin.x + dx, y=origin.y + dy, road="")
        if kind == "RelativeRoadPosition":
            return origin.moved(node.number("ds"), node.number("dt"))
        if kind == "RelativeLanePosition":
            return self._relative_lane(node, origin)
        return None

    def _relative_lane(self, node: Node, origin: Pose) -> Pose:
        ahead, lanes = node.number("ds", node.number("dsLane", 0.0)), int(node.number("dLane"))
        offset = node.number("offset", 0.0)
        if not origin.road:
            return origin.moved(ahead, lanes * LANE_M + offset)
        side = -1 if origin.lane > 0 else 1
        lane = origin.lane + side * lanes
        if lane * origin.lane <= 0:
            lane += side
        return self.roads.at(node, origin.road, origin.s + side * ahead, lane, offset)


def _turned(node: Node, pose: Pose) -> Pose:
    """Apply an orientation."""
    orientation = node.first("Orientation")
    if orientation is None:
        return pose
    turn = orientation.number("h", 0.0)
    if orientation.get("type", "absolute") == "relative":
        return pose._replace(heading=pose.heading + turn)
    return pose._replace(heading=turn) if orientation.get("h") else pose
