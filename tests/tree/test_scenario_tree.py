"""Laws of the tree: a value that is the fold of its edits."""

import copy
import json
import pickle
import re
import threading
import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.errors import DataError, UnknownComponent, UsageError
from oodscen.testing._encoder import HashEncoder
from oodscen.tree._edit_log import MAX_DEPTH
from oodscen.tree._labels import slug
from oodscen.tree._scenario_tree import ROOT, Node, ScenarioTree, TreeEdit
from tests.tree.woods import REFUSED, broad, chain, changes, edits, few, grown, trees


@given(trees)
def test_a_tree_is_valid_however_it_was_edited(tree):
    seen = set()
    for node in tree.nodes:
        assert node.parent in seen or (node.parent is None and not seen)
        assert node.id not in seen
        assert node.label.strip()
        seen.add(node.id)
    assert list(tree.by_id) == [node.id for node in tree.nodes]
    assert sum(map(len, tree.children.values())) == max(len(tree) - 1, 0)


@given(trees, edits)
def test_an_edit_is_applied_or_refused_and_the_tree_stays(tree, edit):
    text, nodes = tree.to_json(), tree.nodes
    try:
        after = tree.apply(edit)
    except DataError as caught:
        after, error = None, caught
    assert (tree.to_json(), tree.nodes) == (text, nodes)
    if after is None:
        assert [issue.path for issue in error.issues] == ["edits[0]"]
    else:
        assert after.edits == (*tree.edits, edit)
        assert after != tree


@few
@given(trees)
def test_nodes_are_the_fold_of_the_edits(tree):
    assert ScenarioTree(edits=tree.edits) == tree
    assert ScenarioTree().apply(*tree.edits) == tree
    half = len(tree.edits) // 2
    assert ScenarioTree().apply(*tree.edits[:half]).apply(*tree.edits[half:]) == tree


@few
@given(trees)
def test_json_and_pickle_give_the_tree_back(tree):
    again = ScenarioTree.parse(tree.to_json())
    assert again == tree == pickle.loads(pickle.dumps(tree))
    assert again.to_json() == tree.to_json()
    assert hash(again) == hash(tree)


@given(trees, changes)
def test_a_tree_is_a_collection_of_its_nodes(tree, steps):
    assert list(tree) == list(tree.nodes)
    assert len(tree) == len(list(tree))
    assert bool(tree) == bool(tree.nodes)
    assert all(node in tree for node in tree)
    for node in grown(steps):
        assert (node in tree) == (node in tree.nodes)
    assert "root" not in tree
    assert None not in tree


@few
@given(trees, trees)
def test_digests_are_equal_exactly_for_equal_trees(one, other):
    assert (one.digest() == other.digest()) == (one == other)


@few
@given(trees)
def test_a_file_of_nodes_alone_is_a_tree(tree):
    nodes = [node.model_dump() for node in tree.nodes]
    read = ScenarioTree.parse(json.dumps({"nodes": nodes}))
    assert read.nodes == tree.nodes
    assert len(read.edits) == len(read.nodes)
    assert ScenarioTree.parse(read.to_json()) == read


def test_a_file_of_nodes_alone_keeps_what_is_attested():
    nodes = [
        {"id": "root", "parent": None, "label": "Root"},
        {"id": "fog", "parent": "root", "label": "Fog", "attested": "paper"},
    ]
    assert ScenarioTree.parse({"nodes": nodes}).by_id["fog"].attested == "paper"


@few
@given(trees)
def test_the_outline_has_one_line_per_node(tree):
    lines = tree.outline(ids=True).splitlines()
    assert len(lines) == len(tree)
    for line, (node, depth) in zip(lines, tree.walk(), strict=True):
        assert line == f"{'  ' * depth}- {node.label} [{node.id}]"


@few
@given(trees)
def test_paths_lead_from_the_root_to_every_leaf(tree):
    assert list(tree.paths) == [leaf.id for leaf in tree.leaves]
    for leaf, path in tree.paths.items():
        assert path == tree.path(leaf)
        assert path[0] == tree.by_id[ROOT].label
        assert path[-1] == tree.by_id[leaf].label
        assert 3 <= len(path) <= tree.depth + 1
    below_classes = {node.id for node, depth in tree.walk() if depth >= 2}
    assert set(tree.paths) == {name for name in below_classes if not tree.children[name]}


@few
@given(trees)
def test_every_earlier_tree_is_the_fold_of_its_edits(tree):
    for number, edit in enumerate(tree.edits):
        earlier = tree.at(edit=number)
        assert earlier.edits == tree.edits[:number]
        assert earlier.nodes == ScenarioTree(tree.edits[:number]).nodes
        assert tree.before(number) == earlier.by_id.get(edit.node)
    assert tree.at(edit=len(tree.edits)) == tree


