"""A simulator's vocabulary: static data that is readable without starting the simulator."""

from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar, Literal, Protocol, Self, TypeVar, get_args

from pydantic import Field, model_validator

from oodscen._field_docs import with_fields
from oodscen._words.decimals import exact
from oodscen.data._base import Data, LeanData
from oodscen.data._category import Category
from oodscen.data._designs.motion import KEYED, Motion, motion_faults
from oodscen.data._designs.prop import FLAT_M, Prop, check_prop, sizes_of
from oodscen.data._detail_checks import check_details, unknown_words
from oodscen.data._details import AssetDetails, DetailKinds, shown_as
from oodscen.data._issues import IssuesError, below
from oodscen.data._map_state import MapPart
from oodscen.data._scene import Actor, Scene
from oodscen.data._weather import CLEAR_AIR_M, Precipitation, Weather
from oodscen.errors import Issue

if TYPE_CHECKING:
    from oodscen.data._additions import Addition


LandmarkKind = Literal["junction", "roundabout", "tunnel", "bridge", "crest", "traffic_light"]
LANDMARKS: tuple[LandmarkKind, ...] = get_args(LandmarkKind)
"""Places along a road at which something can be staged."""
LONGEST_ASSET_M = 1_000.0
"""Greatest length, width and height of an asset, m."""


@with_fields
class Asset(LeanData):
    """A kind of object that can be placed in a scene."""

    _left_out: ClassVar = ("offers",)

    id: str
    category: Category
    description: str
    """Visible appearance, e.g. `a large brown cardboard box`."""
    length: float = Field(gt=0, le=LONGEST_ASSET_M)
    """Extent along x, m."""
    width: float = Field(gt=0, le=LONGEST_ASSET_M)
    """Extent along y, m."""
    height: float = Field(gt=0, le=LONGEST_ASSET_M)
    """Extent along z, m."""
    tags: tuple[str, ...] = ()
    """Further words for the asset: `emergency`, `heavy`, `debris` ..."""
    states: tuple[str, ...] = ()
    """Allowed values of `Actor.state`; the first is the default."""
    passable: tuple[str, ...] = ()
    """States in which the asset blocks no one although its box does, e.g. a gate's `open`."""
    names: tuple[str, ...] = ()
    """Ids of the same thing in other catalogues, e.g. `police_car`; the asset serves wherever one is needed."""
    offers: AssetDetails | None = None
    """Poses, open parts and other details that it can show; left out of the JSON text if there are none."""

    def is_passable(self, state: str = "") -> bool:
        """Return whether a vehicle can drive over or through the asset in the given state."""
        shown = state or (self.states[0] if self.states else "")
        return self.height < FLAT_M or shown in self.passable


@with_fields
class BehaviourParameter(Data):
    """A numeric parameter of a behaviour."""

    minimum: float
    maximum: float
    default: float
    description: str = ""

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if self.minimum > self.maximum:
            fault = f"{self.minimum:g} is above the maximum, {self.maximum:g}"
            raise IssuesError([Issue("minimum", fault)])
        if not self.minimum <= self.default <= self.maximum:
            fault = f"{self.default:g} is outside {self.minimum:g} to {self.maximum:g}"
            raise IssuesError([Issue("default", fault)])
        return self


@with_fields
class BehaviourKind(Data):
    """A behaviour that actors can have."""

    noun: ClassVar[str] = "behaviour"

    id: str
    description: str
    """The actor's motion before and after the trigger."""
    categories: tuple[Category, ...]
    """Categories of actors that can have this behaviour."""
    parameters: dict[str, BehaviourParameter] = {}
    needs_other: bool = False
    """True if `Behaviour.other` must name the actor that carries, tows or owns this one."""
    like: str = ""
    """For a behaviour of the simulator's own: id of the most similar built-in one, which stands in for it
    wherever no simulator runs, as in the checks of a scene. Empty for a built-in behaviour."""

    @property
    def built_in(self) -> str:
        """Id of the built-in behaviour that this one is, or that stands in for it."""
        return self.like or self.id


