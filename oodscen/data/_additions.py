"""Possible additions to a catalogue, and the catalogue extended by them."""

import re
from collections.abc import Iterable, Mapping, Sequence, Set
from itertools import chain, count
from typing import Any, Literal, assert_never, get_args

from pydantic import Field, model_validator

from oodscen.data._base import Data
from oodscen.data._catalogue import (
    LANDMARKS,
    Asset,
    BehaviourKind,
    Catalogue,
    RoadMap,
    WeatherRange,
)
from oodscen.data._category import Category
from oodscen.data._weather import WeatherKind, is_weather_kind
from oodscen.errors import UsageError

AdditionKind = Literal["asset", "state", "behaviour", "weather", "map", "other"]
"""`other` is something no catalogue can provide, e.g. an author that knows how to stage a hazard."""

_KINDS = {"behavior": "behaviour", "trait": "map"} | {kind: kind for kind in get_args(AdditionKind)}
"""Kinds of additions by the words that models write for them."""
_WEATHER_WORDS = {
    "ice": "a road as slippery as ice",
    "low_sun": "a low sun that dazzles",
    "glare": "glare in the camera",
}
"""Readable words for the weather names that need them."""
DENSE_FOG_M = 60.0
"""Visual range up to which fog counts as dense, m."""
ICE = 0.25
"""Friction up to which a road counts as icy."""


class Addition(Data):
    """One thing that a catalogue lacks."""

    kind: AdditionKind
    name: str = Field(min_length=1, max_length=160)
    """Id of an asset or behaviour; a kind of weather; the traits of one map, joined by ` + `; of a
    state `asset: state`."""
    category: Category | None = None
    """Category of the asset; `None` for other kinds."""

    @model_validator(mode="before")
    @classmethod
    def _read(cls, value: Any) -> Any:
        return _tidy(_split(value) if isinstance(value, str) else value)

    @property
    def traits(self) -> tuple[str, ...]:
        """Traits of the map that is missing."""
        return tuple(self.name.split(" + ")) if self.kind == "map" else ()

    @property
    def words(self) -> str:
        """The addition for a reader: `an asset: fallen tree`."""
        name = self.name.replace("_", " ")
        if self.kind == "map":
            return f"a map with: {', '.join(trait.replace('_', ' ') for trait in self.traits)}"
        if self.kind == "weather":
            return f"weather: {_WEATHER_WORDS.get(self.name, name)}"
        if self.kind == "other":
            return name
        article = "an" if self.kind == "asset" else "a"
        return f"{article} {self.kind}: {name}"

    @property
    def key(self) -> tuple[AdditionKind, frozenset[str]]:
        """The same for additions of one thing, whatever the case of its name and the order of its traits."""
        return self.kind, frozenset(self.traits or (self.name.casefold(),))

    def brings(self, other: "Addition") -> bool:
        """Return whether making this addition also provides `other`."""
        if self.kind == other.kind == "map":
            return set(other.traits) <= set(self.traits)
        return self.key == other.key


def _split(text: str) -> dict[str, str]:
    """Parse `weather: snow`; a bare name is an asset."""
    head, colon, name = text.partition(":")
    words = head.casefold().split()
    if colon and words and words[-1] in _KINDS:
        return {"kind": _KINDS[words[-1]], "name": name.strip()[:160]}
    return {"kind": "asset", "name": text.strip()[:160]}


def _tidy(value: Any) -> Any:
    """Normalise ids to lower case with underscores, and states to `asset: state`, so that each thing has one name."""
    if not isinstance(value, Mapping):
        return value
    name, kind = value.get("name"), value.get("kind")
    if not isinstance(name, str) or kind == "other":
        return value
    if kind == "state":
        parts = [*filter(None, map(str.strip, name.split(":")))]
        return {**value, "name": ": ".join((*map(_as_id, parts[:1]), *parts[1:]))}
    parts = name.split("+") if kind == "map" else [name]
    return {**value, "name": " + ".join(filter(None, map(_as_id, parts)))}


def _as_id(words: str) -> str:
    return "_".join(words.casefold().split())


def map_with(traits: Iterable[str]) -> Addition:
    """Return the addition of a single map that has all these traits; of any road if there are none."""
    return Addition(kind="map", name=" + ".join(dict.fromkeys(traits)) or "road")


def extend(catalogue: Catalogue, additions: Iterable[Addition]) -> Catalogue:
    """Return the catalogue extended by placeholders for some additions.

    A placeholder has a name and a plausible size but cannot be drawn: it shows what could be staged, not
    how it would look. An addition of kind `other`, or that the catalogue has already, changes nothing.

    Raises:
        UsageError: If one is no addition.
    """
    additions = tuple(additions)
    for addition in additions:
        if not isinstance(addition, Addition):
            raise UsageError(f"each addition must be an Addition, not {addition!r:.80}")
    # A state needs its asset.
    for addition in sorted(additions, key=lambda addition: addition.kind == "state"):
        catalogue = catalogue.model_copy(update=_changes(catalogue, addition))
    return catalogue


