"""Ordinary road users in place of a hazard: the twin's text and its scene name the same one."""

from typing import NamedTuple

from oodscen._seeding import stream
from oodscen._words.text import folded_words
from oodscen.author._knowledge.base import HazardKind, RoadKind

_STREETS = frozenset({"urban", "residential"})
"""Traits of the places that have a pavement."""
_HEAVY = frozenset(
    "truck bus tram tanker excavator road_roller cement_mixer overturned_truck camper trailer "
    "garbage_truck fire_truck scaffolding school_bus tractor tow_truck".split()
)
"""Assets of hazards in whose place something large drives."""
_WALKER_SHARE = 0.55
"""Share of the twins on streets in which someone walks along the pavement."""


class OrdinaryRoadUser(NamedTuple):
    """An ordinary road user that takes the place of a hazard in its twin."""

    assets: tuple[str, ...]
    is_ahead: bool
    """True if it drives ahead in the ego's lane; otherwise it walks along the pavement."""
    clause: str


_WALKER = OrdinaryRoadUser(
    ("adult",), False, "the lane is free and a person walks along the pavement"
)
_CAR, _VAN, _LORRY = (
    OrdinaryRoadUser((asset,), True, f"a {noun} drives ahead in the lane at an even speed")
    for noun, asset in (("car", "car"), ("van", "van"), ("lorry", "truck"))
)
_LARGE, _SMALL = (_LORRY, _LORRY, _VAN), (_CAR, _CAR, _VAN)
"""Vehicles from which one is drawn in place of a heavy hazard, and of any other."""


def ordinary_road_user(
    hazard: HazardKind | None, text: str, place: RoadKind | None
) -> OrdinaryRoadUser | None:
    """Return the road user in place of a hazard that its recipe removes; `None` if there is none."""
    if hazard is None or hazard.stage is None or place is None or not hazard.stage.removes_hazards:
        return None
    walker_draw, vehicle_draw = stream(0, "stand-in", folded_words(text)).random(2)
    if walker_draw < _WALKER_SHARE and not _STREETS.isdisjoint(place.traits):
        return _WALKER
    is_heavy = any(not _HEAVY.isdisjoint(actor.asset) for actor in hazard.stage.hazards)
    vehicles = _LARGE if is_heavy else _SMALL
    return vehicles[int(vehicle_draw * len(vehicles))]
