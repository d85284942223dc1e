"""The ego's route: the sequence of roads that it drives through a network."""

import math
from bisect import bisect_right
from collections.abc import Collection, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from oodscen.driving._roads.geometry import CurvePoint, Points
from oodscen.driving._roads.network import (
    KINDS,
    Contact,
    Lane,
    LaneSection,
    Network,
    Road,
    RoadLink,
)
from oodscen.errors import Issue
from oodscen.numerics._exact import Floats, cos, sin

AHEAD_M = 2_000.0
"""Length ahead of the start at which a default route ends, m."""
BEHIND_M = 250.0
"""Length behind the start up to which preceding roads are joined, m."""
_MAX_LEGS = 300
_ROUNDING_RAD = 1e-6
"""Difference up to which two turns are equal, rad: the first in the file is taken."""


class Leg(NamedTuple):
    """One road of a route, with its driving direction relative to the reference line."""

    road: Road
    forward: bool

    @property
    def exit(self) -> Contact:
        """The end of the road where the leg ends."""
        return "end" if self.forward else "start"

    @property
    def onward(self) -> RoadLink | None:
        """The link at the end of the leg."""
        return self.road.successor if self.forward else self.road.predecessor

    @property
    def turned(self) -> "Leg":
        """The same road in the opposite direction."""
        return Leg(self.road, not self.forward)

    @property
    def sections(self) -> tuple[LaneSection, ...]:
        """Lane sections in driving order."""
        return self.road.sections if self.forward else self.road.sections[::-1]

    def id_of(self, lane: Lane) -> int:
        """Return a lane's id in the driver's numbering: negative on the right."""
        return lane.id if self.forward else -lane.id

    def direction_of(self, lane: Lane) -> int:
        """Return +1 for a lane with traffic along the leg, -1 for any other."""
        with_right = 1 if self.id_of(lane) < 0 else -1
        return with_right * (-1 if self.road.left_hand else 1) * (-1 if lane.reversed else 1)

    def has_lane(self, direction: int, section: int = 0) -> bool:
        """Return whether a section (0: the first driven) has a driving lane in a direction."""
        return any(
            lane.id and KINDS.get(lane.type) == "driving" and self.direction_of(lane) == direction
            for lane in self.sections[section].lanes
        )

    def start_pose(self) -> CurvePoint:
        """Return the leg's first point, heading in driving direction."""
        return road_point(self.road, 0.0 if self.forward else self.road.length, self.forward)

    def end_pose(self) -> CurvePoint:
        """Return the leg's last point, heading in driving direction."""
        return road_point(self.road, self.road.length if self.forward else 0.0, self.forward)


def road_point(road: Road, s: float, forward: bool = True) -> CurvePoint:
    """Return a point of a road's reference line, with heading and curvature in driving direction."""
    index = bisect_right(road.curves, s, key=lambda curve: curve.s)
    curve = road.curves[max(index - 1, 0)]
    point = curve.at(min(max(s - curve.s, 0.0), curve.length))
    if forward:
        return point
    return CurvePoint(point.x, point.y, point.heading + math.pi, -point.curvature)


def road_points(road: Road, s: Floats) -> Points:
    """Return many points of a road's reference line, with the same bits as `road_point` for each."""
    begins = np.array([curve.s for curve in road.curves])
    pieces = np.maximum(np.searchsorted(begins, s, side="right") - 1, 0)
    columns = np.empty((4, len(s)))
    for index in np.unique(pieces):
        curve, is_on_curve = road.curves[index], pieces == index
        along = np.clip(s[is_on_curve] - curve.s, 0.0, curve.length)
        columns[:, is_on_curve] = curve.at_all(along)
    x, y, heading, curvature = columns
    return x, y, heading, curvature


def followers(network: Network, leg: Leg) -> list[Leg]:
    """Return all legs that can follow a leg, in the file's order."""
    link = leg.onward
    if link is None:
        return []
    if link.kind == "road":
        return [Leg(network.roads[link.id], link.contact == "start")]
    legs: dict[tuple[str, bool], Leg] = {}
    for connection in network.junctions[link.id].connections:
        through = network.roads[connection.connecting]
        if connection.incoming == leg.road.id:
            forward = connection.contact == "start"
            back = through.predecessor if forward else through.successor
            if back is None or back.id != leg.road.id or back.contact == leg.exit:
                legs.setdefault((through.id, forward), Leg(through, forward))
        for forward, end in ((True, through.predecessor), (False, through.successor)):
            if end == RoadLink("road", leg.road.id, leg.exit):
                legs.setdefault((through.id, forward), Leg(through, forward))
    return list(legs.values())


def joint(before: Leg, after: Leg) -> tuple[float, float, float]:
    """Return a leg's start relative to the end of another: forward and left, m, and turn, rad."""
    end, start = before.end_pose(), after.start_pose()
    along, across = cos(end.heading), sin(end.heading)
    dx, dy = start.x - end.x, start.y - end.y
    turn = math.remainder(start.heading - end.heading, math.tau)
    return dx * along + dy * across, dy * along - dx * across, turn


