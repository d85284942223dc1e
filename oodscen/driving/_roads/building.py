"""Builds corridors from OpenDRIVE files."""

import math
from collections.abc import Iterable, Iterator, Sequence
from copy import copy
from dataclasses import replace
from functools import lru_cache
from importlib.resources import files
from itertools import accumulate, pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from oodscen._arguments import checked, instance_of
from oodscen._files import read_regular
from oodscen.data._catalogue import Catalogue, RoadMap
from oodscen.driving._roads.corridor import Corridor, OtherRoad, PaintedArea, RoadSignal, Structure
from oodscen.driving._roads.crosssection import Places, build_strips, freeze
from oodscen.driving._roads.document import MAX_BYTES
from oodscen.driving._roads.geometry import piecewise, piecewise_all
from oodscen.driving._roads.network import Network, Road, Signal
from oodscen.driving._roads.opendrive import read_network
from oodscen.driving._roads.routes import (
    AHEAD_M,
    BEHIND_M,
    Leg,
    find_route,
    joint,
    road_point,
    road_points,
    straight_on,
)
from oodscen.errors import DataError, Issue, UnknownComponent
from oodscen.numerics._arrays import interpolated, rounded, sincos_each
from oodscen.numerics._exact import Floats, Real, cos, sin

SAMPLE_STEP = 0.5
"""Maximum distance between two samples of a corridor, m."""
NEAR_M = 400.0
"""Maximum distance of other roads and signals from the ego's road, m."""

_MAX_OTHERS_M = 60_000.0
"""Maximum total length of other roads, m; the nearest are kept."""
_MAX_FURNITURE = 5_000
"""Number of signals and painted areas at which no further road's are added."""
_MAX_STARTS = 200
"""Maximum number of roads on which a start is looked for."""
_BEFORE_END_M = 20.0
"""Minimum distance between the ego's start and the end of its road in a user's own file, m."""
_DEFAULT_SPEED_LIMIT = 13.9
"""Speed limit of a road without one, m/s."""
_SNAP = 1e-3
"""Distance below which two reference lines count as one, m."""
_TIGHTEST = 0.1
"""Minimum share of its length that a line parallel to a bend must keep."""


@checked
def load_corridor(road_map: RoadMap | str, catalogue: Catalogue | None = None) -> Corridor:
    """Return the road that the ego drives on a map; `Corridor.load` tells arguments and errors."""
    instance_of("road_map", road_map, str, RoadMap)
    found = find_map(road_map, catalogue) if isinstance(road_map, str) else road_map
    return _corridor(read_map(found.file), found)


def find_map(name: str, catalogue: Catalogue | None = None) -> RoadMap:
    """Return the catalogue's map of a name, or the description of the OpenDRIVE file at that path.

    Raises:
        UnknownComponent: If there is no such map.
        DataError: If the file cannot be used.
    """
    if not name.endswith(".xodr"):
        try:
            if catalogue is not None:
                return catalogue.map(name)
        except KeyError:
            pass
        if catalogue is None:
            raise UnknownComponent("map (a map's id needs a catalogue)", name, [])
        raise UnknownComponent("map", name, [road.id for road in catalogue.maps])
    return _describe(read_map(name), name)


@lru_cache(maxsize=16)
def _describe(data: bytes, name: str) -> RoadMap:
    """Return a map entry for a user's own file, with a start chosen for the ego."""
    network = _network(data, name)
    legs, index, start = _default_start(network, name)
    road, forward = legs[index]
    start_m = start if forward else road.length - start
    route = tuple(leg.road.id for leg in legs[index + 1 :])
    corridor = _sampled_route(data, road.id, start_m, forward, route, name)
    kinds = {strip.kind for strip in corridor.strips}
    return RoadMap(
        id=Path(name).stem,
        description=f"the road of {Path(name).name}",
        file=name,
        road=road.id,
        start_m=start_m,
        forward=forward,
        route=route,
        lanes=max(1, len(corridor.ego_lanes)),
        oncoming_lanes=len(corridor.driving) - len(corridor.ego_lanes),
        has_shoulder="shoulder" in kinds,
        speed_limit=corridor.speed_limit,
        length_m=max(1.0, corridor.length - corridor.start),
        traits=("junction",) if corridor.in_junction.any() else (),
    )


def _default_start(network: Network, source: str) -> tuple[list[Leg], int, float]:
    """Return a way through the network, the index of the leg where the ego starts, and the position on it, m."""
    best: tuple[list[Leg], int, float] | None = None
    longest = 0.0
    for legs in _ways(network):
        total = sum(leg.road.length for leg in legs)
        if total > longest and (found := _open_leg(legs, min(160.0, 0.25 * total))) is not None:
            best, longest = (legs, *found), total
        if longest >= BEHIND_M + 300.0:
            break
    if best is None:
        issue = Issue("", "no road outside junctions has a driving lane")
        raise DataError("OpenDRIVE file", [issue], source=source)
    return best


