"""Reads the part of ASAM OpenDRIVE that driving needs.

It covers plan view, elevation, lanes with their marks and links, junctions, signals, crosswalks, stop lines,
tunnels and bridges. The reader trusts nothing: an unusable file raises a `DataError` that lists
all faults found, in time and memory that do not depend on the file's claims. Superelevation and
road shape are ignored: roads are level across.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

from oodscen.driving._roads.document import Document, XmlNode, name_of
from oodscen.driving._roads.furniture import read_patches, read_signals, read_stretches
from oodscen.driving._roads.geometry import Arc, Cubic, Curve, Line, ParamPoly3, Poly3, Spiral
from oodscen.driving._roads.network import (
    Contact,
    Junction,
    JunctionWay,
    Lane,
    LaneSection,
    Network,
    Road,
    RoadLink,
)

_MAX_ROAD_LENGTH_M = 50_000.0
_MAX_ROADS = 5_000
_MAX_PIECES = 100_000
"""Maximum number of geometries in all roads together."""
_MAX_TOTAL_LENGTH_M = 500_000.0
_MAX_TURN_RAD = 20_000.0
"""Maximum total turn of all roads, rad."""
_MAX_SECTIONS = 1_000
_MAX_LANES = 64
"""Maximum number of lanes in one lane section."""
_WIDTHS_M = (-1.0, 60.0)
_OFFSETS_M = (-200.0, 200.0)
_HEIGHTS_M = (-10_000.0, 10_000.0)
_SHAPES = ("line", "arc", "spiral", "poly3", "paramPoly3")
_GAP_M = 0.1
"""Distance between two pieces of a plan view above which the road is broken, m."""
_KINK_RAD = 0.05
"""Angle between two pieces of a plan view above which the road is broken, rad."""
_UNITS_MPS = {"m/s": 1.0, "km/h": 1.0 / 3.6, "mph": 0.44704}
"""Units of speed limits in m/s."""
_SHORTEST_M = 1e-6
"""Length above which a piece of a road's line is read, m."""


