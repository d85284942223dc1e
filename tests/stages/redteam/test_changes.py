"""Decisions become edits that the tree accepts."""

from hypothesis import given
from hypothesis import strategies as st

from oodscen import ScenarioTree
from oodscen.prompts._tree.place_scenario import PlacedScenario
from oodscen.stages._redteam.changes import edits_of, misfits, resolve_decision
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


THINGS = ("Moose", "Wild boar", "Deer", "Lost box", "Cow")


@given(
    st.lists(st.sampled_from(THINGS), min_size=2, max_size=4, unique=True),
    st.sampled_from(["broaden", "add"]),
    st.sampled_from(THINGS),
)
def test_a_list_of_kinds_becomes_one_leaf_each(things, decision, met):
    """No leaf lists kinds, no kind is lost, and the text's own leaf is the one that it is about."""
    listed = f"{', '.join(things[:-1])} or {things[-1].lower()} on the road"
    node = "deer" if decision == "broaden" else "animals"
    placed = PlacedScenario(reasoning="", decision=decision, node=node, label=listed)
    source = f"A {met.lower()} stands there."
    edits, kind = edits_of(TREE, placed, splits_lists=True, source=source)
    after = TREE.apply(*edits)
    labels = [leaf.label for leaf in after.leaves]
    if "Deer" not in things and decision == "broaden":
        assert after.by_id["deer"].label == listed  # no part is the leaf's own: it stays one kind
        assert resolve_decision(placed, edits) == "broaden"
        return
    assert resolve_decision(placed, edits) == "add"
    assert not any(" or " in label for label in labels)
    wanted = [f"{one[0]}{one[1:].lower()} on the road" for one in things]
    assert {label.casefold() for label in labels} >= {one.casefold() for one in wanted}
    assert len(labels) == len(set(labels))
    new = [one.casefold() for one in wanted if one.casefold() != "deer on the road"]
    if f"{met.casefold()} on the road" in new:
        assert after.by_id[kind].label.casefold() == f"{met.casefold()} on the road"


def test_the_open_loop_takes_labels_as_they_are():
    placed = PlacedScenario(
        reasoning="", decision="broaden", node="deer", label="Deer or moose on the road"
    )
    edits, _ = edits_of(TREE, placed)
    assert [edit.op for edit in edits] == ["broaden"]
