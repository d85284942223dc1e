"""Scenes that a strong model staged for its own texts are accepted, and refused once they contradict them."""

import sys
from pathlib import Path

import pytest
from oodscen_pybullet._catalogue import load_catalogue

from oodscen.claims._checking import check_claims, mismatches
from oodscen.claims._matching import Likeness
from oodscen.stages._augment import Augmenter
from oodscen.testing import ScriptedLLM

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

from benchmarks._falsified_scenes import CHANGES, falsified
from benchmarks.models import accepted, recorded

WORDED_FREELY = {
    "fallen-tree-across-the-right-lane-001": "a state that is null",
    "fallen-tree-across-the-right-lane-002": "a toppled birch",
    "fallen-tree-across-the-right-lane-003": "an uprooted maple",
    "oil-spill-on-a-downhill-curve-003": "leaked diesel",
    "traffic-light-showing-red-and-green-at-once-001": "red and green at once",
    "traffic-light-showing-red-and-green-at-once-003": "red and green at once",
    "mattress-sliding-off-a-pickup-truck-ahead-001": "falls into the lane in which it rode",
    "mattress-sliding-off-a-pickup-truck-ahead-003": "falls into the lane in which it rode",
    "dense-smoke-from-a-roadside-fire-drifting-over-t-001": "smoke that drifts",
    "herd-of-sheep-stopping-on-both-lanes-001": "a heading of more than half a turn",
    "bystander-stopping-traffic-to-shield-an-injured-003": "a cyclist who lies on the road",
}


@pytest.fixture(scope="module")
def judged(minilm):
    catalogue = load_catalogue()
    augmenter = Augmenter(ScriptedLLM(lambda request: ""), catalogue, encoder=minilm)
    wanted = [one for one in recorded() if one["id"] in WORDED_FREELY or one["fault"]]
    return {one["id"]: (told, why) for one, told, why in accepted(augmenter, wanted)}


@pytest.mark.parametrize("name", WORDED_FREELY)
def test_free_words_are_no_contradiction(judged, name):
    told, why = judged[name]
    assert told is not None, why


def test_real_faults_are_refused(judged):
    faults = {one["id"]: one["fault"] for one in recorded() if one["fault"]}
    assert len(faults) == 8
    for name in faults:
        told, why = judged[name]
        assert told is None
        assert why


def test_a_scene_that_contradicts_its_text_is_refused_by_the_claim(judged, minilm):
    catalogue = load_catalogue()
    likeness = Likeness(minilm, catalogue)
    scenes = [told for told, _ in judged.values() if told is not None]
    made = list(falsified(scenes, catalogue, 40))
    assert {one.change for one in made} >= set(CHANGES) - {"fewer", "other side", "other state"}
    caught = [
        any(
            found.claim.kind in one.kinds
            for found in mismatches(
                check_claims(one.told.claims, one.scene, catalogue, likeness=likeness)
            )
        )
        for one in made
    ]
    assert sum(caught) >= 0.95 * len(made)
