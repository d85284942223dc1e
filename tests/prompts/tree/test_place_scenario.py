"""The place of a scenario: an answer may leave blank what its decision does not need, and must fit the tree."""

import pytest

from oodscen.prompts._tree.place_scenario import Hidden, PlacedScenario, PlaceScenario
from oodscen.tree._scenario_tree import ROOT, ScenarioTree, TreeEdit

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


@pytest.mark.parametrize(
    ("answer", "path", "words"),
    [
        ({"decision": "covered", "node": None}, "node", "'' is not an id of the tree"),
        ({"decision": "covered", "node": "tyre"}, "node", "'tyre' is not an id of the tree"),
        ({"decision": "covered", "node": "debris"}, "node", "'debris' is not a leaf"),
        ({"decision": "covered", "node": "environmental"}, "node", "is not a leaf"),
        ({"decision": "add", "node": ROOT}, "node", "name a node below the root"),
        ({"decision": "add", "node": "box"}, "node", "'box' is a leaf: name the node above it"),
        ({"decision": "add", "node": "environmental"}, "category", "name a new one"),
        ({"decision": "add", "node": "debris", "category": "debris"}, "category", "already: [debris]"),
        ({"decision": "add", "node": "debris", "label": "Old red wet big round heavy burning rolling tyre on the road"}, "label", "anecdote"),
        ({"decision": "add", "node": "debris", "label": "box on the Road"}, "label", "already: [box]"),
        ({"decision": "add", "node": "debris", "category": "Tyre on the road"}, "category", "different labels"),
        ({"decision": "split", "node": "box", "category": "Box on the road"}, "category", "already: [box]"),
        ({"decision": "split", "node": "debris", "category": "Things"}, "node", "is not a leaf"),
        ({"decision": "broaden", "node": "debris"}, "node", "is not a leaf"),
        ({"decision": "broaden", "node": "box"}, "decision", "broadened often enough: split it"),
    ],
)  # fmt: skip
def test_an_answer_that_does_not_fit_the_tree_is_sent_back_with_the_reason(answer, path, words):
    question = QUESTION.model_copy(update={"full": ("box",)})
    issues = question.check(
        PlacedScenario(**{"reasoning": "", "label": "Tyre on the road", **answer})
    )
    assert [issue.path for issue in issues if words in issue.message] == [path]


def test_the_papers_procedure_widens_families_and_splits_nothing():
    question = QUESTION.model_copy(update={"procedure": "paper"})
    wider = {"reasoning": "", "decision": "broaden", "label": "Things on the road"}
    assert question.check(PlacedScenario(**wider, node="debris")) == []
    (issue,) = question.check(PlacedScenario(**wider, node="environmental"))
    assert issue.message == "the classes keep their labels"
    split = PlacedScenario(**{**wider, "decision": "split"}, node="box", category="Things")
    assert [issue.path for issue in question.check(split)] == ["decision"]


def test_a_node_whose_leaves_are_not_shown_is_no_leaf():
    nodes = tuple(node for node in TREE.nodes if node.id != "box")
    part = QUESTION.model_copy(update={"nodes": nodes, "hidden": (Hidden(id="debris", leaves=1),)})
    assert "Debris [debris] (+1)" in part.variables()["outline"]
    covered = PlacedScenario(reasoning="", decision="covered", node="debris")
    assert [issue.message for issue in part.check(covered)] == ["'debris' is not a leaf"]


@pytest.mark.parametrize("decision", ["not-ood", "off-topic"])
def test_a_refused_text_needs_no_node(decision):
    assert QUESTION.check(PlacedScenario(reasoning="", decision=decision)) == []
