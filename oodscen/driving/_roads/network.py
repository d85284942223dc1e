"""The roads and junctions of an OpenDRIVE file, as plain data."""

from dataclasses import dataclass, field
from typing import Literal

from oodscen.driving._roads.geometry import Cubic, Curve

Contact = Literal["start", "end"]


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
    """Id of the lane in the next section, or of the next road, that continues this one."""
    reversed: bool
    """Whether traffic runs against the usual direction of this side."""
    predecessor: int | None = None
    """Id of the lane in the last section, or of the road before, that this one continues."""


@dataclass(frozen=True)
class LaneSection:
    """A stretch of road with one set of lanes."""

    s: float
    lanes: tuple[Lane, ...]
    """From left to right, lane 0 included."""


@dataclass(frozen=True)
class RoadLink:
    """What a road leads to at one of its ends."""

    kind: Literal["road", "junction"]
    id: str
    contact: Contact = "start"
    """Which end of that road is met."""


@dataclass(frozen=True)
class Signal:
    """A traffic light or sign, in its road's coordinates."""

    id: str
    name: str
    s: float
    t: float
    height: float
    """Of its lower edge above the road, m."""
    orientation: str
    """`+` addresses traffic along the reference line, `-` against it, `none` both."""
    turn: float
    """By how much it is turned from facing that traffic, rad."""
    type: str
    subtype: str
    country: str
    value: str
    is_dynamic: bool


@dataclass(frozen=True)
class Patch:
    """An area of a road's surface, in its road's coordinates."""

    kind: Literal["crosswalk", "stop_line"]
    corners: tuple[tuple[float, float], ...]
    """(s, t) of each."""


@dataclass(frozen=True)
class Stretch:
    """A part of a road that is a tunnel or a bridge."""

    kind: Literal["tunnel", "bridge"]
    start: float
    end: float


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
    junction: str = ""
    """Id of the junction that this road leads through; empty for an ordinary road."""
    predecessor: RoadLink | None = None
    successor: RoadLink | None = None
    signals: tuple[Signal, ...] = ()
    patches: tuple[Patch, ...] = ()
    stretches: tuple[Stretch, ...] = ()


@dataclass(frozen=True)
class Connection:
    """One way into a junction."""

    incoming: str
    """Id of the road before the junction."""
    connecting: str
    """Id of the road through it."""
    contact: Contact
    """Which end of the connecting road is met."""
    lanes: tuple[tuple[int, int], ...]
    """Pairs of lane ids, of the incoming and of the connecting road."""


@dataclass(frozen=True)
class Junction:
    """Where several roads meet."""

    id: str
    connections: tuple[Connection, ...]


@dataclass(frozen=True)
class Network:
    """All roads and junctions of a file."""

    roads: dict[str, Road]
    """By id, in the file's order."""
    junctions: dict[str, Junction] = field(default_factory=dict)
