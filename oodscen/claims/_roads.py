"""Checks of claims about the road against the catalogue's entry for its map."""

from typing import Protocol

from oodscen.data._claim import Claim


class Road(Protocol):
    """The known properties of a map: a `RoadMap`, or a line of a catalogue's digest."""

    @property
    def lanes(self) -> int:
        """Number of driving lanes in the ego's direction."""
        ...

    @property
    def oncoming_lanes(self) -> int:
        """Number of driving lanes for oncoming traffic."""
        ...

    @property
    def traits(self) -> tuple[str, ...]:
        """Kinds of road that the map is."""
        ...


def is_so(claim: Claim, road: Road) -> bool:
    """Return whether a claim of kind road, lanes or own_lanes holds on a map that has traits."""
    if claim.kind == "road":
        return _is(claim.value, road)
    wanted = int(claim.value)
    if claim.kind == "own_lanes" or not road.oncoming_lanes:
        return road.lanes == wanted
    both = road.lanes + road.oncoming_lanes == wanted
    return both or ("divided" in road.traits and road.lanes == wanted)


def _is(value: str, road: Road) -> bool:
    if value == "two_way":
        return road.oncoming_lanes > 0
    return bool(_ANY_OF.get(value, frozenset({value})) & set(road.traits))


_ANY_OF = {
    "urban": frozenset({"urban", "residential"}),
    "signalised": frozenset({"signalised", "signalized"}),
    "curve": frozenset({"curve", "winding"}),
    "junction": frozenset({"junction", "t_junction", "roundabout"}),
}
"""Traits that satisfy a value, any one of them; other values need the trait of the same name."""
