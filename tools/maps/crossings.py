"""Designs of the maps with junctions."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from oodscen.numerics._exact import cos, sin, tan
from tools.maps.design import (
    ConnectionDesign,
    JunctionDesign,
    LaneDesign,
    LinkDesign,
    MapDesign,
    PatchDesign,
    Piece,
    Pose,
    RoadDesign,
    SectionDesign,
    SignalDesign,
    both_ways,
    smooth,
    straight,
    widths_of,
)
from tools.maps.streets import AVENUE, RESIDENTIAL

_AHEAD = 200.0 + 110.0
"""Distance from the start of the first road to the centre of the junction it leads to, m."""
_JUNCTION = "100"
"""Id of the junction of a map that has only one."""


@dataclass(frozen=True)
class Arm:
    """The end of a road at a junction."""

    road: str
    ends: bool
    """True if the road's reference line ends at the junction, False if it begins there."""
    entry: Pose
    """The end of the reference line, with the heading into the junction."""
    widths: tuple[float, ...]
    """Widths of the lanes on each side, from the inside out; the last is the pavement, m."""

    @property
    def contact(self) -> Literal["start", "end"]:
        """The end of the road that is at the junction."""
        return "end" if self.ends else "start"

    def into(self, lane: int) -> int:
        """Return the id of the n-th lane into the junction, counted from the inside."""
        return -lane if self.ends else lane

    def out_of(self, lane: int) -> int:
        """Return the id of the n-th lane out of the junction, counted from the inside."""
        return lane if self.ends else -lane

    def pose(self, lane: int, *, entering: bool) -> Pose:
        """Return the left edge of a lane as seen by its driver."""
        x, y, heading = self.entry
        if not entering:
            heading += math.pi
        inside = sum(self.widths[: lane - 1])
        return x + inside * sin(heading), y - inside * cos(heading), heading


