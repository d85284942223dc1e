"""The roads of the served map: heights, spawn points and the map that pictures show."""

import hashlib
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from oodscen.data import Catalogue, RoadMap
from oodscen.driving._roads.building import find_map, load_corridor, read_map
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._roads.geometry import piecewise
from oodscen.driving._roads.network import LaneSection, Network, Road
from oodscen.driving._roads.opendrive import read_network
from oodscen.driving._roads.routes import road_point
from oodscen_carla._opendrive import decoded, for_carla
from oodscen_carla.server._values import Transform

_LEAST_STEP_M = 2.0
"""Least distance between the samples of heights, m."""
_NEAR_M = 40.0
"""Distance from a road's line beyond which it gives no height, m."""
_MOST_SAMPLES = 60_000
"""Number of samples from which they are farther apart."""
_APART_M = 40.0
"""Distance between spawn points on a lane, m."""
_LIFT_M = 0.3
"""Height of spawn points above the road, m."""
_FIRST_M = 10.0
"""Largest distance of a road's first spawn points from its start, m."""
_LEAST_WIDTH_M = 2.0
"""Width above which a lane has spawn points, m."""
_MOST_POINTS = 400
"""Greatest number of spawn points."""
_BEFORE_END_M = 60.0
"""Distance from the end of the shown road within which no vehicle starts, m."""
_SLOPE_AROUND_M = 0.5
"""Distance before and after a place over which its slope is measured, m."""
_LEAST_M = 1e-6
"""Least length by which a rise is divided, m."""
_ROUNDING_M = 1e-9
"""Distance before a lane section from which a place belongs to it, m."""

RECEIVED = "OpenDriveMap"
"""Name of the map that a client sent."""


class Ground(NamedTuple):
    """The road below a place, in right-handed axes."""

    z: float
    """Height, m."""
    heading: float
    """Direction of the road's reference line, rad."""
    slope: float
    """Rise of the road per metre in that direction."""


@dataclass(frozen=True, eq=False)
class ServedMap:
    """One OpenDRIVE map and what the server derives from it."""

    name: str
    """The map's name as clients read it."""
    text: str
    """The OpenDRIVE document."""
    road_map: RoadMap
    """The description by which the drawing simulator finds its road."""
    samples: NDArray[np.float64]
    """[n, 5] x, y, z, heading (rad) and slope of all reference lines, in right-handed axes."""
    step: float
    """Greatest distance between two samples of a reference line, m."""
    spawn_points: tuple[Transform, ...]
    """Places for vehicles whose cameras see the road, in CARLA's axes; without any such, places on all roads."""

    @classmethod
    def received(cls, text: str, folder: Path, catalogue: Catalogue) -> "ServedMap":
        """Return the map of a client's OpenDRIVE document.

        A shipped map is recognised by its bytes, and is drawn as in any other simulator.

        Args:
            text: The document.
            folder: Folder for the file that the drawing simulator reads.
            catalogue: The drawing simulator's catalogue.

        Raises:
            DataError: If the document cannot be used.
        """
        data, digest = text.encode(), _digest(text)
        road_map = _shipped(catalogue).get(digest)
        if road_map is None:
            read_network(data, source="generate_opendrive_world")
            path = folder / f"{digest[:16]}.xodr"
            path.write_bytes(data)
            road_map = find_map(str(path), catalogue)
        return cls._of(RECEIVED, text, road_map)

    @classmethod
    def of(cls, road_map: RoadMap, name: str = "") -> "ServedMap":
        """Return a map of the catalogue, under another name if one is given."""
        return cls._of(name or road_map.id, for_carla(decoded(read_map(road_map.file))), road_map)

    @classmethod
    def _of(cls, name: str, text: str, road_map: RoadMap) -> "ServedMap":
        network = read_network(read_map(road_map.file), source=name)
        corridor, step = load_corridor(road_map), _step(network)
        shown = (place for place in _spawn_points(network) if _is_shown(place, corridor))
        points = tuple(islice(shown, _MOST_POINTS)) or tuple(
            islice(_spawn_points(network), _MOST_POINTS)
        )
        return cls(name, text, road_map, _samples(network, step), step, points)

    def ground(self, x: float, y: float) -> Ground | None:
        """Return the nearest road at a place, or `None` far from all roads.

        Args:
            x: x in right-handed axes, m.
            y: y in right-handed axes, m.
        """
        squares = (self.samples[:, 0] - x) ** 2 + (self.samples[:, 1] - y) ** 2
        index = int(squares.argmin())
        if squares[index] > _NEAR_M * _NEAR_M:
            return None
        sample_x, sample_y, z, heading, slope = self.samples[index].tolist()
        along = (x - sample_x) * math.cos(heading) + (y - sample_y) * math.sin(heading)
        return Ground(z + slope * max(-self.step, min(self.step, along)), heading, slope)


