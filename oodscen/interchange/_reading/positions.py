"""Positions in scenarios of other tools as poses, on their own roads or on an imagined straight one."""

import math
from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np

from oodscen.driving._roads.geometry import piecewise
from oodscen.driving._roads.network import Lane, LaneSection, Network, Road
from oodscen.driving._roads.routes import Leg, road_point, road_points
from oodscen.interchange._reading.tree import Element
from oodscen.numerics._exact import Floats

LANE_M = 3.5
"""Width of a lane of an imagined road, m."""
_OVERHANG_M = 0.01
"""Length by which a place may lie beyond the end of its road, m."""
_ROUNDING_M = 1e-6
"""Distance before a lane section from which a place belongs to it, m."""
_SAMPLE_M = 2.0
"""Distance of the points of a road among which the nearest is looked for, m."""
_STEPS = 20
"""Steps in which the place beside a pose is found; each squares its error."""


class EntityPlace(NamedTuple):
    """The place of an entity, with its lane if the file names one."""

    x: float
    y: float
    heading: float
    road: str = ""
    lane: int = 0
    s: float = 0.0
    direction: int = 0
    """+1 in a lane with traffic along the road's reference line, -1 against it, 0 if no lane is known."""

    def moved(self, ahead: float, left: float, turn: float = 0.0) -> "EntityPlace":
        """Return a pose relative to this one."""
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        x, y = self.x + ahead * cos - left * sin, self.y + ahead * sin + left * cos
        return EntityPlace(x, y, self.heading + turn)

    def offset_from(self, origin: "EntityPlace") -> tuple[float, float]:
        """Return the distances ahead of another pose and to its left, m."""
        cos, sin = math.cos(origin.heading), math.sin(origin.heading)
        dx, dy = self.x - origin.x, self.y - origin.y
        return dx * cos + dy * sin, dy * cos - dx * sin

    def lanes_to(self, lane: int) -> int:
        """Return the number of lanes to another of the road, positive where ids grow; 0 is not a lane."""
        lanes = lane - self.lane
        if lane * self.lane < 0:
            lanes -= 1 if lanes > 0 else -1
        return lanes

    def lane_beside(self, count: int) -> int:
        """Return the id of the lane that is a number of lanes to the left in this one's direction."""
        steps = self.direction * count
        lane = self.lane + steps
        if lane * self.lane <= 0:
            lane += 1 if steps > 0 else -1
        return lane


class Roads(Protocol):
    """The places of lanes."""

    def has_lane(self, road_id: str, s: float, lane: int) -> bool:
        """Return whether a road has a lane at `s`."""
        ...

    def reaches(self, road_id: str, s: float) -> bool:
        """Return whether `s` is on a road."""
        ...

    def at(self, node: Element, road_id: str, s: float, lane: int, offset: float) -> EntityPlace:
        """Return the pose at an offset from a lane's centre; lane 0 is the reference line."""
        ...

    def in_lane(self, pose: EntityPlace) -> EntityPlace:
        """Return a pose with the lane that it is in, if the file names none and there is one."""
        ...

    def direction_beside(self, pose: EntityPlace, other: EntityPlace) -> int:
        """Return +1 if a pose is in the traffic along the reference line of another's road, else -1."""
        ...


