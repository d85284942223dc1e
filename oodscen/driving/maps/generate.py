"""Writes the shipped OpenDRIVE maps.

Run `python -m oodscen.driving.maps.generate [FOLDER]` after changing a design below; without a
folder the files beside this module are replaced. The same design gives the same bytes.
"""

import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from lxml import etree

from oodscen.driving.geometry import Arc, Curve, Line, Spiral


@dataclass(frozen=True)
class LaneDesign:
    """One lane: its type, width in metres and the mark on its outer edge."""

    type: str
    width: float
    mark: str = "none"


@dataclass(frozen=True)
class MapDesign:
    """One road: pieces as (kind, length, start and end curvature), and its cross-section."""

    id: str
    name: str
    type: str
    speed_km_h: int
    pieces: tuple[tuple[str, float, float, float], ...]
    right: tuple[LaneDesign, ...]
    """From the reference line outwards."""
    left: tuple[LaneDesign, ...]
    centre_mark: str
    elevation: tuple[tuple[float, float, float, float, float], ...] = field(
        default=((0.0, 0.0, 0.0, 0.0, 0.0),)
    )
    """Rows of s, a, b, c, d."""


_PAVEMENT = LaneDesign("sidewalk", 2.5)
_RESIDENTIAL = (
    LaneDesign("driving", 3.25, "solid"),
    LaneDesign("parking", 2.2, "curb"),
    _PAVEMENT,
)
_AVENUE = (
    LaneDesign("driving", 3.4, "broken"),
    LaneDesign("driving", 3.4, "curb"),
    LaneDesign("sidewalk", 3.0),
)
_HIGHWAY = (
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

DESIGNS: tuple[MapDesign, ...] = (
    MapDesign(
        id="residential_two_lane",
        name="Residential street",
        type="townLocal",
        speed_km_h=30,
        pieces=(
            ("line", 430.0, 0.0, 0.0),
            ("spiral", 40.0, 0.0, 1 / 300),
            ("arc", 130.0, 1 / 300, 1 / 300),
            ("spiral", 40.0, 1 / 300, 0.0),
            ("line", 180.0, 0.0, 0.0),
        ),
        right=_RESIDENTIAL,
        left=_RESIDENTIAL,
        centre_mark="broken",
    ),
    MapDesign(
        id="urban_three_lane",
        name="One-way street with three lanes",
        type="townArterial",
        speed_km_h=50,
        pieces=(("line", 1000.0, 0.0, 0.0),),
        right=(
            LaneDesign("driving", 3.5, "broken"),
            LaneDesign("driving", 3.5, "broken"),
            LaneDesign("driving", 3.5, "curb"),
            LaneDesign("sidewalk", 3.0),
        ),
        left=(LaneDesign("sidewalk", 3.0),),
        centre_mark="curb",
    ),
    MapDesign(
        id="urban_avenue",
        name="Avenue with two lanes each way",
        type="townArterial",
        speed_km_h=50,
        pieces=(
            ("line", 600.0, 0.0, 0.0),
            ("spiral", 50.0, 0.0, -1 / 500),
            ("arc", 150.0, -1 / 500, -1 / 500),
            ("spiral", 50.0, -1 / 500, 0.0),
            ("line", 150.0, 0.0, 0.0),
        ),
        right=_AVENUE,
        left=_AVENUE,
        centre_mark="solid solid",
    ),
    MapDesign(
        id="highway",
        name="Divided highway with two lanes and a shoulder each way",
        type="motorway",
        speed_km_h=100,
        pieces=(
            ("line", 700.0, 0.0, 0.0),
            ("spiral", 120.0, 0.0, 1 / 1500),
            ("arc", 400.0, 1 / 1500, 1 / 1500),
            ("spiral", 120.0, 1 / 1500, 0.0),
            ("line", 260.0, 0.0, 0.0),
        ),
        right=_HIGHWAY,
        left=_HIGHWAY,
        centre_mark="none",
    ),
    MapDesign(
        id="rural_curve",
        name="Country road with a long bend",
        type="rural",
        speed_km_h=80,
        pieces=(
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
        right=_RURAL,
        left=_RURAL,
        centre_mark="broken",
        elevation=(
            (0.0, 0.0, 0.0, 0.0, 0.0),
            (250.0, 0.0, 0.0, 3 * 2.5 / 400**2, -2 * 2.5 / 400**3),
            (650.0, 2.5, 0.0, 0.0, 0.0),
        ),
    ),
)
"""The ego starts 200 m after the beginning of every one of them."""


def curves_of(design: MapDesign) -> list[Curve]:
    """Chain a design's pieces, each starting where the last one ends."""
    curves: list[Curve] = []
    s = x = y = heading = 0.0
    for kind, length, start, end in design.pieces:
        curve: Curve
        if kind == "line":
            curve = Line(s, x, y, heading, length)
        elif kind == "arc":
            curve = Arc(s, x, y, heading, length, start)
        else:
            curve = Spiral(s, x, y, heading, length, start, end)
        curves.append(curve)
        last = curve.at(length)
        s, x, y, heading = s + length, last.x, last.y, last.heading
    return curves


def write(design: MapDesign) -> bytes:
    """Return the OpenDRIVE 1.7 file of a design."""
    root = etree.Element("OpenDRIVE")
    header = {"revMajor": "1", "revMinor": "7", "name": design.name, "version": "1.0"}
    etree.SubElement(root, "header", header)
    curves = curves_of(design)
    length = sum(curve.length for curve in curves)
    road = etree.SubElement(
        root, "road", name=design.name, length=_text(length), id="1", junction="-1", rule="RHT"
    )
    kind = etree.SubElement(road, "type", s="0", type=design.type)
    etree.SubElement(kind, "speed", max=str(design.speed_km_h), unit="km/h")
    plan = etree.SubElement(road, "planView")
    for curve in curves:
        _add_curve(plan, curve)
    profile = etree.SubElement(road, "elevationProfile")
    for s, *coefficients in design.elevation:
        row = dict(zip("abcd", map(_text, coefficients), strict=True))
        etree.SubElement(profile, "elevation", {"s": _text(s), **row})
    lanes = etree.SubElement(road, "lanes")
    section = etree.SubElement(lanes, "laneSection", s="0")
    numbered = list(enumerate(design.left, start=1))[::-1]
    _add_lanes(section, "left", numbered)
    centre = etree.SubElement(etree.SubElement(section, "center"), "lane", id="0", type="none")
    _add_mark(centre, design.centre_mark)
    _add_lanes(section, "right", [(-i, lane) for i, lane in enumerate(design.right, start=1)])
    etree.indent(root)
    return bytes(etree.tostring(root, xml_declaration=True, encoding="UTF-8")) + b"\n"


def _add_curve(plan: etree._Element, curve: Curve) -> None:
    place = {"s": curve.s, "x": curve.x, "y": curve.y, "hdg": curve.heading, "length": curve.length}
    geometry = etree.SubElement(plan, "geometry", {k: _text(v) for k, v in place.items()})
    if isinstance(curve, Arc):
        etree.SubElement(geometry, "arc", curvature=_text(curve.curvature))
    elif isinstance(curve, Spiral):
        ends = {"curvStart": curve.curvature_start, "curvEnd": curve.curvature_end}
        etree.SubElement(geometry, "spiral", {k: _text(v) for k, v in ends.items()})
    else:
        etree.SubElement(geometry, "line")


def _add_lanes(section: etree._Element, side: str, lanes: Sequence[tuple[int, LaneDesign]]) -> None:
    group = etree.SubElement(section, side)
    for number, lane in lanes:
        element = etree.SubElement(group, "lane", id=str(number), type=lane.type, level="false")
        etree.SubElement(element, "width", sOffset="0", a=_text(lane.width), b="0", c="0", d="0")
        _add_mark(element, lane.mark)


def _add_mark(lane: etree._Element, mark: str) -> None:
    facts = {"sOffset": "0", "type": mark, "weight": "standard", "color": "standard"}
    if mark not in ("none", "curb"):
        facts |= {"width": "0.12", "laneChange": "both" if mark == "broken" else "none"}
    etree.SubElement(lane, "roadMark", facts)


def _text(value: float) -> str:
    return format(round(value, 12) + 0.0, ".12g")


def main(arguments: Sequence[str]) -> None:
    """Write all maps into a folder."""
    folder = Path(arguments[0]) if arguments else Path(__file__).parent
    for design in DESIGNS:
        (folder / f"{design.id}.xodr").write_bytes(write(design))


if __name__ == "__main__":
    main(sys.argv[1:])
