"""Reads the part of ASAM OpenDRIVE that driving needs: plan view, elevation, lanes and their marks.

The reader trusts nothing: no entities, no network, limits on size, depth and numbers. A file that
cannot be used is a `DataError` that lists everything found wrong with it.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from lxml import etree

from oodscen.driving.geometry import Arc, Cubic, Curve, Line, ParamPoly3, Poly3, Spiral
from oodscen.errors import DataError, Issue

MAX_BYTES = 32 * 1024 * 1024
MAX_DEPTH = 32
MAX_ROAD_LENGTH = 50_000.0
_MAX_NUMBER = 1e7
_MAX_ISSUES = 100
_GAP = 0.1
"""Metres between two pieces of a plan view above which the road is broken."""
_KINK = 0.05
"""Radians between two pieces of a plan view above which the road is broken."""


@dataclass(frozen=True)
class Lane:
    """One lane of a lane section."""

    id: int
    """Negative right of the reference line, positive left of it; 0 is the line itself."""
    type: str
    """OpenDRIVE's word, e.g. `driving`, `shoulder`, `sidewalk`."""
    widths: tuple[Cubic, ...]
    """By distance from the section's start."""
    mark: str
    """OpenDRIVE's word for the mark on the outer edge (of lane 0: the centre line)."""
    successor: int | None
    """Id of the lane in the next section that continues this one."""
    reversed: bool
    """Whether traffic runs against the usual direction of this side."""


@dataclass(frozen=True)
class LaneSection:
    """A stretch of road with one set of lanes."""

    s: float
    lanes: tuple[Lane, ...]
    """From left to right, lane 0 included."""


@dataclass(frozen=True)
class Road:
    """One road of an OpenDRIVE file."""

    id: str
    length: float
    left_hand: bool
    """Whether traffic keeps to the left."""
    curves: tuple[Curve, ...]
    elevation: tuple[Cubic, ...]
    lane_offset: tuple[Cubic, ...]
    sections: tuple[LaneSection, ...]
    speed_limit: float | None
    """m/s, where the file gives one."""


def read_road(data: bytes, road_id: str = "", *, source: str = "") -> Road:
    """Read one road from the bytes of an OpenDRIVE file.

    Args:
        data: The file's content.
        road_id: OpenDRIVE id of the road; empty is the first.
        source: Where the bytes came from, for the error message.

    Raises:
        DataError: With every fault of the file and of that road.
    """
    reader = _Reader(source)
    return reader.read(data, road_id)


