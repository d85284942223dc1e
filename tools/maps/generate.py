"""Writes the shipped OpenDRIVE maps.

Run `python -m tools.maps.generate [FOLDER]` after changing a design; without a folder it replaces
the shipped files. The same design always gives the same bytes.
"""

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from lxml import etree

from oodscen.driving._roads.geometry import Arc, Curve, Spiral
from tools.maps.crossings import CROSSINGS
from tools.maps.design import (
    JunctionDesign,
    LaneDesign,
    MapDesign,
    PatchDesign,
    RoadDesign,
    SectionDesign,
    SignalDesign,
    StretchDesign,
    curves_of,
)
from tools.maps.exits import EXITS
from tools.maps.streets import STREETS

Facts = dict[str, str | float]
"""The attributes of an element."""

SHIPPED = Path(__file__).parents[2] / "oodscen" / "driving" / "maps"

DESIGNS: tuple[MapDesign, ...] = (*STREETS, *CROSSINGS, *EXITS)
"""All shipped maps; in each, the ego starts 200 m after the beginning of the first road."""


def write(design: MapDesign) -> bytes:
    """Return the OpenDRIVE 1.7 file of a design."""
    root = etree.Element("OpenDRIVE")
    header = {"revMajor": "1", "revMinor": "7", "name": design.name, "version": "1.0"}
    _add(root, "header", header)
    for road in design.roads:
        _add_road(root, road)
    for junction in design.junctions:
        _add_junction(root, junction)
    etree.indent(root)
    return bytes(etree.tostring(root, xml_declaration=True, encoding="UTF-8")) + b"\n"


def _add(parent: etree._Element, tag: str, facts: Mapping[str, str | float]) -> etree._Element:
    """Add an element; numbers among its attributes are written out."""
    texts = {key: one if isinstance(one, str) else _text(one) for key, one in facts.items()}
    return etree.SubElement(parent, tag, texts)


def _add_road(root: etree._Element, design: RoadDesign) -> None:
    curves = curves_of(design)
    length = sum(curve.length for curve in curves)
    facts = {"name": design.name, "length": length, "id": design.id}
    road = _add(root, "road", {**facts, "junction": design.junction, "rule": "RHT"})
    if design.predecessor or design.successor:
        links = etree.SubElement(road, "link")
        for end, link in (("predecessor", design.predecessor), ("successor", design.successor)):
            if link is not None:
                meets = {"elementType": link.kind, "elementId": link.id}
                contact = {"contactPoint": link.contact} if link.kind == "road" else {}
                _add(links, end, {**meets, **contact})
    kind = _add(road, "type", {"s": 0.0, "type": design.type})
    _add(kind, "speed", {"max": design.speed_km_h, "unit": "km/h"})
    plan = etree.SubElement(road, "planView")
    for curve in curves:
        _add_curve(plan, curve)
    profile = etree.SubElement(road, "elevationProfile")
    for row in design.elevation:
        _add(profile, "elevation", dict(zip("sabcd", row, strict=True)))
    lanes = etree.SubElement(road, "lanes")
    for section in design.sections:
        _add_section(lanes, section)
    if design.patches or design.stretches:
        objects = etree.SubElement(road, "objects")
        for patch in design.patches:
            _add_patch(objects, patch)
        for stretch in design.stretches:
            _add_stretch(objects, stretch)
    if design.signals:
        signals = etree.SubElement(road, "signals")
        for signal in design.signals:
            _add_signal(signals, signal)


def _add_curve(plan: etree._Element, curve: Curve) -> None:
    place = {"s": curve.s, "x": curve.x, "y": curve.y, "hdg": curve.heading, "length": curve.length}
    geometry = _add(plan, "geometry", place)
    if isinstance(curve, Arc):
        _add(geometry, "arc", {"curvature": curve.curvature})
    elif isinstance(curve, Spiral):
        ends = {"curvStart": curve.curvature_start, "curvEnd": curve.curvature_end}
        _add(geometry, "spiral", ends)
    else:
        etree.SubElement(geometry, "line")


def _add_section(lanes: etree._Element, design: SectionDesign) -> None:
    section = _add(lanes, "laneSection", {"s": design.s})
    numbered = list(enumerate(design.left, start=1))[::-1]
    if numbered:
        _add_lanes(section, "left", numbered)
    centre = _add(etree.SubElement(section, "center"), "lane", {"id": "0", "type": "none"})
    _add_mark(centre, design.centre_mark)
    if design.right:
        _add_lanes(section, "right", [(-i, lane) for i, lane in enumerate(design.right, start=1)])