def _bend(start: Pose, end: Pose) -> tuple[Piece, ...]:
    """Return the pieces of a path between two poses, with a single arc."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    turn = math.remainder(end[2] - start[2], math.tau)
    if abs(turn) < 1e-9:
        return (straight(math.sqrt(dx * dx + dy * dy)),)
    c, s = cos(start[2]), sin(start[2])
    ahead, aside = dx * c + dy * s, dy * c - dx * s
    second = aside / sin(turn)
    first = ahead - second * cos(turn)
    tangent = min(first, second)
    radius = tangent / tan(0.5 * abs(turn))
    curvature = math.copysign(1.0 / radius, turn)
    pieces = (
        straight(first - tangent),
        ("arc", radius * abs(turn), curvature, curvature),
        straight(second - tangent),
    )
    return tuple(piece for piece in pieces if piece[1] > 1e-6)


def _way(
    id: str,
    name: str,
    speed_km_h: int,
    entry: tuple[Arm, int],
    leaving: tuple[Arm, int],
    lanes: int = 1,
    *,
    has_pavement: bool = False,
) -> tuple[RoadDesign, ConnectionDesign]:
    """Connect lanes of one arm, from the n-th on, to lanes of another."""
    (source, first), (target, second) = entry, leaving
    designs = [
        LaneDesign(
            "driving",
            source.widths[first - 1 + k],
            "broken" if k + 1 < lanes else "curb" if has_pavement else "none",
            source.into(first + k),
            target.out_of(second + k),
        )
        for k in range(lanes)
    ]
    if has_pavement:
        ends = source.into(len(source.widths)), target.out_of(len(target.widths))
        designs.append(LaneDesign("sidewalk", source.widths[-1], "none", *ends))
    road = RoadDesign(
        id,
        name,
        "town",
        speed_km_h,
        _bend(source.pose(first, entering=True), target.pose(second, entering=False)),
        (SectionDesign(tuple(designs), (), "none"),),
        start=source.pose(first, entering=True),
        junction=_JUNCTION,
        predecessor=LinkDesign("road", source.road, source.contact),
        successor=LinkDesign("road", target.road, target.contact),
    )
    pairs = tuple((lane.predecessor or 0, -k) for k, lane in enumerate(designs, start=1))
    return road, ConnectionDesign(source.road, id, pairs)


def _arms(count: int, setback: float, widths: tuple[float, ...]) -> list[Arm]:
    """Return the first of the arms south, east, north and west of a centre, where the first road ends."""
    places = ((0.0, -setback), (setback, 0.0), (0.0, setback), (-setback, 0.0))
    return [
        Arm(str(index + 1), index == 0, (x, y, 0.5 * math.pi * (index + 1)), widths)
        for index, (x, y) in enumerate(places[:count])
    ]


def _approach(
    arm: Arm,
    name: str,
    speed_km_h: int,
    length: float,
    sections: tuple[SectionDesign, ...],
    *,
    junction: str = _JUNCTION,
    kind: str = "townLocal",
) -> RoadDesign:
    """Return the road of an arm, linked to its junction."""
    x, y, heading = arm.entry
    link = LinkDesign("junction", junction)
    start = (x, y, heading + math.pi)
    if arm.ends:
        start = (x - length * cos(heading), y - length * sin(heading), heading)
    return RoadDesign(
        arm.road,
        name,
        kind,
        speed_km_h,
        (straight(length),),
        sections,
        start=start,
        predecessor=None if arm.ends else link,
        successor=link if arm.ends else None,
    )


def _equipped(
    road: RoadDesign,
    arm: Arm,
    *,
    half: float,
    crosswalk: float | None = None,
    stop_line: float | None = None,
    signals: Sequence[SignalDesign] = (),
) -> RoadDesign:
    """Add a crosswalk, a stop line and signals to an arm, at distances from its junction.

    Signals specify `s` and `t` as the distance before the junction and to the driver's right.
    """

    def along(distance: float) -> float:
        return road.length - distance if arm.ends else distance

    toward = -1.0 if arm.ends else 1.0
    patches = []
    if crosswalk is not None:
        patches.append(
            PatchDesign(f"c{road.id}", "crosswalk", along(crosswalk), 0.0, 3.5, 2.0 * half)
        )
    if stop_line is not None:
        t = toward * 0.5 * half
        patches.append(PatchDesign(f"l{road.id}", "stop_line", along(stop_line), t, 0.4, half))
    placed = [
        replace(
            signal,
            s=along(signal.s),
            t=toward * signal.t,
            orientation="+" if arm.ends else "-",
        )
        for signal in signals
    ]
    return replace(road, patches=tuple(patches), signals=tuple(placed))


def _light(id: str, s: float, t: float) -> SignalDesign:
    return SignalDesign(id, "Traffic light", s, t, "1000001", "+", "OpenDRIVE", True, 2.3, 0.9, 0.3)


def _four_way() -> MapDesign:
    widths = widths_of(AVENUE)
    half = widths[0] + widths[1]
    setback = half + 7.0
    arms = _arms(4, setback, widths)
    section = both_ways(AVENUE, "solid solid")
    names = ("South Avenue", "East Avenue", "North Avenue", "West Avenue")
    lengths = (_AHEAD - setback, 220.0, 420.0, 220.0)
    roads: list[RoadDesign] = []
    for arm, name, length in zip(arms, names, lengths, strict=True):
        road = _approach(arm, name, 50, length, (section,), kind="townArterial")
        near = _light(f"near{arm.road}", 5.7, half + 0.7)
        roads.append(_equipped(road, arm, half=half, crosswalk=2.75, stop_line=5.7, signals=[near]))
    ways: list[tuple[RoadDesign, ConnectionDesign]] = []
    for index, arm in enumerate(arms):
        for number, lane, count, kind in (
            (1, 2, 1, "right"),
            (2, 1, 2, "straight"),
            (3, 1, 1, "left"),
        ):
            way = _way(
                str(10 * (index + 1) + number),
                f"From {names[index]} {kind}",
                50 if kind == "straight" else 30,
                (arm, lane),
                (arms[(index + number) % 4], lane),
                count,
                has_pavement=kind == "right",
            )
            if kind == "straight":
                far = _light(f"far{arm.road}", 2.0 * setback - 0.3, -(half + 0.8))
                way = replace(way[0], signals=(far,)), way[1]
            ways.append(way)
    roads += [road for road, _ in ways]
    junction = JunctionDesign(_JUNCTION, "Crossing", tuple(one for _, one in ways))
    return MapDesign("urban_junction", "Crossing of two avenues", tuple(roads), (junction,))


def _without_parking(length: float, *, ends: bool) -> tuple[SectionDesign, ...]:
    """Return the cross-section of a residential road whose kerb replaces the parking near its junction."""
    driving, parking, pavement = RESIDENTIAL
    rows = smooth(length - 18.0, 5.0, 2.2, 0.0) if ends else smooth(13.0, 5.0, 0.0, 2.2)
    lanes = driving, replace(parking, width=rows), pavement
    return (both_ways(lanes),)


def _t_junction() -> MapDesign:
    half = 3.25
    setback = half + 5.0
    widths = (half, 0.0, 2.5)
    south, east, north = _arms(3, setback, widths)
    roads = []
    for arm, name, length in (
        (south, "Main Street", 200.0 + 100.0 - setback),
        (east, "Side Street", 220.0),
        (north, "Main Street", 420.0),
    ):
        sections = _without_parking(length, ends=arm.ends)
        road = _approach(arm, name, 30, length, sections)
        if arm is east:
            stop = SignalDesign("stop", "Stop", 5.7, half + 0.6, "206")
            road = _equipped(road, arm, half=half, crosswalk=2.75, stop_line=5.7, signals=[stop])
        roads.append(road)
    ways = [
        _way("11", "Right into Side Street", 20, (south, 1), (east, 1), has_pavement=True),
        _way("12", "Along Main Street", 30, (south, 1), (north, 1)),
        _way("21", "Right into Main Street", 20, (east, 1), (north, 1), has_pavement=True),
        _way("23", "Left into Main Street", 20, (east, 1), (south, 1)),
        _way("32", "Back along Main Street", 30, (north, 1), (south, 1), has_pavement=True),
        _way("33", "Left into Side Street", 20, (north, 1), (east, 1)),
    ]
    junction = JunctionDesign(_JUNCTION, "Mouth of Side Street", tuple(one for _, one in ways))
    roads += [road for road, _ in ways]
    return MapDesign("t_junction", "Side street from the right", tuple(roads), (junction,))


_RADIUS = 13.5
"""Radius of the roundabout's island, m."""
_RING_WIDTH = 5.0
_SPREAD = 0.62
"""Angle between an arm's direction and the point where its traffic joins or leaves the ring, rad."""
_SPLITTER = 2.0
"""Half the width of the splitter islands between entry and exit, m."""


