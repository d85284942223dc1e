"""What a simulator can show: static data, readable without starting it."""

from collections.abc import Collection, Mapping
from typing import ClassVar, Literal

from pydantic import Field

from oodscen.data._base import Data
from oodscen.data._scene import Actor, Scene, Weather
from oodscen.errors import Issue, close_matches

Category = Literal[
    "vehicle", "cyclist", "pedestrian", "animal", "object", "work_zone", "vegetation", "signal"
]


FLAT_M = 0.08
"""What is lower lies on the road: others drive over it and stand on it."""


class Asset(Data):
    """One thing that can be placed in a scene."""

    noun: ClassVar[str] = "asset"

    id: str
    category: Category
    description: str
    """What a person sees, e.g. `a large brown cardboard box`."""
    length: float = Field(gt=0)
    """Along x, m."""
    width: float = Field(gt=0)
    """Along y, m."""
    height: float = Field(gt=0)
    """Along z, m."""
    tags: tuple[str, ...] = ()
    """Further words for it: `emergency`, `heavy`, `debris` ..."""
    states: tuple[str, ...] = ()
    """What `Actor.state` may be; the first is the default."""
    passable: tuple[str, ...] = ()
    """States in which it is in nobody's way although its box is, e.g. a gate's `open`."""
    names: tuple[str, ...] = ()
    """What other catalogues call such a thing, e.g. `police_car`: it is one wherever that is needed."""

    def is_passable(self, state: str = "") -> bool:
        """Tell whether one can drive over or through it, in one of its states."""
        shown = state or (self.states[0] if self.states else "")
        return self.height < FLAT_M or shown in self.passable


class BehaviourParameter(Data):
    """One number that shapes a behaviour."""

    minimum: float
    maximum: float
    default: float
    description: str = ""


class BehaviourKind(Data):
    """One thing that actors can do."""

    noun: ClassVar[str] = "behaviour"

    id: str
    description: str
    """What the actor does before and after the trigger."""
    categories: tuple[Category, ...]
    """Who can do it."""
    parameters: dict[str, BehaviourParameter] = {}
    needs_other: bool = False
    """Whether `Behaviour.other` must name the actor that carries, tows or owns this one."""


class RoadMap(Data):
    """One road network, with the place where the ego starts."""

    noun: ClassVar[str] = "road map"

    id: str
    description: str
    """What a person would call it, e.g. `a two-lane residential street`."""
    file: str
    """OpenDRIVE file: `package:path/inside.xodr` for a shipped map, or a path."""
    road: str = ""
    """OpenDRIVE id of the road where the ego starts; empty is the first."""
    start_m: float = Field(default=0.0, ge=0)
    """Where along that road the ego starts."""
    route: tuple[str, ...] = ()
    """OpenDRIVE ids of the roads that the ego drives after it, in order, connecting roads of
    junctions included; empty goes straight on wherever there is a choice."""
    forward: bool = True
    """Whether the ego drives in the direction of the road's reference line."""
    lanes: int = Field(ge=1)
    """Driving lanes in the ego's direction."""
    oncoming_lanes: int = Field(default=0, ge=0)
    has_shoulder: bool = False
    speed_limit: float = Field(gt=0)
    """m/s"""
    length_m: float = Field(gt=0)
    """Usable length ahead of the start."""
    traits: tuple[str, ...] = ()
    """`residential`, `urban`, `highway`, `rural`, `curve`, `junction`, `one_way` ..."""
    landmarks: tuple[
        Literal["junction", "roundabout", "tunnel", "bridge", "crest", "traffic_light"], ...
    ] = ()
    """Kinds that its roads are known to have, where there is no file at hand to find them in."""


class WeatherRange(Data):
    """The weather that a simulator can show."""

    noun: ClassVar[str] = "weather range"

    min_sun_elevation_deg: float = -90.0
    """Above -6 where there is no night."""
    min_fog_visual_range_m: float = 10_000.0
    """10 km where there is no fog."""
    precipitation: tuple[Literal["none", "rain", "snow"], ...] = ("none",)
    max_precipitation_mm_h: float = 0.0
    min_friction: float = 1.0
    """1 where the road is always dry."""
    others: tuple[str, ...] = ()
    """Further weather that it can show and for which a scene has no scale: `dust`, `wind` ..."""


