"""Designs of the single-road maps."""

import math
from dataclasses import replace

from tools.maps.design import (
    LaneDesign,
    MapDesign,
    PatchDesign,
    Piece,
    RoadDesign,
    Row,
    SectionDesign,
    SignalDesign,
    StretchDesign,
    smooth,
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


def _single_road(
    id: str,
    name: str,
    type: str,
    speed_km_h: int,
    pieces: tuple[Piece, ...],
    lanes: tuple[LaneDesign, ...],
    left: tuple[LaneDesign, ...] | None = None,
    *,
    centre_mark: str = "broken",
    elevation: tuple[Row, ...] = ((0.0, 0.0, 0.0, 0.0, 0.0),),
) -> MapDesign:
    section = SectionDesign(lanes, lanes if left is None else left, centre_mark)
    road = RoadDesign("1", name, type, speed_km_h, pieces, (section,), elevation=elevation)
    return MapDesign(id, name, (road,))


def _with_stretch(
    plain: MapDesign, stretch: StretchDesign, lanes: tuple[LaneDesign, ...]
) -> MapDesign:
    """Add a tunnel or bridge, with its own cross-section, to a single road."""
    road = plain.roads[0]
    outside = road.sections[0].right
    mark = road.sections[0].centre_mark
    sections = []
    for number, (s, used) in enumerate(
        ((0.0, outside), (stretch.s, lanes), (stretch.s + stretch.length, outside))
    ):
        sides = []
        for sign in (-1, 1):
            linked = []
            for index, lane in enumerate(used, start=1):
                same = index < 3
                linked.append(
                    replace(
                        lane,
                        predecessor=sign * index if same and number > 0 else None,
                        successor=sign * index if same and number < 2 else None,
                    )
                )
            sides.append(tuple(linked))
        sections.append(SectionDesign(sides[0], sides[1], mark, s))
    road = replace(road, sections=tuple(sections), stretches=(stretch,))
    return replace(plain, roads=(road,))


def _narrow_passage() -> MapDesign:
    """Return a street whose pavements leave a single lane for both directions, 90 to 130 m ahead.

    Both lanes run on through the gap, side by side in its middle, so that a car of either direction
    has room for itself but not beside another.
    """
    taper, begin, end = 40.0, 290.0, 330.0
    lane, margin = 1.2, 0.5 * _GAP_M - 1.2
    wide, kerb, pavement = 3.25, 2.2, 2.5
    free = wide + kerb + pavement - lane - margin
    sections = []
    for s, mark, driving, beside, walk in (
        (0.0, "broken", wide, kerb, pavement),
        (
            begin - taper,
            "none",
            smooth(0.0, taper, wide, lane),
            smooth(0.0, taper, kerb, margin),
            smooth(0.0, taper, pavement, free),
        ),
        (begin, "none", lane, margin, free),
        (
            end,
            "none",
            smooth(0.0, taper, lane, wide),
            smooth(0.0, taper, margin, kerb),
            smooth(0.0, taper, free, pavement),
        ),
        (end + taper, "broken", wide, kerb, pavement),
    ):
        number = len(sections)
        edge = "solid" if mark == "broken" else "none"
        sides = []
        for sign in (-1, 1):
            lanes = (
                LaneDesign("driving", driving, edge),
                LaneDesign("parking", beside, "curb"),
                LaneDesign("sidewalk", walk),
            )
            sides.append(
                tuple(
                    replace(
                        one,
                        predecessor=sign * index if number > 0 else None,
                        successor=sign * index if number < 4 else None,
                    )
                    for index, one in enumerate(lanes, start=1)
                )
            )
        sections.append(SectionDesign(sides[0], sides[1], mark, s))
    road = RoadDesign(
        "1",
        "Street with a narrow passage",
        "townLocal",
        30,
        (("line", 800.0, 0.0, 0.0),),
        tuple(sections),
        # Oncoming traffic waits at the line; the sign faces it.
        signals=(SignalDesign("yield1", "Give way", end + 20.0, wide + kerb + 0.6, "205", "-"),),
        patches=(PatchDesign("l1", "stop_line", end + 18.0, 0.5 * wide, 0.4, wide),),
    )
    return MapDesign("narrow_passage", "Street with a narrow passage", (road,))


def _level_crossing() -> MapDesign:
    """Return a country road that a single track crosses at a right angle, 110 m ahead."""
    crossing, reach, before = 310.0, 160.0, 7.0
    plain = _single_road(
        "level_crossing",
        "Country road over a level crossing",
        "rural",
        70,
        (("line", 800.0, 0.0, 0.0),),
        _RURAL,
    )
    lines = tuple(
        PatchDesign(f"l{number}", "stop_line", crossing - side * before, -side * 1.625, 0.4, 3.25)
        for number, side in ((1, 1.0), (2, -1.0))
    )
    signs = tuple(
        SignalDesign(f"rail{number}", "Railway", crossing - side * 60.0, -side * 5.0, "101", facing)
        for number, side, facing in ((1, 1.0, "+"), (2, -1.0, "-"))
    )
    road = replace(plain.roads[0], patches=lines, signals=signs)
    bed = (LaneDesign("rail", 1.6),)
    track = RoadDesign(
        "2",
        "Single-track railway",
        "unknown",
        80,
        (("line", 2.0 * reach, 0.0, 0.0),),
        (SectionDesign(bed, bed, "none"),),
        start=(crossing, -reach, 0.5 * math.pi),
    )
    return replace(plain, roads=(road, track))


STREETS: tuple[MapDesign, ...] = (
    _single_road(
        "residential_two_lane",
        "Residential street",
        "townLocal",
        30,
        (
            ("line", 430.0, 0.0, 0.0),
            ("spiral", 40.0, 0.0, 1 / 300),
            ("arc", 130.0, 1 / 300, 1 / 300),
            ("spiral", 40.0, 1 / 300, 0.0),
            ("line", 180.0, 0.0, 0.0),
        ),
        RESIDENTIAL,
    ),
    _single_road(
        "urban_three_lane",
        "One-way street with three lanes",
        "townArterial",
        50,
        (("line", 1000.0, 0.0, 0.0),),
        (
            LaneDesign("driving", 3.5, "broken"),
            LaneDesign("driving", 3.5, "broken"),
            LaneDesign("driving", 3.5, "curb"),
            LaneDesign("sidewalk", 3.0),
        ),
        (LaneDesign("sidewalk", 3.0),),
        centre_mark="curb",
    ),
    _single_road(
        "urban_avenue",
        "Avenue with two lanes each way",
        "townArterial",
        50,
        (
            ("line", 600.0, 0.0, 0.0),
            ("spiral", 50.0, 0.0, -1 / 500),
            ("arc", 150.0, -1 / 500, -1 / 500),
            ("spiral", 50.0, -1 / 500, 0.0),
            ("line", 150.0, 0.0, 0.0),
        ),
        AVENUE,
        centre_mark="solid solid",
    ),
    _single_road(
        "highway",
        "Divided highway with two lanes and a shoulder each way",
        "motorway",
        100,
        (
            ("line", 700.0, 0.0, 0.0),
            ("spiral", 120.0, 0.0, 1 / 1500),
            ("arc", 400.0, 1 / 1500, 1 / 1500),
            ("spiral", 120.0, 1 / 1500, 0.0),
            ("line", 260.0, 0.0, 0.0),
        ),
        HIGHWAY,
        centre_mark="none",
    ),
    _single_road(
        "rural_curve",
        "Country road with a long bend",
        "rural",
        80,
        (
            ("line", 260.0, 0.0, 0.0),
            ("spiral", 70.0, 0.0, 1 / 250),
            ("arc", 220.0, 1 / 250, 1 / 250),
            ("spiral", 70.0, 1 / 250, 0.0),
            ("line", 60.0, 0.0, 0.0),
            ("spiral", 70.0, 0.0, -1 / 350),
            ("arc", 150.0, -1 / 350, -1 / 350),
            ("spiral", 70.0, -1 / 350, 0.0),
            ("line", 130.0, 0.0, 0.0),
        ),
        _RURAL,
        elevation=(
            (0.0, 0.0, 0.0, 0.0, 0.0),
            (250.0, 0.0, 0.0, 3 * 2.5 / 400**2, -2 * 2.5 / 400**3),
            (650.0, 2.5, 0.0, 0.0, 0.0),
        ),
    ),
    _single_road(
        "rural_hill",
        "Country road over a crest",
        "rural",
        80,
        (
            ("line", 620.0, 0.0, 0.0),
            ("spiral", 60.0, 0.0, -1 / 400),
            ("arc", 160.0, -1 / 400, -1 / 400),
            ("spiral", 60.0, -1 / 400, 0.0),
            ("line", 100.0, 0.0, 0.0),
        ),
        _RURAL,
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
    _with_stretch(
        _single_road(
            "tunnel",
            "Road through a tunnel",
            "rural",
            70,
            (
                ("line", 560.0, 0.0, 0.0),
                ("spiral", 60.0, 0.0, 1 / 500),
                ("arc", 180.0, 1 / 500, 1 / 500),
                ("spiral", 60.0, 1 / 500, 0.0),
                ("line", 100.0, 0.0, 0.0),
            ),
            _OPEN,
            centre_mark="solid solid",
        ),
        StretchDesign("tunnel", "t1", "Tunnel", 260.0, 200.0),
        _WALLED,
    ),
    _with_stretch(
        _single_road(
            "bridge",
            "Road over a bridge",
            "rural",
            70,
            (
                ("line", 520.0, 0.0, 0.0),
                ("spiral", 60.0, 0.0, -1 / 450),
                ("arc", 160.0, -1 / 450, -1 / 450),
                ("spiral", 60.0, -1 / 450, 0.0),
                ("line", 140.0, 0.0, 0.0),
            ),
            _OPEN,
            elevation=(
                *smooth(160.0, 180.0, 0.0, 4.5)[:2],
                *smooth(340.0, 180.0, 4.5, 0.0)[1:],
            ),
        ),
        StretchDesign("bridge", "b1", "Bridge", 260.0, 160.0),
        _DECK,
    ),
    _single_road(
        "town_bend",
        "Town street in tight bends",
        "town",
        30,
        (
            ("line", 230.0, 0.0, 0.0),
            ("spiral", 25.0, 0.0, 1 / 60),
            ("arc", 20.0, 1 / 60, 1 / 60),
            ("spiral", 25.0, 1 / 60, 0.0),
            ("line", 20.0, 0.0, 0.0),
            ("spiral", 25.0, 0.0, -1 / 70),
            ("arc", 25.0, -1 / 70, -1 / 70),
            ("spiral", 25.0, -1 / 70, 0.0),
            ("line", 330.0, 0.0, 0.0),
        ),
        _TOWN,
    ),
    _single_road(
        "downhill_bend",
        "Country road downhill into a bend",
        "rural",
        60,
        (
            ("line", 275.0, 0.0, 0.0),
            ("spiral", 50.0, 0.0, -1 / 120),
            ("arc", 70.0, -1 / 120, -1 / 120),
            ("spiral", 50.0, -1 / 120, 0.0),
            ("line", 355.0, 0.0, 0.0),
        ),
        _RURAL,
        centre_mark="solid",
        elevation=(
            (0.0, 13.2, 0.0, 0.0, 0.0),
            (180.0, 13.2, 0.0, -0.06 / 80, 0.0),
            (220.0, 12.0, -0.06, 0.0, 0.0),
            (400.0, 1.2, -0.06, 0.06 / 80, 0.0),
            (440.0, 0.0, 0.0, 0.0, 0.0),
        ),
    ),
    _narrow_passage(),
    _level_crossing(),
)
