"""What is wrong with the map itself is optional, part of the hazard, and refused where it cannot be drawn."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen import make_catalogue
from oodscen.claims._checking import check_claims
from oodscen.data import Scene
from oodscen.data._claim import Claim
from oodscen.data._map_state import MapState
from oodscen.driving._sight.placement import check_scene
from oodscen.errors import DataError
from oodscen.stages._hazard_words import visible_of
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE
from oodscen.testing._scenes import example_scene

FAULTS = ("off", "flashing", "all_on", "bent", "turned", "missing")
JUNCTION = {
    "id": "dark",
    "scenario_id": "dark",
    "map": "urban_junction",
    "ego": {"speed": 8.0},
    "hazard": {},
    "decision": {"kind": "time", "value": 3.0},
}


@pytest.fixture(scope="module")
def catalogue():
    return make_catalogue("pybullet")


def with_state(**state):
    return Scene.parse({**JUNCTION, "map_state": state})


def test_a_scene_without_it_has_the_same_text():
    assert "map_state" not in example_scene().model_dump_json()


@given(st.sampled_from(FAULTS))
def test_it_survives_json_and_its_twin_is_in_order(fault):
    scene = with_state(signals=fault)
    assert Scene.model_validate_json(scene.model_dump_json()) == scene
    assert scene.twin(3.0).map_state is None


@given(*[st.floats(-1000, 1000)] * 3)
def test_lamps_are_dark_within_their_stretch_only(one, two, ahead):
    low, high = sorted((one, two))
    if low < high:
        state = MapState(street_lamps="off", lamps_from_m=low, lamps_to_m=high)
        assert state.is_dark(ahead) == (low <= ahead <= high)
        assert not MapState(signals="off").is_dark(ahead)


@pytest.mark.parametrize(
    "state",
    [
        {},
        {"signals": "blue"},
        {"street_lamps": "off"},
        {"street_lamps": "off", "lamps_from_m": 9, "lamps_to_m": 9},
    ],
)
def test_states_that_say_nothing_are_refused(state):
    with pytest.raises(DataError):
        with_state(**state)


def test_only_what_is_there_and_can_be_drawn_passes(catalogue):
    scene = with_state(signals="off")
    assert check_scene(scene, catalogue) == []
    assert [one.path for one in check_scene(scene, FLAT_CATALOGUE)] == ["map_state.signals"]
    bare = Scene.parse({**JUNCTION, "map": "rural_curve", "map_state": {"signals": "off"}})
    assert [one.path for one in check_scene(bare, catalogue)] == ["map_state.signals"]


def status(scene, value, catalogue, subject="traffic light", kind="state"):
    claims = (Claim(kind=kind, value=value, subject=subject),)
    return check_claims(claims, scene, catalogue)[0].status


@pytest.mark.parametrize("fault", ["off", "flashing", "all_on"])
def test_claims_about_lights_hold_for_their_state_alone(fault, catalogue):
    scene = with_state(signals=fault)
    assert status(scene, fault, catalogue) == "holds"
    for other in {"off", "flashing", "all_on", "green"} - {fault}:
        assert status(scene, other, catalogue) == "fails"


def test_the_distance_of_the_maps_own_lights_stays_open(catalogue):
    scene = with_state(signals="off").model_copy(update={"stands_for": {"traffic light": ("map",)}})
    told = [("thing", "present"), ("state", "off"), ("count", "2"), ("distance", "35")]
    claims = [Claim(kind=kind, value=value, subject="traffic light") for kind, value in told]
    found = [check_claim.status for check_claim in check_claims(claims, scene, catalogue)]
    assert found == ["holds", "holds", "open", "open"]
    assert status(with_state(signals="off"), "3", catalogue, kind="distance") != "holds"


def test_claims_about_dark_lamps_and_missing_lights(catalogue):
    night = {**JUNCTION, "weather": {"sun_elevation_deg": -20.0}}
    dark = Scene.parse({**night, "map_state": {"street_lamps": "off"}})
    assert status(dark, "off", catalogue, "street lamps") == "holds"
    gone = with_state(signals="missing")
    assert status(gone, "present", catalogue, kind="thing") == "fails"


@given(st.sampled_from(FAULTS))
def test_it_is_told_to_those_who_judge_answers(fault):
    state = MapState(signals=fault, signs="bent")
    scene = example_scene().model_copy(update={"actors": (), "map_state": state})
    told = visible_of(scene, FLAT_CATALOGUE)
    assert len(told) == 2
    assert "traffic lights" in told[0].what
