"""Reads the part of ASAM OpenDRIVE that driving needs.

It covers plan view, elevation, lanes with their marks and links, junctions, signals, crosswalks, stop lines,
tunnels and bridges. The reader trusts nothing: an unusable file raises a `DataError` that lists
all faults found, in time and memory that do not depend on the file's claims. Superelevation and
road shape are ignored: roads are level across.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

from lxml import etree

from oodscen.driving._roads.document import MAX_BYTES, Document, child, children, label, name_of
from oodscen.driving._roads.furniture import read_patches, read_signals, read_stretches
from oodscen.driving._roads.geometry import Arc, Cubic, Curve, Line, ParamPoly3, Poly3, Spiral
from oodscen.driving._roads.network import (
    Connection,
    Contact,
    Junction,
    Lane,
    LaneSection,
    Network,
    Road,
    RoadLink,
)

__all__ = ["MAX_BYTES", "MAX_ROAD_LENGTH", "read_network"]

MAX_ROAD_LENGTH = 50_000.0
_MAX_ROADS = 5_000
_MAX_PIECES = 100_000
"""Maximum number of geometries in all roads together."""
_MAX_TOTAL_LENGTH = 500_000.0
_MAX_TURN = 20_000.0
"""Maximum total turn of all roads, rad."""
_MAX_SECTIONS = 1_000
_MAX_LANES = 64
"""Maximum number of lanes in one lane section."""
_WIDTHS = (-1.0, 60.0)
_OFFSETS = (-200.0, 200.0)
_HEIGHTS = (-10_000.0, 10_000.0)
_GAP = 0.1
"""Distance between two pieces of a plan view above which the road is broken, m."""
_KINK = 0.05
"""Angle between two pieces of a plan view above which the road is broken, rad."""


def read_network(data: bytes, *, source: str = "") -> Network:
    """Read all roads and junctions from the bytes of an OpenDRIVE file.

    Args:
        data: The file's content.
        source: The origin of the bytes, for error messages.

    Raises:
        DataError: With every fault of the file.
    """
    document = Document(source)
    root = document.parse(data)
    elements = document.limited(children(root, "road"), _MAX_ROADS, "", "roads")
    if not elements:
        document.fail("", "no road")
    reader = _Reader(document)
    roads: dict[str, Road] = {}
    for element in elements:
        if element.get("id", "") in roads:
            document.add(f"road[{label(element)}]@id", "is the id of an earlier road, too")
        road = reader.road(element)
        if road is not None:
            roads[road.id] = road
    junctions: dict[str, Junction] = {}
    for element in document.limited(children(root, "junction"), _MAX_ROADS, "", "junctions"):
        junction = _junction(document, element)
        if junction.id in junctions:
            document.add(f"junction[{label(element)}]@id", "is the id of an earlier one, too")
        junctions[junction.id] = junction
    network = Network(roads, junctions)
    if not document.issues:
        _check_links(document, network)
    if document.issues:
        raise document.error()
    return network


class _Reader:
    """Reads roads and enforces the limits on all of them together."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self.pieces = 0
        self.length = 0.0
        self.turn = 0.0

    def road(self, element: etree._Element) -> Road | None:
        document = self.document
        before = len(document.issues)
        path = f"road[{label(element)}]"
        length = document.number(element, "length", path)
        if not 0.0 < length <= MAX_ROAD_LENGTH:
            document.add(f"{path}@length", f"must be above 0 and at most {MAX_ROAD_LENGTH:g}")
        self.length += max(length, 0.0)
        if self.length > _MAX_TOTAL_LENGTH:
            document.fail("", f"the roads are longer than {_MAX_TOTAL_LENGTH:g} m together")
        curves = self._plan_view(element, path, length)
        profile = children(element, "elevationProfile", "elevation")
        elevation = _pieces(document, profile, f"{path}/elevationProfile/elevation", "s")
        _check_range(document, elevation, length, _HEIGHTS, f"{path}/elevationProfile")
        lanes = child(element, "lanes")
        if lanes is None:
            document.add(f"{path}/lanes", "is missing")
            return None
        offset = _pieces(document, children(lanes, "laneOffset"), f"{path}/lanes/laneOffset", "s")
        _check_range(document, offset, length, _OFFSETS, f"{path}/lanes/laneOffset")
        sections = _sections(document, lanes, f"{path}/lanes", length)
        predecessor, successor = (
            _link(document, element, end, path) for end in ("predecessor", "successor")
        )
        junction = element.get("junction", "-1")
        road = Road(
            id=element.get("id", ""),
            length=length,
            left_hand=element.get("rule", "RHT") == "LHT",
            curves=tuple(curves),
            elevation=elevation,
            lane_offset=offset,
            sections=tuple(sections),
            speed_limit=_speed(document, element, path),
            junction="" if junction == "-1" else junction,
            predecessor=predecessor,
            successor=successor,
            signals=read_signals(document, element, path),
            patches=read_patches(document, element, path),
            stretches=read_stretches(document, element, path),
        )
        return road if len(document.issues) == before else None

    def _plan_view(self, road: etree._Element, path: str, length: float) -> list[Curve]:
        document = self.document
        elements = children(road, "planView", "geometry")
        if not elements:
            document.add(f"{path}/planView", "has no geometry")
        self.pieces += len(elements)
        if self.pieces > _MAX_PIECES:
            document.fail(f"{path}/planView", f"the file has more than {_MAX_PIECES} geometries")
        curves: list[Curve] = []
        total = 0.0
        for index, element in enumerate(elements):
            here = f"{path}/planView/geometry[{index}]"
            curve = self._curve(element, here)
            if curve is None:
                continue
            total += curve.length
            if total > 2.0 * MAX_ROAD_LENGTH:
                break
            if curves:
                _check_joint(document, curves[-1], curve, here)
            elif abs(curve.s) > _GAP:
                document.add(f"{here}@s", "the first geometry must start at 0")
            curves.append(curve)
        if curves and len(curves) == len(elements) and abs(total - length) > _GAP + 1e-3 * length:
            document.add(
                f"{path}@length", f"{length:g} m, but the geometries add up to {total:g} m"
            )
        return curves

    def _curve(self, element: etree._Element, here: str) -> Curve | None:
        number = self.document.number
        s, x, y, heading, length = (
            number(element, name, here) for name in ("s", "x", "y", "hdg", "length")
        )
        if not 1e-6 < length <= MAX_ROAD_LENGTH:
            self.document.add(f"{here}@length", "must be above 0")
            return None
        base = (s, x, y, math.remainder(heading, math.tau), length)
        shape = next((one for one in element if name_of(one) in _SHAPES), None)
        if shape is None:
            self.document.add(here, f"needs one of {', '.join(_SHAPES)}")
            return None
        kind = name_of(shape)
        inner = f"{here}/{kind}"
        if kind == "line":
            return Line(*base)
        if kind in ("arc", "spiral"):
            names = ("curvature",) if kind == "arc" else ("curvStart", "curvEnd")
            bends = [number(shape, name, inner, limit=2.0) for name in names]
            self.turn += length * max(abs(bend) for bend in bends)
            if self.turn > _MAX_TURN:
                self.document.fail(here, f"the roads turn by more than {_MAX_TURN:g} rad together")
            return Arc(*base, bends[0]) if kind == "arc" else Spiral(*base, bends[0], bends[1])
        if kind == "poly3":
            a, b, c, d = (number(shape, name, inner) for name in "abcd")
            return Poly3(*base, (a, b, c, d))
        au, bu, cu, du = (number(shape, f"{name}U", inner) for name in "abcd")
        av, bv, cv, dv = (number(shape, f"{name}V", inner) for name in "abcd")
        scale = 1.0 if shape.get("pRange", "normalized") == "normalized" else length
        curve = ParamPoly3(*base, (au, bu, cu, du), (av, bv, cv, dv), scale)
        if not abs(curve.arc - length) <= 0.5 + 0.1 * length:
            self.document.add(f"{here}@length", f"{length:g} m, but the curve is {curve.arc:g} m")
        return curve


