"""Augmenting: what leaves the stage runs; every fault goes back to the model with its path."""

import pytest

from oodscen import Augmenter, Scenario
from oodscen.errors import AnswerError
from oodscen.testing import ScriptedLLM
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._scenes import example_scene

SCENARIO = Scenario(
    id="box-001", text="A cardboard box lies on the road ahead.", leaf="box", path=("OOD", "Box")
)
CATALOGUE = FlatSimulator().catalogue()


CLAIMS = {
    "claims": [
        {
            "kind": "thing",
            "value": "present",
            "subject": "cardboard box",
            "quote": "cardboard box",
        },
        {
            "kind": "motion",
            "value": "stationary",
            "subject": "cardboard box",
            "quote": "lies on the road",
        },
    ]
}


def draft(**changes):
    scene = example_scene().model_dump(mode="json")
    kept = ("map", "ego", "weather", "actors", "hazard", "decision", "horizon_s")
    return {"reasoning": "", **{name: scene[name] for name in kept}, **changes}


def moved(**placement):
    actor = draft()["actors"][0]
    return [{**actor, "placement": {**actor["placement"], **placement}}]


def test_a_valid_draft_becomes_the_scene_of_the_scenario():
    scene = Augmenter(ScriptedLLM([draft()]), CATALOGUE, claims=False).run(SCENARIO)
    same = {"id": "box-001", "scenario_id": "box-001", "visible": scene.visible}
    assert scene == example_scene().model_copy(update=same)
    assert [one.what for one in scene.visible] == ["large cardboard box"]


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


def test_a_claim_that_is_contradicted_goes_back_by_name():
    rolling = {"name": "walk_along", "parameters": {"speed": 1.0}}
    wrong = draft(actors=[{**draft()["actors"][0], "behaviour": rolling}])
    llm = ScriptedLLM([CLAIMS, wrong, draft()])
    assert Augmenter(llm, CATALOGUE).run(SCENARIO).actors[0].behaviour.name == "stand"
    assert (
        "cardboard box: it does not move ('lies on the road')" in llm.requests[2].messages[-1].text
    )


def test_a_scene_that_contradicts_its_text_to_the_end_is_refused_with_the_claim():
    wrong = draft(actors=[{**draft()["actors"][0], "asset": "sofa"}])
    with pytest.raises(AnswerError) as caught:
        Augmenter(ScriptedLLM([CLAIMS, *[wrong] * 3]), CATALOGUE).run(SCENARIO)
    assert any("the text says cardboard box" in issue.message for issue in caught.value.issues)


def test_claims_may_be_read_before_or_by_another_model():
    reader = ScriptedLLM([CLAIMS])
    augmenter = Augmenter(ScriptedLLM([draft(), draft()]), CATALOGUE, reader=reader)
    claims = augmenter.read(SCENARIO)
    assert [claim.value for claim in claims] == ["present", "stationary"]
    assert augmenter.run(SCENARIO, claims) == augmenter.run(SCENARIO, ())
    assert len(reader.requests) == 1


def test_claims_that_quote_what_is_not_there_are_put_again():
    false = {"claims": [{**CLAIMS["claims"][0], "quote": "a purple box"}]}
    llm = ScriptedLLM([false, CLAIMS, CLAIMS])
    augmenter = Augmenter(llm, CATALOGUE)
    claims = augmenter.read(SCENARIO)
    assert len(claims) == 2
    assert augmenter.read(SCENARIO.text) == claims
    assert "claims[0].quote" in llm.requests[1].messages[-1].text


def test_a_decision_without_an_actor_is_measured_to_the_first_of_the_hazard():
    scene = example_scene()
    crate = scene.actors[0].model_copy(
        update={
            "id": "crate",
            "placement": scene.actors[0].placement.model_copy(update={"ahead_m": 75.0}),
        }
    )
    answer = draft(
        actors=[actor.model_dump(mode="json") for actor in (crate, *scene.actors)],
        hazard={"actors": {"crate": None, "box": None}},
        decision={"kind": "distance", "value": 45.0},
    )
    augmenter = Augmenter(ScriptedLLM([answer]), CATALOGUE, claims=False)
    staged = augmenter.run(SCENARIO)
    assert staged.decision.actor == "crate"
    assert list(staged.hazard.actors) == ["box", "crate"]