def read_network(data: bytes, *, source: str = "") -> Network:
    """Read all roads and junctions from the bytes of an OpenDRIVE file; `source` is its name in messages.

    Raises:
        DataError: With every fault of the file.
    """
    document = Document(source)
    root = document.parse(data)
    nodes = root.limited(root.all("road", by="id"), _MAX_ROADS, "roads")
    if not nodes:
        document.fail("", "no road")
    reader = _Reader(document)
    roads: dict[str, Road] = {}
    for node in nodes:
        if node.get("id") in roads:
            node.fault("is the id of an earlier road, too", "@id")
        road = reader.road(node)
        if road is not None:
            roads[road.id] = road
    junctions: dict[str, Junction] = {}
    for node in root.limited(root.all("junction", by="id"), _MAX_ROADS, "junctions"):
        junction = _junction(node)
        if junction.id in junctions:
            node.fault("is the id of an earlier one, too", "@id")
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

    def road(self, node: XmlNode) -> Road | None:
        before = len(self.document.issues)
        length = node.number("length")
        if not 0.0 < length <= _MAX_ROAD_LENGTH_M:
            node.fault(f"must be above 0 and at most {_MAX_ROAD_LENGTH_M:g}", "@length")
        self.length += max(length, 0.0)
        if self.length > _MAX_TOTAL_LENGTH_M:
            self.document.fail("", f"the roads are longer than {_MAX_TOTAL_LENGTH_M:g} m together")
        curves = self._plan_view(node, length)
        elevation = _pieces(node.all("elevationProfile", "elevation"), "s")
        _check_range(node, elevation, length, _HEIGHTS_M, "/elevationProfile")
        lanes = node.first("lanes")
        if lanes is None:
            node.fault("is missing", "/lanes")
            return None
        offset = _pieces(lanes.all("laneOffset"), "s")
        _check_range(lanes, offset, length, _OFFSETS_M, "/laneOffset")
        sections = _sections(lanes, length)
        junction = node.get("junction", "-1")
        road = Road(
            id=node.get("id"),
            length=length,
            left_hand=node.get("rule", "RHT") == "LHT",
            curves=tuple(curves),
            elevation=elevation,
            lane_offset=offset,
            sections=tuple(sections),
            predecessor=_link(node, "predecessor"),
            successor=_link(node, "successor"),
            speed_limits=_speed_limits(node),
            junction="" if junction == "-1" else junction,
            signals=read_signals(node),
            patches=read_patches(node),
            stretches=read_stretches(node),
        )
        return road if len(self.document.issues) == before else None

    def _plan_view(self, road: XmlNode, length: float) -> list[Curve]:
        nodes = road.all("planView", "geometry")
        if not nodes:
            road.fault("has no geometry", "/planView")
        self.pieces += len(nodes)
        if self.pieces > _MAX_PIECES:
            message = f"the file has more than {_MAX_PIECES} geometries"
            self.document.fail(f"{road.path}/planView", message)
        curves: list[Curve] = []
        total = 0.0
        for node in nodes:
            curve = self._curve(node)
            if curve is None:
                continue
            total += curve.length
            if total > 2.0 * _MAX_ROAD_LENGTH_M:
                break
            if curves:
                _check_joint(node, curves[-1], curve)
            elif abs(curve.s) > _GAP_M:
                node.fault("the first geometry must start at 0", "@s")
            curves.append(curve)
        if curves and len(curves) == len(nodes) and abs(total - length) > _GAP_M + 1e-3 * length:
            road.fault(f"{length:g} m, but the geometries add up to {total:g} m", "@length")
        return curves

    def _curve(self, node: XmlNode) -> Curve | None:
        s, x, y, heading, length = map(node.number, ("s", "x", "y", "hdg", "length"))
        if not _SHORTEST_M < length <= _MAX_ROAD_LENGTH_M:
            node.fault("must be above 0", "@length")
            return None
        base = (s, x, y, math.remainder(heading, math.tau), length)
        kind = next((name for element in node.element if (name := name_of(element)) in _SHAPES), "")
        shape = node.first(kind) if kind else None
        if shape is None:
            node.fault(f"needs one of {', '.join(_SHAPES)}")
            return None
        if kind == "line":
            return Line(*base)
        if kind in ("arc", "spiral"):
            names = ("curvature",) if kind == "arc" else ("curvStart", "curvEnd")
            bends = [shape.number(name, limit=2.0) for name in names]
            self.turn += length * max(abs(bend) for bend in bends)
            if self.turn > _MAX_TURN_RAD:
                message = f"the roads turn by more than {_MAX_TURN_RAD:g} rad together"
                self.document.fail(node.path, message)
            return Arc(*base, bends[0]) if kind == "arc" else Spiral(*base, bends[0], bends[1])
        if kind == "poly3":
            a, b, c, d = map(shape.number, "abcd")
            return Poly3(*base, (a, b, c, d))
        au, bu, cu, du = (shape.number(f"{name}U") for name in "abcd")
        av, bv, cv, dv = (shape.number(f"{name}V") for name in "abcd")
        scale = 1.0 if shape.get("pRange", "normalized") == "normalized" else length
        curve = ParamPoly3(*base, (au, bu, cu, du), (av, bv, cv, dv), scale)
        if not abs(curve.arc - length) <= 0.5 + 0.1 * length:
            node.fault(f"{length:g} m, but the curve is {curve.arc:g} m", "@length")
        return curve


def _check_joint(node: XmlNode, before: Curve, after: Curve) -> None:
    last = before.s + before.length
    if abs(last - after.s) > _GAP_M:
        node.fault(f"{after.s:g}, but the last one ends at {last:g}", "@s")
    end, start = before.at(before.length), after.at(0.0)
    gap = math.sqrt((end.x - start.x) ** 2 + (end.y - start.y) ** 2)
    if not gap <= _GAP_M:
        node.fault(f"starts {gap:.3g} m away from the end of the last geometry")
    kink = abs(math.remainder(end.heading - start.heading, math.tau))
    if not kink <= _KINK_RAD:
        node.fault(f"turns by {kink:.3g} rad at the end of the last geometry", "@hdg")


