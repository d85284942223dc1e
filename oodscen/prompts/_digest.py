"""Digests of catalogues for prompts: only the vocabulary that an answer may use."""

import re
from collections import Counter
from functools import cached_property, lru_cache
from typing import Self

from oodscen._words.decimals import exact
from oodscen.data._base import Data
from oodscen.data._catalogue import Asset, BehaviourKind, Catalogue, RoadMap, by_name
from oodscen.data._category import Category
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._roads.corridor import Corridor
from oodscen.errors import DataError, UnknownComponent
from oodscen.prompts._landmarks import Landmark, landmarks
from oodscen.prompts._layout import layout
from oodscen.prompts._weather_line import WeatherLimits, weather_line

_LEAST_SHARING = 3
"""Number of assets with the same states from which the states get a name of their own."""
_MOST_NAMED_VEHICLES = 7
"""Largest number of vehicles that are named as those that have a part."""

_NUMBER = r"-?[\d.]+?(?:e[+-]\d+)?"
_PARAMETER = re.compile(rf"(\w+) ({_NUMBER})\.\.({_NUMBER}) \(")
"""Name, minimum and maximum of a parameter in the line of a behaviour."""


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
        described = set(re.findall(r"[a-z0-9]+", self.description.casefold()))
        words = re.findall(r"[a-z0-9]+", self.id.casefold())
        return all(any(other.startswith(word) for other in described) for word in words)


class BehaviourLine(Data):
    """One behaviour in a prompt."""

    id: str
    description: str
    categories: tuple[Category, ...]
    parameters: str = ""
    """Parameters such as `speed 0..20 (8) m/s`: minimum, maximum, default, unit or meaning."""

    @property
    def limits(self) -> dict[str, tuple[float, float]]:
        """Minimum and maximum of every parameter, read from the line."""
        return {
            name: (float(minimum), float(maximum))
            for name, minimum, maximum in _PARAMETER.findall(self.parameters)
        }


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
    def by_name(self) -> dict[str, AssetLine]:
        """The first asset of every name, ids before other names."""
        return by_name(self.assets)

    @property
    def by_category(self) -> dict[str, tuple[AssetLine, ...]]:
        """The assets of each category, in the order of first appearance."""
        groups: dict[str, list[AssetLine]] = {}
        for asset in self.assets:
            groups.setdefault(asset.category, []).append(asset)
        return {category: tuple(assets) for category, assets in groups.items()}

    @property
    def state_sets(self) -> dict[str, tuple[str, ...]]:
        """States that many assets share, by the name that stands for them in a prompt."""
        counts = Counter(asset.states for asset in self.assets if asset.states)
        shared = [states for states, count in counts.items() if count >= _LEAST_SHARING]
        return {f"set {number}": states for number, states in enumerate(shared, start=1)}

    def states_of(self, asset: AssetLine) -> str:
        """Return the states of an asset in words, by the name of their set if many share them."""
        return self._names_of_sets.get(asset.states) or ", ".join(asset.states)

    @cached_property
    def _names_of_sets(self) -> dict[tuple[str, ...], str]:
        return {states: name for name, states in self.state_sets.items()}

    @classmethod
    def of(cls, catalogue: Catalogue) -> Self:
        """Return the digest of a catalogue."""
        details = catalogue.details
        return cls(
            assets=tuple(_asset_line(asset) for asset in catalogue.assets),
            behaviours=tuple(_behaviour_line(kind) for kind in catalogue.behaviours),
            maps=tuple(_map_line(road, catalogue) for road in catalogue.maps),
            weather=weather_line(catalogue),
            poses=tuple(kind.id for kind in details.poses) if details else (),
            parts=tuple(_part_line(kind.id, catalogue) for kind in details.parts)
            if details
            else (),
            map_parts=catalogue.map_parts,
        )


def _asset_line(asset: Asset) -> AssetLine:
    description = asset.description
    if description and {"flat", "smoke"} <= set(asset.tags):
        description += " (the size is that of its foot; its smoke rises above)"
    return AssetLine(
        id=asset.id,
        category=asset.category,
        description=description,
        states=asset.states,
        names=asset.names,
        length_m=asset.length,
        width_m=asset.width,
        height_m=asset.height,
    )


def _part_line(part: str, catalogue: Catalogue) -> str:
    """Return a part, with the vehicles that have it if they are few."""
    ids = [asset.id for asset in catalogue.assets if asset.offers and part in asset.offers.parts]
    return f"{part} ({', '.join(ids)})" if len(ids) <= _MOST_NAMED_VEHICLES else part


def _behaviour_line(kind: BehaviourKind) -> BehaviourLine:
    parameters = ", ".join(
        f"{name} {exact(parameter.minimum)}..{exact(parameter.maximum)} ({exact(parameter.default)}) "
        f"{parameter.description}".rstrip()
        for name, parameter in kind.parameters.items()
    )
    description = f"{kind.description} (needs `other`)" if kind.needs_other else kind.description
    return BehaviourLine(
        id=kind.id, description=description, categories=kind.categories, parameters=parameters
    )


def _map_line(road: RoadMap, catalogue: Catalogue) -> MapLine:
    marks, layout_words = _landmarks_and_layout(road, catalogue)
    return MapLine(
        id=road.id,
        description=road.description,
        lanes=road.lanes,
        oncoming_lanes=road.oncoming_lanes,
        speed_limit=road.speed_limit,
        traits=road.traits,
        landmarks=marks,
        somewhere=() if marks else road.landmarks,
        layout=layout_words,
    )


def _landmarks_and_layout(road: RoadMap, catalogue: Catalogue) -> tuple[tuple[Landmark, ...], str]:
    """Return the landmarks and layout of a map's file; both empty if there is no readable file."""
    if not road.file:
        return (), ""
    try:
        corridor = load_corridor(road.id, catalogue)
    except (DataError, UnknownComponent):
        return (), ""
    return _described_corridor(corridor, road.traits)


@lru_cache(maxsize=64)
def _described_corridor(
    corridor: Corridor, traits: tuple[str, ...]
) -> tuple[tuple[Landmark, ...], str]:
    """Return the landmarks and layout of a road, which every question about its map repeats."""
    return landmarks(corridor, traits), layout(corridor)
