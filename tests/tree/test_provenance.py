"""Every node answers who put it there and why."""

import pytest
from hypothesis import given

from oodscen.errors import UnknownComponent
from oodscen.tree._provenance import Provenance, origin_words, provenances
from oodscen.tree._scenario_tree import ScenarioTree, TreeEdit
from tests.tree.woods import few, trees


@few
@given(trees)
def test_every_edit_belongs_to_the_history_of_one_node(tree):
    found = provenances(tree, {edit.node for edit in tree.edits})
    decisions = [one for item in found.values() for one in (item.origin, *item.later)]
    assert sorted(decision.index for decision in decisions) == list(range(len(tree.edits)))
    for item in found.values():
        assert item.origin.edit.op == "add"
        assert item.is_present == (item.node in tree.by_id)
        assert item == tree.provenance(item.node) == Provenance.parse(item.to_json())
        assert len(str(item).splitlines()) >= 2 + len(item.later)
        for one in (item.origin, *item.later):
            assert one.edit == tree.edits[one.index]
    origin_words(tree)


def test_a_node_says_who_why_and_what_came_later():
    tree = ScenarioTree.initial().apply(
        TreeEdit(
            op="add",
            node="fog",
            parent="environmental",
            label="Fog",
            stage="redteam",
            round=3,
            model="gpt",
            prompt="place-scenario@12ab",
            reason="nothing covers it",
            source="Fog swallows the road.",
        ),
        TreeEdit(op="broaden", node="fog", label="Fog or smoke", stage="redteam", round=5),
        TreeEdit(op="broaden", node="fog", label="Fog or ash", stage="redteam", round=6),
    )
    tree = tree.undo().apply(TreeEdit(op="remove", node="fog", stage="prune", reason="no fog"))
    history = tree.provenance("fog")
    assert (history.stage, history.round, history.model) == ("redteam", 3, "gpt")
    assert (history.prompt, history.source) == ("place-scenario@12ab", "Fog swallows the road.")
    assert (history.reason, history.path) == ("nothing covers it", ())
    assert [one.is_undone for one in history.later] == [False, True, False, False]
    assert [one.label_before for one in history.later] == [
        "Fog",
        "Fog or smoke",
        "Fog or ash",
        "Fog or smoke",
    ]
    for part in ("round 3", "gpt", "nothing covers it", "swallows", "undone", "no fog"):
        assert part in str(history)
    assert origin_words(tree)["fog"] == "new in round 3, broadened in round 5, at first “Fog”"


def test_a_node_of_a_removed_ones_id_has_no_past() -> None:
    tree = ScenarioTree.initial().apply(
        TreeEdit(op="add", node="fog", parent="environmental", label="Fog", round=1),
        TreeEdit(op="broaden", node="fog", label="Fog or smoke", round=2),
        TreeEdit(op="remove", node="fog"),
    )
    assert "fog" in origin_words(tree.undo())
    assert "fog" not in origin_words(tree.undo().undo(len(ScenarioTree.initial().edits)))
    again = TreeEdit(op="add", node="fog", parent="environmental", label="Mist")
    assert "fog" not in origin_words(tree.apply(again))


def test_a_node_relabelled_without_a_round_names_none() -> None:
    tree = ScenarioTree.initial().apply(
        TreeEdit(op="add", node="fog", parent="environmental", label="Fog"),
        TreeEdit(op="broaden", node="fog", label="Fog or smoke"),
    )
    assert origin_words(tree)["fog"] == "broadened, at first “Fog”"
    tree = tree.apply(TreeEdit(op="broaden", node="fog", label="Fog or ash", round=2))
    assert origin_words(tree)["fog"] == "broadened in round 2, at first “Fog”"


def test_a_node_that_never_was_is_named_with_close_matches():
    with pytest.raises(UnknownComponent) as caught:
        ScenarioTree.initial().provenance("enviromental")
    assert caught.value.matches == ("environmental",)
    with pytest.raises(UnknownComponent):
        ScenarioTree.initial().node("enviromental")


def test_what_a_model_says_is_shown_escaped():
    hostile = "\x1b]0;owned\x07 \u202egnp.exe\n  9: added"
    tree = ScenarioTree.initial().apply(
        TreeEdit(
            op="add",
            node="fog",
            parent="environmental",
            label="Fog",
            reason=hostile,
            source=hostile,
            model=hostile,
        )
    )
    shown = str(tree.provenance("fog"))
    assert not {"\x1b", "\x07", "\u202e"} & set(shown)
    assert len(shown.splitlines()) == 2


def test_an_edit_of_a_merge_without_a_round_names_the_tree():
    edit = TreeEdit(op="keep", node="root", origin="merge-1", model="m")
    tree = ScenarioTree.initial().apply(edit)
    assert "kept by merge-1, m" in str(tree.provenance("root"))
