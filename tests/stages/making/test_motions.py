from typing import Any

import pytest

from oodscen.author._knowledge.designs import load_motions
from oodscen.data._additions import Addition
from oodscen.data._designs.motion import Motion
from oodscen.data._scenario import Scenario
from oodscen.driving import DynamicSimulator
from oodscen.errors import SceneError
from oodscen.prompts._scenario.stage_scene import SceneDraft
from oodscen.stages._augment import scene_of_draft
from oodscen.stages._making.motions import (
    MotionMaker,
    made_motions,
    trial_scene,
)
from oodscen.stages._making.wanted import WantedMotion, wanted_motions
from oodscen.stages._prune.decisions import PruneDecision
from oodscen.testing import ScriptedLLM
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE
from oodscen.tree._scenario_tree import ScenarioTree, TreeEdit
from tests.motions import TOPPLE

WANTED = WantedMotion("topple", ("Root", "Interactional", "Cone that topples"), ("work_zone",))


def made_by(*answers: Any) -> Any:
    """Return what a model with these answers makes, and its questions."""
    llm = ScriptedLLM(list(answers))
    with FlatSimulator() as simulator:
        return MotionMaker(llm, simulator).make(WANTED), llm.requests


def test_a_movement_is_made_and_tried() -> None:
    made, (request,) = made_by({"motion": TOPPLE})
    assert made.motion == Motion.parse(TOPPLE)
    assert "topple" in request.messages[-1].text
    assert made_motions([made.model_dump(mode="json")]) == {"topple": made.motion}


@pytest.mark.parametrize(
    "bad",
    [
        {"motion": {**TOPPLE, "id": "other"}},
        {"motion": {**TOPPLE, "body": "car"}},
        {"motion": {**TOPPLE, "keys": [{"at": 0}, {"at": 0.1, "ahead": 90}]}},
        {"motion": None},
    ],
)
def test_a_fault_goes_back_to_the_model(bad: Any) -> None:
    made, requests = made_by(bad, {"motion": TOPPLE})
    assert made.motion is not None
    assert len(requests) == 2
    assert "cannot be used" in requests[1].messages[-1].text


def test_what_cannot_be_made_is_said() -> None:
    made, _ = made_by({"motion": None, "cannot_make": "it waves"})
    assert (made.motion, made.reason, made.status) == (None, "it waves", "ok")
    failed, _ = made_by("no", "no", "no")
    assert failed.status == "failed"


def test_a_simulator_with_motion_of_its_own_is_not_asked_for_more(monkeypatch: Any) -> None:
    monkeypatch.setattr(FlatSimulator, "plays_motions", DynamicSimulator.plays_motions)
    made, requests = made_by({"motion": TOPPLE})
    assert made.motion is None
    assert made.reason
    assert not requests
    scene = trial_scene(Motion.parse(TOPPLE), FLAT_CATALOGUE)
    assert scene is not None
    with FlatSimulator() as simulator, pytest.raises(SceneError) as refused:
        simulator.reset(scene, 0)
    assert refused.value.issues[0].path == "motions"


def test_only_leaves_that_lack_what_can_be_made_want_it() -> None:
    tree = ScenarioTree.initial()
    for number, label in enumerate(("Cone that topples", "Cone that topples in a quarry")):
        tree = tree.apply(
            TreeEdit(
                op="add", node=f"leaf-{number}", label=label, parent="interactional", stage="grow"
            )
        )
    topple = Addition(kind="behaviour", name="topple")
    cone = Addition(kind="asset", name="tall_cone", category="work_zone")
    quarry = Addition(kind="map", name="quarry")
    judged = [
        PruneDecision(id="leaf-0", path=tree.path("leaf-0"), keep=False, lacks=(topple, cone)),
        PruneDecision(id="leaf-1", path=tree.path("leaf-1"), keep=False, lacks=(topple, quarry)),
    ]
    (wanted,) = wanted_motions(tree, judged, FLAT_CATALOGUE)
    assert wanted == WantedMotion("topple", tree.path("leaf-0"), ("work_zone",))
    again = judged[0].model_copy(
        update={
            "keep": True,
            "made": ("topple", "tall_cone"),
            "made_as": judged[0].lacks,
            "lacks": (),
        }
    )
    assert wanted_motions(tree, [again, judged[1]], FLAT_CATALOGUE) == [wanted]


def test_a_scene_carries_the_motions_that_it_shows() -> None:
    draft = SceneDraft.model_validate(
        {
            "map": "urban_three_lane",
            "ego": {"speed": 8},
            "actors": [
                {
                    "id": "cone",
                    "asset": "cone",
                    "placement": {"ahead_m": 40},
                    "behaviour": {"name": "topple"},
                }
            ],
            "hazard": {"actors": {"cone": None}},
            "decision": {"kind": "distance", "value": 25, "actor": "cone"},
        }
    )
    motions = [Motion.parse(TOPPLE), Motion.parse({**TOPPLE, "id": "other"})]
    catalogue = FLAT_CATALOGUE.with_made((), motions)
    scenario = Scenario(id="a", path=("Root", "Cone"), text="A cone topples.")
    scene = scene_of_draft(scenario, draft, catalogue, (), motions)
    assert [motion.id for motion in scene.motions] == ["topple"]
    assert scene.visible[0].doing == "toppling over ahead"


def test_the_author_s_movements_can_be_played() -> None:
    motions = load_motions()
    assert len(motions) >= 12
    with FlatSimulator() as simulator:
        for motion in motions.values():
            scene = trial_scene(motion, FLAT_CATALOGUE)
            assert scene is not None
            simulator.reset(scene, 0)