def _ways(network: Network) -> Iterator[list[Leg]]:
    """Yield the ways straight on from the roads outside junctions, in both directions."""
    for road in list(network.roads.values())[:_MAX_STARTS]:
        for leg in (Leg(road, True), Leg(road, False)):
            if road.junction or not leg.has_lane(1):
                continue
            legs, total = [leg], road.length
            for after in straight_on(network, leg):
                if total >= AHEAD_M:
                    break
                legs.append(after)
                total += after.road.length
            yield legs


def _open_leg(legs: Sequence[Leg], at: float) -> tuple[int, float] | None:
    """Return the last usable leg outside junctions up to a place, else the first after it, and its position."""
    found: tuple[int, float] | None = None
    for index, leg in enumerate(legs):
        if not leg.road.junction and leg.has_lane(1):
            latest = max(0.5 * leg.road.length, leg.road.length - _BEFORE_END_M)
            found = index, min(max(at, 0.0), latest)
        at -= leg.road.length
        if at <= 0.0 and found is not None:
            break
    return found


def read_map(file: str) -> bytes:
    """Return the content of `package:path/inside.xodr` or of a path."""
    package, _, inside = file.partition(":")
    is_packaged = inside and all(part.isidentifier() for part in package.split("."))
    try:
        if is_packaged and len(package) > 1:
            return files(package).joinpath(inside).read_bytes()
        return read_regular(file, "OpenDRIVE file", limit=MAX_BYTES)
    except (OSError, ValueError, ModuleNotFoundError) as error:
        raise DataError("OpenDRIVE file", [Issue("", str(error))], source=file) from None


@lru_cache(maxsize=8)
def _network(data: bytes, source: str) -> Network:
    return read_network(data, source=source)


@lru_cache(maxsize=32)
def _corridor(data: bytes, road_map: RoadMap) -> Corridor:
    """Return the corridor of a map, which it keeps as its `road_map`."""
    start, forward, route = road_map.start_m, road_map.forward, road_map.route
    corridor = copy(_sampled_route(data, road_map.road, start, forward, route, road_map.file))
    object.__setattr__(corridor, "road_map", road_map)
    return corridor


@lru_cache(maxsize=32)
def _sampled_route(
    data: bytes, road_id: str, start: float, forward: bool, route: tuple[str, ...], source: str
) -> Corridor:
    network = _network(data, source)

    def fault(path: str, message: str) -> DataError:
        return DataError("OpenDRIVE file", [Issue(path, message)], source=source)

    if road_id and road_id not in network.roads:
        known = ", ".join(identity[:40] for identity in list(network.roads)[:20])
        raise fault("road", f"no road {road_id!r}; the file has: {known}")
    road = network.roads[road_id] if road_id else next(iter(network.roads.values()))
    if not 0.0 <= start <= road.length:
        raise fault("start_m", f"{start:g} m is not on the road, which is {road.length:g} m long")
    legs, index, issues = find_route(network, Leg(road, forward), start, route)
    if issues:
        raise DataError("OpenDRIVE file", issues, source=source)
    try:
        corridor = build_route(network, legs, index=index, start_m=start)
    except ValueError as error:
        raise fault("", str(error)) from None
    if not corridor.driving:
        raise fault("", f"road {road.id!r} has no driving lane where the ego starts")
    return corridor


def build_corridor(road: Road) -> Corridor:
    """Sample a single road, along its own reference line.

    Raises:
        ValueError: If the road has too many lanes.
    """
    return _sampled(Network({road.id: road}), [Leg(road, True)], 0, 0.0)


def build_route(network: Network, legs: Sequence[Leg], *, index: int, start_m: float) -> Corridor:
    """Sample the roads that the ego drives, and describe their surroundings.

    The ego starts on the leg of the given index, `start_m` along that road's own reference line.

    Raises:
        ValueError: If a bend is too tight to drive, or there are too many lanes.
    """
    corridor = _sampled(network, legs, index, start_m)
    taken = {leg.road.id for leg in legs}
    near = _NearbyRoads(corridor)
    others: list[OtherRoad] = []
    room = _MAX_OTHERS_M
    for road in near.sorted(road for road in network.roads.values() if road.id not in taken):
        room -= road.length
        if room < 0.0:
            break
        others.append(OtherRoad(build_corridor(road), road.id, bool(road.junction), road.junction))
    order = {identity: place for place, identity in enumerate(network.roads)}
    others.sort(key=lambda other: order[other.road_id])
    signals: list[RoadSignal] = []
    outlines: list[PaintedArea] = []
    for road in near.sorted(network.roads.values()):
        if len(signals) + len(outlines) < _MAX_FURNITURE:
            signals += [_signal(road, signal, corridor) for signal in road.signals]
            outlines += _outlines(road)
    return replace(
        corridor, others=tuple(others), signals=tuple(signals), crosswalks=tuple(outlines)
    )


