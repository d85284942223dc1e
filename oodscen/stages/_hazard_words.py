"""The visible part of a hazard, in words: its things, their places and what they do, without their story."""

import math
from collections.abc import Collection, Mapping
from types import MappingProxyType

from oodscen._text import one_line
from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._details import DetailKinds, described
from oodscen.data._map_state import MapPart, MapState
from oodscen.data._scene import DARK_DEG, FOG_M, Actor, Ego, Hazard, Visible, Weather
from oodscen.driving._motion.behaviours import BUILT_IN
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import ego_strip
from oodscen.errors import OodscenError

_INSIDE_M = 1.4
"""Offset from a lane's centre up to which a thing is in that lane, m."""
_SLOW = 0.6
"""Share of the ego's speed below which others are slow."""
_ALONG_DEG, _TOWARDS_DEG = 45.0, 135.0
"""Headings up to which a walker moves the ego's way, and from which against it, degrees."""
_LONGEST = 120
"""Largest number of characters of a description."""
_LOW_DEG = 12.0
"""Sun elevation below which the sun stands low, degrees."""
_HIDDEN = 0.6
"""Cloud cover from which a low sun is hidden."""
_SLIPPERY = 0.5
"""Friction below which ice or water can be seen."""

_PARTS: dict[MapPart, str] = {
    "street_lamps": "street lamps",
    "signals": "traffic lights",
    "signs": "road signs",
}
_FAULTS = {
    "off": "dark",
    "flashing": "flashing amber",
    "all_on": "red, amber and green",
    "bent": "bent",
    "turned": "turned-away",
    "missing": "missing",
}
"""States of the map's own things, in words."""
_STATES = {
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
    "half": "stuck half-way",
}
"""States of actors, in words."""
_SIGNAL_STATES = frozenset(
    {"off", "all_on", "flashing", "red", "amber", "green", "closed", "open", "half"}
)


def visible_of(
    actors: tuple[Actor, ...],
    hazard: Hazard,
    weather: Weather,
    ego: Ego,
    map_id: str,
    catalogue: Catalogue,
    motions: Mapping[str, str] = MappingProxyType({}),
) -> tuple[Visible, ...]:
    """Return everything that can be seen of a hazard; equal things are named once.

    `motions` has the looks of motions made to order, by id.
    """
    assets = {asset.id: asset for asset in catalogue.assets}
    kinds = catalogue.details or DetailKinds()
    oncoming = _oncoming_lanes(ego, map_id, catalogue)
    visibles = [
        Visible(
            what=_without_article(_described(actor, assets, kinds)),
            where=_where(actor, oncoming),
            doing=_doing(
                actor, assets[actor.asset], kinds, _movement(actor, ego.speed, oncoming, motions)
            ),
        )
        for actor in actors
        if actor.id in hazard.actors and actor.asset in assets
    ]
    if hazard.weather is not None:
        visibles += [
            Visible(what=phenomenon, where="everywhere")
            for phenomenon in _phenomena(weather, hazard.weather)
        ]
    return tuple(dict.fromkeys(visibles))


def visible_of_map(state: MapState | None) -> tuple[Visible, ...]:
    """Return everything that can be seen of a map that is out of order."""
    if state is None:
        return ()
    return tuple(
        Visible(what=f"{_FAULTS[fault]} {_PARTS[part]}", where="along the road")
        for part, fault in state.faults()
    )


def _without_article(description: str) -> str:
    first, _, rest = description.partition(" ")
    if first.casefold() in ("a", "an", "the") and rest:
        return rest[:_LONGEST]
    return description[:_LONGEST]


def _described(actor: Actor, assets: Mapping[str, Asset], kinds: DetailKinds) -> str:
    """Return an asset's description, or its id if it has none, with the details other than its pose."""
    description = one_line(assets[actor.asset].description) or actor.asset.replace("_", " ")
    if actor.details is None:
        return description
    return described(description, actor.details.model_copy(update={"pose": ""}), assets, kinds)


def _oncoming_lanes(ego: Ego, map_id: str, catalogue: Catalogue) -> frozenset[int]:
    """Return the lanes of oncoming traffic, counted to the left of the ego's; none of a road that cannot be read."""
    try:
        road = load_corridor(map_id, catalogue)
        own = road.driving.index(ego_strip(road, ego.lane))
    except (OodscenError, ValueError):
        return frozenset()
    return frozenset(
        number - own
        for number, strip in enumerate(road.driving)
        if road.strips[strip].direction < 0
    )


