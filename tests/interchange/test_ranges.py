from lxml import etree

from oodscen.driving._sight.placement import check_scene
from oodscen.interchange import read_openscenario
from oodscen.interchange._ranges import changed, ranges, vary
from tests.interchange.staging import SCENES, catalogue

SCENE = min(
    (scene for scene in SCENES if any(actor.behaviour.trigger.value for actor in scene.actors)),
    key=lambda one: len(one.actors),
)


def test_both_ends_of_every_range_can_be_staged():
    found = ranges(SCENE, catalogue())
    assert found
    for one in found:
        assert one.low <= one.value <= one.high
        for end in (one.low, one.high):
            assert check_scene(changed(SCENE, {one.path: end}), catalogue()) == []


def test_variants_are_within_the_ranges_and_the_same_for_a_seed():
    found = ranges(SCENE, catalogue())
    variants = vary(SCENE, catalogue(), 3, seed=1)
    assert variants == vary(SCENE, catalogue(), 3, seed=1)
    assert variants != vary(SCENE, catalogue(), 3, seed=2)
    assert len({one.id for one in variants}) == 3
    for variant in variants:
        assert check_scene(variant, catalogue()) == []
        data = variant.model_dump(mode="json")
        for one in found:
            value = data
            for key in one.path:
                value = value[key]
            assert one.low - 1e-9 <= value <= one.high + 1e-9


def test_an_ordinary_drive_has_variants_that_are_ordinary():
    twin = SCENE.twin(2.0)
    one = next(iter(vary(twin, catalogue(), 1)))
    assert one.id == f"{SCENE.id}.v001~twin"
    assert one.is_ordinary


def test_a_scene_that_fails_itself_has_no_ranges_and_tells_a_hundred_overlaps_at_most():
    one, *others = SCENE.actors
    heap = [one.model_copy(update={"id": f"copy-{index}"}) for index in range(30)]
    crowded = SCENE.model_copy(update={"actors": (one, *others, *heap)})
    assert ranges(crowded, catalogue()) == ()
    faults = [one for one in check_scene(crowded, catalogue()) if "overlaps" in one.message]
    assert len(faults) == 100


def test_parameters_of_a_file_have_values_in_both_distributions(tmp_path):
    file = SCENE.to_openscenario(catalogue(), mode="logical")
    paths = [file.save(tmp_path), *(tmp_path / name for name in file.beside)]
    scenario, deterministic, stochastic = map(etree.parse, paths)
    declared = {one.get("name"): one.get("value") for one in scenario.iter("ParameterDeclaration")}
    assert declared
    text = paths[0].read_text()
    assert all(f'"${name}"' in text for name in declared)
    for tree in (deterministic, stochastic):
        assert tree.find(".//ScenarioFile").get("filepath") == paths[0].name
        given = {
            one.get("parameterName"): one.find(".//Range")
            for one in tree.iter()
            if one.get("parameterName")
        }
        assert set(given) == set(declared)
        for name, one in given.items():
            low, high = float(one.get("lowerLimit")), float(one.get("upperLimit"))
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