def _pieces(nodes: Sequence[XmlNode], key: str) -> tuple[Cubic, ...]:
    pieces: list[Cubic] = []
    for node in nodes:
        start, a, b, c, d = map(node.number, (key, *"abcd"))
        if pieces and start < pieces[-1].start:
            node.fault("must not be below the one before", f"@{key}")
        pieces.append(Cubic(start, a, b, c, d))
    return tuple(pieces)


def _check_range(
    node: XmlNode, pieces: Sequence[Cubic], end: float, limits: tuple[float, float], at: str
) -> None:
    """Record a fault for polynomials that leave the allowed range where they apply."""
    low, high = limits
    for index, piece in enumerate(pieces):
        following = pieces[index + 1].start if index + 1 < len(pieces) else end
        span = min(following, end) - piece.start
        if span < 0.0:
            break  # It begins beyond the end, and so do the others.
        for part in (0.0, 0.25, 0.5, 0.75, 1.0):
            value = piece.at(piece.start + part * span)
            if not low <= value <= high:
                message = f"becomes {value:.3g} m; {low:g} to {high:g} are allowed"
                node.fault(message, f"{at}[{index}]")
                break


def _speed_limits(road: XmlNode) -> tuple[tuple[float, float | None], ...]:
    return tuple(
        (kind.number("s", default=0.0), _speed(kind)) for kind in road.all("type", by="name")
    )


def _speed(kind: XmlNode) -> float | None:
    speed = kind.first("speed")
    if speed is None or speed.get("max", "no limit") in ("no limit", "undefined"):
        return None
    value = speed.number("max", limit=500.0)
    if value < 0.0:
        speed.fault(f"{value:g} is negative", "@max")
    unit = speed.get("unit", "m/s")
    if unit not in _UNITS_MPS:
        speed.fault(f"{unit[:40]!r} is none of {', '.join(_UNITS_MPS)}", "@unit")
    return max(value, 0.0) * _UNITS_MPS.get(unit, 1.0)


def _link(road: XmlNode, end: str) -> RoadLink | None:
    link = road.first("link")
    node = None if link is None else link.first(end)
    if node is None:
        return None
    kind, identity = node.get("elementType", "road"), node.element.get("elementId")
    if identity is None:
        node.fault("is missing", "@elementId")
        return None
    if kind == "junction":
        return RoadLink("junction", identity)
    if kind != "road":
        node.fault(f"{kind[:40]!r} is neither road nor junction", "@elementType")
        return None
    return RoadLink("road", identity, _contact(node))


def _contact(node: XmlNode) -> Contact:
    contact = node.get("contactPoint", "start")
    if contact == "start":
        return "start"
    if contact != "end":
        node.fault(f"{contact[:40]!r} is neither start nor end", "@contactPoint")
    return "end"


def _sections(lanes: XmlNode, length: float) -> list[LaneSection]:
    sections: list[LaneSection] = []
    nodes = lanes.all("laneSection")
    if not nodes:
        lanes.fault("has no laneSection")
    nodes = lanes.limited(nodes, _MAX_SECTIONS, "lane sections")
    starts = [node.number("s") for node in nodes]
    for index, (s, node) in enumerate(zip(starts, nodes, strict=True)):
        if index == 0 and abs(s) > _GAP_M:
            node.fault("the first section must start at 0", "@s")
        if index and s <= starts[index - 1]:
            node.fault("must be above the one before", "@s")
        if s >= length > 0.0:
            node.fault("lies behind the road's end", "@s")
        end = starts[index + 1] if index + 1 < len(starts) else length
        sections.append(LaneSection(s, _lanes(node, end - s)))
    return sections