STORY = ScenarioTree.initial().apply(
    TreeEdit(op="add", node="fog", parent="environmental", label="Fog", stage="grow"),
    TreeEdit(op="add", node="ice", parent="environmental", label="Ice", stage="redteam", round=1),
    TreeEdit(op="add", node="mud", parent="environmental", label="Mud", stage="redteam", round=2),
    TreeEdit(op="keep", node="ice", stage="prune", reason="rare"),
)
"""A tree that was grown, red-teamed in two rounds and pruned."""


def test_a_tree_knows_its_moments_by_edit_round_and_stage():
    for moment, count in (
        ({"edit": 2}, 2),
        ({"round": 0}, 4),
        ({"round": 1}, 5),
        ({"stage": "grow"}, 4),
        ({"stage": "redteam"}, 6),
        ({"stage": "prune"}, 7),
    ):
        assert STORY.at(**moment).edits == STORY.edits[:count]
    for moment in ({}, {"edit": 2, "round": 1}, {"round": 1, "stage": "grow"}, {"edit": 8}):
        with pytest.raises(UsageError):
            STORY.at(**moment)


def test_an_edit_or_a_round_is_undone_and_not_both():
    def left(tree):
        return [leaf.id for leaf in tree.leaves]

    assert STORY.undo().edits[-1].undoes == 6
    assert left(STORY.undo(3)) == ["ice", "mud"]
    assert left(STORY.undo(-2)) == ["fog", "ice"]
    assert left(STORY.undo(round=1)) == ["fog", "mud"]
    away = ScenarioTree(edit.model_copy(update={"origin": "away"}) for edit in STORY.edits)
    assert left(away.undo(round=2, origin="away")) == ["fog", "ice"]
    for asked in (
        {"index": 3, "round": 1},
        {"origin": "away"},
        {"index": 3, "origin": "away"},
        {"round": 2, "origin": ""},
    ):
        with pytest.raises(UsageError):
            away.undo(**asked)


def test_a_node_is_found_with_who_added_it_or_refused_by_name():
    assert STORY.node("ice") == STORY.by_id["ice"]
    found = STORY.provenance("ice")
    assert (found.stage, found.round) == ("redteam", 1)
    assert [one.edit.reason for one in found.later] == ["rare"]
    for ask in (STORY.node, STORY.provenance):
        with pytest.raises(UnknownComponent):
            ask("fogs")


def test_a_planted_tree_has_two_classes_and_an_empty_one_nothing():
    tree = ScenarioTree.initial("Anything")
    assert tree.outline() == "- Anything\n  - Environmental\n  - Interactional"
    assert [node.id for node in tree] == ["root", "environmental", "interactional"]
    assert {edit.stage for edit in tree.edits} == {"grow"}
    assert (tree.depth, tree.leaves, tree.paths) == (1, (), {})
    empty = ScenarioTree()
    assert (empty.depth, len(empty), empty.outline(), empty.nodes) == (0, 0, "", ())


def test_a_notebook_shows_the_labels():
    shown = STORY._repr_html_()
    assert all(node.label in shown for node in STORY)


def test_a_file_says_its_version():
    assert json.loads(STORY.to_json())["schema_version"] == 1
    with pytest.raises(DataError):
        ScenarioTree.parse({**json.loads(STORY.to_json()), "schema_version": 2})


@few
@given(trees, st.text())
def test_new_ids_are_free_and_valid(tree, label):
    new = tree.new_id(label)
    assert new not in {edit.node for edit in tree.edits}
    assert tree.apply(
        TreeEdit(op="add", node=new, parent=None if not len(tree) else tree.nodes[0].id, label="x")
    )


@given(st.text())
def test_a_slug_is_a_safe_file_name(label):
    assert re.fullmatch(r"[a-z0-9]([a-z0-9-]{0,46}[a-z0-9])?", slug(label))


@given(st.characters(categories=["Cc", "Zl", "Zp"]))
def test_labels_stay_on_one_line(char):
    assert unicodedata.category(char) in ("Cc", "Zl", "Zp")
    with pytest.raises(DataError):
        ScenarioTree.initial().apply(TreeEdit(op="broaden", node=ROOT, label=f"a{char}b"))


def test_a_removed_id_is_not_given_out_again():
    tree = ScenarioTree.initial().apply(
        TreeEdit(op="add", node="fog", parent="environmental", label="Fog"),
        TreeEdit(op="remove", node="fog"),
    )
    assert tree.new_id("Fog") == "fog-2"