class StraightRoad:
    """One straight road, for scenarios without the file of their own roads."""

    def __init__(self, *, is_left_hand: bool) -> None:
        """Choose the side to which traffic keeps."""
        self.is_left_hand = is_left_hand

    def has_lane(self, road_id: str, s: float, lane: int) -> bool:
        """Return whether a lane is one: all are but the reference line."""
        return lane != 0

    def reaches(self, road_id: str, s: float) -> bool:
        """Return true: the road has no ends."""
        return True

    def at(self, node: Element, road_id: str, s: float, lane: int, offset: float) -> EntityPlace:
        """Return the pose on a road along x whose right lanes have negative ids."""
        centre = (lane + 0.5 if lane < 0 else lane - 0.5) * LANE_M if lane else 0.0
        is_along = lane == 0 or (lane > 0) is self.is_left_hand
        heading, direction = (0.0, 1) if is_along else (math.pi, -1)
        return EntityPlace(s, centre + offset, heading, road_id, lane, s, direction)

    def in_lane(self, pose: EntityPlace) -> EntityPlace:
        """Return the pose as it is: where the lanes of the file's own roads lie is not known."""
        return pose

    def direction_beside(self, pose: EntityPlace, other: EntityPlace) -> int:
        """Return +1 for a pose in the traffic along x, else -1."""
        return pose.direction or (1 if math.cos(pose.heading) >= 0.0 else -1)


class _RoadSample(NamedTuple):
    """One of the points of a road among which the nearest to a pose is looked for."""

    road: Road
    s: float
    distance_m: float
    """Distance from the pose, m."""


class MappedRoads:
    """The roads of an OpenDRIVE file."""

    def __init__(self, network: Network) -> None:
        self.network = network
        self._samples: dict[str, tuple[Floats, Floats, Floats]] = {}
        """Places s and points x and y among which the nearest is looked for, by road."""

    def at(self, node: Element, road_id: str, s: float, lane: int, offset: float) -> EntityPlace:
        """Return the pose on a road of the file.

        Raises:
            DataError: If there is no such road or lane, or the road ends before.
        """
        road = self.network.roads.get(road_id)
        if road is None:
            raise node.fault(f"the map has no road {road_id[:40]!r}")
        if not self.reaches(road_id, s):
            raise node.fault(
                f"road {road_id[:40]!r} goes from 0 to {road.length:g} m, not to {s:g}"
            )
        s = min(max(s, 0.0), road.length)
        point = road_point(road, s)
        centres = _centres(road, s)
        if lane not in centres:
            raise node.fault(f"road {road_id[:40]!r} has no lane {lane} at {s:g} m")
        t = centres[lane] + offset
        x, y = point.x - t * math.sin(point.heading), point.y + t * math.cos(point.heading)
        direction = _direction(road, s, lane)
        heading = point.heading + (math.pi if direction < 0 else 0.0)
        return EntityPlace(x, y, heading, road_id, lane, s, direction)

    def has_lane(self, road_id: str, s: float, lane: int) -> bool:
        """Return whether a road has a lane at `s`; the reference line is none."""
        road = self.network.roads.get(road_id)
        return road is not None and lane != 0 and lane in _lanes(road, s)

    def reaches(self, road_id: str, s: float) -> bool:
        """Return whether `s` is on a road, but for rounding."""
        return -_OVERHANG_M <= s <= self.network.roads[road_id].length + _OVERHANG_M

    def nearest(self, pose: EntityPlace) -> tuple[Road, float, bool]:
        """Return the road of a pose, s on it, and true if the pose heads along it."""
        nearest = min(
            (self._nearest_sample(road, pose) for road in self._candidates(pose)),
            key=lambda sample: sample.distance_m,
        )
        s = _projected(nearest.road, pose, nearest.s)
        if pose.direction:
            return nearest.road, s, pose.direction > 0
        heading = road_point(nearest.road, s).heading
        return nearest.road, s, math.cos(heading - pose.heading) >= 0.0

    def in_lane(self, pose: EntityPlace) -> EntityPlace:
        """Return a pose with the lane whose centre is nearest, unless it has one or is off all roads."""
        if pose.lane:
            return pose
        road, s, _ = self.nearest(pose)
        point = road_point(road, s)
        ahead, left = pose.offset_from(EntityPlace(point.x, point.y, point.heading))
        centres = {lane: t for lane, t in _centres(road, s).items() if lane}
        if not centres:
            return pose
        lane = min(centres, key=lambda lane: abs(centres[lane] - left))
        if math.hypot(ahead, centres[lane] - left) > LANE_M:
            return pose
        return pose._replace(road=road.id, lane=lane, s=s, direction=_direction(road, s, lane))

    def direction_beside(self, pose: EntityPlace, other: EntityPlace) -> int:
        """Return +1 if a pose is in the traffic along the reference line of another's road, else -1.

        That is told by its heading if it is on another road.
        """
        road, _, along = self.nearest(pose)
        if road.id != other.road:
            line = road_point(self.network.roads[other.road], other.s)
            along = math.cos(line.heading - pose.heading) >= 0.0
        return 1 if along else -1

    def _nearest_sample(self, road: Road, pose: EntityPlace) -> _RoadSample:
        if road.id not in self._samples:
            steps = max(1, int(road.length / _SAMPLE_M))
            s = road.length * np.arange(steps + 1) / steps
            self._samples[road.id] = (s, *road_points(road, s)[:2])
        s, x, y = self._samples[road.id]
        distances_m = np.hypot(x - pose.x, y - pose.y)
        nearest = int(np.argmin(distances_m))
        return _RoadSample(road, float(s[nearest]), float(distances_m[nearest]))

    def _candidates(self, pose: EntityPlace) -> list[Road]:
        """Return the road that a pose names, or all outside junctions."""
        if pose.road in self.network.roads:
            return [self.network.roads[pose.road]]
        return [road for road in self.network.roads.values() if not road.junction]