def _check_joint(document: Document, before: Curve, after: Curve, here: str) -> None:
    last = before.s + before.length
    if abs(last - after.s) > _GAP:
        document.add(f"{here}@s", f"{after.s:g}, but the last one ends at {last:g}")
    end, start = before.at(before.length), after.at(0.0)
    gap = math.sqrt((end.x - start.x) ** 2 + (end.y - start.y) ** 2)
    if not gap <= _GAP:
        document.add(here, f"starts {gap:.3g} m away from the end of the last geometry")
    kink = abs(math.remainder(end.heading - start.heading, math.tau))
    if not kink <= _KINK:
        document.add(f"{here}@hdg", f"turns by {kink:.3g} rad at the end of the last geometry")


def _pieces(
    document: Document, elements: list[etree._Element], where: str, key: str
) -> tuple[Cubic, ...]:
    pieces: list[Cubic] = []
    for index, element in enumerate(elements):
        here = f"{where}[{index}]"
        start, a, b, c, d = (document.number(element, name, here) for name in (key, *"abcd"))
        if pieces and start < pieces[-1].start:
            document.add(f"{here}@{key}", "must not be below the one before")
        pieces.append(Cubic(start, a, b, c, d))
    return tuple(pieces)


def _check_range(
    document: Document,
    pieces: Sequence[Cubic],
    end: float,
    limits: tuple[float, float],
    where: str,
) -> None:
    """Record a fault for polynomials that leave the allowed range where they apply."""
    low, high = limits
    for index, piece in enumerate(pieces):
        last = pieces[index + 1].start if index + 1 < len(pieces) else end
        begin = min(piece.start, last)
        for part in (0.0, 0.25, 0.5, 0.75, 1.0):
            value = piece.at(begin + part * (last - begin))
            if not low <= value <= high:
                document.add(
                    f"{where}[{index}]", f"becomes {value:.3g} m; {low:g} to {high:g} are allowed"
                )
                break


