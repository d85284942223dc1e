"""Ordinary road users in place of a hazard: the twin's text and its scene name the same one."""

from typing import NamedTuple

from oodscen._seeding import stream
from oodscen.author._knowledge.base import HazardKind, RoadKind
from oodscen.prompts._scenario.describe_path import plain

_STREETS = frozenset({"urban", "residential"})
_HEAVY = frozenset(
    "truck bus tram tanker excavator road_roller cement_mixer overturned_truck camper trailer "
    "garbage_truck fire_truck scaffolding school_bus tractor tow_truck".split()
)
_WALKS = 0.55
"""Share of the twins on streets in which someone walks along the pavement, if the hazard is not a vehicle."""


class StandIn(NamedTuple):
    """An ordinary road user that takes the place of a hazard in its twin."""

    assets: tuple[str, ...]
    is_ahead: bool
    """True if it drives ahead in the ego's lane; otherwise it walks along the pavement."""
    clause: str


_CLAUSES = {
    "car": "a car drives ahead in the lane at an even speed",
    "van": "a van drives ahead in the lane at an even speed",
    "lorry": "a lorry drives ahead in the lane at an even speed",
}
_ASSETS = {"car": ("car",), "van": ("van",), "lorry": ("truck",)}
_WALKER = StandIn(("adult",), False, "the lane is free and a person walks along the pavement")


def stand_in(hazard: HazardKind | None, text: str, place: RoadKind | None) -> StandIn | None:
    """Return the road user in place of a hazard that its recipe removes; `None` if there is none."""
    if hazard is None or hazard.stage is None or place is None:
        return None
    parts = [actor for actor in hazard.stage.actors if actor.hazard]
    if not parts or any(actor.ordinary != "remove" for actor in parts):
        return None
    kind, size = stream(0, "stand-in", plain(text)).random(2)
    is_street = bool(_STREETS & set(place.traits))
    if is_street and kind < _WALKS:
        return _WALKER
    is_heavy = any(_HEAVY & set(actor.asset) for actor in parts)
    nouns = ("lorry", "lorry", "van") if is_heavy else ("car", "car", "van")
    noun = nouns[int(size * len(nouns))]
    return StandIn(_ASSETS[noun], True, _CLAUSES[noun])
