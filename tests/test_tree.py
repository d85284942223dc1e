"""Laws of the tree: a value that is the fold of its edits."""

import json
import pickle
import re
import unicodedata
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.errors import DataError
from oodscen.tree import MAX_LABEL, ROOT, Node, ScenarioTree, TreeEdit, slug

labels = st.one_of(
    st.sampled_from(["Fog", "Deer", "", "  ", "a\nb", "a\u2028b", "x" * (MAX_LABEL + 1)]),
    st.text(max_size=12),
)
ids = st.sampled_from([ROOT, "environmental", "interactional", "a", "b", "c", "no id", ""])
edits = st.builds(
    TreeEdit,
    op=st.sampled_from(["add", "add", "broaden", "keep", "remove"]),
    node=ids,
    parent=st.none() | ids,
    label=st.none() | labels,
    attested=st.sampled_from([None, "paper"]),
    reason=st.sampled_from(["", "because"]),
)


def grown(changes):
    """Apply what can be applied, one by one."""
    tree = ScenarioTree.planted()
    for edit in changes:
        with suppress(DataError):
            tree = tree.apply(edit)
    return tree


trees = st.lists(edits, max_size=14).map(grown)


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


@given(trees)
def test_nodes_are_the_fold_of_the_edits(tree):
    assert ScenarioTree(edits=tree.edits) == tree
    assert ScenarioTree().apply(*tree.edits) == tree
    half = len(tree.edits) // 2
    assert ScenarioTree().apply(*tree.edits[:half]).apply(*tree.edits[half:]) == tree


@given(trees)
def test_json_and_pickle_give_the_tree_back(tree):
    again = ScenarioTree.parse(tree.to_json())
    assert again == tree == pickle.loads(pickle.dumps(tree))
    assert again.to_json() == tree.to_json()
    assert hash(again) == hash(tree)


@given(trees, trees)
def test_digests_are_equal_exactly_for_equal_trees(one, other):
    assert (one.digest() == other.digest()) == (one == other)


@given(trees)
def test_a_file_of_nodes_alone_is_a_tree(tree):
    nodes = [node.model_dump() for node in tree.nodes]
    read = ScenarioTree.parse(json.dumps({"nodes": nodes}))
    assert read.nodes == tree.nodes
    assert len(read.edits) == len(read.nodes)
    assert ScenarioTree.parse(read.to_json()) == read


@given(trees)
def test_the_outline_has_one_line_per_node(tree):
    lines = tree.outline(ids=True).splitlines()
    assert len(lines) == len(tree)
    for line, (node, depth) in zip(lines, tree.walk(), strict=True):
        assert line == f"{'  ' * depth}- {node.label} [{node.id}]"


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
        ScenarioTree.planted().apply(TreeEdit(op="broaden", node=ROOT, label=f"a{char}b"))


def test_a_removed_id_is_not_given_out_again():
    tree = ScenarioTree.planted().apply(
        TreeEdit(op="add", node="fog", parent="environmental", label="Fog"),
        TreeEdit(op="remove", node="fog"),
    )
    assert tree.new_id("Fog") == "fog-2"


def test_broadening_keeps_the_place_and_the_attestation():
    tree = ScenarioTree.planted().apply(
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
        ScenarioTree.planted().apply(
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


def test_nodes_that_do_not_follow_from_the_edits_are_refused():
    tree = ScenarioTree.planted()
    value = json.loads(tree.to_json())
    value["nodes"][1]["label"] = "Else"
    with pytest.raises(DataError) as caught:
        ScenarioTree.parse(value)
    assert [issue.path for issue in caught.value.issues] == ["nodes"]


@pytest.mark.parametrize(
    "text", ["", "[]", "null", '{"nodes": 3}', "{", "\ufeff{}", '{"nodes":' + "[" * 9_000]
)
def test_files_that_hold_something_else_are_data_errors(tmp_path, text):
    file = tmp_path / "tree.json"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(DataError):
        ScenarioTree.load(file)


def test_a_chain_of_ten_thousand_works():
    size = 10_000
    adds = [TreeEdit(op="add", node="n0", label="0")]
    adds += [
        TreeEdit(op="add", node=f"n{i}", parent=f"n{i - 1}", label=str(i)) for i in range(1, size)
    ]
    tree = ScenarioTree().apply(*adds)
    assert tree.depth == size - 1
    assert [leaf.id for leaf in tree.leaves] == [f"n{size - 1}"]
    assert len(tree.paths[f"n{size - 1}"]) == size
    assert len(tree.outline().splitlines()) == size
    assert ScenarioTree.parse(tree.to_json()) == tree
    assert tree.apply(TreeEdit(op="remove", node=f"n{size - 1}")).depth == size - 2