def _speed(document: Document, road: etree._Element, path: str) -> float | None:
    factors = {"m/s": 1.0, "km/h": 1.0 / 3.6, "mph": 0.44704}
    for kind in children(road, "type"):
        speed = child(kind, "speed")
        if speed is not None and speed.get("max") not in (None, "no limit", "undefined"):
            value = document.number(speed, "max", f"{path}/type/speed", limit=500.0)
            return max(value, 0.0) * factors.get(speed.get("unit", "m/s"), 1.0)
    return None


def _link(document: Document, road: etree._Element, end: str, path: str) -> RoadLink | None:
    link = child(road, "link")
    element = None if link is None else child(link, end)
    if element is None:
        return None
    where = f"{path}/link/{end}"
    kind, identity = element.get("elementType", "road"), element.get("elementId")
    if identity is None:
        document.add(f"{where}@elementId", "is missing")
        return None
    if kind == "junction":
        return RoadLink("junction", identity)
    if kind != "road":
        document.add(f"{where}@elementType", f"{kind[:40]!r} is neither road nor junction")
        return None
    return RoadLink("road", identity, _contact(document, element, where, "start"))


def _contact(document: Document, element: etree._Element, where: str, default: Contact) -> Contact:
    contact = element.get("contactPoint", default)
    if contact == "start":
        return "start"
    if contact != "end":
        document.add(f"{where}@contactPoint", f"{contact[:40]!r} is neither start nor end")
    return "end"


# ---------------------------------------------------------------------- lanes


def _sections(
    document: Document, lanes: etree._Element, path: str, length: float
) -> list[LaneSection]:
    sections: list[LaneSection] = []
    elements = children(lanes, "laneSection")
    if not elements:
        document.add(path, "has no laneSection")
    elements = list(document.limited(elements, _MAX_SECTIONS, path, "lane sections"))
    starts = [
        document.number(element, "s", f"{path}/laneSection[{index}]")
        for index, element in enumerate(elements)
    ]
    for index, (s, element) in enumerate(zip(starts, elements, strict=True)):
        here = f"{path}/laneSection[{index}]"
        if index == 0 and abs(s) > _GAP:
            document.add(f"{here}@s", "the first section must start at 0")
        if index and s <= starts[index - 1]:
            document.add(f"{here}@s", "must be above the one before")
        if s >= length > 0.0:
            document.add(f"{here}@s", "lies behind the road's end")
        end = starts[index + 1] if index + 1 < len(starts) else length
        sections.append(LaneSection(s, _lanes(document, element, here, end - s)))
    return sections


