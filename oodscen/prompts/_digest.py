"""Digests of catalogues for prompts: only the vocabulary that an answer may use."""

import re
from collections import Counter
from dataclasses import dataclass
from functools import lru_cache
from typing import Self, assert_never

from oodscen.data._additions import DENSE_FOG_M, ICE
from oodscen.data._base import Data
from oodscen.data._catalogue import Asset, BehaviourKind, Catalogue, RoadMap
from oodscen.data._scene import CLEAR_AIR_M, DUSK_DEG, WeatherKind, is_weather_kind
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor
from oodscen.errors import DataError, UnknownComponent
from oodscen.prompts._landmarks import Landmark, landmarks
from oodscen.prompts._layout import layout

_SHARED = 3
"""Number of assets from which their states get a name of their own."""
_FEW = 7
"""Largest number of vehicles that are named as those that have a part."""


class AssetLine(Data):
    """One asset in a prompt."""

    id: str
    category: str
    description: str
    states: tuple[str, ...] = ()
    names: tuple[str, ...] = ()
    """Names of the asset in other catalogues."""
    length_m: float = 0.0
    width_m: float = 0.0
    height_m: float = 0.0

    @property
    def is_plain(self) -> bool:
        """True if the description holds every word of the id, which then says enough."""
        told = set(re.findall(r"[a-z0-9]+", self.description.casefold()))
        words = re.findall(r"[a-z0-9]+", self.id.casefold())
        return all(any(one.startswith(word) for one in told) for word in words)


class BehaviourLine(Data):
    """One behaviour in a prompt."""

    id: str
    description: str
    categories: tuple[str, ...]
    parameters: str = ""
    """Parameters such as `speed 0..20 (8) m/s`: minimum, maximum, default, unit or meaning."""


class MapLine(Data):
    """One map in a prompt."""

    id: str
    description: str
    lanes: int
    oncoming_lanes: int
    speed_limit: float
    traits: tuple[str, ...]
    landmarks: tuple[Landmark, ...] = ()
    somewhere: tuple[str, ...] = ()
    """Kinds of landmarks that the map has at unknown positions along the ego's road."""
    layout: str = ""
    """The cross-section, bends and side roads in words; empty for a map without a readable file."""

    @property
    def features(self) -> tuple[str, ...]:
        """Traits, and kinds of landmarks that are not traits."""
        marks = (*(mark.kind for mark in self.landmarks), *self.somewhere)
        return tuple(dict.fromkeys((*self.traits, *marks)))


@dataclass(frozen=True)
class WeatherLimits:
    """The contents of a digest's line on the weather."""

    night: bool
    fog_m: float
    """Least visual range, m."""
    rain: bool
    snow: bool
    intensity: float
    """Greatest precipitation intensity, mm/h."""
    friction: float
    """Least friction."""
    sun_deg: float = -90.0
    """Lowest elevation of the sun, degrees; told only where there is no night."""
    sun_is_drawn: bool = True
    others: tuple[str, ...] = ()
    """Kinds of weather that no scene can ask for."""

    @classmethod
    def of(cls, line: str) -> "WeatherLimits":
        """Parse a line such as `night; fog down to 30 m visual range; rain and snow up to 60 mm/h; ...`."""

        def number(pattern: str, default: float) -> float:
            found = re.search(pattern, line)
            return float(found.group(1)) if found else default

        others = re.search(r"\balso ([^;]*), which no scene", line)
        return cls(
            night=re.search(r"\bno night\b", line) is None and "night" in line,
            fog_m=number(r"fog down to ([\d.e+]+)", CLEAR_AIR_M),
            rain=re.search(r"\brain\b", line) is not None,
            snow=re.search(r"\bsnow\b", line) is not None,
            intensity=number(r"up to ([\d.e+]+) mm/h", 0.0),
            friction=number(r"friction down to ([\d.e+]+)", 1.0),
            sun_deg=number(r"sun at (-?[\d.e+]+) degrees", -90.0),
            sun_is_drawn="every sun looks alike" not in line,
            others=tuple(others.group(1).split(", ")) if others else (),
        )

    def offers(self, need: str) -> bool:
        """Return whether a kind of weather can be shown, whether or not it has a scale in a scene."""
        return self._shows(need) if is_weather_kind(need) else need in self.others

    def _shows(self, kind: WeatherKind) -> bool:
        match kind:
            case "night":
                return self.night
            case "fog":
                return self.fog_m <= DENSE_FOG_M
            case "rain":
                return self.rain
            case "snow":
                return self.snow
            case "ice":
                return self.friction <= ICE
            case _:
                assert_never(kind)


