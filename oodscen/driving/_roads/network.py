"""The roads and junctions of an OpenDRIVE file, as plain data."""

from dataclasses import dataclass, field
from typing import Literal

from oodscen.driving._roads.geometry import Cubic, Curve

Contact = Literal["start", "end"]
StripKind = Literal[
    "driving", "shoulder", "parking", "sidewalk", "median", "border", "rail", "none"
]

KINDS: dict[str, StripKind] = {
    **dict.fromkeys(("driving", "entry", "exit", "onRamp", "offRamp", "slipLane"), "driving"),
    **dict.fromkeys(("connectingRamp", "bidirectional", "bus", "taxi", "HOV"), "driving"),
    **dict.fromkeys(("mwyEntry", "mwyExit"), "driving"),
    **dict.fromkeys(("shoulder", "stop", "biking"), "shoulder"),
    **dict.fromkeys(("sidewalk", "walking"), "sidewalk"),
    **dict.fromkeys(("border", "curb", "restricted"), "border"),
    **dict.fromkeys(("rail", "tram"), "rail"),
    "parking": "parking",
    "median": "median",
}
"""Kinds of strips by OpenDRIVE lane type; types that are missing here become `none`."""


@dataclass(frozen=True)
class Lane:
    """One lane of a lane section."""

    id: int
    """Negative to the right of the reference line, positive to the left; 0 is the line itself."""
    type: str
    """OpenDRIVE lane type, e.g. `driving`, `shoulder`, `sidewalk`."""
    widths: tuple[Cubic, ...]
    """Width polynomials by distance from the section's start."""
    mark: str
    """OpenDRIVE mark type on the outer edge (for lane 0: the centre line)."""
    successor: int | None
    """Id of the lane in the next section or road that continues this one."""
    reversed: bool
    """True if traffic runs against the usual direction of this side."""
    predecessor: int | None = None
    """Id of the lane in the previous section or road that this one continues."""


@dataclass(frozen=True)
class LaneSection:
    """A stretch of road with a fixed set of lanes."""

    s: float
    lanes: tuple[Lane, ...]
    """Lanes from left to right, including lane 0."""


@dataclass(frozen=True)
class RoadLink:
    """The connection of a road at one of its ends."""

    kind: Literal["road", "junction"]
    id: str
    contact: Contact = "start"
    """End of the linked road at which the two meet."""


@dataclass(frozen=True)
class Signal:
    """A traffic light or sign, in its road's coordinates."""

    id: str
    name: str
    s: float
    t: float
    height: float
    """Height of its lower edge above the road, m."""
    orientation: str
    """`+` addresses traffic along the reference line, `-` against it, `none` in both directions."""
    turn: float
    """Rotation away from facing that traffic, rad."""
    type: str
    country: str
    value: str
    is_dynamic: bool


@dataclass(frozen=True)
class Patch:
    """An area of a road's surface, in its road's coordinates."""

    kind: Literal["crosswalk", "stop_line"]
    corners: tuple[tuple[float, float], ...]
    """(s, t) of each corner, m."""


@dataclass(frozen=True)
class Stretch:
    """A tunnel or bridge on a road."""

    kind: Literal["tunnel", "bridge"]
    start: float
    end: float


@dataclass(frozen=True)
class Road:
    """One road of an OpenDRIVE file."""

    id: str
    length: float
    left_hand: bool
    """True if traffic keeps to the left."""
    curves: tuple[Curve, ...]
    elevation: tuple[Cubic, ...]
    lane_offset: tuple[Cubic, ...]
    sections: tuple[LaneSection, ...]
    speed_limits: tuple[tuple[float, float | None], ...]
    """s from which each speed limit holds, and the limit, m/s; `None` where the file gives none."""
    junction: str = ""
    """Id of the junction that contains this road; empty for an ordinary road."""
    predecessor: RoadLink | None = None
    successor: RoadLink | None = None
    signals: tuple[Signal, ...] = ()
    patches: tuple[Patch, ...] = ()
    stretches: tuple[Stretch, ...] = ()

    def speed_limit(self, s: float) -> float | None:
        """Return the speed limit at `s`, m/s; `None` if the file gives none."""
        return next((limit for start, limit in self.speed_limits[::-1] if start <= s), None)


@dataclass(frozen=True)
class JunctionWay:
    """A way through a junction."""

    incoming: str
    """Id of the road before the junction."""
    connecting: str
    """Id of the connecting road through the junction."""
    contact: Contact
    """End of the connecting road at which it meets the incoming road."""
    lanes: tuple[tuple[int, int], ...]
    """Pairs of lane ids: incoming road, connecting road."""


@dataclass(frozen=True)
class Junction:
    """A junction of several roads."""

    id: str
    connections: tuple[JunctionWay, ...]


@dataclass(frozen=True)
class Network:
    """All roads and junctions of a file."""

    roads: dict[str, Road]
    """Roads by id, in the file's order."""
    junctions: dict[str, Junction] = field(default_factory=dict)
