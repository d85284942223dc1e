"""Finds maps, reads their OpenDRIVE files and builds their corridors."""

from copy import copy
from functools import lru_cache
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path

from oodscen._arguments import checked, instance_of
from oodscen._io.files import read_regular
from oodscen.data._catalogue import Catalogue, RoadMap
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._roads.document import MAX_BYTES
from oodscen.driving._roads.network import Network
from oodscen.driving._roads.opendrive import read_network
from oodscen.driving._roads.routes import Leg, find_route
from oodscen.driving._roads.sampling import build_route
from oodscen.driving._roads.starts import find_start
from oodscen.errors import DataError, Issue, UnknownComponent

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
    names_package = all(part.isidentifier() for part in package.split("."))
    try:
        if inside and names_package and len(package) > 1:  # A single letter is a drive.
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
    # `replace` would build its look-ups anew.
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
