"""Designs of the single-road maps."""

import math
from collections.abc import Sequence
from dataclasses import replace

from tools.maps.design import (
    LaneDesign,
    MapDesign,
    PatchDesign,
    RoadDesign,
    Row,
    SectionDesign,
    SignalDesign,
    StretchDesign,
    bend,
    both_ways,
    chained,
    smooth,
    straight,
)

PAVEMENT = LaneDesign("sidewalk", 2.5)
RESIDENTIAL = (
    LaneDesign("driving", 3.25, "solid"),
    LaneDesign("parking", 2.2, "curb"),
    PAVEMENT,
)
AVENUE = (
    LaneDesign("driving", 3.4, "broken"),
    LaneDesign("driving", 3.4, "curb"),
    LaneDesign("sidewalk", 3.0),
)
HIGHWAY = (
    LaneDesign("median", 1.5),
    LaneDesign("shoulder", 0.75, "solid"),
    LaneDesign("driving", 3.75, "broken"),
    LaneDesign("driving", 3.75, "solid"),
    LaneDesign("shoulder", 3.0),
    LaneDesign("border", 5.0),
)
_RURAL = (
    LaneDesign("driving", 3.25, "solid"),
    LaneDesign("shoulder", 1.0),
    LaneDesign("border", 6.0),
)
_OPEN = (
    LaneDesign("driving", 3.5, "solid"),
    LaneDesign("shoulder", 0.75),
    LaneDesign("border", 5.0),
)
_WALLED = (
    LaneDesign("driving", 3.5, "solid"),
    LaneDesign("shoulder", 0.75, "curb"),
    LaneDesign("sidewalk", 1.0),
)
_DECK = (
    LaneDesign("driving", 3.5, "solid"),
    LaneDesign("shoulder", 0.75, "curb"),
    LaneDesign("sidewalk", 2.0),
)
_TOWN = (
    LaneDesign("driving", 3.25, "curb"),
    LaneDesign("sidewalk", 2.5),
)
_GAP_M = 3.7
"""Width of the carriageway in the narrow passage, m."""


def _with_stretch(
    road: RoadDesign, stretch: StretchDesign, lanes: tuple[LaneDesign, ...]
) -> RoadDesign:
    """Add a tunnel or bridge, with its own cross-section, to a road."""
    (outside,) = road.sections
    sections = (
        outside,
        replace(both_ways(lanes, outside.centre_mark), s=stretch.s),
        replace(outside, s=stretch.s + stretch.length),
    )
    return replace(road, sections=chained(sections, 2), stretches=(stretch,))


def _narrow_passage() -> RoadDesign:
    """Return a street whose pavements leave a single lane for both directions, 90 to 130 m ahead.

    Both lanes run on through the gap, side by side in its middle, so that a car of either direction
    has room for itself but not beside another.
    """
    taper, begin, end = 40.0, 290.0, 330.0
    wide = (3.25, 2.2, 2.5)
    narrow = (1.2, 0.5 * _GAP_M - 1.2, sum(wide) - 0.5 * _GAP_M)

    def section(widths: Sequence[float | tuple[Row, ...]], mark: str, s: float) -> SectionDesign:
        edge = "solid" if mark == "broken" else "none"
        driving, beside, walk = widths
        lanes = (
            LaneDesign("driving", driving, edge),
            LaneDesign("parking", beside, "curb"),
            LaneDesign("sidewalk", walk),
        )
        return SectionDesign(lanes, lanes, mark, s)

    def tapered(before: Sequence[float], after: Sequence[float]) -> list[tuple[Row, ...]]:
        return [smooth(0.0, taper, one, two) for one, two in zip(before, after, strict=True)]

    sections = (
        section(wide, "broken", 0.0),
        section(tapered(wide, narrow), "none", begin - taper),
        section(narrow, "none", begin),
        section(tapered(narrow, wide), "none", end),
        section(wide, "broken", end + taper),
    )
    return RoadDesign(
        "1",
        "Street with a narrow passage",
        "townLocal",
        30,
        (straight(800.0),),
        chained(sections, 3),
        # Oncoming traffic waits at the line; the sign faces it.
        signals=(
            SignalDesign("yield1", "Give way", end + 20.0, wide[0] + wide[1] + 0.6, "205", "-"),
        ),
        patches=(PatchDesign("l1", "stop_line", end + 18.0, 0.5 * wide[0], 0.4, wide[0]),),
    )


def _level_crossing() -> MapDesign:
    """Return a country road that a single track crosses at a right angle, 110 m ahead."""
    crossing, reach, before = 310.0, 160.0, 7.0
    lines = tuple(
        PatchDesign(f"l{number}", "stop_line", crossing - side * before, -side * 1.625, 0.4, 3.25)
        for number, side in ((1, 1.0), (2, -1.0))
    )
    signs = tuple(
        SignalDesign(f"rail{number}", "Railway", crossing - side * 60.0, -side * 5.0, "101", facing)
        for number, side, facing in ((1, 1.0, "+"), (2, -1.0, "-"))
    )
    road = RoadDesign(
        "1",
        "Country road over a level crossing",
        "rural",
        70,
        (straight(800.0),),
        (both_ways(_RURAL),),
        patches=lines,
        signals=signs,
    )
    bed = (LaneDesign("rail", 1.6),)
    track = RoadDesign(
        "2",
        "Single-track railway",
        "unknown",
        80,
        (straight(2.0 * reach),),
        (both_ways(bed, "none"),),
        start=(crossing, -reach, 0.5 * math.pi),
    )
    return MapDesign("level_crossing", road.name, (road, track))


