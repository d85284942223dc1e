"""Decisions become edits that the tree accepts."""

from oodscen import ScenarioTree
from oodscen.prompts._tree.place_scenario import PlacedScenario
from oodscen.stages._redteam.changes import edits_of, misfits
from oodscen.tree._scenario_tree import TreeEdit

TREE = ScenarioTree.initial().apply(
    TreeEdit(op="add", node="weather", parent="environmental", label="Weather"),
    TreeEdit(op="add", node="wet", parent="weather", label="Wet weather"),
    TreeEdit(op="add", node="rain", parent="wet", label="Cloudburst"),
    TreeEdit(op="add", node="hail", parent="wet", label="Hail"),
    TreeEdit(op="add", node="animals", parent="interactional", label="Animals"),
    TreeEdit(op="add", node="deer", parent="animals", label="Deer on the road"),
)


def added(**fields):
    return PlacedScenario(
        reasoning="", decision="add", label="Burst water main", category="Flooding", **fields
    )


def test_every_family_that_is_emptied_goes_up_to_its_class():
    placed = added(node="environmental", members=["rain", "hail", "rain"])
    edits, leaf = edits_of(TREE, placed, stage="redteam")
    after = TREE.apply(*edits)
    assert [after.by_id[n].label for n in after.children["environmental"]] == ["Flooding"]
    assert {node.label for node in after.leaves} == {
        "Burst water main",
        "Cloudburst",
        "Hail",
        "Deer on the road",
    }
    assert after.by_id[leaf].label == "Burst water main"


def test_a_family_that_holds_the_new_one_stays():
    edits, _ = edits_of(TREE, added(node="wet", members=["rain", "hail"]))
    after = TREE.apply(*edits)
    assert after.path("rain")[1:] == (
        "Environmental",
        "Weather",
        "Wet weather",
        "Flooding",
        "Cloudburst",
    )


def test_members_of_another_class_do_not_fit():
    assert misfits(TREE, added(node="environmental", members=["deer"]))
    assert misfits(TREE, added(node="environmental", members=["wet"]))
    assert not misfits(TREE, added(node="environmental", members=["rain"]))


def test_a_refused_text_has_no_edits():
    assert edits_of(TREE, PlacedScenario(reasoning="", decision="not-ood")) == ((), None)
