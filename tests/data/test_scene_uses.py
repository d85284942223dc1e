"""A scene's own methods do what the functions of the higher floors do; those are tested where they are."""

from oodscen.claims._checking import check_claims
from oodscen.data._claim import Claim
from oodscen.driving._sight.placement import check_scene
from oodscen.interchange._ranges import vary
from oodscen.interchange._tags import openlabel
from oodscen.interchange._traces.osi_writing import osi_trace
from oodscen.interchange._writing.scenario import to_openscenario
from oodscen.testing import example_scene
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE

SCENE = example_scene()


def test_methods_pass_their_arguments_on() -> None:
    night = Claim(kind="time", value="night", quote="at night")
    lost = SCENE.model_copy(update={"map": "nowhere"})
    assert SCENE.check(FLAT_CATALOGUE) == check_scene(SCENE, FLAT_CATALOGUE) == []
    assert lost.check(FLAT_CATALOGUE) == check_scene(lost, FLAT_CATALOGUE) != []
    found = SCENE.check_claims([night], FLAT_CATALOGUE)
    assert found == check_claims([night], SCENE, FLAT_CATALOGUE)
    assert [one.status for one in found] == ["fails"]
    assert SCENE.vary(FLAT_CATALOGUE, 2, seed=3) == vary(SCENE, FLAT_CATALOGUE, 2, seed=3)
    options = {"mode": "reactive", "target": "esmini", "ego": False, "properties": {"a": "b"}}
    for given in ({}, {"action": "stop", "seed": 2}, options):
        made = SCENE.to_openscenario(FLAT_CATALOGUE, **given)
        assert made == to_openscenario(SCENE, FLAT_CATALOGUE, **given)
    assert SCENE.to_openlabel(FLAT_CATALOGUE) == openlabel(SCENE, FLAT_CATALOGUE)
    assert SCENE.to_osi(FLAT_CATALOGUE, action="stop") == osi_trace(
        SCENE, FLAT_CATALOGUE, action="stop"
    )