class CatalogueDigest(Data):
    """The closed vocabulary of one simulator."""

    assets: tuple[AssetLine, ...]
    behaviours: tuple[BehaviourLine, ...]
    maps: tuple[MapLine, ...]
    weather: str
    """The weather that can be shown, in one line."""
    poses: tuple[str, ...] = ()
    """Poses of people."""
    parts: tuple[str, ...] = ()
    """States of vehicles' parts."""
    map_parts: tuple[str, ...] = ()
    """Parts of the maps whose state a scene can change."""

    @property
    def limits(self) -> "WeatherLimits":
        """The weather line as numbers."""
        return WeatherLimits.of(self.weather)

    def called(self, name: str) -> tuple[AssetLine, ...]:
        """Return the assets with a given name: matches by id first, then by other names."""
        exact = tuple(asset for asset in self.assets if asset.id == name)
        return (*exact, *(asset for asset in self.assets if name in asset.names))

    @property
    def by_category(self) -> dict[str, tuple[AssetLine, ...]]:
        """The assets of each category, in the order of first appearance."""
        found: dict[str, tuple[AssetLine, ...]] = {}
        for asset in self.assets:
            found[asset.category] = (*found.get(asset.category, ()), asset)
        return found

    @property
    def state_sets(self) -> dict[str, tuple[str, ...]]:
        """States that many assets share, by the name that stands for them in a prompt."""
        counts = Counter(asset.states for asset in self.assets if asset.states)
        shared = [states for states, count in counts.items() if count >= _SHARED]
        return {f"set {number}": states for number, states in enumerate(shared, start=1)}

    def states_of(self, asset: AssetLine) -> str:
        """Return the states of an asset in words, by the name of their set if many share them."""
        names = {states: name for name, states in self.state_sets.items()}
        return names.get(asset.states) or ", ".join(asset.states)

    @classmethod
    def of(cls, catalogue: Catalogue) -> Self:
        """Return the digest of a catalogue."""
        return cls(
            assets=tuple(
                AssetLine(
                    id=a.id,
                    category=a.category,
                    description=_described(a),
                    states=a.states,
                    names=a.names,
                    length_m=a.length,
                    width_m=a.width,
                    height_m=a.height,
                )
                for a in catalogue.assets
            ),
            behaviours=tuple(_behaviour_line(kind) for kind in catalogue.behaviours),
            maps=tuple(_map_line(road, catalogue) for road in catalogue.maps),
            weather=_weather_line(catalogue),
            poses=tuple(kind.id for kind in catalogue.details.poses) if catalogue.details else (),
            parts=tuple(_part_line(kind.id, catalogue) for kind in catalogue.details.parts)
            if catalogue.details
            else (),
            map_parts=catalogue.map_parts,
        )


def _described(asset: Asset) -> str:
    """Return an asset's description; the size of one that smokes or spreads flat says nothing of its smoke."""
    if asset.description and {"flat", "smoke"} <= set(asset.tags):
        return f"{asset.description} (the size is that of its foot; its smoke rises above)"
    return asset.description


def _part_line(part: str, catalogue: Catalogue) -> str:
    """Return a part, with the vehicles that have it if they are few."""
    having = [asset.id for asset in catalogue.assets if asset.offers and part in asset.offers.parts]
    return f"{part} ({', '.join(having)})" if len(having) <= _FEW else part


def _behaviour_line(kind: BehaviourKind) -> BehaviourLine:
    parameters = ", ".join(
        f"{name} {p.minimum:g}..{p.maximum:g} ({p.default:g}) {p.description}".rstrip()
        for name, p in kind.parameters.items()
    )
    description = f"{kind.description} (needs `other`)" if kind.needs_other else kind.description
    return BehaviourLine(
        id=kind.id, description=description, categories=kind.categories, parameters=parameters
    )


def _map_line(road: RoadMap, catalogue: Catalogue) -> MapLine:
    found, plan = _seen_along(road, catalogue)
    return MapLine(
        id=road.id,
        description=road.description,
        lanes=road.lanes,
        oncoming_lanes=road.oncoming_lanes,
        speed_limit=road.speed_limit,
        traits=road.traits,
        landmarks=found,
        somewhere=() if found else road.landmarks,
        layout=plan,
    )


def _seen_along(road: RoadMap, catalogue: Catalogue) -> tuple[tuple[Landmark, ...], str]:
    """Return the landmarks and layout of a map's file; both empty if there is no readable file."""
    if not road.file:
        return (), ""
    try:
        corridor = load_corridor(road.id, catalogue)
    except (DataError, UnknownComponent):
        return (), ""
    return _described_road(corridor, road.traits)


@lru_cache(maxsize=64)
def _described_road(
    corridor: Corridor, traits: tuple[str, ...]
) -> tuple[tuple[Landmark, ...], str]:
    """Return the landmarks and layout of a road, which every question about its map repeats."""
    return landmarks(corridor, traits), layout(corridor)


def _weather_line(catalogue: Catalogue) -> str:
    weather = catalogue.weather
    lowest = weather.min_sun_elevation_deg
    sun = "" if lowest < DUSK_DEG else f" (sun at {lowest:g} degrees or higher)"
    parts = ["no night" + sun if sun else "night"]
    if not weather.sun_is_drawn:
        parts.append("every sun looks alike: neither dusk nor glare")
    fog = weather.min_fog_visual_range_m
    parts.append(f"fog down to {fog:g} m visual range" if fog < 5_000 else "no fog")
    falling = [kind for kind in weather.precipitation if kind != "none"]
    if falling:
        parts.append(f"{' and '.join(falling)} up to {weather.max_precipitation_mm_h:g} mm/h")
    else:
        parts.append("no precipitation")
    parts.append(f"road friction down to {weather.min_friction:g}")
    if weather.others:
        parts.append(f"also {', '.join(weather.others)}, which no scene can ask for")
    return "; ".join(parts)