def _projected(road: Road, pose: EntityPlace, near_s: float) -> float:
    """Return s of the point of a reference line that is nearest to a pose, from an s near it."""
    s = near_s
    for _ in range(_STEPS):
        point = road_point(road, s)
        along, left = pose.offset_from(EntityPlace(point.x, point.y, point.heading))
        bend = max(1.0 - point.curvature * left, 0.1)
        s = min(max(s + along / bend, 0.0, near_s - _SAMPLE_M), road.length, near_s + _SAMPLE_M)
    return s


def _lanes(road: Road, s: float) -> dict[int, Lane]:
    """Return the lanes of a road at `s`, by id."""
    return {lane.id: lane for lane in _section(road, s).lanes}


def _section(road: Road, s: float) -> LaneSection:
    return [section for section in road.sections if section.s <= s + _ROUNDING_M][-1]


def _direction(road: Road, s: float, lane: int) -> int:
    """Return +1 if a lane's traffic runs along the reference line, -1 if against it, 0 for that line itself."""
    return Leg(road, True).direction_of(_lanes(road, s)[lane]) if lane else 0


def _centres(road: Road, s: float) -> dict[int, float]:
    """Return t of the centre of every lane, by id; lane 0 is the reference line."""
    section = _section(road, s)
    base = piecewise(road.lane_offset, s)
    centres = {0: base}
    for side in (1, -1):
        edge = base
        lanes = [lane for lane in section.lanes if lane.id * side > 0]
        for lane in sorted(lanes, key=lambda lane: abs(lane.id)):
            width = piecewise(lane.widths, s - section.s)
            centres[lane.id] = edge + side * 0.5 * width
            edge += side * width
    return centres


