"""The road on which the ego starts, and the places of actors along it."""

import math
from typing import NamedTuple

from oodscen.data._catalogue import Catalogue, RoadMap
from oodscen.data._scene import Placement
from oodscen.driving._roads.building import find_map, load_corridor
from oodscen.driving._roads.corridor import Corridor
from oodscen.interchange._reading.positions import EntityPlace, MappedRoads
from oodscen.interchange._reading.tree import Element

_ASIDE_M, _TURNED_DEG = 0.05, 1.0
"""Offset and turn of the ego in its lane that are not worth a note."""
_SAME_START_M = 1.0
"""Distance of two starts on a road that is not worth a note, m."""
_MOST_LANES = 6
"""Largest number of lanes between the ego and an actor."""


class EgoRoad(NamedTuple):
    """The road and the lane in which the ego starts."""

    corridor: Corridor
    strip: int
    """Index of the ego's lane among the corridor's strips."""
    origin: EntityPlace | None
    """The ego's start on a road of the file that the map stands for; `None` if the map is the file's own."""

    def placement(self, place: EntityPlace) -> Placement:
        """Return a place relative to the ego along the road; its distances may be beyond those of a scene."""
        road = self.corridor
        if self.origin is None:
            s, t = road.locate(place.x, place.y)
            turn = place.heading - road.heading(s)
        else:
            ahead_m, left_m = place.offset_from(self.origin)
            s = road.start + ahead_m
            t = road.centre(self.strip, s) + left_m
            turn = place.heading - self.origin.heading
        strip = road.strip_at(s, t)
        if strip is None or strip not in road.driving:
            strip = self.strip
        if road.strips[strip].direction < 0:
            turn += math.pi
        lane = road.driving.index(self.strip)
        lanes = min(max(road.driving.index(strip) - lane, -_MOST_LANES), _MOST_LANES)
        strip = road.driving[lane + lanes]
        return Placement.model_construct(
            ahead_m=round(s - road.start, 3),
            lane=lanes,
            offset_m=round(t - road.centre(strip, s), 3),
            heading_deg=round(math.degrees(math.remainder(turn, math.tau)), 3),
        )


def ego_road_on_own(
    ego: Element, start: EntityPlace, roads: MappedRoads, map_name: str, catalogue: Catalogue
) -> EgoRoad:
    """Return the road and lane on which the ego starts in the file, which is in the middle of the lane in a scene.

    Raises:
        DataError: If no driving lane is there.
    """
    corridor = _corridor_at(ego, start, roads, find_map(map_name, catalogue))
    _check_lanes(ego, corridor)
    strip = corridor.strip_at(*corridor.locate(start.x, start.y))
    if strip is None or strip not in corridor.ego_lanes:
        strip = corridor.ego_lanes[0]
    _note_start(ego, start, corridor, strip)
    return EgoRoad(corridor, strip, None)


def ego_road_on_map(
    ego: Element, start: EntityPlace, map_name: str, catalogue: Catalogue
) -> EgoRoad:
    """Return the road of a map that stands for the file's own, with the ego in the lane at the kerb.

    Raises:
        DataError: If no driving lane is there.
    """
    corridor = load_corridor(map_name, catalogue)
    _check_lanes(ego, corridor)
    return EgoRoad(corridor, corridor.ego_lanes[-1 if corridor.keeps_left else 0], start)


def _check_lanes(ego: Element, corridor: Corridor) -> None:
    if not corridor.ego_lanes:
        raise ego.fault("the ego does not start beside a driving lane")


def _corridor_at(
    ego: Element, start: EntityPlace, roads: MappedRoads, road_map: RoadMap
) -> Corridor:
    """Return the corridor on which the ego starts in the file, and note another start than the map's own."""
    road, s, forward = roads.nearest(start)
    is_same_road = road_map.road == road.id and road_map.forward == forward
    if not is_same_road or abs(road_map.start_m - s) > _SAME_START_M:
        ego.note(
            f"the ego starts at {road_map.start_m:g} m of road {road_map.road}, not {s:g} m of {road.id}; actors keep "
            "their distances to it"
        )
    own_start = {"road": road.id, "start_m": s, "forward": forward, "route": ()}
    return load_corridor(road_map.model_copy(update=own_start))


def _note_start(ego: Element, start: EntityPlace, corridor: Corridor, strip: int) -> None:
    """Note where the ego stands in its lane and how it is turned, since in a scene it stands in the middle."""
    s, t = corridor.locate(start.x, start.y)
    left_m = t - corridor.centre(strip, s)
    turn_deg = math.degrees(math.remainder(start.heading - corridor.heading(s), math.tau))
    if abs(left_m) > _ASIDE_M or abs(turn_deg) > _TURNED_DEG:
        ego.note(
            f"the ego starts in the middle of its lane and along it, not {left_m:.2f} m to the left and turned by "
            f"{turn_deg:.1f} degrees; actors keep their places on the road"
        )