def _changes(catalogue: Catalogue, addition: Addition) -> dict[str, Any]:
    """Return the fields of a catalogue that an addition changes."""
    match addition.kind:
        case "asset":
            if addition.name in {asset.id for asset in catalogue.assets}:
                return {}
            return {"assets": (*catalogue.assets, _asset(addition))}
        case "state":
            name, _, state = (word.strip() for word in addition.name.partition(":"))
            return {"assets": tuple(_with_state(asset, name, state) for asset in catalogue.assets)}
        case "behaviour":
            if addition.name in {kind.id for kind in catalogue.behaviours}:
                return {}
            return {"behaviours": (*catalogue.behaviours, _behaviour(catalogue, addition))}
        case "weather":
            return {"weather": _with_weather(catalogue.weather, addition.name)}
        case "map":
            has_it = any(road.description == addition.words for road in catalogue.maps)
            if has_it or not catalogue.maps:
                return {}
            return {"maps": (*catalogue.maps, _map(catalogue.maps, addition))}
        case "other":
            return {}
        case _:
            assert_never(addition.kind)


_SIZES: dict[str, tuple[float, float, float]] = {
    "vehicle": (4.5, 1.9, 1.6),
    "cyclist": (1.8, 0.6, 1.8),
    "pedestrian": (0.4, 0.6, 1.75),
    "animal": (1.6, 0.5, 1.2),
    "signal": (0.4, 0.8, 2.6),
}


def _asset(addition: Addition) -> Asset:
    category: Category = addition.category or "object"
    length, width, height = _SIZES.get(category, (1.0, 1.0, 0.8))
    return Asset(
        id=addition.name,
        category=category,
        description=addition.name.replace("_", " "),
        length=length,
        width=width,
        height=height,
    )


def _with_state(asset: Asset, name: str, state: str) -> Asset:
    """Return an asset with a further state, if it has that name."""
    if name not in (asset.id, *asset.names) or not state or state in asset.states:
        return asset
    return asset.model_copy(update={"states": (*asset.states, state)})


def _behaviour(catalogue: Catalogue, addition: Addition) -> BehaviourKind:
    categories = {category for kind in catalogue.behaviours for category in kind.categories}
    return BehaviourKind(
        id=addition.name, description=addition.words, categories=tuple(sorted(categories))
    )


def _with_weather(weather: WeatherRange, name: str) -> WeatherRange:
    if is_weather_kind(name):
        return weather.model_copy(update=_widened(weather, name))
    if name in weather.others:
        return weather
    return weather.model_copy(update={"others": (*weather.others, name)})


def _widened(weather: WeatherRange, kind: WeatherKind) -> dict[str, Any]:
    """Return the fields of a range that must change to hold a kind of weather."""
    match kind:
        case "night":
            return {"min_sun_elevation_deg": -90.0}
        case "fog":
            return {"min_fog_visual_range_m": min(weather.min_fog_visual_range_m, 30.0)}
        case "ice":
            return {"min_friction": min(weather.min_friction, 0.1)}
        case "rain" | "snow":
            return {
                "precipitation": tuple(dict.fromkeys((*weather.precipitation, kind))),
                "max_precipitation_mm_h": max(weather.max_precipitation_mm_h, 30.0),
            }
        case _:
            assert_never(kind)


def _map(maps: Sequence[RoadMap], addition: Addition) -> RoadMap:
    """Return a map like the first one, with the traits of an addition."""
    model, traits = maps[0], addition.traits
    slug = re.sub(r"[^a-z0-9]+", "_", addition.name.casefold()).strip("_")
    return model.model_copy(
        update={
            "id": _unused_id(f"added_{slug}".rstrip("_"), {road.id for road in maps}),
            "description": addition.words,
            "file": "",
            "traits": traits,
            "landmarks": tuple(kind for kind in LANDMARKS if kind in traits),
            "oncoming_lanes": max(model.oncoming_lanes, int("oncoming" in traits)),
            "has_shoulder": model.has_shoulder or "shoulder" in traits,
        }
    )


def _unused_id(name: str, used: Set[str]) -> str:
    """Return a name, numbered if it is in use: names in other scripts have the same slug."""
    numbered = (f"{name}_{number}" for number in count(2))
    return next(candidate for candidate in chain([name], numbered) if candidate not in used)
