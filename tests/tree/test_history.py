"""Laws of time: replay, earlier moments, undo."""

from contextlib import suppress
from itertools import permutations

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from oodscen.errors import UsageError
from oodscen.tree._edit_log import MAX_DEPTH
from oodscen.tree._scenario_tree import ROOT, ScenarioTree, TreeEdit
from tests.tree.woods import changes, few, grown, numbered, steps, trees


@few
@given(trees)
def test_a_replay_passes_every_earlier_moment(tree):
    after = ScenarioTree()
    for index, (edit, after) in enumerate(tree.replay()):
        assert edit == tree.edits[index]
        assert after == tree.at(edit=index + 1)
        assert after.nodes == ScenarioTree(edits=tree.edits[: index + 1]).nodes
    assert after.nodes == tree.nodes


@few
@given(trees)
def test_a_later_round_holds_an_earlier_one(tree):
    moments = [len(tree.at(round=number).edits) for number in range(7)]
    assert moments == sorted(moments)
    for number, moment in enumerate(moments):
        rounds = [edit.round for edit in tree.edits[:moment] if edit.round is not None]
        assert all(one <= number for one in rounds)


def test_rounds_and_stages_are_moments():
    def add(name, **why):
        return TreeEdit(op="add", node=name, parent="environmental", label=name, **why)

    tree = ScenarioTree.initial().apply(
        add("a", stage="redteam", round=2),
        add("b", stage="redteam", round=2),
        add("c", stage="redteam", round=4),
        add("d", stage="prune"),
    )
    assert [len(tree.at(round=number)) for number in range(6)] == [3, 3, 5, 5, 6, 6]
    assert [len(tree.at(stage=stage)) for stage in ("grow", "redteam", "prune")] == [3, 6, 7]
    again = tree.apply(add("e", stage="redteam", round=1))
    assert len(again.at(round=4)) == 6
    merged = tree.apply(add("f", origin="merge-1", round=1), add("g", stage="redteam", round=5))
    assert [len(merged.at(round=number)) for number in (4, 5)] == [6, 9]
    unplayed = ScenarioTree.initial().apply(add("a", origin="merge-1"), add("b", round=1))
    assert [len(unplayed.at(round=number)) for number in (0, 1)] == [4, 5]


@pytest.mark.parametrize(
    "moment",
    [{}, {"edit": 1, "round": 1}, {"edit": 9}, {"edit": -1}, {"round": -1}, {"stage": "nobody"}],
)
def test_what_is_no_moment_is_refused(moment):
    with pytest.raises(UsageError):
        ScenarioTree.initial().at(**moment)


@given(trees)
def test_undoing_the_last_edit_gives_the_nodes_before_it(tree):
    assume(tree.edits)
    assert tree.undo(-1).nodes == tree.at(edit=len(tree.edits) - 1).nodes


@given(trees, st.integers(0, 12))
def test_an_undo_is_appended_and_can_be_undone(tree, index):
    text = tree.to_json()
    try:
        after = tree.undo(index)
    except UsageError:
        after = None
    assert tree.to_json() == text
    if after is None:
        return
    known = len(tree.edits)
    assert after.edits[:known] == tree.edits
    assert {edit.undoes for edit in after.edits[known:]} == {index}
    assert ScenarioTree.parse(after.to_json()) == after
    for position in reversed(range(known, len(after.edits))):
        after = after.undo(position)
    assert after.nodes == tree.nodes


@few
@given(changes)
def test_undoing_step_by_step_leads_back_to_nothing(steps):
    tree = grown(step.model_copy(update={"undoes": None}) for step in steps)
    for done in range(len(tree.edits), 0, -1):
        tree = tree.undo()
        assert tree.nodes == tree.at(edit=done - 1).nodes
    assert len(tree) == 0
    with pytest.raises(UsageError):
        tree.undo()


