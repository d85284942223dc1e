"""Builds corridors from OpenDRIVE files."""

import math
from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from functools import lru_cache
from importlib.resources import files
from importlib.util import find_spec
from itertools import accumulate
from pathlib import Path

import numpy as np

from oodscen._arguments import checked, instance_of
from oodscen._io.files import read_regular
from oodscen.data._catalogue import Catalogue, RoadMap
from oodscen.driving._roads.corridor import Corridor, OtherRoad, PaintedArea, RoadSignal
from oodscen.driving._roads.crosssection import Places, build_strips, freeze
from oodscen.driving._roads.document import MAX_BYTES
from oodscen.driving._roads.leg_tracks import SAMPLE_STEP_M, tracks_of
from oodscen.driving._roads.network import Network, Road
from oodscen.driving._roads.opendrive import read_network
from oodscen.driving._roads.routes import Leg, find_route
from oodscen.driving._roads.starts import find_start
from oodscen.driving._roads.surroundings import (
    painted_areas,
    roads_by_distance,
    signal_in_world,
    structures_of,
)
from oodscen.errors import DataError, Issue, UnknownComponent
from oodscen.numerics._arrays import rounded

_MAX_OTHERS_M = 60_000.0
"""Maximum total length of other roads, m; the nearest are kept."""
_MAX_FURNITURE = 5_000
"""Number of signals and painted areas at which no further road's are added."""
_DEFAULT_SPEED_LIMIT = 13.9
"""Speed limit of a road without one, m/s."""
_ROUNDING = 1e-9
"""Part of a step by which a length may exceed whole steps before one is added."""
_NAMED, _LONGEST_NAME = 20, 40
"""Number of roads that an error names, and characters of each name."""


@checked
def load_corridor(road_map: RoadMap | str, catalogue: Catalogue | None = None) -> Corridor:
    """Return the road that the ego drives on a map; `Corridor.load` tells arguments and errors."""
    instance_of("road_map", road_map, str, RoadMap)
    if isinstance(road_map, str):
        road_map = find_map(road_map, catalogue)
    return _corridor(read_map(road_map.file), road_map)


def find_map(name: str, catalogue: Catalogue | None = None) -> RoadMap:
    """Return the catalogue's map of a name, or the description of the OpenDRIVE file at that path.

    Raises:
        UnknownComponent: If there is no such map.
        DataError: If the file cannot be used.
    """
    if name.endswith(".xodr"):
        return _describe(read_map(name), name)
    if catalogue is None:
        raise UnknownComponent("map (a map's id needs a catalogue)", name, [])
    try:
        return catalogue.map(name)
    except KeyError:
        raise UnknownComponent("map", name, [road.id for road in catalogue.maps]) from None


@lru_cache(maxsize=16)
def _describe(data: bytes, name: str) -> RoadMap:
    """Return a map entry for a user's own file, with a start chosen for the ego."""
    start = find_start(_network(data, name))
    if start is None:
        raise _fault(name, "", "no road outside junctions has a driving lane")
    road_id, forward = start.leg.road.id, start.leg.forward
    route = tuple(leg.road.id for leg in start.onward)
    corridor = _sampled_route(data, road_id, start.s, forward, route, name)
    kinds = {strip.kind for strip in corridor.strips}
    return RoadMap(
        id=Path(name).stem,
        description=f"the road of {Path(name).name}",
        file=name,
        road=road_id,
        start_m=start.s,
        forward=forward,
        route=route,
        lanes=max(1, len(corridor.ego_lanes)),
        oncoming_lanes=len(corridor.driving) - len(corridor.ego_lanes),
        has_shoulder="shoulder" in kinds,
        speed_limit=corridor.speed_limit,
        length_m=max(1.0, corridor.length - corridor.start),
        traits=("junction",) if corridor.in_junction.any() else (),
    )


