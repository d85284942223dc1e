"""A catalogue as prompts show it: just the vocabulary that an answer may use."""

from typing import Self

from oodscen._data import Data
from oodscen.catalogue import BehaviourKind, Catalogue, RoadMap
from oodscen.errors import DataError, UnknownComponent
from oodscen.prompts.landmarks import Landmark, landmarks


class AssetLine(Data):
    """One asset in a prompt."""

    id: str
    category: str
    description: str
    states: tuple[str, ...] = ()
    length_m: float = 0.0
    width_m: float = 0.0
    height_m: float = 0.0


class BehaviourLine(Data):
    """One behaviour in a prompt."""

    id: str
    description: str
    categories: tuple[str, ...]
    parameters: str = ""
    """E.g. `speed 0..20 (8)`: minimum, maximum, default."""


class MapLine(Data):
    """One map in a prompt."""

    id: str
    description: str
    lanes: int
    oncoming_lanes: int
    speed_limit: float
    traits: tuple[str, ...]
    landmarks: tuple[Landmark, ...] = ()


class CatalogueDigest(Data):
    """The closed vocabulary of one simulator."""

    assets: tuple[AssetLine, ...]
    behaviours: tuple[BehaviourLine, ...]
    maps: tuple[MapLine, ...]
    weather: str
    """What weather can be shown, in one line."""

    @classmethod
    def of(cls, catalogue: Catalogue) -> Self:
        """Summarise a catalogue."""
        return cls(
            assets=tuple(
                AssetLine(
                    id=a.id,
                    category=a.category,
                    description=a.description,
                    states=a.states,
                    length_m=a.length,
                    width_m=a.width,
                    height_m=a.height,
                )
                for a in catalogue.assets
            ),
            behaviours=tuple(_behaviour_line(kind) for kind in catalogue.behaviours),
            maps=tuple(_map_line(road, catalogue) for road in catalogue.maps),
            weather=_weather_line(catalogue),
        )


def _behaviour_line(kind: BehaviourKind) -> BehaviourLine:
    parameters = ", ".join(
        f"{name} {p.minimum:g}..{p.maximum:g} ({p.default:g})"
        for name, p in kind.parameters.items()
    )
    description = f"{kind.description} (needs `other`)" if kind.needs_other else kind.description
    return BehaviourLine(
        id=kind.id, description=description, categories=kind.categories, parameters=parameters
    )


def _map_line(road: RoadMap, catalogue: Catalogue) -> MapLine:
    return MapLine(
        id=road.id,
        description=road.description,
        lanes=road.lanes,
        oncoming_lanes=road.oncoming_lanes,
        speed_limit=road.speed_limit,
        traits=road.traits,
        landmarks=_landmarks(road, catalogue),
    )


def _landmarks(road: RoadMap, catalogue: Catalogue) -> tuple[Landmark, ...]:
    """Find what a map's file has; nothing where there is no file that can be read."""
    from oodscen.driving.roads import find_map, load_corridor

    try:
        return landmarks(load_corridor(find_map(road.id, catalogue)), road.traits)
    except (DataError, UnknownComponent):
        return ()


def _weather_line(catalogue: Catalogue) -> str:
    weather = catalogue.weather
    parts = ["night" if weather.min_sun_elevation_deg < -6 else "no night"]
    fog = weather.min_fog_visual_range_m
    parts.append(f"fog down to {fog:g} m visual range" if fog < 5_000 else "no fog")
    falling = [kind for kind in weather.precipitation if kind != "none"]
    if falling:
        parts.append(f"{' and '.join(falling)} up to {weather.max_precipitation_mm_h:g} mm/h")
    else:
        parts.append("no precipitation")
    parts.append(f"road friction down to {weather.min_friction:g}")
    return "; ".join(parts)
