"""Checks of claims about the road against the catalogue's entry for its map."""

from collections.abc import Iterable, Sequence

from oodscen.data._catalogue import RoadMap
from oodscen.data._claim import Claim
from oodscen.prompts._digest import MapLine

Road = RoadMap | MapLine


def road_claims(claims: Iterable[Claim]) -> list[Claim]:
    """Return the claims about the road."""
    return [claim for claim in claims if claim.kind in ("road", "lanes", "own_lanes")]


def fitting_roads(claims: Sequence[Claim], maps: Iterable[RoadMap]) -> tuple[str, ...]:
    """Return the ids of the maps on which all claims about the road hold; any may hold on a map without traits."""
    return tuple(
        road.id
        for road in maps
        if not road.traits or all(holds_on(claim, road) for claim in claims)
    )


def holds_on(claim: Claim, road: RoadMap) -> bool:
    """Return whether a claim about the road holds on a map that has traits."""
    return holds_by_traits(claim, road) or (claim.value == "shoulder" and road.has_shoulder)


def holds_by_traits(claim: Claim, road: Road) -> bool:
    """Return whether a claim of kind road, lanes or own_lanes holds by a map's traits and numbers of lanes."""
    if claim.kind == "road":
        return is_of_kind(claim.value, road)
    claimed = int(claim.value)
    if claim.kind == "own_lanes" or not road.oncoming_lanes:
        return road.lanes == claimed
    if "divided" in road.traits and road.lanes == claimed:
        return True
    return road.lanes + road.oncoming_lanes == claimed


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
"""Traits any of which satisfies a value; other values need the trait of the same name."""
