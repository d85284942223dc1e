"""The ego of an OpenSCENARIO file: which entity it is, and where on its road it starts."""

import math
import re
from collections.abc import Iterable

from oodscen.data._catalogue import Catalogue, RoadMap
from oodscen.data._scene import Ego
from oodscen.driving._roads.building import find_map, load_corridor, read_map
from oodscen.driving._roads.corridor import Corridor
from oodscen.driving._roads.opendrive import read_network
from oodscen.errors import Issue
from oodscen.interchange._reading.positions import EntityPlace, MappedRoads
from oodscen.interchange._reading.tree import Element

_NAMES = ("ego", "hero")
_NOT_EGO = 4
"""Unlikeness to the ego's name from which a name is another's."""
_NAMED, _LONGEST_NAME = 20, 40
"""Number of entities that an error names, and characters of each name."""
_ASIDE_M, _TURNED_DEG = 0.05, 1.0
"""Offset and turn of the ego in its lane that are not worth a note."""


def no_entity(name: str, entities: Iterable[str]) -> Issue:
    """Return the fault that no entity has the name of the ego."""
    known = ", ".join([repr(entity[:_LONGEST_NAME]) for entity in entities][:_NAMED])
    return Issue("ego", f"there is no entity {name[:_LONGEST_NAME]!r}; the file has: {known}")


def likely_ego(root: Element, entities: Iterable[str]) -> str:
    """Return the entity that is the ego by its name, or else the first, and record a choice that may be wrong.

    Raises:
        DataError: If there are no entities.
    """
    likely = sorted(entities, key=_unlike_ego)
    if not likely:
        raise root.fault("has no entities")
    found, how = likely[0], _unlike_ego(likely[0])
    if how >= _NOT_EGO:
        root.note(f"no entity is called ego; {found} is taken to be it")
    elif how or how == min(map(_unlike_ego, likely[1:]), default=_NOT_EGO):
        root.note(f"{found} is taken to be the ego; name another one to change that")
    return found


def _unlike_ego(name: str) -> int:
    """Return how unlike the ego's a name is: 0 is the name itself, then it begins with it, ends with it, or neither."""
    if name.lower() in _NAMES:
        return 0
    words = re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+", name)
    if not any(word.lower() in _NAMES for word in words):
        return _NOT_EGO
    if words[0].lower() not in _NAMES:
        return 3
    return 1 if len(words) == 1 or words[1].lower() in ("vehicle", "car") else 2


def corridor_from(
    entity: Element, start: EntityPlace, roads: MappedRoads, usual: RoadMap
) -> Corridor:
    """Return the corridor on which the ego starts in the file."""
    road, s, forward = roads.nearest(start)
    if usual.road != road.id or abs(usual.start_m - s) > 1.0 or usual.forward != forward:
        entity.note(
            f"the ego starts at {usual.start_m:g} m of road {usual.road}, not {s:g} m of {road.id}; actors keep "
            "their distances to it"
        )
    place = {"road": road.id, "start_m": s, "forward": forward, "route": ()}
    return load_corridor(usual.model_copy(update=place))


def keeps_left(name: str, catalogue: Catalogue) -> bool:
    """Return whether traffic keeps to the left on the road of a map."""
    road_map = find_map(name, catalogue)
    roads = read_network(read_map(road_map.file), source=road_map.file).roads
    road = roads.get(road_map.road) or next(iter(roads.values()))
    return road.left_hand


def strip_of(start: EntityPlace, corridor: Corridor) -> int:
    """Return the strip in which the ego starts, or the rightmost lane of its direction if it is in none of them."""
    strip = corridor.strip_at(*corridor.locate(start.x, start.y))
    return strip if strip in corridor.ego_lanes else corridor.ego_lanes[0]


def note_start(entity: Element, start: EntityPlace, corridor: Corridor, strip: int) -> None:
    """Record how the ego stands in its lane, as in a scene it starts in the middle and along it."""
    s, t = corridor.locate(start.x, start.y)
    aside = t - corridor.centre(strip, s)
    turn = math.degrees(math.remainder(start.heading - corridor.heading(s), math.tau))
    if abs(aside) > _ASIDE_M or abs(turn) > _TURNED_DEG:
        entity.note(
            f"the ego starts in the middle of its lane and along it, not {aside:.2f} m to the left and turned by "
            f"{turn:.1f} degrees; actors keep their places on the road"
        )


def ego_of(entity: Element, speed: float, corridor: Corridor, strip: int) -> Ego:
    """Return the ego, at the limit of its road if it has no first speed."""
    if speed == 0.0:
        speed = round(corridor.speed_limit, 2)
        entity.note(f"the ego has no speed at the start; {speed:g} m/s is the limit of its road")
    return Ego(speed=round(speed, 3), lane=corridor.ego_lanes.index(strip))
