import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen._seeding import stream
from oodscen.author._knowledge.base import Knowledge
from oodscen.author._knowledge.loading import load_knowledge
from oodscen.author._reading.claim_extraction import read_claims
from oodscen.author._realisation import realise
from oodscen.author._settings import Showable, every_setting
from oodscen.author._staging.background_traffic import available
from oodscen.author._writing.compose import Composer
from oodscen.claims._roads import fitting_roads, road_claims
from oodscen.data._catalogue import WeatherRange
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.prompts._digest import CatalogueDigest
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE

KNOWLEDGE = load_knowledge()
FEW_MAPS = st.lists(st.sampled_from(SHIPPED_MAPS), min_size=1, max_size=3, unique=True).map(tuple)
STAGED = [hazard for hazard in KNOWLEDGE.hazards if hazard.stage is not None]


def digest_of(**fields: object) -> CatalogueDigest:
    return CatalogueDigest.of(FLAT_CATALOGUE.model_copy(update=fields))


@pytest.mark.parametrize("rich", [False, True])
def test_a_catalogue_that_shows_a_hazard_everywhere_leaves_all_its_settings(
    rich: bool, digest: CatalogueDigest, rich_digest: CatalogueDigest
) -> None:
    everything = rich_digest if rich else digest
    shown = Showable(KNOWLEDGE, everything)
    for hazard in KNOWLEDGE.hazards:
        if not realise(hazard, everything, KNOWLEDGE).missing:
            places, conditions, traffic = every_setting(hazard, KNOWLEDGE)
            scope = shown.scope(hazard)
            assert [*scope.places] == [*places]
            assert [*scope.conditions] == [*conditions]
            assert [*scope.traffic] == [*traffic]


@given(FEW_MAPS, st.sampled_from(STAGED))
def test_phrases_are_true_of_a_road_of_the_catalogue(maps, hazard) -> None:
    few = digest_of(maps=maps)
    if realise(hazard, few, KNOWLEDGE).missing:
        return
    for place in Showable(KNOWLEDGE, few).scope(hazard).places:
        for phrase in place.phrases:
            claims = road_claims(read_claims(f"The ego vehicle is {phrase}."))
            roads = fitting_roads(claims, maps)
            assert roads, phrase
            if re.search(r"\b(?:bend|curv|winding)", phrase):
                traits = {trait for road in maps if road.id in roads for trait in road.traits}
                assert traits & {"curve", "winding"}, phrase


@given(FEW_MAPS, st.sampled_from(STAGED))
def test_a_map_that_is_missing_is_enough_once_it_is_there(maps, hazard) -> None:
    few = FLAT_CATALOGUE.model_copy(update={"maps": maps})
    missing = realise(hazard, CatalogueDigest.of(few), KNOWLEDGE).missing
    more = CatalogueDigest.of(few.extended(missing))
    if {one.kind for one in missing} == {"map"}:
        assert not realise(hazard, more, KNOWLEDGE).missing


@given(
    st.builds(
        WeatherRange,
        min_sun_elevation_deg=st.sampled_from([-90.0, 0.0, 6.0, 20.0]),
        sun_is_drawn=st.booleans(),
        min_fog_visual_range_m=st.sampled_from([30.0, 10_000.0]),
        precipitation=st.sampled_from([("none",), ("none", "rain"), ("none", "rain", "snow")]),
        max_precipitation_mm_h=st.sampled_from([0.0, 20.0]),
        min_friction=st.sampled_from([0.1, 1.0]),
    ),
    st.sampled_from(STAGED),
)
def test_conditions_are_within_the_weather_on_offer(weather: WeatherRange, hazard) -> None:
    known = KNOWLEDGE.condition_keys
    shown = Showable(KNOWLEDGE, digest_of(weather=weather)).scope(hazard).conditions
    if set(shown) == set(hazard.conditions):
        return
    for key in shown:
        fields = known[key].weather
        assert fields["sun_elevation_deg"][1] >= weather.min_sun_elevation_deg
        assert fields.get("precipitation", "none") in weather.precipitation
        assert fields.get("friction", (1.0, 1.0))[1] >= weather.min_friction


def test_no_traffic_is_told_that_the_catalogue_lacks() -> None:
    lone = digest_of(assets=tuple(a for a in FLAT_CATALOGUE.assets if a.category != "vehicle"))
    hazard = KNOWLEDGE.by_id["fallen-tree"]
    assert {one.key for one in Showable(KNOWLEDGE, lone).scope(hazard).traffic} <= {"quiet"}
    assert available(KNOWLEDGE.company, lone) == []
    still = digest_of(behaviours=FLAT_CATALOGUE.behaviours[:1])
    assert available(KNOWLEDGE.company, still) == []


def test_a_road_of_no_known_words_is_told_by_its_description(knowledge: Knowledge) -> None:
    (bend,) = (road for road in SHIPPED_MAPS if road.id == "town_bend")
    hazard = knowledge.by_id["fallen-tree"].model_copy(update={"places": ("urban",)})
    scope = Showable(knowledge, digest_of(maps=(bend,))).scope(hazard)
    text = next(Composer(knowledge).texts(hazard, stream(0, "bend"), set(), scope=scope))
    assert bend.description in text[0].lower() + text[1:], text
