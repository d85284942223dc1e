"""The design of a motorway with an exit."""

import math
from dataclasses import replace

from tools.maps.design import (
    ConnectionDesign,
    JunctionDesign,
    LaneDesign,
    LinkDesign,
    MapDesign,
    RoadDesign,
    SectionDesign,
    both_ways,
    curves_of,
    smooth,
    straight,
    widths_of,
)
from tools.maps.streets import HIGHWAY

_EXIT_M = 360.0
"""Distance from the start of the motorway to the nose where its exit leaves it, m."""
_NOSE_M = 40.0
"""Length of the motorway beside the part of the ramp that still touches it, m."""


_JUNCTION = LinkDesign("junction", "100")
_WIDTHS = widths_of(HIGHWAY)


def _exit_ramp() -> MapDesign:
    """Return a motorway whose lane for slowing down begins 20 m ahead, and the ramp that it leads to."""
    onward = RoadDesign(
        "3",
        "Motorway after the exit",
        "motorway",
        100,
        (straight(900.0),),
        (both_ways(HIGHWAY, "none"),),
        start=(_NOSE_M, 0.0, 0.0),
        predecessor=_JUNCTION,
    )
    nose = _nose()
    roads = (_motorway(), onward, _ramp(nose), _past_the_exit(), _opposite_the_exit(), nose)
    connections = (
        ConnectionDesign("1", "13", tuple((-index, -index) for index in range(1, 5))),
        ConnectionDesign("3", "31", tuple((index, -index) for index in range(1, 6))),
        ConnectionDesign("1", "14", ((-5, -1), (-6, -2))),
    )
    exit_ = JunctionDesign("100", "Exit", connections)
    return MapDesign("exit_ramp", "Motorway with an exit", roads, (exit_,))


def _motorway() -> RoadDesign:
    """Return the motorway up to the nose, with the lane for slowing down."""
    slowing = LaneDesign("driving", smooth(0.0, 50.0, 0.0, 3.5), "solid")
    plain = tuple(
        replace(lane, successor=-index if index < 5 else -index - 1)
        for index, lane in enumerate(HIGHWAY, start=1)
    )
    back = tuple(replace(lane, successor=index) for index, lane in enumerate(HIGHWAY, start=1))
    beside = (*HIGHWAY[:3], replace(HIGHWAY[3], mark="broken"), slowing, *HIGHWAY[4:])
    wider = tuple(
        replace(lane, predecessor=None if index == 5 else -index if index < 5 else 1 - index)
        for index, lane in enumerate(beside, start=1)
    )
    on = tuple(replace(lane, predecessor=index) for index, lane in enumerate(HIGHWAY, start=1))
    return RoadDesign(
        "1",
        "Motorway before the exit",
        "motorway",
        100,
        (straight(_EXIT_M),),
        (SectionDesign(plain, back, "none"), SectionDesign(wider, on, "none", 220.0)),
        start=(-_EXIT_M, 0.0, 0.0),
        successor=_JUNCTION,
    )


def _nose() -> RoadDesign:
    """Return the part of the ramp that still touches the motorway."""
    lanes = (
        LaneDesign("driving", 3.5, "solid", -5, -1),
        LaneDesign("shoulder", 3.0, "none", -6, -2),
    )
    return RoadDesign(
        "14",
        "Exit",
        "motorway",
        60,
        (("spiral", _NOSE_M, 0.0, -1 / 90),),
        (SectionDesign(lanes, (), "solid"),),
        start=(0.0, -sum(_WIDTHS[:4]), 0.0),
        junction="100",
        predecessor=LinkDesign("road", "1", "end"),
        successor=LinkDesign("road", "4", "start"),
    )


def _ramp(nose: RoadDesign) -> RoadDesign:
    end = curves_of(nose)[-1].at(_NOSE_M)
    return RoadDesign(
        "4",
        "Ramp",
        "town",
        60,
        (("arc", 60.0, -1 / 90, -1 / 90), ("spiral", 40.0, -1 / 90, 0.0), straight(60.0)),
        _paved_nose((LaneDesign("driving", 3.5, "solid"), LaneDesign("shoulder", 3.0))),
        start=(end.x, end.y, end.heading),
        predecessor=_JUNCTION,
    )


def _past_the_exit() -> RoadDesign:
    # Its beginning is wide enough for the edge line of the motorway.
    widening = smooth(0.0, _NOSE_M, 0.35, _WIDTHS[4])[:1]
    lanes = tuple(
        replace(lane, predecessor=-index, successor=-index)
        for index, lane in enumerate(HIGHWAY[:4], start=1)
    )
    lanes += (replace(HIGHWAY[4], width=widening, successor=-5),)
    return RoadDesign(
        "13",
        "Past the exit",
        "motorway",
        100,
        (straight(_NOSE_M),),
        (SectionDesign(lanes, (), "none"),),
        junction="100",
        predecessor=LinkDesign("road", "1", "end"),
        successor=LinkDesign("road", "3", "start"),
    )


def _opposite_the_exit() -> RoadDesign:
    lanes = tuple(
        replace(lane, predecessor=index, successor=index)
        for index, lane in enumerate(HIGHWAY[:5], start=1)
    )
    return RoadDesign(
        "31",
        "Opposite the exit",
        "motorway",
        100,
        (straight(_NOSE_M),),
        (SectionDesign(lanes, (), "none"),),
        start=(_NOSE_M, 0.0, math.pi),
        junction="100",
        predecessor=LinkDesign("road", "3", "start"),
        successor=LinkDesign("road", "1", "end"),
    )


def _paved_nose(lanes: tuple[LaneDesign, ...]) -> tuple[SectionDesign, ...]:
    """Return a ramp's sections; the first paves the wedge between the ramp and the motorway."""
    length, taper = 6.0, 2.5
    width = smooth(length, taper, 1.6, 0.0)[:2]
    first = tuple(replace(lane, successor=-index) for index, lane in enumerate(lanes, start=1))
    rest = tuple(replace(lane, predecessor=-index) for index, lane in enumerate(lanes, start=1))
    return (
        SectionDesign(first, (LaneDesign("shoulder", width),), "solid"),
        SectionDesign(rest, (), "solid", length + taper),
    )


EXITS: tuple[MapDesign, ...] = (_exit_ramp(),)