@with_fields
class RoadMap(Data):
    """A road network and the ego's starting point on it."""

    id: str
    description: str
    """Short description, e.g. `a two-lane residential street`."""
    file: str
    """OpenDRIVE file: `package:path/inside.xodr` for a shipped map, or a path."""
    road: str = ""
    """OpenDRIVE id of the road on which the ego starts; empty for the first road."""
    start_m: float = Field(default=0.0, ge=0)
    """Position of the ego's start along that road, m."""
    route: tuple[str, ...] = ()
    """OpenDRIVE ids of the roads that the ego drives next, in order, including connecting roads of
    junctions; empty to go straight on at every choice."""
    forward: bool = True
    """True if the ego drives in the direction of the road's reference line."""
    lanes: int = Field(ge=1)
    """Number of driving lanes in the ego's direction."""
    oncoming_lanes: int = Field(default=0, ge=0)
    has_shoulder: bool = False
    speed_limit: float = Field(gt=0)
    """m/s"""
    length_m: float = Field(gt=0)
    """Usable length ahead of the start, m."""
    traits: tuple[str, ...] = ()
    """`residential`, `urban`, `highway`, `rural`, `curve`, `junction`, `one_way` ..."""
    landmarks: tuple[LandmarkKind, ...] = ()
    """Landmarks known to be on its roads, for maps without a file to search."""


@with_fields
class WeatherRange(Data):
    """The range of weather that a simulator can show."""

    min_sun_elevation_deg: float = 0.0
    """Lowest sun elevation; -90 with night, 0 with dusk, more for daylight only."""
    sun_is_drawn: bool = True
    """False if every sun looks alike, as in a simulator without shade: no scene can be about the sun."""
    min_fog_visual_range_m: float = CLEAR_AIR_M
    """Shortest visual range in fog, m; 10 km if the simulator has no fog."""
    precipitation: tuple[Precipitation, ...] = ("none",)
    max_precipitation_mm_h: float = 0.0
    min_friction: float = 1.0
    """Lowest friction; 1 if the road is always dry."""
    others: tuple[str, ...] = ()
    """Weather that can be shown but has no scale in a scene: `dust`, `wind` ..."""