def _lanes(section: XmlNode, length: float) -> tuple[Lane, ...]:
    lanes: list[Lane] = []
    for side, sign in (("left", 1), ("center", 0), ("right", -1)):
        nodes = section.all(side, "lane", by="name")
        for node in section.limited(nodes, _MAX_LANES, "lanes on one side"):
            lane = _lane(node, sign, length)
            if lane is not None:
                lanes.append(lane)
    ids = sorted((lane.id for lane in lanes), reverse=True)
    if 0 not in ids:
        section.fault("has no lane 0", "/center")
    if ids and ids != list(range(ids[0], ids[-1] - 1, -1)):
        section.fault(f"lane ids must be unique and without a gap, not {ids[:20]}")
    if len(ids) < 2:
        section.fault("has no lane beside the centre")
    return tuple(sorted(lanes, key=lambda lane: -lane.id))


def _lane(node: XmlNode, sign: int, length: float) -> Lane | None:
    number = node.lane_id()
    if number is None:
        return None
    node = node.at(f"{node.path}[{number}]")
    if (number > 0) - (number < 0) != sign:
        node.fault("is on the wrong side", "@id")
    widths = _pieces(node.all("width"), "sOffset")
    if number != 0 and not widths:
        node.fault("is missing (lane borders are not supported)", "/width")
    if widths and abs(widths[0].start) > _GAP_M:
        node.fault("the first width must start at 0", "/width[0]@sOffset")
    if widths:
        widths = (replace(widths[0], start=0.0), *widths[1:])
    _check_range(node, widths, length, _WIDTHS_M, "/width")
    mark = node.first("roadMark")
    before, after = node.first("link", "predecessor"), node.first("link", "successor")
    return Lane(
        id=number,
        type=node.get("type", "none"),
        widths=widths,
        mark=mark.get("type", "none") if mark else "none",
        predecessor=before.lane_id() if before else None,
        successor=after.lane_id() if after else None,
        reversed=node.get("direction") == "reversed",
    )


def _junction(node: XmlNode) -> Junction:
    connections = []
    for connection in node.all("connection"):
        incoming = connection.element.get("incomingRoad")
        connecting = connection.element.get("connectingRoad", connection.element.get("linkedRoad"))
        if incoming is None or connecting is None:
            connection.fault("needs incomingRoad and connectingRoad")
            continue
        pairs = []
        for link in connection.all("laneLink", by="name"):
            start, end = link.lane_id("from"), link.lane_id("to")
            if start is not None and end is not None:
                pairs.append((start, end))
        connections.append(JunctionWay(incoming, connecting, _contact(connection), tuple(pairs)))
    return Junction(node.get("id"), tuple(connections))


def _check_links(document: Document, network: Network) -> None:
    """Record a fault for links to roads, junctions and lanes that the file lacks."""
    for road in network.roads.values():
        path = f"road[{road.id[:40]}]"
        if road.junction and road.junction not in network.junctions:
            document.add(f"{path}@junction", f"no junction {road.junction[:40]!r}")
        for end, link in (("predecessor", road.predecessor), ("successor", road.successor)):
            if link is None:
                continue
            targets = network.roads if link.kind == "road" else network.junctions
            if link.id not in targets:
                document.add(f"{path}/link/{end}@elementId", f"no {link.kind} {link.id[:40]!r}")
    for junction in network.junctions.values():
        for index, way in enumerate(junction.connections):
            _check_way(document, network, way, f"junction[{junction.id[:40]}]/connection[{index}]")


def _check_way(document: Document, network: Network, way: JunctionWay, path: str) -> None:
    """Record a fault for roads and lanes of a connection that the file lacks."""
    for name, road_id in (("incomingRoad", way.incoming), ("connectingRoad", way.connecting)):
        if road_id not in network.roads:
            document.add(f"{path}@{name}", f"no road {road_id[:40]!r}")
    through = network.roads.get(way.connecting)
    if through is None:
        return
    section = through.sections[0 if way.contact == "start" else -1]
    lane_ids = {lane.id for lane in section.lanes}
    for _, to in way.lanes:
        if to not in lane_ids:
            document.add(f"{path}/laneLink@to", f"no lane {to} on {through.id[:40]!r}")