def test_undoing_a_round_takes_back_all_it_did():
    why = {"stage": "redteam", "round": 3}
    before = ScenarioTree.initial()
    tree = before.apply(
        TreeEdit(op="add", node="weather", parent="environmental", label="Weather", **why),
        TreeEdit(op="add", node="fog", parent="weather", label="Fog", **why),
        TreeEdit(op="broaden", node=ROOT, label="Rare", attested="paper", **why),
    )
    assert tree.undo(round=3).nodes == before.nodes
    for round_ in (2, 3):
        with pytest.raises(UsageError):
            tree.undo(round=3).undo(round=round_)
    with pytest.raises(UsageError):
        tree.undo(1, round=3)


@pytest.mark.parametrize("is_chain", [False, True])
def test_undoing_a_large_round_looks_at_the_tree_once(monkeypatch, is_chain):
    size = MAX_DEPTH - 1 if is_chain else 300
    why = {"stage": "redteam", "round": 3}
    before = ScenarioTree.initial()
    tree = before.apply(
        *(
            TreeEdit(
                op="add",
                node=f"n{number}",
                parent=f"n{number - 1}" if is_chain and number else "environmental",
                label=f"Kind {number}",
                **why,
            )
            for number in range(size)
        ),
        *(TreeEdit(op="broaden", node=f"n{n}", label=f"Wider {n}", **why) for n in range(size)),
    )
    applied, apply = [], ScenarioTree.apply
    monkeypatch.setattr(
        ScenarioTree,
        "apply",
        lambda self, *edits: applied.append(len(edits)) or apply(self, *edits),
    )
    assert tree.undo(round=3).nodes == before.nodes
    assert applied == [2 * size]


@few
@given(changes, st.integers(0, 1))
def test_undoing_a_round_is_undoing_its_edits_from_the_last_one_on(steps, number):
    tree = grown(
        step.model_copy(update={"undoes": None, "round": (step.round or 0) % 2}) for step in steps
    )
    one_by_one = tree
    try:
        at_once = tree.undo(round=number)
    except UsageError:
        return
    for index in reversed(range(len(tree.edits))):
        if tree.edits[index].round == number:
            with suppress(UsageError):
                one_by_one = one_by_one.undo(index)
    assert at_once.nodes == one_by_one.nodes
    assert ScenarioTree.parse(at_once.to_json()) == at_once


def test_what_a_round_added_and_removed_does_not_come_back():
    why = {"stage": "redteam", "round": 3}
    before = ScenarioTree.initial()
    tree = before.apply(
        TreeEdit(op="add", node="fog", parent="environmental", label="Fog", **why),
        TreeEdit(op="broaden", node="environmental", label="Surroundings", **why),
        TreeEdit(op="remove", node="fog", **why),
    )
    assert tree.undo(round=3).nodes == before.nodes


def test_what_came_back_and_was_edited_since_stays_when_a_later_leaf_goes():
    family = TreeEdit(op="add", node="fam", parent=ROOT, label="Things on the road")
    dog = TreeEdit(op="add", node="dog", parent="fam", label="Dog")
    other = TreeEdit(op="add", node="other", parent=ROOT, label="Weather")
    tree = ScenarioTree.initial().apply(family, dog, other)
    tree = tree.undo(tree.edits.index(family))
    gone = next(i for i, edit in enumerate(tree.edits) if (edit.op, edit.node) == ("remove", "dog"))
    tree = tree.undo(gone).apply(TreeEdit(op="move", node="dog", parent="other"))
    wider = TreeEdit(op="broaden", node="fam", label="Things on or beside the road")
    cat = TreeEdit(op="add", node="cat", parent="fam", label="Cat")
    for before in (tree, tree.apply(wider)):
        after = before.apply(cat)
        assert after.undo().nodes == before.nodes
        assert after.undo().undo(-1).nodes == after.nodes