def _add_lanes(section: etree._Element, side: str, lanes: Sequence[tuple[int, LaneDesign]]) -> None:
    group = etree.SubElement(section, side)
    for number, lane in lanes:
        element = _add(group, "lane", {"id": number, "type": lane.type, "level": "false"})
        if lane.predecessor is not None or lane.successor is not None:
            link = etree.SubElement(element, "link")
            for end, other in (("predecessor", lane.predecessor), ("successor", lane.successor)):
                if other is not None:
                    _add(link, end, {"id": other})
        rows = lane.width
        if not isinstance(rows, tuple):
            rows = ((0.0, rows, 0.0, 0.0, 0.0),)
        for row in rows:
            _add(element, "width", dict(zip(("sOffset", *"abcd"), row, strict=True)))
        _add_mark(element, lane.mark)


def _add_mark(lane: etree._Element, mark: str) -> None:
    facts = {"sOffset": "0", "type": mark, "weight": "standard", "color": "standard"}
    if mark not in ("none", "curb"):
        facts |= {"width": "0.12", "laneChange": "both" if mark == "broken" else "none"}
    _add(lane, "roadMark", facts)


def _add_patch(objects: etree._Element, patch: PatchDesign) -> None:
    is_crosswalk = patch.kind == "crosswalk"
    facts: Facts = {
        "id": patch.id,
        "name": "Crosswalk" if is_crosswalk else "StopLine",
        "type": "crosswalk" if is_crosswalk else "roadMark",
        "s": patch.s,
        "t": patch.t,
        **dict.fromkeys(("zOffset", "hdg", "roll", "pitch"), 0.0),
        "orientation": "none",
        "length": patch.length,
        "width": patch.width,
        "height": 0.0,
    }
    outlines = etree.SubElement(_add(objects, "object", facts), "outlines")
    outline = _add(outlines, "outline", {"id": "0"})
    u, v = 0.5 * patch.length, 0.5 * patch.width
    for index, (along, across) in enumerate(((-u, -v), (u, -v), (u, v), (-u, v), (-u, -v))):
        place = {"u": along, "v": across, "z": 0.0, "height": 0.0, "id": index}
        _add(outline, "cornerLocal", place)


def _add_stretch(objects: etree._Element, stretch: StretchDesign) -> None:
    facts: Facts = {
        "id": stretch.id,
        "name": stretch.name,
        "s": stretch.s,
        "length": stretch.length,
    }
    if stretch.kind == "tunnel":
        facts |= {"type": "standard", "lighting": 0.5, "daylight": 0.5}
    else:
        facts |= {"type": "concrete"}
    _add(objects, stretch.kind, facts)


def _add_signal(signals: etree._Element, signal: SignalDesign) -> None:
    facts: Facts = {
        "id": signal.id,
        "name": signal.name,
        "s": signal.s,
        "t": signal.t,
        "dynamic": "yes" if signal.is_dynamic else "no",
        "orientation": signal.orientation,
        "zOffset": signal.bottom,
        "country": signal.country,
        "type": signal.type,
        "subtype": "-1",
        "height": signal.height,
        "width": signal.width,
        "hOffset": "0",
    }
    if signal.value is not None:
        facts |= {"value": signal.value, "unit": signal.unit}
    _add(signals, "signal", facts)


def _add_junction(root: etree._Element, design: JunctionDesign) -> None:
    junction = _add(root, "junction", {"id": design.id, "name": design.name})
    for number, connection in enumerate(design.connections):
        facts: Facts = {
            "id": number,
            "incomingRoad": connection.incoming,
            "connectingRoad": connection.connecting,
            "contactPoint": "start",
        }
        element = _add(junction, "connection", facts)
        for start, end in connection.lanes:
            _add(element, "laneLink", {"from": start, "to": end})


def _text(value: float) -> str:
    return format(round(value, 12) + 0.0, ".12g")


def main(arguments: Sequence[str]) -> None:
    """Write all maps to a folder."""
    folder = Path(arguments[0]) if arguments else SHIPPED
    for design in DESIGNS:
        (folder / f"{design.id}.xodr").write_bytes(write(design))


if __name__ == "__main__":
    main(sys.argv[1:])