def test_the_question_holds_the_claims_and_asks_who_stands_for_what():
    llm = ScriptedLLM([CLAIMS, draft()])
    Augmenter(llm, CATALOGUE).run(SCENARIO)
    asked = llm.requests[1].messages
    assert "it does not move ('lies on the road')" in asked[-1].text
    assert "`stands_for` for: <data>cardboard box</data>" in asked[-1].text
    assert "cardboard box" not in asked[-1].text.partition("Text:")[0]


def test_who_stands_for_what_is_kept_where_words_do_not_tell():
    told = {"claims": [{**CLAIMS["claims"][0], "subject": "parcel", "quote": "cardboard box"}]}
    for shown, kept in (({"parcel": "box"}, {"parcel": ("box",)}), ({"parcel": "map"}, None)):
        llm = ScriptedLLM([told, *[draft(stands_for=shown)] * 3])
        augmenter = Augmenter(llm, CATALOGUE)
        if kept is None:
            with pytest.raises(AnswerError):
                augmenter.run(SCENARIO)
        else:
            assert augmenter.run(SCENARIO).stands_for == kept
    scene = Augmenter(ScriptedLLM([CLAIMS, draft(stands_for={"cardboard box": "box"})]), CATALOGUE)
    assert "stands_for" not in scene.run(SCENARIO).to_json()


def test_claims_that_fail_for_one_reason_are_one_line():
    wrong = draft(actors=[{**draft()["actors"][0], "asset": "sofa"}])
    llm = ScriptedLLM([CLAIMS, wrong, draft()])
    Augmenter(llm, CATALOGUE).run(SCENARIO)
    faults = [line for line in llm.requests[2].messages[-1].text.splitlines() if line[:2] == "- "]
    assert len(faults) == 1
    assert "it is there" in faults[0]
    assert "it does not move" in faults[0]
    assert "`stands_for`" in faults[0]


def test_the_way_out_is_told_beside_a_fault_that_names_another():
    night = {"kind": "time", "value": "night", "subject": "", "quote": "at night"}
    wrong = draft(actors=[{**draft()["actors"][0], "asset": "sofa"}])
    for claims in ([CLAIMS["claims"][0], night], [night, CLAIMS["claims"][0]]):
        llm = ScriptedLLM([{"claims": claims}, wrong, {"cannot_show": "it is day"}])
        with pytest.raises(AnswerError):
            Augmenter(llm, CATALOGUE).run(SCENARIO)
        told = llm.requests[2].messages[-1].text
        faults = [line for line in told.splitlines() if line[:2] == "- "]
        assert ["`cannot_show`" in fault for fault in faults] == [
            "night" in fault for fault in faults
        ]


def test_a_text_that_cannot_be_shown_ends_the_attempts():
    llm = ScriptedLLM([CLAIMS, {"cannot_show": "there are no boxes"}, draft()])
    with pytest.raises(AnswerError, match="there are no boxes") as caught:
        Augmenter(llm, CATALOGUE).run(SCENARIO)
    assert len(llm.requests) == 2
    assert not caught.value.retryable


def test_a_text_without_a_road_is_not_asked_about():
    text = "A cardboard box lies on the motorway in a tunnel."
    road = {"kind": "road", "subject": ""}
    claims = {
        "claims": [
            {**road, "value": "highway", "quote": "motorway"},
            {**road, "value": "residential", "quote": "in a tunnel"},
        ]
    }
    llm = ScriptedLLM([claims])
    with pytest.raises(AnswerError, match="the simulator has no road"):
        Augmenter(llm, CATALOGUE).run(SCENARIO.model_copy(update={"text": text}))
    assert len(llm.requests) == 1
