"""The place of a scenario: an answer may leave blank what its decision does not need."""

import pytest

from oodscen.prompts._tree.place_scenario import PlacedScenario, PlaceScenario
from oodscen.tree._scenario_tree import ScenarioTree, TreeEdit

TREE = ScenarioTree.initial().apply(
    TreeEdit(op="add", node="debris", parent="environmental", label="Debris"),
    TreeEdit(op="add", node="box", parent="debris", label="Box on the road"),
)
QUESTION = PlaceScenario(text="A tyre lies on the road.", nodes=TREE.nodes, procedure="closed")


@pytest.mark.parametrize("blank", [None, "", "  "])
def test_a_blank_family_is_none(blank):
    answer = {"reasoning": "", "decision": "add", "node": "debris", "label": "Tyre on the road"}
    below_family = PlacedScenario.model_validate(answer | {"category": blank})
    assert QUESTION.check(below_family) == []
    below_class = below_family.model_copy(update={"node": "environmental"})
    assert [issue.message for issue in QUESTION.check(below_class)] == [
        "a leaf hangs below a family: name a new one"
    ]