def _where(actor: Actor, oncoming: Collection[int]) -> str:
    placement = actor.placement
    if placement.ahead_m < 0.0:
        return "behind the ego vehicle"
    if placement.lane == 0 and abs(placement.offset_m) > _INSIDE_M:
        return f"beside the ego's lane on the {'left' if placement.offset_m > 0.0 else 'right'}"
    if placement.lane == 0:
        return "in the ego's lane"
    if placement.lane in oncoming:
        return "in the oncoming lane"
    return f"in a lane to the {'left' if placement.lane > 0 else 'right'}"


def _doing(actor: Actor, asset: Asset, kinds: DetailKinds, movement: str) -> str:
    """Return what an actor does, in which pose and with which lights."""
    state = _STATES.get(actor.state, "")
    if actor.state in _SIGNAL_STATES and asset.category in ("signal", "work_zone"):
        return state
    pose = kinds.pose(actor.details.pose) if actor.details else None
    if pose is not None:
        is_standing = actor.behaviour.name == "stand"
        movement = pose.doing if is_standing else f"{movement}, {pose.doing}"
    return f"{movement} {state}".strip()[:_LONGEST]


def _movement(
    actor: Actor, ego_speed: float, oncoming: Collection[int], motions: Mapping[str, str]
) -> str:
    name = actor.behaviour.name
    if name not in BUILT_IN:
        return motions.get(name, "moving")
    heading_deg = _heading_deg(actor, oncoming)
    if name in ("follow_lane", "wrong_way"):
        return _driving(actor, heading_deg, ego_speed)
    if name == "walk_along" and abs(heading_deg) < _ALONG_DEG:
        return "moving the same way"
    if name == "walk_along" and abs(heading_deg) > _TOWARDS_DEG:
        return "coming towards the ego vehicle"
    if BUILT_IN[name].has_side:
        side = "right" if math.sin(math.radians(heading_deg)) > 0.0 else "left"
        return f"{BUILT_IN[name].doing} from the {side}"
    return BUILT_IN[name].doing


def _heading_deg(actor: Actor, oncoming: Collection[int]) -> float:
    """Return an actor's heading against the ego's direction; its placement has that against its lane's."""
    heading_deg = 180.0 if actor.behaviour.name == "wrong_way" else actor.placement.heading_deg
    if actor.placement.lane in oncoming:
        heading_deg += 180.0 if heading_deg <= 0.0 else -180.0
    return heading_deg


def _driving(actor: Actor, heading_deg: float, ego_speed: float) -> str:
    """Return what a driver does that keeps to its lane, in whichever direction."""
    usual = BUILT_IN[actor.behaviour.name].parameters["speed"].default
    speed = actor.behaviour.parameters.get("speed", usual)
    is_ahead = actor.placement.ahead_m >= 0.0
    if speed == 0.0:
        return BUILT_IN["stand"].doing
    if abs(heading_deg) > 90.0:
        return "coming towards the ego vehicle" if is_ahead else "driving the other way"
    if speed < _SLOW * ego_speed:
        return "driving slowly ahead" if is_ahead else "driving slowly"
    return BUILT_IN["follow_lane"].doing


def _phenomena(weather: Weather, ordinary: Weather) -> list[str]:
    """Return everything that can be seen of unusual weather."""
    phenomena = []
    if weather.fog_visual_range_m < min(FOG_M, ordinary.fog_visual_range_m):
        phenomena.append("fog")
    if weather.precipitation_mm_h > ordinary.precipitation_mm_h:
        phenomena.append(f"heavy {weather.precipitation}")
    if weather.sun_elevation_deg < DARK_DEG < ordinary.sun_elevation_deg:
        phenomena.append("darkness")
    elif weather.sun_elevation_deg <= 0.0 < ordinary.sun_elevation_deg:
        phenomena.append("twilight")
    elif _has_low_sun(weather) and ordinary.sun_elevation_deg > _LOW_DEG:
        phenomena.append("low sun")
    if weather.friction < min(_SLIPPERY, ordinary.friction):
        phenomena.append("ice or water on the road")
    return phenomena or ["unusual weather"]


def _has_low_sun(weather: Weather) -> bool:
    is_veiled = weather.precipitation != "none" or weather.fog_visual_range_m < FOG_M
    is_low = 0.0 < weather.sun_elevation_deg < _LOW_DEG
    return is_low and not is_veiled and weather.cloud_cover < _HIDDEN
