"""CARLA's catalogue: valid data without CARLA, with what it lacks named as the reason."""

import pytest
from oodscen_carla import CarlaSimulator, load_catalogue

from oodscen._paper import ATTESTED
from oodscen.author._knowledge.loading import load_knowledge
from oodscen.author._realisation import realise
from oodscen.data._catalogue import Catalogue
from oodscen.errors import SceneError
from oodscen.prompts._digest import CatalogueDigest
from oodscen.testing import example_scene

CATALOGUE = load_catalogue()
DIGEST = CatalogueDigest.of(CATALOGUE)
KNOWLEDGE = load_knowledge()


def test_it_is_valid_and_every_id_is_there_once():
    assert Catalogue.parse(CATALOGUE.to_json()) == CATALOGUE
    for ids in (
        [asset.id for asset in CATALOGUE.assets],
        [road.id for road in CATALOGUE.maps],
        [kind.id for kind in CATALOGUE.behaviours],
    ):
        assert len(ids) == len(set(ids))
    assert (CATALOGUE.simulator, CATALOGUE.version) == ("carla", "0.9.16")
    assert len(CATALOGUE.assets) >= 190


def test_names_elsewhere_are_names_that_somebody_uses():
    asked = set(KNOWLEDGE.categories) | {
        name for one in KNOWLEDGE.substitute for name in (one.wanted, *one.by)
    }
    named = {name for asset in CATALOGUE.assets for name in asset.names}
    assert named <= asked
    categories = KNOWLEDGE.categories
    for asset in CATALOGUE.assets:
        for name in asset.names:
            if name in categories and name != "metal_sheet":
                assert categories[name] == asset.category, asset.id


@pytest.mark.parametrize("hazard", KNOWLEDGE.hazards, ids=lambda one: one.id)
def test_snow_and_animals_are_missing_wherever_they_are_needed(hazard):
    missing = realise(hazard, DIGEST, KNOWLEDGE).missing
    if "snow" in hazard.needs.weather:
        assert any((one.kind, one.name) == ("weather", "snow") for one in missing)
    animals = [n for n in hazard.needs.assets if KNOWLEDGE.category(n) == "animal"]
    if animals:
        assert {one.name for one in missing if one.category == "animal"} >= set(animals)


def test_it_shows_whatever_the_paper_simulated_in_it(diverse_labels):
    shown = {
        hazard.label
        for hazard in KNOWLEDGE.hazards
        if not realise(hazard, DIGEST, KNOWLEDGE).missing
    }
    assert len(diverse_labels) == len(ATTESTED)
    assert set(diverse_labels) <= shown


@pytest.fixture
def diverse_labels():
    from oodscen.author._builtin import BuiltinAuthor

    return [hazard.label for hazard in BuiltinAuthor()._trees.simulated]


def test_towns_have_no_files_and_say_what_they_have():
    for road in CATALOGUE.maps:
        assert road.file == ""
        line = next(line for line in DIGEST.maps if line.id == road.id)
        assert line.landmarks == ()
        assert line.somewhere == road.landmarks


def test_a_scene_in_the_words_of_another_simulator_is_refused_in_short_lines_that_say_what_to_do():
    with pytest.raises(SceneError) as refused, CarlaSimulator("127.0.0.1:1") as simulator:
        simulator.reset(example_scene(), 0)
    first, *faults, advice = str(refused.value).splitlines()
    assert [fault.split(":")[0] for fault in faults] == ["  - actors[0].asset"]
    assert f"known are {len(simulator.catalogue().assets)}: " in faults[0]
    assert "the catalogue 'carla'" in advice
    assert max(map(len, (first, *faults, advice))) < 300