class _Reader:
    """Collects issues while it reads; a fault never stops the search for further ones."""

    def __init__(self, source: str) -> None:
        self.source = source
        self.issues: list[Issue] = []

    def read(self, data: bytes, road_id: str) -> Road:
        root = self._parse(data)
        roads = _children(root, "road")
        chosen = [road for road in roads if not road_id or road.get("id") == road_id]
        if not chosen:
            known = ", ".join(str(road.get("id")) for road in roads[:20])
            wanted = f"no road {road_id!r}; the file has: {known}" if roads else "no road"
            self._fail("", wanted)
        road = self._road(chosen[0])
        if self.issues or road is None:
            raise self._error()
        return road

    # ------------------------------------------------------------------ XML

    def _parse(self, data: bytes) -> etree._Element:
        if len(data) > MAX_BYTES:
            self._fail("", f"the file has {len(data)} bytes; at most {MAX_BYTES} are read")
        parser = etree.XMLParser(
            resolve_entities=False,
            no_network=True,
            huge_tree=False,
            load_dtd=False,
            dtd_validation=False,
            remove_comments=True,
            remove_pis=True,
        )
        try:
            root = etree.fromstring(data, parser)
        except (etree.XMLSyntaxError, ValueError) as error:
            self._fail("", f"not well-formed XML: {error}")
        if root.getroottree().docinfo.internalDTD is not None:
            self._fail("", "a document type declaration is not allowed")
        if _depth(root) > MAX_DEPTH:
            self._fail("", f"elements are nested more than {MAX_DEPTH} deep")
        if _name(root) != "OpenDRIVE":
            self._fail("", f"the root element is {_name(root)!r}, not 'OpenDRIVE'")
        return root

    def _error(self) -> DataError:
        return DataError("OpenDRIVE file", self.issues[:_MAX_ISSUES], source=self.source)

    def _fail(self, path: str, message: str) -> None:
        self._add(path, message)
        raise self._error()

    def _add(self, path: str, message: str) -> None:
        self.issues.append(Issue(path, message))

    def _number(
        self,
        element: etree._Element,
        name: str,
        path: str,
        *,
        default: float | None = None,
        limit: float = _MAX_NUMBER,
    ) -> float:
        """Return a finite attribute; what cannot be read is an issue and counts as the default."""
        fallback = 0.0 if default is None else default
        text = element.get(name)
        if text is None:
            if default is None:
                self._add(f"{path}@{name}", "is missing")
            return fallback
        try:
            value = float(text)
        except ValueError:
            self._add(f"{path}@{name}", f"{text[:40]!r} is not a number")
            return fallback
        if not math.isfinite(value) or abs(value) > limit:
            self._add(f"{path}@{name}", f"{text[:40]} is not within +-{limit:g}")
            return fallback
        return value

    # ------------------------------------------------------------------ road

    def _road(self, element: etree._Element) -> Road | None:
        path = f"road[{element.get('id', '?')[:40]}]"
        length = self._number(element, "length", path)
        if not 0.0 < length <= MAX_ROAD_LENGTH:
            self._add(f"{path}@length", f"must be above 0 and at most {MAX_ROAD_LENGTH:g}")
        curves = self._plan_view(element, path, length)
        elevation = self._cubics(element, ("elevationProfile", "elevation"), path)
        lanes = _child(element, "lanes")
        if lanes is None:
            self._add(f"{path}/lanes", "is missing")
            return None
        offset = self._cubics(lanes, ("laneOffset",), f"{path}/lanes")
        sections = self._sections(lanes, f"{path}/lanes", length)
        if self.issues:
            return None
        return Road(
            id=element.get("id", ""),
            length=length,
            left_hand=element.get("rule", "RHT") == "LHT",
            curves=tuple(curves),
            elevation=elevation,
            lane_offset=offset,
            sections=tuple(sections),
            speed_limit=self._speed(element, path),
        )

    def _plan_view(self, road: etree._Element, path: str, length: float) -> list[Curve]:
        plan = _child(road, "planView")
        pieces = [] if plan is None else _children(plan, "geometry")
        if not pieces:
            self._add(f"{path}/planView", "has no geometry")
        curves: list[Curve] = []
        for index, piece in enumerate(pieces):
            here = f"{path}/planView/geometry[{index}]"
            curve = self._curve(piece, here)
            if curve is None:
                continue
            if curves:
                self._check_joint(curves[-1], curve, here)
            elif abs(curve.s) > _GAP:
                self._add(f"{here}@s", "the first geometry must start at 0")
            curves.append(curve)
        total = sum(curve.length for curve in curves)
        if curves and len(curves) == len(pieces) and abs(total - length) > _GAP + 1e-3 * length:
            self._add(f"{path}@length", f"{length:g} m, but the geometries add up to {total:g} m")
        return curves

    def _curve(self, piece: etree._Element, here: str) -> Curve | None:
        s, x, y, heading, length = (
            self._number(piece, name, here) for name in ("s", "x", "y", "hdg", "length")
        )
        if not 1e-6 < length <= MAX_ROAD_LENGTH:
            self._add(f"{here}@length", "must be above 0")
            return None
        base = (s, x, y, math.remainder(heading, math.tau), length)
        shape = next((child for child in piece if _name(child) in _SHAPES), None)
        if shape is None:
            self._add(here, f"needs one of {', '.join(_SHAPES)}")
            return None
        kind = _name(shape)
        inner = f"{here}/{kind}"
        if kind == "line":
            return Line(*base)
        if kind == "arc":
            return Arc(*base, self._number(shape, "curvature", inner, limit=2.0))
        if kind == "spiral":
            ends = [
                self._number(shape, name, inner, limit=2.0) for name in ("curvStart", "curvEnd")
            ]
            return Spiral(*base, ends[0], ends[1])
        if kind == "poly3":
            a, b, c, d = (self._number(shape, name, inner) for name in "abcd")
            return Poly3(*base, (a, b, c, d))
        au, bu, cu, du = (self._number(shape, f"{name}U", inner) for name in "abcd")
        av, bv, cv, dv = (self._number(shape, f"{name}V", inner) for name in "abcd")
        scale = 1.0 if shape.get("pRange", "normalized") == "normalized" else length
        return ParamPoly3(*base, (au, bu, cu, du), (av, bv, cv, dv), scale)

    def _check_joint(self, before: Curve, after: Curve, here: str) -> None:
        if abs(before.s + before.length - after.s) > _GAP:
            self._add(
                f"{here}@s", f"{after.s:g}, but the last one ends at {before.s + before.length:g}"
            )
        end, start = before.at(before.length), after.at(0.0)
        gap = math.sqrt((end.x - start.x) ** 2 + (end.y - start.y) ** 2)
        if not gap <= _GAP:
            self._add(here, f"starts {gap:.3g} m away from the end of the last geometry")
        kink = abs(math.remainder(end.heading - start.heading, math.tau))
        if not kink <= _KINK:
            self._add(f"{here}@hdg", f"turns by {kink:.3g} rad at the end of the last geometry")

    def _cubics(
        self, parent: etree._Element, names: tuple[str, ...], path: str
    ) -> tuple[Cubic, ...]:
        elements = [parent]
        for name in names:
            elements = [child for element in elements for child in _children(element, name)]
        where = f"{path}/{'/'.join(names)}"
        return self._pieces(elements, where, "s")

    def _pieces(self, elements: list[etree._Element], where: str, key: str) -> tuple[Cubic, ...]:
        pieces: list[Cubic] = []
        for index, element in enumerate(elements):
            here = f"{where}[{index}]"
            start, a, b, c, d = (self._number(element, name, here) for name in (key, *"abcd"))
            if pieces and start < pieces[-1].start:
                self._add(f"{here}@{key}", "must not be below the one before")
            pieces.append(Cubic(start, a, b, c, d))
        return tuple(pieces)

    def _speed(self, road: etree._Element, path: str) -> float | None:
        factors = {"m/s": 1.0, "km/h": 1.0 / 3.6, "mph": 0.44704}
        for kind in _children(road, "type"):
            speed = _child(kind, "speed")
            if speed is not None and speed.get("max") not in (None, "no limit", "undefined"):
                value = self._number(speed, "max", f"{path}/type/speed")
                return value * factors.get(speed.get("unit", "m/s"), 1.0)
        return None

    # ------------------------------------------------------------------ lanes

    def _sections(self, lanes: etree._Element, path: str, length: float) -> list[LaneSection]:
        sections: list[LaneSection] = []
        elements = _children(lanes, "laneSection")
        if not elements:
            self._add(path, "has no laneSection")
        for index, element in enumerate(elements):
            here = f"{path}/laneSection[{index}]"
            s = self._number(element, "s", here)
            if index == 0 and abs(s) > _GAP:
                self._add(f"{here}@s", "the first section must start at 0")
            if sections and s <= sections[-1].s:
                self._add(f"{here}@s", "must be above the one before")
            if s >= length > 0.0:
                self._add(f"{here}@s", "lies behind the road's end")
            sections.append(LaneSection(s, self._lanes(element, here)))
        return sections

    def _lanes(self, section: etree._Element, path: str) -> tuple[Lane, ...]:
        lanes: list[Lane] = []
        for side, sign in (("left", 1), ("center", 0), ("right", -1)):
            for group in _children(section, side):
                for element in _children(group, "lane"):
                    lane = self._lane(element, sign, f"{path}/{side}")
                    if lane is not None:
                        lanes.append(lane)
        ids = sorted((lane.id for lane in lanes), reverse=True)
        if 0 not in ids:
            self._add(f"{path}/center", "has no lane 0")
        if (
            len(set(ids)) != len(ids) or ids != list(range(ids[0], ids[-1] - 1, -1))
            if ids
            else False
        ):
            self._add(path, f"lane ids must be unique and without a gap, not {ids[:20]}")
        if len(ids) < 2:
            self._add(path, "has no lane beside the centre")
        return tuple(sorted(lanes, key=lambda lane: -lane.id))

    def _lane(self, element: etree._Element, sign: int, path: str) -> Lane | None:
        number = self._integer(element.get("id"), f"{path}/lane@id")
        if number is None:
            return None
        here = f"{path}/lane[{number}]"
        if (number > 0) - (number < 0) != sign:
            self._add(f"{here}@id", "is on the wrong side")
        widths = self._pieces(_children(element, "width"), f"{here}/width", "sOffset")
        if number != 0 and not widths:
            self._add(f"{here}/width", "is missing (lane borders are not supported)")
        if widths and abs(widths[0].start) > _GAP:
            self._add(f"{here}/width[0]@sOffset", "the first width must start at 0")
        if widths:
            widths = (replace(widths[0], start=0.0), *widths[1:])
        marks = _children(element, "roadMark")
        link = _child(element, "link")
        successor = None if link is None else _child(link, "successor")
        following = None if successor is None else successor.get("id")
        return Lane(
            id=number,
            type=element.get("type", "none"),
            widths=widths,
            mark=marks[0].get("type", "none") if marks else "none",
            successor=self._integer(following, f"{here}/link/successor@id") if following else None,
            reversed=element.get("direction") == "reversed",
        )

    def _integer(self, text: str | None, path: str) -> int | None:
        if text is None or not text.strip().lstrip("+-").isascii() or len(text) > 5:
            self._add(path, "is missing or not a lane id")
            return None
        try:
            return int(text)
        except ValueError:
            self._add(path, f"{text!r} is not a lane id")
            return None


_SHAPES = ("line", "arc", "spiral", "poly3", "paramPoly3")


def _name(element: etree._Element) -> str:
    """Return an element's name without its namespace."""
    tag = element.tag
    return tag.rpartition("}")[2] if isinstance(tag, str) else ""


def _children(element: etree._Element, name: str) -> list[etree._Element]:
    return [child for child in element if _name(child) == name]


def _child(element: etree._Element, name: str) -> etree._Element | None:
    return next((child for child in element if _name(child) == name), None)


def _depth(root: etree._Element) -> int:
    """Return how deep elements are nested, without recursion."""
    level: Iterator[etree._Element]
    deepest, level = 0, iter([root])
    while members := list(level):
        deepest += 1
        if deepest > MAX_DEPTH:
            break
        level = (child for member in members for child in member)
    return deepest
