"""Checks of claims about the road against the catalogue's entry for its map."""

from collections.abc import Iterable, Sequence

from oodscen.data._catalogue import RoadMap
from oodscen.data._claim import Claim
from oodscen.prompts._digest import MapLine

Road = RoadMap | MapLine


def of_roads(claims: Iterable[Claim]) -> list[Claim]:
    return [claim for claim in claims if claim.kind in ("road", "lanes", "own_lanes")]


def fitting_roads(claims: Sequence[Claim], maps: Iterable[RoadMap]) -> tuple[str, ...]:
    """Return the ids of the maps on which all claims about the road hold; one without traits has any."""
    return tuple(
        road.id
        for road in maps
        if not road.traits or all(is_so_or_has(claim, road) for claim in claims)
    )


def is_so_or_has(claim: Claim, road: RoadMap) -> bool:
    """Return whether a claim about the road holds on a map, whose shoulder is known by itself."""
    return is_so(claim, road) or (claim.value == "shoulder" and road.has_shoulder)


def is_so(claim: Claim, road: Road) -> bool:
    """Return whether a claim of kind road, lanes or own_lanes holds on a map that has traits."""
    if claim.kind == "road":
        return is_of_kind(claim.value, road)
    wanted = int(claim.value)
    if claim.kind == "own_lanes" or not road.oncoming_lanes:
        return road.lanes == wanted
    both = road.lanes + road.oncoming_lanes == wanted
    return both or ("divided" in road.traits and road.lanes == wanted)


def is_of_kind(value: str, road: Road) -> bool:
    """Return whether a map that has traits is a kind of road, or has a feature."""
    if value == "two_way":
        return road.oncoming_lanes > 0
    return bool(_ANY_OF.get(value, frozenset({value})) & set(road.traits))


_ANY_OF = {
    "urban": frozenset({"urban", "residential"}),
    "signalised": frozenset({"signalised", "signalized"}),
    "curve": frozenset({"curve", "winding"}),
    "junction": frozenset({"junction", "t_junction", "roundabout"}),
    "level_crossing": frozenset({"level_crossing", "rail_crossing"}),
    "hill": frozenset({"hill", "downhill"}),
}
"""Traits that satisfy a value, any one of them; other values need the trait of the same name."""