def read_map(file: str) -> bytes:
    """Return the content of `package:path/inside.xodr` or of a path."""
    package, _, inside = file.partition(":")
    is_packaged = inside and all(part.isidentifier() for part in package.split("."))
    try:
        if is_packaged and len(package) > 1:
            spec = find_spec(package)
            if spec is None or spec.submodule_search_locations is None:
                raise ModuleNotFoundError(f"no package named {package!r}")
            return files(package).joinpath(inside).read_bytes()
        return read_regular(file, "OpenDRIVE file", limit=MAX_BYTES)
    except (OSError, ValueError, ModuleNotFoundError) as error:
        raise _fault(file, "", str(error)) from None


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
    if road_id and road_id not in network.roads:
        names = ", ".join(name[:_LONGEST_NAME] for name in list(network.roads)[:_NAMED])
        raise _fault(source, "road", f"no road {road_id!r}; the file has: {names}")
    road = network.roads[road_id] if road_id else next(iter(network.roads.values()))
    if not 0.0 <= start <= road.length:
        why = f"{start:g} m is not on the road, which is {road.length:g} m long"
        raise _fault(source, "start_m", why)
    legs, index, issues = find_route(network, Leg(road, forward), start, route)
    if issues:
        raise DataError("OpenDRIVE file", issues, source=source)
    try:
        corridor = build_route(network, legs, index=index, start_m=start)
    except ValueError as error:
        raise _fault(source, "", str(error)) from None
    if not corridor.driving:
        raise _fault(source, "", f"road {road.id!r} has no driving lane where the ego starts")
    return corridor


def _fault(source: str, path: str, message: str) -> DataError:
    return DataError("OpenDRIVE file", [Issue(path, message)], source=source)


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
    untaken = [road for road in network.roads.values() if road.id not in taken]
    signals: list[RoadSignal] = []
    areas: list[PaintedArea] = []
    for road in roads_by_distance(network.roads.values(), corridor):
        if len(signals) + len(areas) < _MAX_FURNITURE:
            signals += [signal_in_world(road, signal, corridor) for signal in road.signals]
            areas += painted_areas(road)
    return replace(
        corridor,
        others=tuple(_others(untaken, corridor)),
        signals=tuple(signals),
        crosswalks=tuple(areas),
    )


def _others(roads: Sequence[Road], corridor: Corridor) -> list[OtherRoad]:
    """Return the roads near a corridor, in the order given, as far as there is room for them."""
    room_m = _MAX_OTHERS_M
    others: dict[str, OtherRoad] = {}
    for road in roads_by_distance(roads, corridor):
        room_m -= road.length
        if room_m < 0.0:
            break
        others[road.id] = OtherRoad(
            corridor=build_corridor(road),
            road_id=road.id,
            is_connecting=bool(road.junction),
            junction=road.junction,
        )
    return [others[road.id] for road in roads if road.id in others]


def _sampled(network: Network, legs: Sequence[Leg], index: int, start_m: float) -> Corridor:
    """Sample a chain of legs as one evenly spaced line."""
    tracks = tracks_of(legs)
    begins = [0.0, *accumulate(track.length for track in tracks)]
    length = begins[-1]
    count = max(2, math.ceil(length / SAMPLE_STEP_M - _ROUNDING) + 1)
    along = length * np.arange(count) / (count - 1)
    leg_numbers = np.searchsorted(begins[1:-1], along, side="right")
    road_s = np.empty(count)
    columns = np.empty((6, count))
    for number, (track, begin) in enumerate(zip(tracks, begins[:-1], strict=True)):
        is_on_leg = leg_numbers == number
        road_s[is_on_leg] = track.own(along[is_on_leg] - begin)
        columns[:, is_on_leg] = track.points(road_s[is_on_leg])
    x, y, z, cosine, sine, curvature = (freeze(rounded(column)) for column in columns)
    in_junction = np.array([bool(leg.road.junction) for leg in legs])[leg_numbers]
    in_junction.setflags(write=False)
    places = Places(leg_numbers, road_s, [track.shift for track in tracks])
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
        speed_limit=legs[index].road.speed_limit(start_m) or _DEFAULT_SPEED_LIMIT,
        keeps_left=legs[index].road.left_hand,
        in_junction=in_junction,
        structures=structures_of(tracks, begins[:-1]),
    )