class Catalogue(LeanData):
    """The closed vocabulary of scenes in one simulator."""

    _left_out: ClassVar = ("details", "draws_props")

    schema_version: Literal[1] = 1
    simulator: str
    version: str
    ego: Asset
    assets: tuple[Asset, ...]
    behaviours: tuple[BehaviourKind, ...]
    maps: tuple[RoadMap, ...]
    weather: WeatherRange
    map_parts: tuple[MapPart, ...] = ()
    """Parts of its maps whose state a scene can change: `street_lamps`, `signals`, `signs`."""
    camera: Literal["dash", "top"] = "dash"
    """The pictures that the simulator draws: `dash` for views forward from the ego, with any `Camera`; `top`
    for views straight down only, such as `Camera.above()`."""
    details: DetailKinds | None = None
    """Poses and states of parts that the simulator draws; left out of the JSON text if there are none."""
    draws_props: bool = False
    """Things made to order are drawn from their designs, not as boxes; left out of the JSON text if not."""

    @model_validator(mode="after")
    def _unambiguous(self) -> Self:
        ids = {
            "assets": [asset.id for asset in self.assets],
            "behaviours": [behaviour.id for behaviour in self.behaviours],
            "maps": [road_map.id for road_map in self.maps],
        }
        issues = [
            Issue(kind, f"the id {name!r} occurs {count} times")
            for kind, names in ids.items()
            for name, count in Counter(names).items()
            if count > 1
        ]
        if issues:
            raise IssuesError(issues)
        return self

    @property
    def by_name(self) -> dict[str, Asset]:
        """The first asset of every name, ids before other names."""
        return by_name(self.assets)

    def asset(self, name: str) -> Asset:
        """Return an asset by id; raises `KeyError` if it is unknown."""
        return {asset.id: asset for asset in self.assets}[name]

    def behaviour(self, name: str) -> BehaviourKind:
        """Return a behaviour by id; raises `KeyError` if it is unknown."""
        return {kind.id: kind for kind in self.behaviours}[name]

    def map(self, name: str) -> RoadMap:
        """Return a map by id; raises `KeyError` if it is unknown."""
        return {road.id: road for road in self.maps}[name]

    def extended(self, additions: "Iterable[Addition]") -> "Catalogue":
        """Return the catalogue extended by placeholders for some additions.

        A placeholder has a name and a plausible size but cannot be drawn: it shows what could be
        staged, not how it would look.

        Args:
            additions: The additions, e.g. those of `Pruner.restoration`.

        Raises:
            UsageError: If one is no addition.
        """
        from oodscen.data._additions import extend

        return extend(self, additions)

    def with_made(self, made: Iterable[Prop], motions: Iterable[Motion] = ()) -> "Catalogue":
        """Return the catalogue extended by things and motions made to order; what it has already stays."""
        known = {asset.id for asset in self.assets}
        sizes = sizes_of(self.assets)
        added = tuple(prop.asset(sizes) for prop in made if prop.id not in known)
        can = {kind.id for kind in self.behaviours}
        learned = tuple(motion.kind() for motion in motions if motion.id not in can)
        if not added and not learned:
            return self
        return self.model_copy(
            update={
                "assets": (*self.assets, *added),
                "behaviours": (*self.behaviours, *learned),
            }
        )

    def for_scene(self, scene: Scene) -> "Catalogue":
        """Return the catalogue with the things and motions that a scene brings along."""
        has_made = scene.made or scene.motions
        return self.with_made(scene.made, scene.motions) if has_made else self

    def shown(self, actor: Actor) -> Asset:
        """Return an actor's asset with the size and the words that its details give it.

        Raises:
            KeyError: If the catalogue lacks the asset.
        """
        asset = self.asset(actor.asset)
        if actor.details is None:
            return asset
        things = {one.id: one for one in self.assets}
        return shown_as(asset, actor.details, things, self.details or DetailKinds())

    def bodies(self, scene: Scene) -> list[tuple[str, Asset, str]]:
        """Return id, asset and state of every body in a scene: `ego`, then the actors in order.

        The sizes are those of the actors' poses and other details.

        Raises:
            KeyError: If the catalogue lacks an asset.
        """
        whole = self.for_scene(scene)
        assets = {asset.id: asset for asset in whole.assets}
        bodies = [("ego", self.ego, "")]
        bodies += [
            (actor.id, whole.shown(actor) if actor.details else assets[actor.asset], actor.state)
            for actor in scene.actors
        ]
        return [
            (name, asset, state or (asset.states[0] if asset.states else ""))
            for name, asset, state in bodies
        ]

    def lacks(self, scene: Scene) -> list[Issue]:
        """Return an issue, with close matches, for everything in a scene that the catalogue lacks.

        Only the vocabulary is checked here; `Scene.check` checks room on the road, overlap and reachability too.
        """
        faults: list[Issue] = []
        for index, prop in enumerate(scene.made):
            faults += below(f"made[{index}]", check_prop(prop, self.assets))
        for index, motion in enumerate(scene.motions):
            faults += below(f"motions[{index}]", self._check_motion(motion, scene))
        return faults or self.for_scene(scene)._check(scene)

    def _check_motion(self, motion: Motion, scene: Scene) -> list[Issue]:
        """Return the faults of a motion that depend on the catalogue and on the ego's speed."""
        issues = motion_faults(motion, scene.ego.speed) if motion.by == "ego" else []
        if any(kind.id == motion.id and kind.like != KEYED for kind in self.behaviours):
            issues.append(Issue("id", f"the catalogue has {motion.id!r} already"))
        return issues

    def _check(self, scene: Scene) -> list[Issue]:
        issues: list[Issue] = []
        if not scene.map.endswith(".xodr"):
            issues += _unknown("map", "map", scene.map, [road.id for road in self.maps])
        issues += below("weather", self._check_weather(scene.weather))
        if (ordinary := scene.hazard.weather) is not None:
            issues += below("hazard.weather", self._check_weather(ordinary))
            sun = scene.weather.sun_elevation_deg
            if not self.weather.sun_is_drawn and ordinary.sun_elevation_deg != sun:
                message = f"must be {sun:g} as in the scene: the simulator draws every sun alike"
                issues.append(Issue("hazard.weather.sun_elevation_deg", message))
        if scene.map_state is not None:
            issues += [
                Issue(f"map_state.{part}", f"{self.simulator} cannot draw the map's own as {state}")
                for part, state in scene.map_state.faults()
                if part not in self.map_parts
            ]
        for index, actor in enumerate(scene.actors):
            issues += below(f"actors[{index}]", self._check_actor(actor, scene.made))
        for key, counterpart in scene.hazard.actors.items():
            if counterpart is not None:
                found = self._check_actor(counterpart, scene.made)
                issues += below(f"hazard.actors.{key}", found)
        return issues + _check_belonging(scene)

    def _check_actor(self, actor: Actor, made: Sequence[Prop]) -> list[Issue]:
        assets = {asset.id: asset for asset in self.assets}
        kinds = {kind.id: kind for kind in self.behaviours}
        does = actor.behaviour
        asset, kind = assets.get(actor.asset), kinds.get(does.name)
        issues = _unknown("asset", "asset", actor.asset, assets)
        issues += _unknown("behaviour.name", "behaviour", does.name, kinds)
        if asset and kind and asset.category not in kind.categories:
            able = ", ".join(kind.categories)
            message = f"{asset.id!r} is a {asset.category}; {kind.id!r} is for {able}"
            issues.append(Issue("behaviour.name", message))
        if asset and actor.state:
            issues += _unknown("state", "state", actor.state, asset.states)
        if kind:
            issues += below("behaviour.parameters", _check_parameters(kind, does.parameters))
        if kind and kind.needs_other and does.other is None:
            message = f"{kind.id!r} needs the actor that carries, tows or owns this one"
            issues.append(Issue("behaviour.other", message))
        if asset and actor.details is not None:
            built_in = kind.built_in if kind else "stand"
            detail_kinds, props = self.details or DetailKinds(), {prop.id: prop for prop in made}
            found = check_details(actor.details, asset, built_in, assets, detail_kinds, props)
            issues += below("details", found)
        return issues

    def _check_weather(self, weather: Weather) -> list[Issue]:
        allowed, issues = self.weather, []
        if weather.sun_elevation_deg < allowed.min_sun_elevation_deg:
            issues.append(
                Issue("sun_elevation_deg", f"at least {exact(allowed.min_sun_elevation_deg)}")
            )
        if weather.fog_visual_range_m < allowed.min_fog_visual_range_m:
            issues.append(
                Issue("fog_visual_range_m", f"at least {exact(allowed.min_fog_visual_range_m)}")
            )
        if weather.precipitation not in allowed.precipitation:
            offered = ", ".join(allowed.precipitation)
            issues.append(Issue("precipitation", f"{weather.precipitation!r}: only {offered}"))
        elif weather.precipitation_mm_h > allowed.max_precipitation_mm_h:
            issues.append(
                Issue("precipitation_mm_h", f"at most {exact(allowed.max_precipitation_mm_h)}")
            )
        if weather.friction < allowed.min_friction:
            issues.append(Issue("friction", f"at least {exact(allowed.min_friction)}"))
        return issues