def test_ids_are_numbered_without_a_gap_and_an_earlier_tree_knows_no_later_ones():
    tree = ScenarioTree.initial()
    past = [tree]
    for wanted in ("fog", "fog-2", "fog-3", "fog-4"):
        assert tree.new_id("Fog") == wanted
        tree = tree.apply(TreeEdit(op="add", node=wanted, parent="environmental", label="Fog"))
        past.append(tree)
    for earlier, wanted in zip(past, ("fog", "fog-2", "fog-3", "fog-4", "fog-5"), strict=True):
        assert earlier.new_id("Fog") == wanted
        assert past[-1].new_id("Fog") == "fog-5"
    branch = past[1].apply(TreeEdit(op="add", node="ice", parent="environmental", label="Ice"))
    assert branch.new_id("Fog") == "fog-2"


def test_broadening_keeps_the_place_and_the_attestation():
    tree = ScenarioTree.initial().apply(
        TreeEdit(op="add", node="fog", parent="environmental", label="Fog", attested="paper"),
        TreeEdit(op="add", node="ice", parent="environmental", label="Ice"),
        TreeEdit(op="broaden", node="fog", label="Fog or smoke"),
    )
    assert tree.by_id["fog"] == Node(
        id="fog", parent="environmental", label="Fog or smoke", attested="paper"
    )
    assert [leaf.id for leaf in tree.leaves] == ["fog", "ice"]


def test_every_fault_of_an_edit_list_is_reported():
    with pytest.raises(DataError) as caught:
        ScenarioTree.initial().apply(
            TreeEdit(op="add", node="a b", parent="environmental", label="x"),
            TreeEdit(op="add", node="fog", parent="nowhere", label="x"),
            TreeEdit(op="keep", node="environmental"),
            TreeEdit(op="remove", node=ROOT),
            TreeEdit(op="add", node="top", label="second root"),
            TreeEdit(op="broaden", node="environmental", label=" "),
        )
    assert [issue.path for issue in caught.value.issues] == [f"edits[{i}]" for i in (0, 1, 3, 4, 5)]


def test_a_malformed_file_lists_every_issue_with_its_path(tmp_path):
    file = tmp_path / "tree.json"
    file.write_text(
        json.dumps(
            {
                "nodes": [
                    {"id": "root", "parent": None, "label": "r"},
                    {"id": 3, "parent": "root", "label": "x"},
                    {"id": "y", "parent": "root"},
                    {"id": "z", "parent": "root", "label": "z", "colour": "red"},
                ],
                "size": 4,
            }
        )
    )
    with pytest.raises(DataError) as caught:
        ScenarioTree.load(file)
    assert caught.value.source == str(file)
    assert {issue.path for issue in caught.value.issues} == {
        "nodes[1].id",
        "nodes[2].label",
        "nodes[3].colour",
        "size",
    }


def test_a_file_of_misfitting_nodes_lists_every_node():
    nodes = [("root", None, "r"), ("a", "root", "a"), ("a", "root", "b"), ("c", "nowhere", "c")]
    value = {"nodes": [{"id": i, "parent": p, "label": text} for i, p, text in nodes]}
    with pytest.raises(DataError) as caught:
        ScenarioTree.parse(value)
    assert [issue.path for issue in caught.value.issues] == ["nodes[2]", "nodes[3]"]


@pytest.mark.parametrize("part", ["nodes", "edits"])
def test_a_label_that_is_none_is_found_in_a_file_too(part):
    tree = ScenarioTree.initial().apply(
        TreeEdit(op="add", node="fog", parent="environmental", label="Fog")
    )
    value = json.loads(tree.to_json())
    value[part][3]["label"] = "Fog <img src=x onerror=alert(1)>"
    with pytest.raises(DataError) as caught:
        ScenarioTree.parse({part: value[part]})
    assert [issue.path for issue in caught.value.issues] == [f"{part}[3]"]
    assert "markup" in caught.value.issues[0].message


def test_no_edit_of_a_file_undoes_itself_or_a_later_one():
    tree = ScenarioTree.initial()
    own = len(tree.edits)
    edits = [edit.model_dump(mode="json") for edit in tree.edits]
    again = {"op": "broaden", "node": "environmental", "label": "Weather and light"}
    assert (
        len(ScenarioTree.parse({"edits": [*edits, {**again, "undoes": own - 1}]}).edits) == own + 1
    )
    for undone in (own, own + 1):
        with pytest.raises(DataError) as caught:
            ScenarioTree.parse({"edits": [*edits, {**again, "undoes": undone}]})
        assert [issue.path for issue in caught.value.issues] == [f"edits[{own}]"]