def _is_shown(place: Transform, shown: Corridor) -> bool:
    """Return whether pictures from a place show its road: they show one corridor."""
    s, t = shown.locate(place.location[0], -place.location[1])
    is_between = shown.start <= s <= shown.length - _BEFORE_END_M
    return is_between and shown.is_drivable(s, t, t)


@lru_cache(maxsize=4)
def _digests(maps: tuple[tuple[str, str], ...]) -> dict[str, str]:
    """Return the ids of maps by the digests of their documents, as they are and as served."""
    digests: dict[str, str] = {}
    for name, file in maps:
        text = decoded(read_map(file))
        digests |= {_digest(text): name, _digest(for_carla(text)): name}
    return digests


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def _shipped(catalogue: Catalogue) -> dict[str, RoadMap]:
    """Return the catalogue's maps by the digests of their documents."""
    maps = {road_map.id: road_map for road_map in catalogue.maps if road_map.file}
    digests = _digests(tuple((name, road_map.file) for name, road_map in maps.items()))
    return {digest: maps[name] for digest, name in digests.items()}


def _slope(road: Road, s: float) -> float:
    """Return the rise of a road per metre."""
    before, after = max(0.0, s - _SLOPE_AROUND_M), min(road.length, s + _SLOPE_AROUND_M)
    rise = piecewise(road.elevation, after) - piecewise(road.elevation, before)
    return rise / max(after - before, _LEAST_M)


def _step(network: Network) -> float:
    """Return the distance between samples of heights, m: it grows with the roads, whose samples are limited."""
    return max(_LEAST_STEP_M, sum(road.length for road in network.roads.values()) / _MOST_SAMPLES)


def _samples(network: Network, step: float) -> NDArray[np.float64]:
    """Return x, y, z, heading and slope along all reference lines, [n, 5], at most a step apart."""
    rows: list[tuple[float, float, float, float, float]] = []
    for road in network.roads.values():
        count = max(1, math.ceil(road.length / step))
        for number in range(count + 1):
            s = road.length * number / count
            point = road_point(road, s)
            rows.append(
                (point.x, point.y, piecewise(road.elevation, s), point.heading, _slope(road, s))
            )
    return np.array(rows, np.float64)


def _spawn_points(network: Network) -> Iterator[Transform]:
    """Yield places for vehicles on the driving lanes outside junctions, in CARLA's axes."""
    for road in network.roads.values():
        if road.junction:
            continue
        first = min(_FIRST_M, road.length / 2)
        gaps = int(max(0.0, road.length - 2 * first) / _APART_M)
        for number in range(gaps + 1):
            yield from _across(road, first + number * _APART_M)


def _section_at(road: Road, s: float) -> LaneSection:
    """Return the lane section of a place."""
    return next(section for section in reversed(road.sections) if section.s <= s + _ROUNDING_M)


def _across(road: Road, s: float) -> list[Transform]:
    """Return one spawn point for every driving lane at a place of a road."""
    section = _section_at(road, s)
    points = []
    for side in (-1, 1):
        t = piecewise(road.lane_offset, s)
        lanes = [lane for lane in section.lanes if lane.id * side > 0]
        for lane in sorted(lanes, key=lambda lane: abs(lane.id)):
            width = piecewise(lane.widths, s - section.s)
            if lane.type == "driving" and width > _LEAST_WIDTH_M:
                is_against = ((side > 0) != road.left_hand) != lane.reversed
                points.append(_spawn_point(road, s, t + side * width / 2, is_against=is_against))
            t += side * width
    return points


def _spawn_point(road: Road, s: float, t: float, *, is_against: bool) -> Transform:
    """Return a place above a road for a vehicle that drives along the road, or against it."""
    point = road_point(road, s)
    x = point.x - t * math.sin(point.heading)
    y = point.y + t * math.cos(point.heading)
    z = piecewise(road.elevation, s) + _LIFT_M
    heading = point.heading + (math.pi if is_against else 0.0)
    pitch = math.degrees(math.atan(_slope(road, s))) * (-1 if is_against else 1)
    yaw = math.degrees(-heading + 2 * math.pi) % 360.0
    return Transform((x, -y, z), (pitch, yaw, 0.0))
