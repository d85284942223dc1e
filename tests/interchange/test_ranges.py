from copy import deepcopy

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

from oodscen.data import Scene
from oodscen.driving._sight.placement import check_scene
from oodscen.errors import DataError
from oodscen.interchange import read_openscenario
from oodscen.interchange._ranges import _suffixes, changed, ranges, vary
from tests.interchange.staging import SCENES, catalogue

SCENE = min(
    (scene for scene in SCENES if any(actor.behaviour.trigger.value for actor in scene.actors)),
    key=lambda scene: len(scene.actors),
)


def test_both_ends_of_every_range_can_be_staged():
    parameters = ranges(SCENE, catalogue())
    assert parameters
    for parameter in parameters:
        assert parameter.low <= parameter.value <= parameter.high
        for end in (parameter.low, parameter.high):
            assert check_scene(changed(SCENE, {parameter.path: end}), catalogue()) == []


def test_variants_are_within_the_ranges_and_the_same_for_a_seed():
    parameters = ranges(SCENE, catalogue())
    variants = vary(SCENE, catalogue(), 3, seed=1)
    assert variants == vary(SCENE, catalogue(), 3, seed=1)
    assert variants != vary(SCENE, catalogue(), 3, seed=2)
    assert len({variant.id for variant in variants}) == 3
    for variant in variants:
        assert check_scene(variant, catalogue()) == []
        data = variant.model_dump(mode="json")
        for parameter in parameters:
            value = data
            for key in parameter.path:
                value = value[key]
            assert parameter.low - 1e-9 <= value <= parameter.high + 1e-9


def test_an_id_without_room_for_a_number_is_an_error():
    with pytest.raises(DataError, match="id"):
        vary(SCENE.model_copy(update={"id": "a" * 200}), catalogue(), 1)


def test_an_ordinary_drive_has_variants_that_are_ordinary():
    twin = SCENE.twin(2.0)
    (variant,) = vary(twin, catalogue(), 1)
    assert variant.id == f"{SCENE.id}.v001~twin"
    assert variant.is_ordinary


def test_a_scene_that_fails_itself_has_no_ranges_and_tells_a_hundred_overlaps_at_most():
    heap = [SCENE.actors[0].model_copy(update={"id": f"copy-{index}"}) for index in range(30)]
    crowded = SCENE.model_copy(update={"actors": (*SCENE.actors, *heap)})
    assert ranges(crowded, catalogue()) == ()
    assert vary(crowded, catalogue(), 1) == []
    faults = [issue for issue in check_scene(crowded, catalogue()) if "overlaps" in issue.message]
    assert len(faults) == 100


def test_parameters_of_a_file_have_values_in_both_distributions(tmp_path):
    file = SCENE.to_openscenario(catalogue(), mode="logical")
    paths = [file.save(tmp_path), *(tmp_path / name for name in file.beside)]
    scenario, deterministic, stochastic = map(etree.parse, paths)
    declared = {
        element.get("name"): element.get("value")
        for element in scenario.iter("ParameterDeclaration")
    }
    assert declared
    text = paths[0].read_text()
    assert all(f'"${name}"' in text for name in declared)
    for tree in (deterministic, stochastic):
        assert tree.find(".//ScenarioFile").get("filepath") == paths[0].name
        limits = {
            element.get("parameterName"): element.find(".//Range")
            for element in tree.iter()
            if element.get("parameterName")
        }
        assert set(limits) == set(declared)
        for name, limit in limits.items():
            low, high = float(limit.get("lowerLimit")), float(limit.get("upperLimit"))
            assert low <= float(declared[name]) <= high


def test_a_logical_file_is_read_with_its_values(tmp_path):
    path = SCENE.to_openscenario(catalogue(), mode="logical").save(tmp_path)
    path.write_text(path.read_text().replace('"oodscen.scene"', '"other.scene"'))
    found = read_openscenario(path, catalogue())
    assert found.scene.ego.speed == SCENE.ego.speed
    assert found.scene.weather.friction == SCENE.weather.friction


def test_a_scene_without_ranges_has_no_distributions(monkeypatch, tmp_path):
    monkeypatch.setattr("oodscen.interchange._writing.logical.ranges", lambda *given: ())
    file = SCENE.to_openscenario(catalogue(), mode="logical")
    assert file.notes[-1] == "No parameter of the scene has a range."
    assert [path.name for path in (file.save(tmp_path), *tmp_path.glob("*.xosc"))] == [
        f"{SCENE.id}.logical.xosc"
    ] * 2


@given(st.lists(st.from_regex(r"[a-z0-9][a-z0-9_-]{0,3}", fullmatch=True), unique=True))
def test_parameters_of_different_actors_have_different_names(actor_ids):
    suffixes = _suffixes(actor_ids)
    assert len(set(suffixes)) == len(actor_ids)
    assert all(suffix.replace("_", "").isalnum() or set(suffix) == {"_"} for suffix in suffixes)


def test_each_trigger_has_a_parameter_of_its_own_though_actors_have_like_names():
    data = SCENE.model_dump(mode="json")
    (actor,) = data["actors"]
    other = deepcopy(actor)
    other["id"], actor["id"] = "a_b", "a-b"
    other["placement"]["ahead_m"] += 20.0
    other["behaviour"]["trigger"]["value"] += 0.5
    data.update(
        actors=[actor, other],
        hazard={"actors": {"a-b": None}},
        decision={**data["decision"], "actor": "a-b"},
    )
    file = Scene.parse(data).to_openscenario(catalogue(), mode="logical")
    declared = [
        (element.get("name"), float(element.get("value")))
        for element in etree.fromstring(file.xosc).iter("ParameterDeclaration")
        if element.get("name").startswith("trigger_")
    ]
    assert declared == [
        ("trigger_a_b", actor["behaviour"]["trigger"]["value"]),
        ("trigger_a_b_2", other["behaviour"]["trigger"]["value"]),
    ]