def test_nodes_that_do_not_follow_from_the_edits_are_refused():
    tree = ScenarioTree.initial()
    value = json.loads(tree.to_json())
    value["nodes"][1]["label"] = "Else"
    for nodes in (value["nodes"], value["nodes"][:2], []):
        with pytest.raises(DataError) as caught:
            ScenarioTree.parse({**value, "nodes": nodes})
        assert [issue.path for issue in caught.value.issues] == ["nodes"]


@pytest.mark.parametrize("text", ["", "[]", "null", '{"nodes": 3}', "{", '{"nodes":' + "[" * 9_000])
def test_files_that_hold_something_else_are_data_errors(tmp_path, text):
    file = tmp_path / "tree.json"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(DataError):
        ScenarioTree.load(file)


def test_the_deepest_tree_works():
    tree = chain(MAX_DEPTH + 1)
    last = f"n{MAX_DEPTH}"
    assert tree.depth == MAX_DEPTH
    assert [leaf.id for leaf in tree.leaves] == [last]
    assert ScenarioTree.parse(tree.to_json()) == tree
    with pytest.raises(DataError, match="cycle"):
        tree.apply(TreeEdit(op="move", node="n1", parent=last))
    assert len(tree.undo(1)) == 1
    assert tree.undo(1).undo(-1).path("n1") == ("0", "1")


def test_what_is_too_deep_is_refused_where_it_begins():
    nodes = [{"id": "n0", "parent": None, "label": "0"}]
    nodes += [{"id": f"n{i}", "parent": f"n{i - 1}", "label": str(i)} for i in range(1, 15_000)]
    with pytest.raises(DataError, match="levels below the root") as caught:
        ScenarioTree.parse({"nodes": nodes})
    assert [issue.path for issue in caught.value.issues] == [f"nodes[{MAX_DEPTH + 1}]"]


@given(st.integers(1, MAX_DEPTH - 2), st.sampled_from([-1, 0, 1]))
def test_a_move_is_refused_exactly_where_the_tree_would_be_too_deep(above, over):
    size = MAX_DEPTH - 1 - above + over
    tree = chain(above + 1).apply(TreeEdit(op="add", node="x0", parent="n0", label="x0"))
    tree = tree.apply(
        *(
            TreeEdit(op="add", node=f"x{i}", parent=f"x{i - 1}", label=f"x{i}")
            for i in range(1, size + 1)
        )
    )
    move = TreeEdit(op="move", node="x0", parent=f"n{above}")
    if over > 0:
        with pytest.raises(DataError, match="levels below the root"):
            tree.apply(move)
    else:
        assert tree.apply(move).depth == above + 1 + size


def test_ten_thousand_single_edits_copy_nothing():
    tree = broad.__wrapped__(10_000)
    assert len(tree) == 10_000
    growth = tree._index
    tree = tree.apply(TreeEdit(op="keep", node=ROOT))
    assert tree._index is growth
    assert growth._is_ordered
    assert "nodes" not in tree.__dict__
    assert "edits" not in tree.__dict__
    assert tree.at(edit=5_000)._index is growth
    assert len(tree.at(edit=5_000)) == 5_000


@few
@given(changes, changes)
def test_branches_of_one_tree_know_nothing_of_each_other(one, other):
    trunk = ScenarioTree.initial()
    first, second = grown(one, trunk), grown(other, trunk)
    assert first == ScenarioTree(edits=first.edits)
    assert second == ScenarioTree(edits=second.edits)
    assert [tree.nodes for tree in (first, second, trunk)] == [
        ScenarioTree(edits=tree.edits).nodes for tree in (first, second, trunk)
    ]
    assert len(first) == len(first.nodes)


def test_threads_may_branch_off_the_same_tree():
    trunk = ScenarioTree.initial()
    found = {}

    def grow(name):
        tree = trunk
        for number in range(200):
            label = f"{name}{number}"
            edit = TreeEdit(op="add", node=tree.new_id(label), parent="environmental", label=label)
            tree = tree.apply(edit)
        found[name] = tree

    threads = [threading.Thread(target=grow, args=(name,)) for name in "abcd"]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for name, tree in found.items():
        assert [node.label for node in tree.nodes[3:]] == [f"{name}{n}" for n in range(200)]


@given(trees, edits)
def test_a_moved_branch_takes_all_below_it_along(tree, edit):
    after = grown([edit], tree)
    if edit.op != "move" or after is tree:
        return
    assert set(after.by_id) == set(tree.by_id)
    assert after.by_id[edit.node].parent == edit.parent
    for node in tree.nodes:
        if node.id != edit.node:
            assert after.by_id[node.id] == node
    for parent, children in after.children.items():
        before = tree.children[parent]
        assert [child for child in children if child != edit.node] == [
            child for child in before if child != edit.node
        ]


