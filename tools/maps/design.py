"""Building blocks of map designs."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from oodscen.driving._roads.geometry import Arc, Curve, Line, Spiral

Row = tuple[float, float, float, float, float]
"""Start of a cubic, and its coefficients a, b, c, d."""
Piece = tuple[str, float, float, float]
"""Kind, length, start and end curvature of a geometry."""
Pose = tuple[float, float, float]
"""x, y, heading."""


@dataclass(frozen=True)
class LaneDesign:
    """One lane: its type, width in metres and the mark on its outer edge."""

    type: str
    width: float | tuple[Row, ...]
    mark: str = "none"
    predecessor: int | None = None
    successor: int | None = None


@dataclass(frozen=True)
class SectionDesign:
    """A cross-section that starts at `s`."""

    right: tuple[LaneDesign, ...]
    """Lanes from the reference line outwards."""
    left: tuple[LaneDesign, ...]
    centre_mark: str
    s: float = 0.0


@dataclass(frozen=True)
class LinkDesign:
    """The successor or predecessor of a road."""

    kind: Literal["road", "junction"]
    id: str
    contact: Literal["start", "end"] = "start"


@dataclass(frozen=True)
class SignalDesign:
    """A traffic light or sign beside a road."""

    id: str
    name: str
    s: float
    t: float
    type: str
    orientation: str = "+"
    country: str = "DE"
    is_dynamic: bool = False
    bottom: float = 2.1
    """Height of its lower edge, m."""
    height: float = 0.75
    width: float = 0.75
    value: float | None = None
    unit: str = ""


@dataclass(frozen=True)
class PatchDesign:
    """A rectangle on the road: a crosswalk or a stop line."""

    id: str
    kind: Literal["crosswalk", "stop_line"]
    s: float
    """Position of its centre along the road, m."""
    t: float
    length: float
    """Size along the road, m."""
    width: float
    """Size across the road, m."""


@dataclass(frozen=True)
class StretchDesign:
    """A tunnel or a bridge on a road."""

    kind: Literal["tunnel", "bridge"]
    id: str
    name: str
    s: float
    length: float


@dataclass(frozen=True)
class RoadDesign:
    """One road."""

    id: str
    name: str
    type: str
    speed_km_h: int
    pieces: tuple[Piece, ...]
    sections: tuple[SectionDesign, ...]
    start: Pose = (0.0, 0.0, 0.0)
    elevation: tuple[Row, ...] = ((0.0, 0.0, 0.0, 0.0, 0.0),)
    junction: str = "-1"
    predecessor: LinkDesign | None = None
    successor: LinkDesign | None = None
    signals: tuple[SignalDesign, ...] = ()
    patches: tuple[PatchDesign, ...] = ()
    stretches: tuple[StretchDesign, ...] = ()

    @property
    def length(self) -> float:
        """Length of the reference line, m."""
        return sum(piece[1] for piece in self.pieces)


@dataclass(frozen=True)
class ConnectionDesign:
    """One connection through a junction."""

    incoming: str
    connecting: str
    lanes: tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class JunctionDesign:
    """A junction of roads."""

    id: str
    name: str
    connections: tuple[ConnectionDesign, ...]


@dataclass(frozen=True)
class MapDesign:
    """One map, written to one file."""

    id: str
    name: str
    roads: tuple[RoadDesign, ...]
    junctions: tuple[JunctionDesign, ...] = ()


def straight(length: float) -> Piece:
    """Return a straight piece of road."""
    return ("line", length, 0.0, 0.0)


def bend(transition: float, arc: float, curvature: float) -> tuple[Piece, ...]:
    """Return an arc between two spirals, which lead into it and out of it."""
    return (
        ("spiral", transition, 0.0, curvature),
        ("arc", arc, curvature, curvature),
        ("spiral", transition, curvature, 0.0),
    )


def both_ways(lanes: tuple[LaneDesign, ...], centre_mark: str = "broken") -> SectionDesign:
    """Return a cross-section with the same lanes on both sides."""
    return SectionDesign(lanes, lanes, centre_mark)


def widths_of(lanes: Sequence[LaneDesign]) -> tuple[float, ...]:
    """Return the widths of lanes that do not change theirs, m."""
    return tuple(lane.width for lane in lanes if not isinstance(lane.width, tuple))


def chained(sections: Sequence[SectionDesign], count: int) -> tuple[SectionDesign, ...]:
    """Link the lanes of sections that follow each other: the first `count` lanes on each side."""
    last = len(sections) - 1

    def linked(number: int, lanes: tuple[LaneDesign, ...], sign: int) -> tuple[LaneDesign, ...]:
        return tuple(
            replace(
                lane,
                predecessor=sign * index if number > 0 else None,
                successor=sign * index if number < last else None,
            )
            if index <= count
            else lane
            for index, lane in enumerate(lanes, start=1)
        )

    return tuple(
        replace(one, right=linked(number, one.right, -1), left=linked(number, one.left, 1))
        for number, one in enumerate(sections)
    )


def curves_of(road: RoadDesign) -> list[Curve]:
    """Chain a road's pieces, each starting where the last one ends."""
    curves: list[Curve] = []
    s = 0.0
    x, y, heading = road.start
    for kind, length, start, end in road.pieces:
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


def smooth(start: float, length: float, low: float, high: float) -> tuple[Row, ...]:
    """Return rows that change smoothly from one value to another, with zero slope at both ends.

    Args:
        start: Start of the change.
        length: Length of the change.
        low: Value before.
        high: Value after.
    """
    rise = high - low
    change = (start, low, 0.0, 3 * rise / length**2, -2 * rise / length**3)
    before = ((0.0, low, 0.0, 0.0, 0.0),) if start > 0.0 else ()
    return (*before, change, (start + length, high, 0.0, 0.0, 0.0))