class Positions:
    """Reads positions, also those relative to entities whose poses are known."""

    def __init__(self, roads: Roads, *, is_mirrored: bool) -> None:
        """Start without entities.

        World positions have y to the right if they are mirrored, as those for CARLA may be.
        """
        self.roads = roads
        self.side = -1.0 if is_mirrored else 1.0
        self.places: dict[str, EntityPlace] = {}

    def in_lane(self, name: str) -> EntityPlace | None:
        """Return the pose of an entity with its lane, as far as both are known."""
        pose = self.places.get(name)
        return None if pose is None else self.roads.in_lane(pose)

    def reference(self, holder: Element) -> str:
        """Return the entity to which a `Position` is relative, or an empty text."""
        return next((child.get("entityRef") for child in holder.children()), "")

    def can_read(self, holder: Element) -> bool:
        """Return whether the place of a `Position` that is relative to no entity can be read."""
        node = next(holder.children(), None)
        return node is not None and node.name in ("WorldPosition", "LanePosition", "RoadPosition")

    def read(self, holder: Element) -> EntityPlace | None:
        """Return the pose of a `Position`, or `None` after recording that it cannot be used."""
        node = next(holder.children(), None)
        if node is None:
            holder.leave_out("is empty")
            return None
        reader = _READERS.get(node.name)
        place = None if reader is None else reader(self, node)
        if place is not None:
            return _turned(node, place)
        reference = node.get("entityRef")
        if reference:
            node.leave_out(f"is relative to {reference[:40]!r}, whose place is not known")
        else:
            node.leave_out("this kind of position is not read")
        return None

    def _world(self, node: Element) -> EntityPlace:
        y, heading = self.side * node.number("y"), self.side * node.number("h", 0.0)
        return EntityPlace(node.number("x"), y, heading)

    def _lane(self, node: Element) -> EntityPlace:
        road, s, lane = node.get("roadId"), node.number("s"), node.integer("laneId")
        if lane == 0:
            node.note("lane 0 is the reference line of the road and is read as that")
        return self.roads.at(node, road, s, lane, node.number("offset", 0.0))

    def _road(self, node: Element) -> EntityPlace:
        return self.roads.at(node, node.get("roadId"), node.number("s"), 0, node.number("t"))

    def _relative_object(self, node: Element) -> EntityPlace | None:
        origin = self.places.get(node.get("entityRef"))
        if origin is None:
            return None
        return origin.moved(node.number("dx"), node.number("dy"))

    def _relative_world(self, node: Element) -> EntityPlace | None:
        origin = self.places.get(node.get("entityRef"))
        if origin is None:
            return None
        dx, dy = node.number("dx"), self.side * node.number("dy")
        return EntityPlace(origin.x + dx, origin.y + dy, origin.heading)

    def _relative_road(self, node: Element) -> EntityPlace | None:
        origin = self.places.get(node.get("entityRef"))
        if origin is None:
            return None
        node.note("is read as ahead of the entity and to its left")
        return origin.moved(node.number("ds"), node.number("dt"))

    def _relative_lane(self, node: Element) -> EntityPlace | None:
        origin = self.in_lane(node.get("entityRef"))
        if origin is None:
            return None
        ahead, lanes = node.number("ds", node.number("dsLane", 0.0)), node.integer("dLane")
        offset, s = node.number("offset", 0.0), origin.s + origin.direction * ahead
        if not origin.lane:
            node.note(f"is read as ahead of the entity, with lanes of {LANE_M:g} m")
        elif not self.roads.reaches(origin.road, s):
            node.note(f"leaves road {origin.road[:40]!r} and is read as straight ahead")
        else:
            lane = origin.lane_beside(lanes)
            return self.roads.at(node, origin.road, s, lane, offset)
        return origin.moved(ahead, lanes * LANE_M + offset)


_READERS: dict[str, Callable[[Positions, Element], EntityPlace | None]] = {
    "WorldPosition": Positions._world,
    "LanePosition": Positions._lane,
    "RoadPosition": Positions._road,
    "RelativeObjectPosition": Positions._relative_object,
    "RelativeWorldPosition": Positions._relative_world,
    "RelativeRoadPosition": Positions._relative_road,
    "RelativeLanePosition": Positions._relative_lane,
}


def _turned(node: Element, pose: EntityPlace) -> EntityPlace:
    """Return a pose with the orientation that a position gives."""
    orientation = node.first("Orientation")
    if orientation is None:
        return pose
    heading = orientation.number("h", 0.0)
    if orientation.word("type", "absolute", "relative") == "relative":
        return pose._replace(heading=pose.heading + heading)
    return pose._replace(heading=heading) if orientation.get("h") else pose
