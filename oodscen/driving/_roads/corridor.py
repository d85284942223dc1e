"""The ego's road as samples along its reference line, with look-ups.

A corridor has its own coordinates: `s`, metres along the reference line in the ego's driving
direction, and `t`, metres to its left. It hides the individual roads of the map.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from oodscen._display import Brief
from oodscen.data._catalogue import Catalogue, RoadMap
from oodscen.driving._roads import track as look
from oodscen.driving._roads.coverage import (
    REACH_M,
    OverlapStrip,
    Ranges,
    covered_ranges,
    extend,
    union_of,
)
from oodscen.driving._roads.network import StripKind
from oodscen.driving._roads.track import Track, for_kernels, pack, view_track
from oodscen.numerics import _exact as exact
from oodscen.numerics._kernels import seen

DRIVABLE: frozenset[str] = frozenset({"driving", "shoulder", "parking"})
"""Kinds of strips that the ego may drive on."""

_BATCH = 2_000_000
"""Maximum number of point-sample pairs compared at once."""
_AROUND_M = (600.0, 2_600.0)
"""Distances behind and ahead of the start within which other roads count as drivable, m."""
_NARROW_M = 1e-6
"""Width from which a strip is there, m."""


@dataclass(frozen=True, eq=False, repr=False)
class LaneStrip(Brief):
    """A lane, shoulder, pavement or other strip along the whole corridor."""

    kind: StripKind
    direction: int
    """Direction of travel: +1 with the ego, -1 oncoming, 0 neither."""
    right: NDArray[np.float64] = field(repr=False)
    """[n], t of the right edge at every sample, m."""
    left: NDArray[np.float64] = field(repr=False)
    """[n], t of the left edge, m; equal to `right` where the strip does not exist."""
    mark: str
    """Mark on the left edge: `solid`, `broken`, `curb` or `none`."""
    right_mark: str = "none"
    """Mark on the right edge."""
    mark_changes: tuple[tuple[float, str, str], ...] = ()
    """Changes of marks along the strip: rows of s and the left and right marks from there on;
    `mark` and `right_mark` are those at the ego's start."""


@dataclass(frozen=True)
class RoadSignal:
    """A traffic light or sign of the map."""

    id: str
    kind: Literal["traffic_light", "sign"]
    type: str
    """OpenDRIVE type in `country`'s catalogue, e.g. `1000001` or `205`."""
    value: str
    """Value of the sign, e.g. a speed limit; empty if the file gives none."""
    x: float
    y: float
    z: float
    """Height of the ground or road at its foot, m."""
    yaw: float
    """Direction that it faces, towards the traffic that it addresses, rad."""
    s: float
    """s on the ego's corridor, m."""
    t: float
    height: float = 0.0
    """Height of its lower edge above `z`, m."""
    country: str = ""
    """Catalogue of `type`: `OpenDRIVE` or a country's code."""
    name: str = ""


@dataclass(frozen=True, eq=False)
class PaintedArea:
    """A painted area on the road, from the map's objects."""

    kind: Literal["crosswalk", "stop_line"]
    points: NDArray[np.float64] = field(repr=False)
    """[n, 2] corners in world coordinates, counter-clockwise, m; the first comes last again."""


@dataclass(frozen=True)
class Structure:
    """A tunnel or bridge on the ego's road."""

    kind: Literal["tunnel", "bridge"]
    start: float
    """s on the ego's corridor, m."""
    end: float


@dataclass(frozen=True, eq=False)
class OtherRoad:
    """A road of the map that the ego does not drive."""

    corridor: "Corridor"
    """The road's corridor: its own s and t, the same world coordinates, and no other roads."""
    road_id: str
    is_connecting: bool
    """True if it leads through a junction."""
    junction: str = ""
    """Id of the junction; empty if there is none."""