class Catalogue(Data):
    """The closed vocabulary for scenes in one simulator."""

    noun: ClassVar[str] = "catalogue"

    schema_version: Literal[1] = 1
    simulator: str
    version: str
    ego: Asset
    assets: tuple[Asset, ...]
    behaviours: tuple[BehaviourKind, ...]
    maps: tuple[RoadMap, ...]
    weather: WeatherRange

    def asset(self, name: str) -> Asset:
        """Return an asset by id; `KeyError` if there is none."""
        return {asset.id: asset for asset in self.assets}[name]

    def behaviour(self, name: str) -> BehaviourKind:
        """Return a behaviour by id; `KeyError` if there is none."""
        return {kind.id: kind for kind in self.behaviours}[name]

    def map(self, name: str) -> RoadMap:
        """Return a map by id; `KeyError` if there is none."""
        return {road.id: road for road in self.maps}[name]

    def check(self, scene: Scene) -> list[Issue]:
        """Find everything in a scene that this catalogue does not offer, with close matches.

        Only the vocabulary is checked here; room on the road, overlap and reachability are
        checked by `oodscen.driving.check_scene`.
        """
        issues: list[Issue] = []
        if not scene.map.endswith(".xodr"):
            issues += _unknown("map", "map", scene.map, [road.id for road in self.maps])
        issues += [
            Issue(f"weather.{i.path}", i.message) for i in self._check_weather(scene.weather)
        ]
        if scene.hazard.weather is not None:
            issues += [
                Issue(f"hazard.weather.{i.path}", i.message)
                for i in self._check_weather(scene.hazard.weather)
            ]
        for index, actor in enumerate(scene.actors):
            issues += self._check_actor(f"actors[{index}]", actor)
        for key, ordinary in scene.hazard.actors.items():
            if ordinary is not None:
                issues += self._check_actor(f"hazard.actors.{key}", ordinary)
        return issues + _check_belonging(scene)

    def _check_actor(self, path: str, actor: Actor) -> list[Issue]:
        assets = {asset.id: asset for asset in self.assets}
        kinds = {kind.id: kind for kind in self.behaviours}
        asset, kind = assets.get(actor.asset), kinds.get(actor.behaviour.name)
        here = f"{path}.behaviour"
        issues = _unknown(f"{path}.asset", "asset", actor.asset, assets)
        issues += _unknown(f"{here}.name", "behaviour", actor.behaviour.name, kinds)
        if asset and kind and asset.category not in kind.categories:
            able = ", ".join(kind.categories)
            message = f"{asset.id!r} is a {asset.category}; {kind.id!r} is for {able}"
            issues.append(Issue(f"{here}.name", message))
        if asset and actor.state:
            issues += _unknown(f"{path}.state", "state", actor.state, asset.states)
        if kind:
            issues += _check_parameters(f"{here}.parameters", kind, actor.behaviour.parameters)
        if kind and kind.needs_other and actor.behaviour.other is None:
            message = f"{kind.id!r} needs the actor that carries, tows or owns this one"
            issues.append(Issue(f"{here}.other", message))
        return issues

    def _check_weather(self, weather: Weather) -> list[Issue]:
        allowed, issues = self.weather, []
        if weather.sun_elevation_deg < allowed.min_sun_elevation_deg:
            issues.append(Issue("sun_elevation_deg", f"at least {allowed.min_sun_elevation_deg:g}"))
        if weather.fog_visual_range_m < allowed.min_fog_visual_range_m:
            issues.append(
                Issue("fog_visual_range_m", f"at least {allowed.min_fog_visual_range_m:g}")
            )
        if weather.precipitation not in allowed.precipitation:
            offered = ", ".join(allowed.precipitation)
            issues.append(Issue("precipitation", f"{weather.precipitation!r}: only {offered}"))
        elif weather.precipitation_mm_h > allowed.max_precipitation_mm_h:
            issues.append(
                Issue("precipitation_mm_h", f"at most {allowed.max_precipitation_mm_h:g}")
            )
        if weather.friction < allowed.min_friction:
            issues.append(Issue("friction", f"at least {allowed.min_friction:g}"))
        return issues


def _check_belonging(scene: Scene) -> list[Issue]:
    """Find actors that belong to each other in a ring."""
    owners = {actor.id: actor.behaviour.other for actor in scene.actors}
    issues: list[Issue] = []
    for index, actor in enumerate(scene.actors):
        seen: set[str] = set()
        name: str | None = actor.id
        while name is not None and name not in seen:
            seen.add(name)
            name = owners.get(name)
        if name == actor.id:
            message = f"{actor.id!r} would belong to itself"
            issues.append(Issue(f"actors[{index}].behaviour.other", message))
    return issues


def _check_parameters(path: str, kind: BehaviourKind, given: Mapping[str, float]) -> list[Issue]:
    issues: list[Issue] = []
    for name, value in given.items():
        if (allowed := kind.parameters.get(name)) is None:
            issues += _unknown(f"{path}.{name}", "parameter", name, kind.parameters)
        elif not allowed.minimum <= value <= allowed.maximum:
            limits = f"{allowed.minimum:g} to {allowed.maximum:g}"
            issues.append(Issue(f"{path}.{name}", f"{value:g} is outside {limits}"))
    return issues


def _unknown(path: str, kind: str, name: str, known: Collection[str]) -> list[Issue]:
    """Return one issue with close matches if `name` is not among `known`."""
    if name in known:
        return []
    matches = close_matches(name, known)
    hint = f"known: {', '.join(known)}" if known else "there are none"
    if matches:
        hint = f"did you mean {' or '.join(matches)}?"
    return [Issue(path, f"unknown {kind} {name!r}; {hint}")]