def _check_belonging(scene: Scene) -> list[Issue]:
    """Return issues for actors that belong to each other in a cycle."""
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


def _check_parameters(kind: BehaviourKind, given: Mapping[str, float]) -> list[Issue]:
    issues: list[Issue] = []
    for name, value in given.items():
        if (allowed := kind.parameters.get(name)) is None:
            issues += _unknown(name, "parameter", name, kind.parameters)
        elif not allowed.minimum <= value <= allowed.maximum:
            limits = f"{exact(allowed.minimum)} to {exact(allowed.maximum)}"
            issues.append(Issue(name, f"{exact(value)} is outside {limits}"))
    return issues


class _Named(Protocol):
    """A thing with an id and other names."""

    @property
    def id(self) -> str: ...

    @property
    def names(self) -> tuple[str, ...]: ...


_Thing = TypeVar("_Thing", bound=_Named)


def by_name(things: Sequence[_Thing]) -> dict[str, _Thing]:
    """Return the first thing of every name, ids before other names."""
    named = {name: thing for thing in reversed(things) for name in thing.names}
    return named | {thing.id: thing for thing in things}


def _unknown(path: str, kind: str, name: str, known: Collection[str]) -> list[Issue]:
    """Return one issue with close matches if `name` is unknown, else none."""
    return [] if name in known else [Issue(path, unknown_words(kind, name, known))]