@dataclass(frozen=True, eq=False, repr=False)
class Corridor(Brief):
    """A road with its cross-section, in the ego's driving direction."""

    s: NDArray[np.float64] = field(repr=False)
    """[n], distance from the corridor's beginning, evenly spaced by `step`, m."""
    x: NDArray[np.float64] = field(repr=False)
    y: NDArray[np.float64] = field(repr=False)
    z: NDArray[np.float64] = field(repr=False)
    cos: NDArray[np.float64] = field(repr=False)
    """[n], cosine of the heading; the normal to the left is (-sin, cos)."""
    sin: NDArray[np.float64] = field(repr=False)
    curvature: NDArray[np.float64] = field(repr=False)
    """[n], curvature, 1/m, left positive."""
    strips: tuple[LaneStrip, ...] = field(repr=False)
    """Strips from right to left; adjacent strips share an edge."""
    start: float
    """s of the ego's start, m."""
    speed_limit: float
    """m/s"""
    keeps_left: bool = False
    """True if traffic keeps to the left where the ego starts."""
    in_junction: NDArray[np.bool_] = field(
        default_factory=lambda: np.zeros(0, dtype=np.bool_), repr=False
    )
    """[n], true for samples inside a junction; all false by default."""
    others: tuple[OtherRoad, ...] = field(default=(), repr=False)
    """All other roads of the map."""
    signals: tuple[RoadSignal, ...] = field(default=(), repr=False)
    """Signals on all roads of the map."""
    crosswalks: tuple[PaintedArea, ...] = field(default=(), repr=False)
    """Crosswalks and stop lines on all roads of the map."""
    structures: tuple[Structure, ...] = ()
    road_map: RoadMap | None = field(default=None, repr=False)
    """Description of the map that it was loaded from."""
    driving: tuple[int, ...] = field(init=False)
    """Indices of the driving strips at the start, from right to left."""
    step: float = field(init=False)
    """Spacing of the samples, m."""
    length: float = field(init=False)
    """s of the last sample, m."""
    track: Track = field(init=False, repr=False)
    """The corridor as arrays, for kernels."""
    _plain: Track = field(init=False, repr=False)
    """The same arrays in a form that plain Python indexes quickly."""
    _around: list[Ranges] = field(init=False, repr=False)
    """Ranges of t on other roads, by sample."""
    _tracks: dict[int, list[tuple[float, float]]] = field(
        init=False, default_factory=dict, repr=False
    )
    """Ranges of t on the rails of other roads, by sample."""

    @classmethod
    def load(cls, road_map: RoadMap | str, catalogue: Catalogue | None = None) -> "Corridor":
        """Return the road that the ego drives on a map; each file is read only once per process.

        Consecutive roads form one corridor, also through junctions: first those of `RoadMap.route`, then the
        roads straight on.

        Args:
            road_map: Gives the OpenDRIVE file, the ego's start and its route; or `Scene.map`: a map's id, or the
                path of an `.xodr` file. In a user's own file, the ego starts on the first road outside junctions
                with a long enough way straight on, 160 m after the beginning of that way or after a quarter of it.
            catalogue: Describes the maps that are named by an id.

        Returns:
            The corridor; its `road_map` describes the map.

        Raises:
            UnknownComponent: If there is no such map.
            DataError: With every fault of the file, or if start or route are not on the road.
        """
        from oodscen.driving._roads.building import load_corridor  # Late, because it builds these.

        return load_corridor(road_map, catalogue)

    def __post_init__(self) -> None:
        put = object.__setattr__
        if not len(self.in_junction):
            put(self, "in_junction", np.zeros(len(self.s), dtype=np.bool_))
            self.in_junction.setflags(write=False)
        put(self, "length", float(self.s[-1]))
        put(self, "step", float(self.s[-1]) / (len(self.s) - 1))
        start = self._index(self.start)
        driving = [
            index
            for index, strip in enumerate(self.strips)
            if strip.kind == "driving" and strip.left[start] - strip.right[start] > 0.5
        ]
        put(self, "driving", tuple(driving))
        drivable = _intervals(self.strips)
        self._build_tracks(drivable)
        around: list[Ranges] = [()] * len(self.s)
        if self.others:
            bands = [band for other in self.others for band in self._bands(other.corridor)]
            count = len(self.s)
            roads = [band for kind, band in bands if kind in DRIVABLE]
            for sample, ranges in covered_ranges(roads, self.step, count).items():
                drivable[sample] = union_of(drivable[sample], ranges)
            every = covered_ranges((band for _, band in bands), self.step, count)
            for sample, ranges in every.items():
                around[sample] = tuple(ranges)
            self._build_tracks(drivable)
            tracks = [band for kind, band in bands if kind == "rail"]
            put(self, "_tracks", covered_ranges(tracks, self.step, count))
        put(self, "_around", around)

    @property
    def ego_lanes(self) -> tuple[int, ...]:
        """Indices of the strips where the ego may start, from right to left."""
        return tuple(index for index in self.driving if self.strips[index].direction > 0)

    def _build_tracks(self, drivable: Sequence[Ranges]) -> None:
        """Build the arrays for look-ups from the drivable ranges of t at every sample."""
        norm = np.sqrt(self.cos * self.cos + self.sin * self.sin)
        columns = (self.x, self.y, self.z, self.cos / norm, self.sin / norm, self.curvature)
        track = pack(
            np.stack(columns, axis=1),
            np.stack(
                [edge for strip in self.strips for edge in (strip.right, strip.left)],
                axis=1,
            ),
            drivable,
            lanes=[strip.kind == "driving" for strip in self.strips],
            driving=self.driving,
            step=self.step,
            length=self.length,
        )
        object.__setattr__(self, "track", track)
        object.__setattr__(self, "_plain", view_track(track))

    def point(self, s: float, t: float) -> tuple[float, float, float, float]:
        """Return x, y, z and the road's heading at a place; beyond the ends, the road continues straight."""
        x, y, z, cos, sin = look.point(self._plain, s, t)
        return x, y, z, exact.atan2(sin, cos)

    def locate(self, x: float, y: float, near: float | None = None) -> tuple[float, float]:
        """Return the place (s, t) of a point.

        Args:
            x: World x, m.
            y: World y, m.
            near: An s close to the result, e.g. the previous one; by default the search starts at the
                nearest sample.
        """
        if near is None:
            square = (self.x - x) ** 2 + (self.y - y) ** 2
            near = int(square.argmin()) * self.step
        return look.locate(self._plain, x, y, near)

    def locate_all(
        self, x: NDArray[np.float64], y: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the places of many points, with the same bits as `locate` for each.

        Args:
            x: [n], world x, m.
            y: [n], world y, m.

        Returns:
            s and t, [n] each.
        """
        return self._locate_among(x, y, np.arange(len(self.x)))

    def _locate_among(
        self, x: NDArray[np.float64], y: NDArray[np.float64], among: NDArray[np.int64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Search from the nearest of the given samples, in batches to limit the memory."""
        s, t = np.empty(len(x)), np.empty(len(x))
        batch = max(1, _BATCH // len(among))
        for first in range(0, len(x), batch):
            part = slice(first, first + batch)
            px, py = x[part], y[part]
            square = (self.x[among] - px[:, None]) ** 2 + (self.y[among] - py[:, None]) ** 2
            near = among[square.argmin(axis=1)] * self.step
            look.locate_each(
                for_kernels(self.track),
                seen(px),
                seen(py),
                seen(near),
                seen(s[part]),
                seen(t[part]),
            )
        return s, t

    def heading(self, s: float) -> float:
        """Return the road's heading at `s`, rad."""
        return look.heading(self._plain, s)

    def alignment(self, s: float, yaw: float) -> float:
        """Return the cosine of the angle between the road at `s` and a direction: 1 along it, -1 against it."""
        return look.alignment(self._plain, s, yaw)

    def bend(self, s: float) -> float:
        """Return the reference line's curvature at `s`, 1/m, left positive; 0 beyond the ends."""
        return look.bend(self._plain, s)

    def edges(self, strip: int, s: float) -> tuple[float, float]:
        """Return t of a strip's right and left edges at `s`."""
        return look.edges(self._plain, strip, s)

    def centre(self, strip: int, s: float) -> float:
        """Return t of a strip's centre at `s`."""
        return look.centre(self._plain, strip, s)

    def strip_at(self, s: float, t: float) -> int | None:
        """Return the index of the strip at a place, or `None` if it is off the road."""
        for index in range(len(self.strips)):
            right, left = self.edges(index, s)
            if right <= t < left:
                return index
        return None

    def is_drivable(self, s: float, t_min: float, t_max: float) -> bool:
        """Return whether the road is drivable everywhere between two offsets at `s`."""
        return look.is_drivable(self._plain, s, t_min, t_max)

    def drivable_range(self, s: float, t: float) -> tuple[float, float] | None:
        """Return the right and left limits of the drivable road around `t`, or `None` off it."""
        is_on_road, right, left = look.drivable_range(self._plain, s, t)
        return (right, left) if is_on_road else None

    def extent(self, s: float) -> tuple[float, float]:
        """Return t of the right and left edges of the whole cross-section at `s`."""
        return self.edges(0, s)[0], self.edges(len(self.strips) - 1, s)[1]

    def is_on_map(self, s: float, t: float) -> bool:
        """Return whether a place is on a strip of the ego's road or of another road."""
        right, left = self.extent(s)
        if right <= t <= left:
            return True
        if not 0.0 <= s <= self.length:
            return False
        return any(low <= t <= high for low, high in self._around[self._index(s)])

    def is_on_track(self, s: float, t: float) -> bool:
        """Return whether a place is on the rails of another road of the map."""
        ranges = self._tracks.get(self._index(s), ())
        return any(low <= t <= high for low, high in ranges)

    def neighbour(self, strip: int, s: float, side: int) -> int | None:
        """Return the driving strip that touches `strip` on one side.

        Args:
            strip: Index of a strip.
            s: Position along the corridor, m.
            side: +1 for left, -1 for right.
        """
        index = look.neighbour(self._plain, strip, s, side)
        return None if index < 0 else index

    def _bands(self, road: "Corridor") -> list[tuple[StripKind, OverlapStrip]]:
        """Return the strips of a nearby road, each with its kind."""
        first, last = (self._index(self.start + m) for m in (-_AROUND_M[0], _AROUND_M[1]))
        among = np.arange(first, last + 1, max(1, round(4.0 / self.step)))
        coarse = among[::4]
        near = np.zeros(len(road.x), dtype=np.bool_)
        for begin in range(0, len(road.x), 4096):
            part = slice(begin, begin + 4096)
            square = (self.x[coarse] - road.x[part, None]) ** 2
            square += (self.y[coarse] - road.y[part, None]) ** 2
            near[part] = square.min(axis=1) < (REACH_M + 40.0) ** 2
        if not near.any():
            return []
        lx, ly, cos, sin = (road.track.samples[near, column] for column in (0, 1, 3, 4))
        bands: list[tuple[StripKind, OverlapStrip]] = []
        for strip in road.strips:
            if (strip.left - strip.right).max() > 0.01:
                sides = []
                for edge in (strip.right[near], strip.left[near]):
                    s, t = np.full(len(near), -1e9), np.full(len(near), -1e9)
                    x, y = lx - edge * sin, ly + edge * cos
                    s[near], t[near] = self._locate_among(x, y, among)
                    sides.append((s, t))
                bands.append((strip.kind, OverlapStrip(sides[0], sides[1])))
        return bands

    def _index(self, s: float) -> int:
        """Return the index of the sample nearest to `s`."""
        return min(max(int(s / self.step + 0.5), 0), len(self.s) - 1)


def _intervals(strips: Sequence[LaneStrip]) -> list[Ranges]:
    """Return the drivable ranges of t at every sample, with touching strips merged."""
    drivable = [strip for strip in strips if strip.kind in DRIVABLE]
    count = len(strips[0].right) if strips else 0
    if not drivable:
        return [()] * count
    edges = np.stack([edge for strip in drivable for edge in (strip.right, strip.left)])
    changes = np.flatnonzero((edges[:, 1:] != edges[:, :-1]).any(axis=0)) + 1
    ranges_of: list[Ranges] = []
    for first, last in pairwise([0, *changes.tolist(), count]):
        ranges: list[tuple[float, float]] = []
        sides = edges[:, first].tolist()
        for right, left in zip(sides[::2], sides[1::2], strict=True):
            if left - right >= _NARROW_M:
                extend(ranges, right, left, touch=0.01)
        ranges_of += [tuple(ranges)] * (last - first)
    return ranges_of


def ego_strip(corridor: Corridor, lane: int) -> int:
    """Return the strip of the ego's lane, which is counted from the right.

    Raises:
        ValueError: If the road has fewer lanes in the ego's direction.
    """
    lanes = corridor.ego_lanes
    if lane >= len(lanes):
        raise ValueError(f"the road has {len(lanes)} lanes in the ego's direction (0 is the right)")
    return lanes[lane]


def neighbour_strip(corridor: Corridor, strip: int, lanes: int) -> int:
    """Return the driving strip a number of lanes to the left of another, including oncoming lanes.

    Raises:
        ValueError: If there is no such lane.
    """
    driving = corridor.driving
    origin = driving.index(strip)
    if not 0 <= origin + lanes < len(driving):
        raise ValueError(
            f"there is no lane {lanes:+d}; from here they are {-origin}..{len(driving) - 1 - origin}"
        )
    return driving[origin + lanes]