@pytest.mark.parametrize("label", REFUSED)
@pytest.mark.parametrize("op", ["add", "broaden", "narrow"])
def test_what_cannot_be_a_label_is_refused(label, op):
    assert ScenarioTree.label_fault(label)
    tree = ScenarioTree.initial()
    node = "fog" if op == "add" else "environmental"
    with pytest.raises(DataError) as caught:
        tree.apply(TreeEdit(op=op, node=node, parent="environmental", label=label))
    assert len(str(caught.value)) < 500
    assert tree == ScenarioTree.initial()


@few
@given(trees)
def test_copies_are_equal_and_hold_everything(tree):
    late = tree.apply(TreeEdit(op="keep", node=ROOT)) if ROOT in tree.by_id else tree
    for other in (copy.copy(late), copy.deepcopy(late), pickle.loads(pickle.dumps(late))):
        assert other == late
        assert other.to_json() == late.to_json()
        assert repr(other) == repr(late)


def test_a_tree_never_changes():
    tree = ScenarioTree.initial()
    for name in ("nodes", "edits", "by_id", "children"):
        with pytest.raises(AttributeError, match="never changes"):
            setattr(tree, name, ())
        with pytest.raises(AttributeError, match="never changes"):
            delattr(tree, name)
    for found in (tree.by_id, tree.children):
        with pytest.raises(TypeError):
            found[ROOT] = ()
        assert not hasattr(found, "clear")
    assert repr(tree) == "<scenario tree: 3 nodes, 0 paths, 3 edits>"


@given(changes, st.data())
def test_a_move_below_itself_and_no_other_is_a_cycle(steps, data):
    tree = grown(steps)
    ids = st.sampled_from([node.id for node in tree.nodes])
    node, parent = data.draw(ids), data.draw(ids)
    cursor, above = parent, []
    while cursor is not None:
        above.append(cursor)
        cursor = tree.by_id[cursor].parent
    try:
        tree.apply(TreeEdit(op="move", node=node, parent=parent))
    except DataError:
        assert node in above
    else:
        assert node not in above


def test_an_object_without_nodes_and_edits_is_no_tree():
    for value in ({}, "{}", {"schema_version": 1}):
        with pytest.raises(DataError, match="neither nodes nor edits"):
            ScenarioTree.parse(value)
    assert len(ScenarioTree.parse(ScenarioTree().to_json())) == 0


@pytest.mark.parametrize(
    "call",
    [
        lambda tree: tree.apply([TreeEdit(op="remove", node=ROOT)]),
        lambda tree: tree.apply("edit"),
        lambda tree: tree.diff(tree.nodes),
        lambda tree: tree.merge("tree"),
        lambda tree: tree.path(5),
        lambda tree: tree.new_id(None),
        lambda tree: tree.initial(3),
        lambda tree: tree.before(3),
        lambda tree: ScenarioTree(edit.model_dump() for edit in tree.edits),
        lambda tree: ScenarioTree(tree.edits[0]),
    ],
)
def test_arguments_of_another_kind_are_refused(call):
    with pytest.raises(UsageError, match="must be"):
        call(ScenarioTree.initial())


def test_a_tree_without_edits_has_none_to_look_before():
    with pytest.raises(UsageError, match="the tree has no edits"):
        ScenarioTree().before(0)


def test_labels_pair_by_meaning_from_the_threshold_on():
    def tree(label):
        add = ScenarioTree.Edit(op="add", node=label[:3], parent="environmental", label=label)
        return ScenarioTree.initial().apply(add)

    one, other, encoder = tree("dense fog on the road"), tree("fog on the road"), HashEncoder()
    for threshold, pairs in ((0.1, 1), (1.0, 0)):
        found = one.diff(other, encoder=encoder, threshold=threshold)
        assert len(found.added) == 1 - pairs
        merged = one.merge(other, encoder=encoder, threshold=threshold, name="theirs")
        assert len(merged) == len(one) + 1 - pairs
        assert merged.edits[-1].origin == "theirs"


@pytest.mark.parametrize("name", ["stage", "reason", "source", "model", "prompt", "origin"])
def test_an_edit_with_half_a_character_is_refused(name):
    tree = ScenarioTree.initial()
    with pytest.raises(DataError, match=f"`{name}` has a lone surrogate"):
        tree.apply(TreeEdit(op="keep", node="root", **{name: "a\ud800b"}))