def _lanes(
    document: Document, section: etree._Element, path: str, length: float
) -> tuple[Lane, ...]:
    lanes: list[Lane] = []
    for side, sign in (("left", 1), ("center", 0), ("right", -1)):
        elements = children(section, side, "lane")
        for element in document.limited(elements, _MAX_LANES, path, "lanes on one side"):
            lane = _lane(document, element, sign, f"{path}/{side}", length)
            if lane is not None:
                lanes.append(lane)
    ids = sorted((lane.id for lane in lanes), reverse=True)
    if 0 not in ids:
        document.add(f"{path}/center", "has no lane 0")
    if ids and ids != list(range(ids[0], ids[-1] - 1, -1)):
        document.add(path, f"lane ids must be unique and without a gap, not {ids[:20]}")
    if len(ids) < 2:
        document.add(path, "has no lane beside the centre")
    return tuple(sorted(lanes, key=lambda lane: -lane.id))


def _lane(
    document: Document, element: etree._Element, sign: int, path: str, length: float
) -> Lane | None:
    number = document.lane_id(element.get("id"), f"{path}/lane@id")
    if number is None:
        return None
    here = f"{path}/lane[{number}]"
    if (number > 0) - (number < 0) != sign:
        document.add(f"{here}@id", "is on the wrong side")
    widths = _pieces(document, children(element, "width"), f"{here}/width", "sOffset")
    if number != 0 and not widths:
        document.add(f"{here}/width", "is missing (lane borders are not supported)")
    if widths and abs(widths[0].start) > _GAP:
        document.add(f"{here}/width[0]@sOffset", "the first width must start at 0")
    if widths:
        widths = (replace(widths[0], start=0.0), *widths[1:])
    _check_range(document, widths, length, _WIDTHS, f"{here}/width")
    marks = children(element, "roadMark")
    ends: list[int | None] = []
    for end in ("predecessor", "successor"):
        found = children(element, "link", end)
        where = f"{here}/link/{end}@id"
        ends.append(document.lane_id(found[0].get("id"), where) if found else None)
    return Lane(
        id=number,
        type=element.get("type", "none"),
        widths=widths,
        mark=marks[0].get("type", "none") if marks else "none",
        predecessor=ends[0],
        successor=ends[1],
        reversed=element.get("direction") == "reversed",
    )


_SHAPES = ("line", "arc", "spiral", "poly3", "paramPoly3")


# ---------------------------------------------------------------------- junctions


def _junction(document: Document, element: etree._Element) -> Junction:
    path = f"junction[{label(element)}]"
    connections = []
    for index, one in enumerate(children(element, "connection")):
        here = f"{path}/connection[{index}]"
        incoming = one.get("incomingRoad")
        connecting = one.get("connectingRoad", one.get("linkedRoad"))
        if incoming is None or connecting is None:
            document.add(here, "needs incomingRoad and connectingRoad")
            continue
        pairs = []
        for pair in children(one, "laneLink"):
            start, end = (
                document.lane_id(pair.get(name), f"{here}/laneLink@{name}")
                for name in ("from", "to")
            )
            if start is not None and end is not None:
                pairs.append((start, end))
        contact = _contact(document, one, here, "start")
        connections.append(Connection(incoming, connecting, contact, tuple(pairs)))
    return Junction(element.get("id", ""), tuple(connections))


def _check_links(document: Document, network: Network) -> None:
    """Record a fault for links to roads, junctions and lanes that the file lacks."""
    for road in network.roads.values():
        path = f"road[{road.id[:40]}]"
        if road.junction and road.junction not in network.junctions:
            document.add(f"{path}@junction", f"no junction {road.junction[:40]!r}")
        for end, link in (("predecessor", road.predecessor), ("successor", road.successor)):
            known = network.roads if link and link.kind == "road" else network.junctions
            if link and link.id not in known:
                document.add(f"{path}/link/{end}@elementId", f"no {link.kind} {link.id[:40]!r}")
    for junction in network.junctions.values():
        for index, one in enumerate(junction.connections):
            path = f"junction[{junction.id[:40]}]/connection[{index}]"
            for name, identity in (
                ("incomingRoad", one.incoming),
                ("connectingRoad", one.connecting),
            ):
                if identity not in network.roads:
                    document.add(f"{path}@{name}", f"no road {identity[:40]!r}")
            through = network.roads.get(one.connecting)
            if through is not None:
                section = through.sections[0 if one.contact == "start" else -1]
                ids = {lane.id for lane in section.lanes}
                for _, to in one.lanes:
                    if to not in ids:
                        document.add(f"{path}/laneLink@to", f"no lane {to} on {through.id[:40]!r}")
