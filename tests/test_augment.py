"""Augmenting: what leaves the stage runs; every fault goes back to the model with its path."""

import pytest

from oodscen import Augmenter, Scenario
from oodscen.errors import AnswerError
from oodscen.testing import FlatSimulator, ScriptedLLM
from oodscen.testing.scenes import example_scene

SCENARIO = Scenario(
    id="box-001", text="A cardboard box lies on the road ahead.", leaf="box", path=("OOD", "Box")
)
CATALOGUE = FlatSimulator().catalogue()


def draft(**changes):
    scene = example_scene().model_dump(mode="json")
    kept = ("map", "ego", "weather", "actors", "hazard", "decision", "horizon_s")
    return {"reasoning": "", **{name: scene[name] for name in kept}, **changes}


def moved(**placement):
    actor = draft()["actors"][0]
    return [{**actor, "placement": {**actor["placement"], **placement}}]


def test_a_valid_draft_becomes_the_scene_of_the_scenario():
    scene = Augmenter(ScriptedLLM([draft()]), CATALOGUE, claims=False).run(SCENARIO)
    assert scene == example_scene().model_copy(update={"id": "box-001", "scenario_id": "box-001"})


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"map": "residential"}, "did you mean residential_two_lane"),
        ({"actors": [{**draft()["actors"][0], "asset": "box"}]}, "actors[0].asset"),
        ({"actors": moved(ahead_m=2.0)}, "overlaps 'ego'"),
        ({"actors": moved(lane=5)}, "actors[0].placement.lane"),
        ({"actors": moved(offset_m=24.0)}, "actors[0].placement.offset_m"),
        ({"decision": {"kind": "distance", "value": 1.0}}, "decision"),
        ({"decision": {"kind": "time", "value": 60.0}}, "comes too late"),
        ({"hazard": {"actors": {"bx": None}}}, "hazard.actors.bx"),
        ({"ego": {"speed": -3}}, "ego.speed"),
        ({"weather": {"precipitation": "hail"}}, "weather.precipitation"),
    ],
)
def test_every_fault_goes_back_with_its_path(changes, told):
    llm = ScriptedLLM([draft(**changes), draft()])
    assert Augmenter(llm, CATALOGUE, claims=False).run(SCENARIO).id == "box-001"
    assert told in llm.requests[1].messages[-1].text


def test_what_stays_wrong_is_one_typed_error():
    with pytest.raises(AnswerError) as caught:
        Augmenter(ScriptedLLM([draft(map="moon")] * 3), CATALOGUE, claims=False).run(SCENARIO)
    assert caught.value.purpose == "stage-scene"
    assert [issue.path for issue in caught.value.issues] == ["map"]