def fits(before: Leg, after: Leg) -> bool:
    """Return whether one leg begins where another ends, in the same direction."""
    along, across, turn = joint(before, after)
    return abs(along) <= 1.0 and abs(across) <= 30.0 and abs(turn) <= 0.25


def straightest(
    network: Network, leg: Leg, direction: int = 1, taken: Collection[str] = ()
) -> Leg | None:
    """Return the following leg with the smallest turn, without the `taken` roads.

    In direction +1, the driver must find a lane ahead; in direction -1, traffic must come from it.
    """
    best, least = None, math.inf
    heading = leg.end_pose().heading
    for after in followers(network, leg):
        if after.road.id in taken:
            continue
        if not (after.has_lane(direction) and after.has_lane(direction, -1) and fits(leg, after)):
            continue
        turn = abs(math.remainder(after.end_pose().heading - heading, math.tau))
        if turn < least - _ROUNDING_RAD:
            best, least = after, turn
    return best


def straight_on(
    network: Network, leg: Leg, direction: int = 1, taken: Collection[str] = ()
) -> Iterator[Leg]:
    """Yield the legs after a leg, straight on at every choice; no road is repeated."""
    driven = {leg.road.id, *taken}
    for _ in range(_MAX_LEGS):
        after = straightest(network, leg, direction, driven)
        if after is None:
            return
        leg = after
        driven.add(leg.road.id)
        yield leg


def find_route(
    network: Network, start: Leg, start_m: float, wanted: Sequence[str]
) -> tuple[list[Leg], int, list[Issue]]:
    """Return the chain of roads that the ego drives.

    Args:
        network: All roads.
        start: The leg on which the ego starts.
        start_m: Position of the start along that road's reference line, m.
        wanted: Ids of the roads after it; beyond them the route goes straight on.

    Returns:
        The legs from behind the start to the route's end, the index of the start among them, and the
        issues of the wanted roads.
    """
    legs = [start]
    for index, road_id in enumerate(wanted):
        before = legs[-1]
        following = followers(network, before)
        after = next((leg for leg in following if leg.road.id == road_id), None)
        if after is None:
            names = ", ".join(leg.road.id[:40] for leg in following[:20]) or "nothing"
            fault = f"does not follow road {before.road.id!r}, which leads to: {names}"
            return legs, 0, [Issue(f"route[{index}]", f"road {road_id!r} {fault}")]
        if not fits(before, after):
            fault = f"does not begin where road {before.road.id!r} ends"
            return legs, 0, [Issue(f"route[{index}]", f"road {road_id!r} {fault}")]
        legs.append(after)
    taken = {leg.road.id for leg in legs}
    behind_m = start_m if start.forward else start.road.length - start_m
    ahead_m = sum(leg.road.length for leg in legs) - behind_m
    for after in straight_on(network, legs[-1], 1, taken):
        if ahead_m >= AHEAD_M:
            break
        legs.append(after)
        taken.add(after.road.id)
        ahead_m += after.road.length
    earlier: list[Leg] = []
    for leg in straight_on(network, start.turned, -1, taken):
        if behind_m >= BEHIND_M:
            break
        earlier.append(leg.turned)
        behind_m += leg.road.length
    return [*earlier[::-1], *legs], len(earlier), []


def lane_links(network: Network, before: Leg, after: Leg) -> list[tuple[int, int]]:
    """Return pairs of lane ids, in the driver's numbering, that continue each other between two legs."""
    pairs: list[tuple[int, int]] = []
    for junction in (before.onward, after.turned.onward):
        if junction is None or junction.kind != "junction":
            continue
        for connection in network.junctions[junction.id].connections:
            contact = after.turned.exit
            if (connection.incoming, connection.connecting) == (before.road.id, after.road.id):
                pairs += [pair for pair in connection.lanes if connection.contact == contact]
            elif (connection.incoming, connection.connecting) == (after.road.id, before.road.id):
                pairs += [
                    (to, start)
                    for start, to in connection.lanes
                    if connection.contact == before.exit
                ]
    if before.onward is not None and before.onward.kind == "road":
        for lane in before.sections[-1].lanes:
            following = lane.successor if before.forward else lane.predecessor
            if lane.id and following is not None:
                pairs.append((lane.id, following))
    back = after.turned.onward
    if back is not None and back.kind == "road":
        for lane in after.sections[0].lanes:
            earlier = lane.predecessor if after.forward else lane.successor
            if lane.id and earlier is not None:
                pairs.append((earlier, lane.id))
    sign_before, sign_after = 1 if before.forward else -1, 1 if after.forward else -1
    return [(sign_before * start, sign_after * to) for start, to in pairs]


def section_links(leg: Leg, index: int) -> list[tuple[int, int]]:
    """Return pairs of lane ids, in the driver's numbering, between a driven section and the next."""
    before, after = leg.sections[index], leg.sections[index + 1]
    sign = 1 if leg.forward else -1
    pairs = []
    for lane in before.lanes:
        following = lane.successor if leg.forward else lane.predecessor
        if lane.id and following is not None:
            pairs.append((lane.id * sign, following * sign))
    if not pairs:
        for lane in after.lanes:
            earlier = lane.predecessor if leg.forward else lane.successor
            if lane.id and earlier is not None:
                pairs.append((earlier * sign, lane.id * sign))
    return pairs
