"""Settings of a text that a catalogue can show: its roads, weather and traffic."""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

from oodscen.author._knowledge.base import (
    BackgroundTraffic,
    Conditions,
    HazardKind,
    Knowledge,
    RoadKind,
)
from oodscen.author._reading.claim_extraction import read_claims
from oodscen.author._staging.anchors import has_landmarks
from oodscen.claims._roads import holds_by_traits, is_of_kind, road_claims
from oodscen.claims._things import mentions
from oodscen.data._claim import Claim
from oodscen.prompts._digest import CatalogueDigest, MapLine

_OF_LANES = frozenset({"one_way", "oncoming", "two_lane", "three_lane", "four_lane"})
"""Traits that the phrases of a place tell in words of their own, or not at all."""
_FOG_M = 1_000.0
"""Visual range below which a text calls it fog, m."""
_LOW_SUN_DEG = 15.0
"""Elevation below which a text says where the sun is, degrees."""
_ZENITH_DEG = 90.0


class Scope(NamedTuple):
    """The settings that the texts of a hazard may have."""

    places: Sequence[RoadKind]
    conditions: Sequence[str]
    traffic: Sequence[BackgroundTraffic]


def every_setting(hazard: HazardKind, knowledge: Knowledge) -> Scope:
    """Return all settings that suit a hazard, in whatever simulator."""
    return Scope(places_of(hazard, knowledge), hazard.conditions, knowledge.traffic)


@dataclass(frozen=True)
class Showable:
    """The settings that a catalogue can show."""

    knowledge: Knowledge
    digest: CatalogueDigest

    def scope(self, hazard: HazardKind) -> Scope:
        """Return the settings of a hazard that the catalogue can show.

        If it can show none of the places or none of the conditions, all of them are kept: staging then says what is
        missing.
        """
        conditions = self.knowledge.condition_keys
        shown = [
            key
            for key in hazard.conditions
            if key not in conditions or self._can_show(conditions[key])
        ]
        return Scope(
            self._places(hazard) or places_of(hazard, self.knowledge),
            shown or hazard.conditions,
            self._traffic,
        )

    def lacking_place(self, hazard: HazardKind) -> tuple[str, ...]:
        """Return the traits of a road on which a hazard could be met; none if the catalogue has such a road."""
        places = places_of(hazard, self.knowledge)
        if not places or self._places(hazard):
            return ()
        first = places[0]
        return tuple(trait for trait in first.traits if trait not in {*_OF_LANES, *first.told})

    def _places(self, hazard: HazardKind) -> list[RoadKind]:
        """Return the places of a hazard that the catalogue has, in the author's words or else in the catalogue's."""
        places, roads = places_of(hazard, self.knowledge), roads_for(hazard, self.digest)
        return list(_by_phrases(places, roads)) or _by_description(places, roads)

    @cached_property
    def _traffic(self) -> tuple[BackgroundTraffic, ...]:
        behaviours = {kind.id for kind in self.digest.behaviours}
        return tuple(
            traffic
            for traffic in self.knowledge.traffic
            if all(map(self._has_things, traffic.phrases))
            and (traffic.actor is None or traffic.actor.behaviour in behaviours)
        )

    def _can_show(self, condition: Conditions) -> bool:
        limits, weather = self.digest.limits, condition.weather
        highest = _highest(weather.get("sun_elevation_deg"), _ZENITH_DEG)
        if highest < limits.sun_deg or (highest < _LOW_SUN_DEG and not limits.sun_is_drawn):
            return False
        precipitation = weather.get("precipitation", "none")
        if precipitation != "none":
            least = _lowest(weather.get("precipitation_mm_h"), 0.0)
            if not limits.offers(str(precipitation)) or limits.intensity < least:
                return False
        if _highest(weather.get("friction"), 1.0) < limits.friction:
            return False
        range_m = _highest(weather.get("fog_visual_range_m"), _FOG_M)
        return range_m >= min(limits.fog_m, _FOG_M)

    def _has_things(self, phrase: str) -> bool:
        return all(
            any(mention.thing.fits(asset) for asset in self.digest.assets)
            for mention in mentions(phrase)
        )


def roads_for(hazard: HazardKind, digest: CatalogueDigest) -> list[MapLine]:
    """Return the maps that have all that a hazard needs of its road."""
    needed = set(hazard.needs.traits)
    return [
        road
        for road in digest.maps
        if needed <= set(road.features) and has_landmarks(road, hazard.stage)
    ]


def places_of(hazard: HazardKind, knowledge: Knowledge) -> list[RoadKind]:
    """Return the kinds of road on which a hazard can be met."""
    return [place for key in hazard.places for place in knowledge.place_keys.get(key, ())]


def _by_phrases(places: Iterable[RoadKind], roads: Sequence[MapLine]) -> Iterator[RoadKind]:
    """Yield the places that one of the roads is, with the phrases that are true of it."""
    featured = [(road, frozenset(road.features)) for road in roads]
    for place in places:
        told = tuple(place.told.items())
        phrases = tuple(
            phrase
            for phrase in place.phrases
            if any(
                _is_true(_statement(phrase, place.traits, told), road, features)
                for road, features in featured
            )
        )
        if len(phrases) == len(place.phrases):
            yield place
        elif phrases:
            yield place.model_copy(update={"phrases": phrases})


def _by_description(places: Iterable[RoadKind], roads: Sequence[MapLine]) -> list[RoadKind]:
    """Return the roads of the kinds that the places are, each by its own description."""
    return [
        place.model_copy(update={"traits": road.traits, "phrases": (f"on {road.description}",)})
        for place in places
        for road in roads
        if place.traits[0] in road.traits
        and road.description.startswith(("a ", "an "))
        and all(_holds(claim, road) for claim in _claims_of(f"on {road.description}"))
    ]


class _RoadStatement(NamedTuple):
    """The traits and claims that a phrase of a place tells of its road."""

    traits: frozenset[str]
    claims: tuple[Claim, ...]


@lru_cache(maxsize=2048)
def _statement(
    phrase: str, traits: tuple[str, ...], told: tuple[tuple[str, tuple[str, ...]], ...]
) -> _RoadStatement:
    """Return what a phrase tells of a road with these traits, some of which it tells by one of their words only."""
    unknown = {
        trait
        for trait, words in told
        if not any(re.search(rf"\b{re.escape(word)}", phrase) for word in words)
    }
    return _RoadStatement(frozenset(traits) - _OF_LANES - unknown, _claims_of(phrase))


def _is_true(statement: _RoadStatement, road: MapLine, features: frozenset[str]) -> bool:
    """Return whether a road is as a phrase tells; one without traits or without a file may be anything."""
    if not road.traits or not road.layout:
        return True
    has_traits = all(trait in features or is_of_kind(trait, road) for trait in statement.traits)
    return has_traits and all(_holds(claim, road) for claim in statement.claims)


def _holds(claim: Claim, road: MapLine) -> bool:
    return holds_by_traits(claim, road) or (claim.kind == "road" and claim.value in road.features)


@lru_cache(maxsize=512)
def _claims_of(phrase: str) -> tuple[Claim, ...]:
    """Return what a phrase claims about the road."""
    return tuple(road_claims(read_claims(f"The ego vehicle is {phrase}.")))


def _lowest(value: object, default: float) -> float:
    """Return the lower end of a range."""
    return float(value[0]) if isinstance(value, tuple) else default


def _highest(value: object, default: float) -> float:
    """Return the upper end of a range."""
    return float(value[1]) if isinstance(value, tuple) else default
