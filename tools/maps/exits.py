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
    curves_of,
    smooth,
)
from tools.maps.streets import HIGHWAY

_EXIT_M = 360.0
"""Distance from the start of the motorway to the nose where its exit leaves it, m."""
_NOSE_M = 40.0
"""Length of the motorway beside the part of the ramp that still touches it, m."""


def _exit_ramp() -> MapDesign:
    """Return a motorway whose lane for slowing down begins 20 m ahead, and the ramp that it leads to."""
    inner, outer = HIGHWAY[:4], HIGHWAY[4:]
    widths = [float(lane.width) for lane in HIGHWAY if not isinstance(lane.width, tuple)]
    edge = sum(widths[:4])
    opens, slowing = 220.0, LaneDesign("driving", smooth(0.0, 50.0, 0.0, 3.5), "solid")
    plain = tuple(
        replace(lane, successor=-index if index < 5 else -index - 1)
        for index, lane in enumerate(HIGHWAY, start=1)
    )
    back = tuple(replace(lane, successor=index) for index, lane in enumerate(HIGHWAY, start=1))
    beside = (*inner[:3], replace(inner[3], mark="broken"), slowing, *outer)
    wider = tuple(
        replace(lane, predecessor=None if index == 5 else -index if index < 5 else 1 - index)
        for index, lane in enumerate(beside, start=1)
    )
    on = tuple(replace(lane, predecessor=index) for index, lane in enumerate(HIGHWAY, start=1))
    sections = (
        SectionDesign(plain, back, "none"),
        SectionDesign(wider, on, "none", opens),
    )
    junction = LinkDesign("junction", "100")
    road = RoadDesign(
        "1",
        "Motorway before the exit",
        "motorway",
        100,
        (("line", _EXIT_M, 0.0, 0.0),),
        sections,
        start=(-_EXIT_M, 0.0, 0.0),
        successor=junction,
    )
    onward = RoadDesign(
        "3",
        "Motorway after the exit",
        "motorway",
        100,
        (("line", 900.0, 0.0, 0.0),),
        (SectionDesign(HIGHWAY, HIGHWAY, "none"),),
        start=(_NOSE_M, 0.0, 0.0),
        predecessor=junction,
    )
    bend = ("spiral", _NOSE_M, 0.0, -1 / 90)
    exit_lane = LaneDesign("driving", 3.5, "solid", -5, -1)
    nose = RoadDesign(
        "14",
        "Exit",
        "motorway",
        60,
        (bend,),
        (SectionDesign((exit_lane, LaneDesign("shoulder", 3.0, "none", -6, -2)), (), "solid"),),
        start=(0.0, -edge, 0.0),
        junction="100",
        predecessor=LinkDesign("road", "1", "end"),
        successor=LinkDesign("road", "4", "start"),
    )
    end = curves_of(nose)[-1].at(_NOSE_M)
    ramp = RoadDesign(
        "4",
        "Ramp",
        "town",
        60,
        (("arc", 60.0, -1 / 90, -1 / 90), ("spiral", 40.0, -1 / 90, 0.0), ("line", 60.0, 0.0, 0.0)),
        _paved_nose((LaneDesign("driving", 3.5, "solid"), LaneDesign("shoulder", 3.0))),
        start=(end.x, end.y, end.heading),
        predecessor=junction,
    )
    # Its beginning is wide enough for the edge line of the motorway.
    widening = smooth(0.0, _NOSE_M, 0.35, widths[4])[:1]
    through, return_way = (
        RoadDesign(
            id,
            name,
            "motorway",
            100,
            (("line", _NOSE_M, 0.0, 0.0),),
            (
                SectionDesign(
                    tuple(
                        replace(lane, predecessor=sign * index, successor=sign * index)
                        if index < 5 or sign > 0
                        else replace(lane, width=widening, successor=-index)
                        for index, lane in enumerate(HIGHWAY[:5], start=1)
                    ),
                    (),
                    "none",
                ),
            ),
            start=start,
            junction="100",
            predecessor=LinkDesign("road", *before),
            successor=LinkDesign("road", *after),
        )
        for id, name, sign, start, before, after in (
            ("13", "Past the exit", -1, (0.0, 0.0, 0.0), ("1", "end"), ("3", "start")),
            ("31", "Opposite the exit", 1, (_NOSE_M, 0.0, math.pi), ("3", "start"), ("1", "end")),
        )
    )
    connections = (
        ConnectionDesign("1", "13", tuple((-index, -index) for index in range(1, 5))),
        ConnectionDesign("3", "31", tuple((index, -index) for index in range(1, 6))),
        ConnectionDesign("1", "14", ((-5, -1), (-6, -2))),
    )
    roads = (road, onward, ramp, through, return_way, nose)
    exit_ = JunctionDesign("100", "Exit", connections)
    return MapDesign("exit_ramp", "Motorway with an exit", roads, (exit_,))


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