def test_a_removed_leaf_comes_back_with_its_parents_and_to_its_place():
    tree = ScenarioTree.initial().apply(
        TreeEdit(op="add", node="weather", parent="environmental", label="Weather"),
        TreeEdit(op="add", node="fog", parent="weather", label="Fog"),
        TreeEdit(op="add", node="debris", parent="environmental", label="Debris"),
        TreeEdit(op="remove", node="fog"),
        TreeEdit(op="remove", node="weather"),
    )
    assert tree.undo(6).nodes == tree.at(edit=6).nodes


def test_a_move_that_would_now_be_a_cycle_cannot_be_undone():
    tree = ScenarioTree.initial().apply(
        TreeEdit(op="add", node="a", parent="environmental", label="A"),
        TreeEdit(op="add", node="b", parent="a", label="B"),
        TreeEdit(op="move", node="b", parent="environmental"),
        TreeEdit(op="move", node="a", parent="b"),
    )
    with pytest.raises(UsageError, match=r"cannot be undone in the tree .*cycle") as caught:
        tree.undo(5)
    assert type(caught.value) is UsageError
    assert tree.undo(6).undo(5).nodes == tree.at(edit=5).nodes


def test_a_narrowed_label_has_a_history_and_can_be_taken_back():
    tree = ScenarioTree.initial().apply(
        TreeEdit(op="add", node="a", parent="environmental", label="Fog or hail", attested="paper"),
        TreeEdit(op="narrow", node="a", label="Hail", stage="prune"),
    )
    assert "narrowed from “Fog or hail” to “Hail” by prune" in str(tree.provenance("a"))
    before = tree.undo().by_id["a"]
    assert (before.label, before.attested) == ("Fog or hail", "paper")


def test_an_edit_whose_undoing_was_undone_is_in_force_again():
    tree = ScenarioTree.initial().apply(
        TreeEdit(op="add", node="fog", parent="environmental", label="Fog"),
        TreeEdit(op="broaden", node="fog", label="Fog or smoke"),
    )
    last = len(tree.edits) - 1
    again = tree.undo().undo(-1)
    assert again.nodes == tree.nodes
    assert not again.provenance("fog").later[0].is_undone
    assert again.undo().edits[-1].undoes == last


def test_an_edit_is_undone_by_one_of_its_own_node_only():
    tree = ScenarioTree.initial()
    added = next(index for index, edit in enumerate(tree.edits) if edit.node == "environmental")
    odd = tree.apply(
        TreeEdit(op="add", node="fog", parent="environmental", label="Dense fog", undoes=added)
    )
    assert not odd.provenance("environmental").origin.is_undone
    gone = odd.undo(added)
    assert "environmental" not in gone
    assert gone.provenance("environmental").origin.is_undone


def test_undoing_a_kept_node_is_recorded_as_well():
    tree = ScenarioTree.initial().apply(TreeEdit(op="keep", node="environmental", round=1))
    undone = tree.undo()
    assert undone.nodes == tree.nodes
    assert (undone.edits[-1].op, undone.edits[-1].undoes) == ("keep", len(tree.edits) - 1)


FAMILIES = ("a", "b", "c")
relabelled_or_moved = st.lists(
    st.tuples(
        st.sampled_from(["broaden", "narrow", "move", "keep"]),
        st.sampled_from(["x", "y"]),
        st.sampled_from(FAMILIES),
        st.sampled_from([None, "paper"]),
    ),
    min_size=1,
    max_size=6,
)


def three_families(*changes):
    """Return a tree of two leaves below three families, after changes of the leaves in rounds from 1 on."""
    tree = ScenarioTree.initial().apply(
        *(TreeEdit(op="add", node=n, parent="environmental", label=n.upper()) for n in FAMILIES),
        *(TreeEdit(op="add", node=n, parent="a", label=n.upper()) for n in "xy"),
    )
    for number, (op, node, name, attested) in enumerate(changes, 1):
        more = {"parent": name} if op == "move" else {"label": f"{name} {number}"}
        if op in ("broaden", "narrow"):
            more["attested"] = attested
        more = {} if op == "keep" else more
        tree = tree.apply(TreeEdit(op=op, node=node, round=number, **more))
    return tree


