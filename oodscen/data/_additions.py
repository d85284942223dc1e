"""Possible additions to a catalogue, and the catalogue extended by them."""

import re
from collections.abc import Iterable, Mapping
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
from oodscen.data._scene import WeatherKind, is_weather_kind

AdditionKind = Literal["asset", "state", "behaviour", "weather", "map", "other"]
"""`other` is something no catalogue can provide, e.g. an author that knows how to stage a hazard."""

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

    def brings(self, other: "Addition") -> bool:
        """Return whether making this addition also provides `other`."""
        if self.kind == other.kind == "map":
            return set(other.traits) <= set(self.traits)
        return (self.kind, self.name.casefold()) == (other.kind, other.name.casefold())


_KINDS = {"behavior": "behaviour", "trait": "map"} | {kind: kind for kind in get_args(AdditionKind)}


def _split(text: str) -> dict[str, str]:
    """Parse `weather: snow`; a bare name is an asset."""
    head, colon, tail = text.partition(":")
    words = head.casefold().split()
    if colon and words and words[-1] in _KINDS:
        return {"kind": _KINDS[words[-1]], "name": tail.strip()[:160]}
    return {"kind": "asset", "name": text.strip()[:160]}


def _tidy(value: Any) -> Any:
    """Normalise ids to lower case with underscores, so that each thing has one name."""
    if not isinstance(value, Mapping):
        return value
    name = value.get("name")
    if isinstance(name, str) and value.get("kind") in ("asset", "behaviour", "weather"):
        return {**value, "name": "_".join(name.casefold().split())}
    return value


def map_with(traits: Iterable[str]) -> Addition:
    """Return the addition of a single map that has all these traits."""
    return Addition(kind="map", name=" + ".join(dict.fromkeys(traits)))


def extend(catalogue: Catalogue, additions: Iterable[Addition]) -> Catalogue:
    """Return the catalogue extended by placeholders for some additions.

    A placeholder has a name and a plausible size but cannot be drawn: it shows what could be staged, not
    how it would look. An addition of kind `other` changes nothing.
    """
    assets = list(catalogue.assets)
    behaviours = list(catalogue.behaviours)
    maps = list(catalogue.maps)
    weather = catalogue.weather
    for addition in additions:
        if addition.kind == "asset":
            if addition.name not in {asset.id for asset in assets}:
                assets.append(_asset(addition))
        elif addition.kind == "state":
            name, _, state = (part.strip() for part in addition.name.partition(":"))
            assets = [
                a.model_copy(update={"states": (*a.states, state)})
                if name in (a.id, *a.names)
                else a
                for a in assets
            ]
        elif addition.kind == "behaviour":
            every = sorted({category for kind in behaviours for category in kind.categories})
            added = BehaviourKind(
                id=addition.name, description=addition.words, categories=tuple(every)
            )
            behaviours.append(added)
        elif addition.kind == "weather":
            weather = _with_weather(weather, addition.name)
        elif addition.kind == "map" and maps:
            maps.append(_map(maps[0], addition))
    return catalogue.model_copy(
        update={
            "assets": tuple(assets),
            "behaviours": tuple(behaviours),
            "maps": tuple(maps),
            "weather": weather,
        }
    )


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


def _with_weather(weather: WeatherRange, name: str) -> WeatherRange:
    if is_weather_kind(name):
        return weather.model_copy(update=_widened(weather, name))
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


def _map(model: RoadMap, addition: Addition) -> RoadMap:
    traits = addition.traits
    slug = re.sub(r"[^a-z0-9]+", "_", addition.name.casefold()).strip("_")
    return model.model_copy(
        update={
            "id": f"added_{slug}",
            "description": addition.words,
            "file": "",
            "traits": traits,
            "landmarks": tuple(mark for mark in LANDMARKS if mark in traits),
            "oncoming_lanes": max(model.oncoming_lanes, int("oncoming" in traits)),
            "has_shoulder": model.has_shoulder or "shoulder" in traits,
        }
    )