def _sampled(network: Network, legs: Sequence[Leg], index: int, start_m: float) -> Corridor:
    """Sample a chain of legs as one evenly spaced line."""
    tracks = _tracks(legs)
    begins = [0.0, *accumulate(track.length for track in tracks)]
    length = begins[-1]
    count = max(2, math.ceil(length / SAMPLE_STEP - 1e-9) + 1)
    along = length * np.arange(count) / (count - 1)
    number = np.searchsorted(begins[1:-1], along, side="right")
    own = np.empty(count)
    columns = np.empty((6, count))
    for place, (track, begin) in enumerate(zip(tracks, begins[:-1], strict=True)):
        here = number == place
        own[here] = track.own(along[here] - begin)
        columns[:, here] = track.points(own[here])
    x, y, z, cosine, sine, curvature = (freeze(rounded(column)) for column in columns)
    in_junction = np.array([bool(leg.road.junction) for leg in legs])[number]
    in_junction.setflags(write=False)
    places = Places(number, own, [track.shift for track in tracks])
    start = begins[index] + tracks[index].from_start(start_m)
    strips = build_strips(
        network, legs, places, in_junction, step=length / (count - 1), start=start
    )
    return Corridor(
        s=freeze(rounded(along)),
        x=x,
        y=y,
        z=z,
        cos=cosine,
        sin=sine,
        curvature=curvature,
        strips=tuple(strips),
        start=start,
        speed_limit=legs[index].road.speed_limit or _DEFAULT_SPEED_LIMIT,
        in_junction=in_junction,
        structures=_structures(legs, tracks, begins),
    )


class _LegTrack:
    """One leg's share of a corridor's line: parallel to the road's own line, `shift` m to its left.

    The corridor's line continues without a jump where a road's own line begins beside the end of the previous
    one, so lanes that continue each other keep their offsets from it.
    """

    def __init__(self, leg: Leg, shift: float) -> None:
        self.leg = leg
        self.shift = shift
        road = leg.road
        self.span = min(road.length, road.curves[-1].s + road.curves[-1].length)
        self._driven, self._nodes = [0.0], [0.0]
        if shift:
            self._measure()
        self.length = self._nodes[-1] if shift else self.span

    def _measure(self) -> None:
        """Record the distances along this track at distances driven along the road's own line."""
        inner = {self._own(curve.s) for curve in self.leg.road.curves}
        ends = sorted({0.0, self.span} | {s for s in inner if 0.0 < s < self.span})
        for begin, end in pairwise(ends):
            steps = max(1, math.ceil((end - begin) / SAMPLE_STEP))
            for step in range(steps):
                middle = begin + (end - begin) * (step + 0.5) / steps
                kept = 1.0 - self.shift * self._curvature(middle)
                if kept < _TIGHTEST:
                    name = self.leg.road.id
                    raise ValueError(f"road {name!r} bends too tightly for the lanes before it")
                self._driven.append(begin + (end - begin) * (step + 1) / steps)
                width = self._driven[-1] - self._driven[-2]
                self._nodes.append(self._nodes[-1] + kept * width)

    def _own(self, driven: Real) -> Real:
        """Return s on the road's own line at a distance driven along it, m."""
        return driven if self.leg.forward else self.span - driven

    def _curvature(self, driven: float) -> float:
        curvature = road_point(self.leg.road, self._own(driven)).curvature
        return curvature if self.leg.forward else -curvature

    def own(self, along: Floats) -> Floats:
        """Return s on the road's own line at distances along this track, m."""
        if self.shift:
            along = interpolated(along, np.array(self._nodes), np.array(self._driven))
        return self._own(along)

    def from_start(self, own: float) -> float:
        """Return the distance along this track at s on the road's own line, m."""
        driven = own if self.leg.forward else self.span - own
        if not self.shift:
            return driven
        known, wanted = np.array(self._driven), np.array(self._nodes)
        return float(interpolated(np.array([driven]), known, wanted)[0])

    def points(self, own: Floats) -> tuple[Floats, ...]:
        """Return x, y, z, cosine and sine of the heading, and curvature at s on the road's own line."""
        road, forward = self.leg
        x, y, heading, curvature = road_points(road, own)
        sign = 1.0 if forward else -1.0
        sine, cosine = sincos_each(heading)
        along, across = sign * cosine, sign * sine
        curvature = sign * curvature
        z = piecewise_all(road.elevation, own)
        if not self.shift:
            return x, y, z, along, across, curvature
        x, y = x - self.shift * across, y + self.shift * along
        return x, y, z, along, across, curvature / (1.0 - self.shift * curvature)