@given(relabelled_or_moved, st.randoms(use_true_random=False))
def test_rounds_are_undone_in_any_order(changes, random):
    tree = three_families(*changes)
    rounds = list(range(1, len(changes) + 1))
    random.shuffle(rounds)
    for done, number in enumerate(rounds, 1):
        tree = tree.undo(round=number)
        left = [changes[other - 1] for other in sorted(rounds[done:])]
        expected = three_families(*left)
        places = {node.id: node.parent for node in tree.nodes}
        assert places == {node.id: node.parent for node in expected.nodes}
        assert [node.attested for node in tree.nodes] == [node.attested for node in expected.nodes]
    assert tree.nodes == three_families().nodes


@given(relabelled_or_moved, st.data())
def test_undos_are_undone_in_any_order(changes, data):
    tree = three_families(*changes)
    before, known = tree, len(tree.edits)
    for number in data.draw(st.permutations(range(1, len(changes) + 1))):
        tree = tree.undo(round=number)
    for index in data.draw(st.permutations(range(known, len(tree.edits)))):
        tree = tree.undo(index)
    assert tree.nodes == before.nodes


def without_rounds(tree, rounds):
    """Undo rounds one after the other; one of which nothing is left is refused."""
    for number in rounds:
        with suppress(UsageError):
            tree = tree.undo(round=number)
    return tree


@given(steps, st.data())
def test_any_order_of_undoing_all_rounds_leaves_what_none_of_them_made(steps, data):
    initial = ScenarioTree.initial()
    made = numbered([step for step in steps if step[0] not in ("remove", "undo")], initial)
    names = {node.id for node in initial.nodes}
    edits = [edit for edit in made.edits[len(initial.edits) :] if edit.node not in names]
    tree = initial.apply(*edits)
    rounds = data.draw(st.permutations(range(3)))
    assert without_rounds(tree, rounds).nodes == initial.nodes


@pytest.mark.parametrize("rounds", list(permutations([1, 2, 3])))
def test_a_family_of_an_undone_round_does_not_stay_as_a_leaf(rounds):
    one, two, three = ({"stage": "redteam", "round": number} for number in (1, 2, 3))
    tree = ScenarioTree.initial().apply(
        TreeEdit(op="add", node="f", parent="environmental", label="Family F", **one),
        TreeEdit(op="add", node="leaf", parent="f", label="Leaf", **two),
        TreeEdit(op="add", node="g", parent="environmental", label="Family G", **three),
        TreeEdit(op="move", node="leaf", parent="g", **three),
    )
    after = without_rounds(tree, rounds)
    assert after.nodes == ScenarioTree.initial().nodes
    for position in reversed(range(len(tree.edits), len(after.edits))):
        after = after.undo(position)
    assert after.nodes == tree.nodes


def test_an_edit_that_a_later_one_replaced_leaves_only_its_record():
    tree = three_families(("broaden", "x", "b", None), ("broaden", "x", "c", None))
    first = tree.undo(round=1)
    assert first.by_id["x"].label == "c 2"
    assert [(edit.op, edit.undoes) for edit in first.edits[len(tree.edits) :]] == [("keep", 8)]
    assert first.undo().by_id["x"].label == "X"


def test_an_edit_is_undone_once():
    tree = three_families(("broaden", "x", "b", None)).undo(8)
    with pytest.raises(UsageError, match="edit 8 is undone already"):
        tree.undo(8)


def test_a_label_from_before_a_removal_does_not_return_to_the_node_that_followed():
    tree = three_families(("broaden", "x", "b", None)).apply(
        TreeEdit(op="remove", node="x"), TreeEdit(op="add", node="x", parent="a", label="New")
    )
    assert tree.undo(round=1).by_id["x"].label == "New"