def _ring_lanes(*, has_pavement: bool, before: bool, after: bool) -> SectionDesign:
    """Return the cross-section of the ring; the island is on its left."""

    def linked(lane: LaneDesign, number: int) -> LaneDesign:
        inner = abs(number) == 1
        return replace(
            lane,
            predecessor=number if before and inner else None,
            successor=number if after and inner else None,
        )

    right = [linked(LaneDesign("driving", _RING_WIDTH, "curb" if has_pavement else "none"), -1)]
    if has_pavement:
        right.append(LaneDesign("sidewalk", 2.5))
    return SectionDesign(tuple(right), (linked(LaneDesign("border", _RADIUS - 0.5), 1),), "curb")


def _ring(id: str, name: str, start: float, end: float) -> RoadDesign:
    """Return a part of the ring between two angles."""
    pose = (_RADIUS * cos(start), _RADIUS * sin(start), start + 0.5 * math.pi)
    bend = 1.0 / _RADIUS
    pieces: tuple[Piece, ...] = (("arc", _RADIUS * (end - start), bend, bend),)
    return RoadDesign(id, name, "town", 30, pieces, (), start=pose)


def _roundabout() -> MapDesign:
    setback = 28.0
    widths = (_SPLITTER, 3.5, 2.5)
    arms = _arms(4, setback, widths)
    plain = LaneDesign("driving", 3.5, "curb"), LaneDesign("sidewalk", 2.5)
    names = ("South Road", "East Road", "North Road", "West Road")
    lengths = (_AHEAD - setback, 200.0, 420.0, 200.0)
    roads: list[RoadDesign] = []
    junctions: list[JunctionDesign] = []
    for index, (arm, name, length) in enumerate(zip(arms, names, lengths, strict=True)):
        key, junction = str(index + 1), f"10{index + 1}"
        last = str((index + 3) % 4 + 1)
        roads.append(_splayed(arm, name, length, plain, junction))
        angle = 0.5 * math.pi * (index - 1)
        join, leave = angle + _SPREAD, angle - _SPREAD
        segment = replace(
            _ring(f"1{key}", f"Ring after {name}", join, angle + 0.5 * math.pi - _SPREAD),
            sections=(_ring_lanes(has_pavement=True, before=False, after=False),),
            predecessor=LinkDesign("junction", junction),
            successor=LinkDesign("junction", f"10{(index + 1) % 4 + 1}"),
        )
        through = replace(
            _ring(f"4{key}", f"Ring past {name}", leave, join),
            sections=(_ring_lanes(has_pavement=False, before=True, after=True),),
            junction=junction,
            predecessor=LinkDesign("road", f"1{last}", "end"),
            successor=LinkDesign("road", f"1{key}", "start"),
        )
        entry = _slip(arm, f"Entry from {name}", join, f"1{key}", entering=True)
        leaving = _slip(arm, f"Exit to {name}", leave, f"1{last}", entering=False)
        roads += [segment, through, entry, leaving]
        connections = (
            ConnectionDesign(arm.road, entry.id, ((arm.into(2), -1), (arm.into(3), -2))),
            ConnectionDesign(f"1{last}", through.id, ((1, 1), (-1, -1))),
            ConnectionDesign(f"1{last}", leaving.id, ((-1, -1), (-2, -2))),
        )
        junctions.append(JunctionDesign(junction, f"{name} at the ring", connections))
    return MapDesign("roundabout", "Roundabout with four arms", tuple(roads), tuple(junctions))


