"""The visible part of a hazard, in words: its things, their places and what they do, without their story."""

import math
from collections.abc import Mapping
from types import MappingProxyType

from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._scene import Actor, Hazard, Visible, Weather

_INSIDE_M = 1.4
"""Offset from a lane's centre up to which a thing is in that lane, m."""
_SLOW = 0.6
"""Share of the ego's speed below which others are slow."""
_ALONG_DEG, _TOWARDS_DEG = 45.0, 135.0
_FOG_M, _DARK_DEG, _LOW_DEG = 1_000.0, -3.0, 12.0
_SLIPPERY = 0.5

_DOING = {
    "wrong_way": "coming towards the ego vehicle",
    "cut_in": "moving over into another lane",
    "cut_out": "moving over into another lane",
    "hard_brake": "braking hard",
    "halt": "slowing down",
    "stall": "slowing down",
    "stop_and_go": "stopping and starting again",
    "reverse": "driving backwards",
    "swerve": "weaving from side to side",
    "wobble": "swaying from side to side",
    "pull_out": "moving from the roadside into the lane",
    "u_turn": "turning across the road",
    "drift": "drifting out of its lane",
    "overtake": "overtaking",
    "roll_away": "rolling",
    "wander": "walking about",
    "fall": "falling off a vehicle",
    "towed": "drawn by another vehicle",
    "open_door": "swinging open",
    "blown": "blown along by the wind",
}
_CROSSING = {
    "cross_road": "crossing",
    "run_red": "crossing",
    "bolt": "running across",
    "dart": "running across",
    "hesitate": "stepping onto the road and back",
    "walk_along": "crossing",
}
_SHOWN = {
    "hazard": "with its hazard lights on",
    "beacon": "with its beacon flashing",
    "unlit": "without lights",
    "indicate_left": "indicating left",
    "indicate_right": "indicating right",
    "off": "switched off",
    "all_on": "with all its lamps on",
    "flashing": "flashing",
    "red": "showing red",
    "amber": "showing amber",
    "green": "showing green",
    "closed": "closed",
    "open": "open",
}
_SIGNALS = frozenset({"off", "all_on", "flashing", "red", "amber", "green", "closed", "open"})


def visible_of(
    actors: tuple[Actor, ...],
    hazard: Hazard,
    weather: Weather,
    ego: tuple[int, float],
    map_id: str,
    catalogue: Catalogue,
    motions: Mapping[str, str] = MappingProxyType({}),
) -> tuple[Visible, ...]:
    """Return everything that can be seen of a hazard; equal things are told once.

    Args:
        actors: All actors of the scene.
        hazard: Its hazard.
        weather: Its weather.
        ego: The ego's lane, and its speed, m/s.
        map_id: Its map.
        catalogue: The catalogue of its simulator.
        motions: What motions made to order look like, by id.
    """
    known = {asset.id: asset for asset in catalogue.assets}
    lanes = next((road.lanes for road in catalogue.maps if road.id == map_id), 1)
    found = [
        Visible(
            what=_bare(known[one.asset].description),
            where=_where(one, ego[0], lanes),
            doing=_doing(one, known[one.asset], ego[1], motions),
        )
        for one in actors
        if one.id in hazard.actors and one.asset in known
    ]
    if hazard.weather is not None:
        found += [Visible(what=what, where="everywhere") for what in _sky(weather, hazard.weather)]
    return tuple(dict.fromkeys(found))


def _bare(description: str) -> str:
    """Return a description without its article."""
    first, _, rest = description.partition(" ")
    return rest[:120] if first in ("a", "an", "the") and rest else description[:120]


def _where(actor: Actor, ego_lane: int, lanes: int) -> str:
    place = actor.placement
    if place.ahead_m < 0.0:
        return "behind the ego vehicle"
    if place.lane == 0 and abs(place.offset_m) > _INSIDE_M:
        return f"beside the ego's lane on the {'left' if place.offset_m > 0.0 else 'right'}"
    if place.lane == 0:
        return "in the ego's lane"
    if place.lane > 0 and ego_lane + place.lane >= lanes:
        return "in the oncoming lane"
    return f"in a lane to the {'left' if place.lane > 0 else 'right'}"


def _doing(actor: Actor, asset: Asset, ego_speed: float, motions: Mapping[str, str]) -> str:
    name, heading = actor.behaviour.name, actor.placement.heading_deg
    shown = _SHOWN.get(actor.state, "")
    if actor.state in _SIGNALS and asset.category in ("signal", "work_zone"):
        return shown
    if name == "stand":
        moves = "standing still"
    elif name == "follow_lane":
        speed = actor.behaviour.parameters.get("speed", ego_speed)
        moves = "driving slowly ahead" if speed < _SLOW * ego_speed else "driving the same way"
        moves = "standing still" if speed == 0.0 else moves
    elif name == "walk_along" and abs(heading) < _ALONG_DEG:
        moves = "moving the same way"
    elif name == "walk_along" and abs(heading) > _TOWARDS_DEG:
        moves = "coming towards the ego vehicle"
    elif name in _CROSSING:
        side = "right" if math.sin(math.radians(heading)) > 0.0 else "left"
        moves = f"{_CROSSING[name]} from the {side}"
    else:
        moves = _DOING.get(name) or motions.get(name, "moving")
    return f"{moves} {shown}".strip()[:120]


def _sky(weather: Weather, ordinary: Weather) -> list[str]:
    """Return what can be seen of unusual weather."""
    found = []
    if weather.fog_visual_range_m < min(_FOG_M, ordinary.fog_visual_range_m):
        found.append("fog")
    if weather.precipitation_mm_h > ordinary.precipitation_mm_h:
        found.append(f"heavy {weather.precipitation}")
    if weather.sun_elevation_deg < _DARK_DEG < ordinary.sun_elevation_deg:
        found.append("darkness")
    elif weather.sun_elevation_deg < _LOW_DEG < ordinary.sun_elevation_deg:
        found.append("low sun")
    if weather.friction < min(_SLIPPERY, ordinary.friction):
        found.append("ice or water on the road")
    return found or ["unusual weather"]