_SINGLE_ROADS = {
    "residential_two_lane": RoadDesign(
        "1",
        "Residential street",
        "townLocal",
        30,
        (straight(430.0), *bend(40.0, 130.0, 1 / 300), straight(180.0)),
        (both_ways(RESIDENTIAL),),
    ),
    "urban_three_lane": RoadDesign(
        "1",
        "One-way street with three lanes",
        "townArterial",
        50,
        (straight(1000.0),),
        (
            SectionDesign(
                (
                    LaneDesign("driving", 3.5, "broken"),
                    LaneDesign("driving", 3.5, "broken"),
                    LaneDesign("driving", 3.5, "curb"),
                    LaneDesign("sidewalk", 3.0),
                ),
                (LaneDesign("sidewalk", 3.0),),
                "curb",
            ),
        ),
    ),
    "urban_avenue": RoadDesign(
        "1",
        "Avenue with two lanes each way",
        "townArterial",
        50,
        (straight(600.0), *bend(50.0, 150.0, -1 / 500), straight(150.0)),
        (both_ways(AVENUE, "solid solid"),),
    ),
    "highway": RoadDesign(
        "1",
        "Divided highway with two lanes and a shoulder each way",
        "motorway",
        100,
        (straight(700.0), *bend(120.0, 400.0, 1 / 1500), straight(260.0)),
        (both_ways(HIGHWAY, "none"),),
    ),
    "rural_curve": RoadDesign(
        "1",
        "Country road with a long bend",
        "rural",
        80,
        (
            straight(260.0),
            *bend(70.0, 220.0, 1 / 250),
            straight(60.0),
            *bend(70.0, 150.0, -1 / 350),
            straight(130.0),
        ),
        (both_ways(_RURAL),),
        elevation=smooth(250.0, 400.0, 0.0, 2.5),
    ),
    "rural_hill": RoadDesign(
        "1",
        "Country road over a crest",
        "rural",
        80,
        (straight(620.0), *bend(60.0, 160.0, -1 / 400), straight(100.0)),
        (both_ways(_RURAL),),
        elevation=(
            (0.0, 0.0, 0.0, 0.0, 0.0),
            (170.0, 0.0, 0.0, 0.07 / 120, 0.0),
            (230.0, 2.1, 0.07, 0.0, 0.0),
            (280.0, 5.6, 0.07, -0.07 / 80, 0.0),
            (360.0, 5.6, -0.07, 0.0, 0.0),
            (410.0, 2.1, -0.07, 0.07 / 120, 0.0),
            (470.0, 0.0, 0.0, 0.0, 0.0),
        ),
    ),
    "tunnel": _with_stretch(
        RoadDesign(
            "1",
            "Road through a tunnel",
            "rural",
            70,
            (straight(560.0), *bend(60.0, 180.0, 1 / 500), straight(100.0)),
            (both_ways(_OPEN, "solid solid"),),
        ),
        StretchDesign("tunnel", "t1", "Tunnel", 260.0, 200.0),
        _WALLED,
    ),
    "bridge": _with_stretch(
        RoadDesign(
            "1",
            "Road over a bridge",
            "rural",
            70,
            (straight(520.0), *bend(60.0, 160.0, -1 / 450), straight(140.0)),
            (both_ways(_OPEN),),
            elevation=(
                *smooth(160.0, 180.0, 0.0, 4.5)[:2],
                *smooth(340.0, 180.0, 4.5, 0.0)[1:],
            ),
        ),
        StretchDesign("bridge", "b1", "Bridge", 260.0, 160.0),
        _DECK,
    ),
    "town_bend": RoadDesign(
        "1",
        "Town street in tight bends",
        "town",
        30,
        (
            straight(230.0),
            *bend(25.0, 20.0, 1 / 60),
            straight(20.0),
            *bend(25.0, 25.0, -1 / 70),
            straight(330.0),
        ),
        (both_ways(_TOWN),),
    ),
    "downhill_bend": RoadDesign(
        "1",
        "Country road downhill into a bend",
        "rural",
        60,
        (straight(275.0), *bend(50.0, 70.0, -1 / 120), straight(355.0)),
        (both_ways(_RURAL, "solid"),),
        elevation=(
            (0.0, 13.2, 0.0, 0.0, 0.0),
            (180.0, 13.2, 0.0, -0.06 / 80, 0.0),
            (220.0, 12.0, -0.06, 0.0, 0.0),
            (400.0, 1.2, -0.06, 0.06 / 80, 0.0),
            (440.0, 0.0, 0.0, 0.0, 0.0),
        ),
    ),
    "narrow_passage": _narrow_passage(),
}

STREETS: tuple[MapDesign, ...] = (
    *(MapDesign(id, road.name, (road,)) for id, road in _SINGLE_ROADS.items()),
    _level_crossing(),
)
