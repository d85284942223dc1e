"""The visible part of a hazard, in words: its things, their places and what they do, without their story."""

import math
from collections.abc import Mapping
from types import MappingProxyType

from oodscen.data._catalogue import Asset, Catalogue
from oodscen.data._details import DetailKinds, described
from oodscen.data._map_state import MapPart, MapState
from oodscen.data._scene import DARK_DEG, FOG_M, Actor, Ego, Hazard, Visible, Weather
from oodscen.driving._motion.behaviours import BUILT_IN

_INSIDE_M = 1.4
"""Offset from a lane's centre up to which a thing is in that lane, m."""
_SLOW = 0.6
"""Share of the ego's speed below which others are slow."""
_ALONG_DEG, _TOWARDS_DEG = 45.0, 135.0
_LOW_DEG = 12.0
"""Sun elevation below which the sun stands low, degrees."""
_SLIPPERY = 0.5

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
    "half": "stuck half-way",
}
_SIGNALS = frozenset(
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
    known = {asset.id: asset for asset in catalogue.assets}
    kinds = catalogue.details or DetailKinds()
    lanes = next((road.lanes for road in catalogue.maps if road.id == map_id), 1)
    visibles = [
        Visible(
            what=_bare(_described(actor, known, kinds)),
            where=_where(actor, ego.lane, lanes),
            doing=_doing(actor, known[actor.asset], ego.speed, kinds, motions),
        )
        for actor in actors
        if actor.id in hazard.actors and actor.asset in known
    ]
    if hazard.weather is not None:
        visibles += [
            Visible(what=what, where="everywhere") for what in _sky(weather, hazard.weather)
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


def _bare(description: str) -> str:
    """Return a description without its article."""
    first, _, rest = description.partition(" ")
    return rest[:120] if first in ("a", "an", "the") and rest else description[:120]


def _described(actor: Actor, known: Mapping[str, Asset], kinds: DetailKinds) -> str:
    """Return an asset's description, with the details other than its pose."""
    description = known[actor.asset].description
    if actor.details is None:
        return description
    return described(description, actor.details.model_copy(update={"pose": ""}), known, kinds)


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


def _doing(
    actor: Actor, asset: Asset, ego_speed: float, kinds: DetailKinds, motions: Mapping[str, str]
) -> str:
    name, heading = actor.behaviour.name, actor.placement.heading_deg
    shown = _SHOWN.get(actor.state, "")
    if actor.state in _SIGNALS and asset.category in ("signal", "work_zone"):
        return shown
    if name == "follow_lane":
        speed = actor.behaviour.parameters.get("speed", ego_speed)
        moves = "driving slowly ahead" if speed < _SLOW * ego_speed else BUILT_IN[name].doing
        moves = BUILT_IN["stand"].doing if speed == 0.0 else moves
    elif name == "walk_along" and abs(heading) < _ALONG_DEG:
        moves = "moving the same way"
    elif name == "walk_along" and abs(heading) > _TOWARDS_DEG:
        moves = "coming towards the ego vehicle"
    elif name not in BUILT_IN:
        moves = motions.get(name, "moving")
    else:
        moves = BUILT_IN[name].doing
        if BUILT_IN[name].has_side:
            moves += f" from the {'right' if math.sin(math.radians(heading)) > 0.0 else 'left'}"
    pose = kinds.pose(actor.details.pose) if actor.details else None
    if pose is not None:
        moves = pose.doing if name == "stand" else f"{moves}, {pose.doing}"
    return f"{moves} {shown}".strip()[:120]


def _sky(weather: Weather, ordinary: Weather) -> list[str]:
    """Return what can be seen of unusual weather."""
    found = []
    if weather.fog_visual_range_m < min(FOG_M, ordinary.fog_visual_range_m):
        found.append("fog")
    if weather.precipitation_mm_h > ordinary.precipitation_mm_h:
        found.append(f"heavy {weather.precipitation}")
    if weather.sun_elevation_deg < DARK_DEG < ordinary.sun_elevation_deg:
        found.append("darkness")
    elif weather.sun_elevation_deg < _LOW_DEG < ordinary.sun_elevation_deg:
        found.append("low sun")
    if weather.friction < min(_SLIPPERY, ordinary.friction):
        found.append("ice or water on the road")
    return found or ["unusual weather"]
