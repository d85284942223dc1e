"""The visible part of a hazard, in words: its things, their places and what they do, without their story."""

import math
import textwrap
from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from oodscen._words.text import one_line
from oodscen.claims._surroundings import HEAVY_RAIN, HEAVY_SNOW
from oodscen.data._catalogue import Asset, BehaviourKind, Catalogue
from oodscen.data._details import DetailKinds, described
from oodscen.data._map_state import MapPart
from oodscen.data._scene import Actor, Ego, Placement, Scene, Visible
from oodscen.data._weather import DARK_DEG, FOG_M, Weather
from oodscen.driving._motion.behaviours.codes import Code
from oodscen.driving._motion.behaviours.table import BUILT_IN
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor, ego_strip
from oodscen.errors import OodscenError

_INSIDE_M = 1.4
"""Offset from a lane's centre up to which a thing is in that lane, m."""
_SLOW = 0.6
"""Share of the ego's speed below which others are slow."""
_ALONG_DEG, _TOWARDS_DEG = 45.0, 135.0
"""Headings up to which an actor moves the ego's way, and from which against it, degrees."""
_LONGEST = 120
"""Largest number of characters of a description."""
_LOW_DEG = 12.0
"""Sun elevation below which the sun stands low, degrees."""
_HIDDEN = 0.6
"""Cloud cover from which a low sun is hidden."""
_SLIPPERY = 0.5
"""Friction below which ice or water can be seen."""
_HEAVY = {"rain": HEAVY_RAIN, "snow": HEAVY_SNOW}
"""Rate from which precipitation is heavy, mm/h."""
_STANDING, _SAME_WAY = BUILT_IN["stand"].doing, BUILT_IN["follow_lane"].doing
_TOWARDS_EGO = BUILT_IN["wrong_way"].doing

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
_LIGHTS = {
    "hazard": "with its hazard lights on",
    "beacon": "with its beacon flashing",
    "unlit": "without lights",
    "indicate_left": "indicating left",
    "indicate_right": "indicating right",
}
"""States of vehicles, in words."""
_SIGNALS = {
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
"""States of signals and gates, in words."""


def visible_of(scene: Scene, catalogue: Catalogue) -> tuple[Visible, ...]:
    """Return everything that can be seen of a scene's hazard and its map's faults; equal things are named once."""
    hazard = scene.hazard
    setting = _Setting(
        {asset.id: asset for asset in catalogue.assets},
        {kind.id: kind for kind in catalogue.behaviours},
        catalogue.details or DetailKinds(),
        {motion.id: motion.description for motion in scene.motions},
        _Lanes.seen_by(scene.ego, scene.map, catalogue),
        scene.ego.speed,
    )
    visibles = [
        Visible(
            what=_without_article(_described(actor, setting)),
            where=_where(actor.placement, setting.lanes),
            doing=_doing(actor, setting),
        )
        for actor in scene.actors
        if actor.id in hazard.actors and actor.asset in setting.assets
    ]
    if hazard.weather is not None:
        visibles += [
            Visible(what=phenomenon, where="everywhere")
            for phenomenon in _phenomena(scene.weather, hazard.weather)
        ]
    if scene.map_state is not None:
        visibles += [
            Visible(what=f"{_FAULTS[fault]} {_PARTS[part]}", where="along the road")
            for part, fault in scene.map_state.faults()
        ]
    return tuple(dict.fromkeys(visibles))


class _Lanes(NamedTuple):
    """The driving lanes of a road, counted to the left of the ego's."""

    road: Corridor | None = None
    """The road; `None` if it cannot be read."""
    strips: Mapping[int, int] = MappingProxyType({})
    """The strip of each lane."""

    @classmethod
    def seen_by(cls, ego: Ego, map_id: str, catalogue: Catalogue) -> "_Lanes":
        """Return the lanes of a map; none if its road cannot be read."""
        try:
            road = load_corridor(map_id, catalogue)
            own = road.driving.index(ego_strip(road, ego.lane))
        except (OodscenError, ValueError):
            return cls()
        return cls(road, {number - own: strip for number, strip in enumerate(road.driving)})

    def is_oncoming(self, lane: int) -> bool:
        """Return whether the traffic of a lane comes towards the ego."""
        if self.road is None or lane not in self.strips:
            return False
        return self.road.strips[self.strips[lane]].direction < 0

    def beneath(self, place: Placement) -> tuple[int | None, float]:
        """Return the lane at a place and the offset from its centre; beside all lanes `None` and that from the ego's."""
        if self.road is None or place.lane not in self.strips:
            return place.lane, place.offset_m
        s = self.road.start + place.ahead_m
        t = self.road.centre(self.strips[place.lane], s) + place.offset_m
        beneath = self.road.strip_at(s, t)
        lane = next((lane for lane, strip in self.strips.items() if strip == beneath), None)
        return lane, t - self.road.centre(self.strips[lane or 0], s)


class _Setting(NamedTuple):
    """The setting on which the words for an actor depend."""

    assets: Mapping[str, Asset]
    behaviours: Mapping[str, BehaviourKind]
    details: DetailKinds
    motions: Mapping[str, str]
    """The looks of motions made to order, by id."""
    lanes: _Lanes
    ego_speed: float


def _without_article(description: str) -> str:
    first, _, rest = description.partition(" ")
    return _shortened(rest if first.lower() in ("a", "an", "the") and rest else description)


def _shortened(text: str) -> str:
    return textwrap.shorten(text, _LONGEST, placeholder=" …")


def _described(actor: Actor, setting: _Setting) -> str:
    """Return an asset's description, or its id if it has none, with the details other than its pose."""
    description = one_line(setting.assets[actor.asset].description)
    description = description or actor.asset.replace("_", " ")
    if actor.details is None:
        return description
    details = actor.details.model_copy(update={"pose": ""})
    return described(description, details, setting.assets, setting.details)


def _where(place: Placement, lanes: _Lanes) -> str:
    if place.ahead_m < 0.0:
        return "behind the ego vehicle"
    is_beside = place.lane != 0 and abs(place.offset_m) > _INSIDE_M
    lane, offset_m = lanes.beneath(place) if is_beside else (place.lane, place.offset_m)
    if lane == 0 and abs(offset_m) <= _INSIDE_M:
        return "in the ego's lane"
    side = "left" if (lane or offset_m) > 0.0 else "right"
    if lane is None:
        return f"beside the lanes on the {side}"
    if lane == 0:
        return f"beside the ego's lane on the {side}"
    return "in the oncoming lane" if lanes.is_oncoming(lane) else f"in a lane to the {side}"


def _doing(actor: Actor, setting: _Setting) -> str:
    """Return what an actor does, in which pose and with which lights."""
    asset = setting.assets[actor.asset]
    usual = asset.states[0] if asset.states else ""
    state, movement = actor.state or usual, _movement(actor, setting)
    if state in _SIGNALS and asset.category in ("signal", "work_zone"):
        signal = _SIGNALS[state]
        return signal if movement == _STANDING else _shortened(f"{movement}, {signal}")
    pose = setting.details.pose(actor.details.pose) if actor.details else None
    if pose is not None:
        movement = pose.doing if movement == _STANDING else f"{movement}, {pose.doing}"
    lights = "" if state == usual else (_LIGHTS | _SIGNALS).get(state, "")
    return _shortened(f"{movement} {lights}")


def _movement(actor: Actor, setting: _Setting) -> str:
    """Return the motion of an actor as the ego sees it: headings count from the actor's own lane."""
    does, placement = actor.behaviour, actor.placement
    kind = setting.behaviours.get(does.name)
    row = BUILT_IN.get(kind.built_in) if kind else None
    if kind is None or row is None:
        return setting.motions.get(does.name, "moving")
    heading_deg = 180.0 if row.code == Code.WRONG_WAY else placement.heading_deg
    if setting.lanes.is_oncoming(placement.lane):
        heading_deg += 180.0
    turned = abs(math.remainder(heading_deg, 360.0))
    default = kind.parameters["speed"].default if "speed" in kind.parameters else math.inf
    speed = does.parameters.get("speed", default)
    if speed == 0.0:
        return _STANDING
    is_ahead = placement.ahead_m >= 0.0
    if row.code in (Code.FOLLOW_LANE, Code.WRONG_WAY):
        if turned > 90.0:
            return _TOWARDS_EGO if is_ahead else "driving the other way"
        if speed < _SLOW * setting.ego_speed:
            return "driving slowly ahead" if is_ahead else "driving slowly"
        return _SAME_WAY
    if not row.has_side:
        return row.doing
    if turned < _ALONG_DEG:
        return "moving the same way"
    if turned > _TOWARDS_DEG:
        return _TOWARDS_EGO if is_ahead else "moving the other way"
    side = "right" if math.sin(math.radians(heading_deg)) > 0.0 else "left"
    return f"{row.doing} from the {side}"


def _phenomena(weather: Weather, ordinary: Weather) -> list[str]:
    """Return everything that can be seen of unusual weather."""
    phenomena = []
    if weather.fog_visual_range_m < min(FOG_M, ordinary.fog_visual_range_m):
        phenomena.append("fog")
    form, rate = weather.precipitation, weather.precipitation_mm_h
    if rate > ordinary.precipitation_mm_h or form not in ("none", ordinary.precipitation):
        phenomena.append(f"heavy {form}" if rate >= _HEAVY[form] else form)
    sun_deg = weather.sun_elevation_deg
    if sun_deg < DARK_DEG <= ordinary.sun_elevation_deg:
        phenomena.append("darkness")
    elif sun_deg <= 0.0 < ordinary.sun_elevation_deg:
        phenomena.append("twilight")
    elif sun_deg < _LOW_DEG <= ordinary.sun_elevation_deg and not _is_veiled(weather):
        phenomena.append("low sun")
    if weather.friction < min(_SLIPPERY, ordinary.friction):
        phenomena.append("ice or water on the road")
    return phenomena or ["unusual weather"]


def _is_veiled(weather: Weather) -> bool:
    """Return whether a low sun does not show."""
    is_foggy = weather.fog_visual_range_m < FOG_M
    return is_foggy or weather.precipitation != "none" or weather.cloud_cover >= _HIDDEN