def _tracks(legs: Sequence[Leg]) -> list[_LegTrack]:
    tracks: list[_LegTrack] = []
    for leg in legs:
        shift = 0.0
        if tracks:
            before = tracks[-1]
            _, across, _ = joint(before.leg, leg)
            shift = before.shift - across
            if abs(shift) < _SNAP:
                shift = 0.0
        tracks.append(_LegTrack(leg, shift))
    return tracks


def _structures(
    legs: Sequence[Leg], tracks: Sequence[_LegTrack], begins: Sequence[float]
) -> tuple[Structure, ...]:
    """Return tunnels and bridges of the route; those that meet at a joint stay separate."""
    found = []
    for leg, track, begin in zip(legs, tracks, begins[:-1], strict=True):
        for stretch in leg.road.stretches:
            ends = [
                begin + track.from_start(min(max(end, 0.0), track.span))
                for end in (stretch.start, stretch.end)
            ]
            if max(ends) - min(ends) > 0.1:
                found.append(Structure(stretch.kind, round(min(ends), 6), round(max(ends), 6)))
    return tuple(sorted(found, key=lambda one: one.start))


class _NearbyRoads:
    """Selects the roads close to a corridor."""

    def __init__(self, corridor: Corridor) -> None:
        every = max(1, round(20.0 / corridor.step))
        self.x, self.y = corridor.x[::every], corridor.y[::every]
        self.start = corridor.point(corridor.start, 0.0)[:2]

    def sorted(self, roads: Iterable[Road]) -> list[Road]:
        """Return the roads with a part near the corridor, those closest to the start first."""
        ranked: list[tuple[float, int, Road]] = []
        for road in roads:
            last = road_point(road, road.length)
            x = np.array([*(curve.x for curve in road.curves), last.x])
            y = np.array([*(curve.y for curve in road.curves), last.y])
            least = min(
                float(((self.x - px[:, None]) ** 2 + (self.y - py[:, None]) ** 2).min())
                for px, py in zip(_blocks(x), _blocks(y), strict=True)
            )
            if least <= NEAR_M * NEAR_M:
                away = float(((x - self.start[0]) ** 2 + (y - self.start[1]) ** 2).min())
                ranked.append((away, len(ranked), road))
        return [road for _, _, road in sorted(ranked, key=lambda one: one[:2])]


def _blocks(values: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    return [values[first : first + 1024] for first in range(0, len(values), 1024)]


def _signal(road: Road, signal: Signal, corridor: Corridor) -> RoadSignal:
    """Return a signal in world coordinates."""
    place = road_point(road, signal.s)
    along, across = cos(place.heading), sin(place.heading)
    x = round(place.x - signal.t * across, 6) + 0.0
    y = round(place.y + signal.t * along, 6) + 0.0
    faces = place.heading + signal.turn + (0.0 if signal.orientation == "-" else math.pi)
    s, t = corridor.locate(x, y)
    is_light = signal.is_dynamic or signal.type.startswith("1000")
    return RoadSignal(
        id=signal.id,
        kind="traffic_light" if is_light else "sign",
        type=signal.type,
        value=signal.value,
        x=x,
        y=y,
        z=round(piecewise(road.elevation, signal.s), 6) + 0.0,
        yaw=round(math.remainder(faces, math.tau), 6) + 0.0,
        s=round(s, 6) + 0.0,
        t=round(t, 6) + 0.0,
        height=signal.height,
        country=signal.country,
        name=signal.name,
    )


def _outlines(road: Road) -> list[PaintedArea]:
    """Return a road's crosswalks and stop lines in world coordinates."""
    outlines = []
    for patch in road.patches:
        points = []
        for s, t in patch.corners:
            place = road_point(road, s)
            along, across = cos(place.heading), sin(place.heading)
            beyond = s - min(max(s, 0.0), road.length)
            x, y = place.x + beyond * along, place.y + beyond * across
            points.append((round(x - t * across, 6) + 0.0, round(y + t * along, 6) + 0.0))
        area = sum(
            ax * by - bx * ay
            for (ax, ay), (bx, by) in zip(points, points[1:] + points[:1], strict=True)
        )
        outlines.append(
            PaintedArea(patch.kind, freeze(np.array(points if area > 0 else points[::-1])))
        )
    return outlines