def _splayed(
    arm: Arm, name: str, length: float, plain: tuple[LaneDesign, ...], junction: str
) -> RoadDesign:
    """Return an arm whose two directions separate around an island before the ring."""
    splay = 30.0
    rows = smooth(0.0, 20.0, 0.0, _SPLITTER) if arm.ends else smooth(10.0, 20.0, _SPLITTER, 0.0)
    sections: list[SectionDesign] = []
    for is_splayed in (False, True) if arm.ends else (True, False):
        sides: list[tuple[LaneDesign, ...]] = []
        for sign in (-1, 1):
            end = "successor" if is_splayed != arm.ends else "predecessor"
            linked = []
            for number, lane in enumerate(plain, start=2 if is_splayed else 1):
                other = sign * (number - 1 if is_splayed else number + 1)
                linked.append(
                    replace(lane, successor=other)
                    if end == "successor"
                    else replace(lane, predecessor=other)
                )
            if is_splayed:
                linked.insert(0, LaneDesign("median", rows, "curb"))
            sides.append(tuple(linked))
        begins = 0.0 if not sections else length - splay if arm.ends else splay
        mark = "none" if is_splayed else "broken"
        sections.append(SectionDesign(sides[0], sides[1], mark, begins))
    road = _approach(arm, name, 50, length, tuple(sections), junction=junction)
    give_way = SignalDesign("yield" + arm.road, "Give way", 1.0, _SPLITTER + 3.5 + 0.6, "205")
    return _equipped(road, arm, half=_SPLITTER + 3.5, crosswalk=7.0, signals=[give_way])


def _slip(arm: Arm, name: str, angle: float, ring: str, *, entering: bool) -> RoadDesign:
    """Return the road between an arm and the ring."""
    on_ring = (_RADIUS * cos(angle), _RADIUS * sin(angle), angle + 0.5 * math.pi)
    at_arm = arm.pose(2, entering=entering)
    start, end = (at_arm, on_ring) if entering else (on_ring, at_arm)
    pieces = _bend(start, end)
    length = sum(piece[1] for piece in pieces)
    ends = (arm.widths[1], _RING_WIDTH) if entering else (_RING_WIDTH, arm.widths[1])
    rows = smooth(0.0, length, *ends)[:1]
    inner, outer = (arm.into(2), arm.into(3)) if entering else (arm.out_of(2), arm.out_of(3))
    links = ((inner, -1), (outer, -2)) if entering else ((-1, inner), (-2, outer))
    lanes = (
        LaneDesign("driving", rows, "curb", *links[0]),
        LaneDesign("sidewalk", 2.5, "none", *links[1]),
    )
    tip = 10.0
    island = (
        smooth(tip - 2.5, 2.5, _SPLITTER, 0.0)
        if entering
        else smooth(length - tip, 2.5, 0.0, _SPLITTER)
    )
    arm_link = LinkDesign("road", arm.road, arm.contact)
    ring_link = LinkDesign("road", ring, "start" if entering else "end")
    return RoadDesign(
        f"{2 if entering else 3}{arm.road}",
        name,
        "town",
        30,
        pieces,
        (SectionDesign(lanes, (LaneDesign("median", island, "curb"),), "curb"),),
        start=start,
        junction=f"10{arm.road}",
        predecessor=arm_link if entering else ring_link,
        successor=ring_link if entering else arm_link,
    )


CROSSINGS: tuple[MapDesign, ...] = (_four_way(), _t_junction(), _roundabout())
