"""Single edits: what they do to a node, and which are refused."""

import pytest
from hypothesis import given

from oodscen import ScenarioTree
from oodscen.errors import DataError
from oodscen.tree._edits import TreeEdit
from oodscen.tree._labels import slug
from tests.tree.woods import chain, changes, few, grown

FOG = ScenarioTree.initial().apply(
    TreeEdit(op="add", node="fog", parent="environmental", label="Fog or smoke", attested="paper")
)


@pytest.mark.parametrize(("op", "kept"), [("broaden", "paper"), ("narrow", None)])
def test_a_broader_label_keeps_what_was_attested_and_a_narrower_one_does_not(op, kept):
    assert FOG.apply(TreeEdit(op=op, node="fog", label="Mist")).by_id["fog"].attested == kept
    named = TreeEdit(op=op, node="fog", label="Mist", attested="paper")
    assert FOG.apply(named).by_id["fog"].attested == "paper"


def test_only_an_earlier_edit_can_be_undone():
    last = len(FOG.edits) - 1
    assert FOG.apply(TreeEdit(op="keep", node="fog", undoes=last)).edits[-1].undoes == last
    for later in (last + 1, last + 2):
        with pytest.raises(DataError, match="does not come before it"):
            FOG.apply(TreeEdit(op="keep", node="fog", undoes=later))


def test_an_edit_may_undo_any_that_comes_before_it_in_the_same_list():
    first = len(FOG.edits)
    edits = [TreeEdit(op="keep", node="fog", undoes=index) for index in (0, first, first + 1)]
    assert [edit.undoes for edit in FOG.apply(*edits).edits[first:]] == [0, first, first + 1]
    with pytest.raises(DataError, match="does not come before it"):
        FOG.apply(edits[0], edits[2])


def test_a_parent_that_does_not_exist_is_told():
    for edit in (
        TreeEdit(op="move", node="fog", parent="gone"),
        TreeEdit(op="add", node="ice", parent="gone", label="Ice"),
    ):
        with pytest.raises(DataError, match="the parent 'gone' does not exist") as caught:
            FOG.apply(edit)
        assert [issue.path for issue in caught.value.issues] == ["edits[0]"]


def test_a_fault_below_a_refused_node_is_told_only_where_it_is_its_own():
    with pytest.raises(DataError) as caught:
        FOG.apply(
            TreeEdit(op="add", node="a b", parent="root", label="A"),
            TreeEdit(op="add", node="c", parent="a b", label="C"),
            TreeEdit(op="keep", node="c"),
            TreeEdit(op="remove", node="environmental"),
            TreeEdit(op="add", node="d e", parent="environmental", label="D"),
        )
    assert [issue.path for issue in caught.value.issues] == [f"edits[{i}]" for i in (0, 3, 4)]


@pytest.mark.parametrize(
    ("edit", "is_told"),
    [
        (TreeEdit(op="add", node="b", parent="a", label="B"), False),
        (TreeEdit(op="add", node="b", parent="a", label="null"), True),
        (TreeEdit(op="add", node="b!", parent="a", label="B"), True),
        (TreeEdit(op="add", node="b", parent="gone", label="B"), True),
        (TreeEdit(op="keep", node="a"), False),
        (TreeEdit(op="keep", node="a", undoes=99), True),
        (TreeEdit(op="keep", node="a", label="A"), True),
        (TreeEdit(op="broaden", node="a", label="<b>x</b>"), True),
        (TreeEdit(op="move", node="fog", parent="a"), False),
        (TreeEdit(op="move", node="gone", parent="a"), True),
    ],
)
def test_only_the_lack_of_a_refused_node_is_not_told(edit, is_told):
    refused = TreeEdit(op="add", node="a", parent="environmental", label="null")
    with pytest.raises(DataError) as caught:
        FOG.apply(refused, edit)
    told = ["edits[0]", "edits[1]"] if is_told else ["edits[0]"]
    assert [issue.path for issue in caught.value.issues] == told


def test_every_edit_of_a_node_that_nothing_adds_is_told():
    with pytest.raises(DataError) as caught:
        FOG.apply(*[TreeEdit(op="keep", node="gone")] * 2)
    assert [issue.path for issue in caught.value.issues] == ["edits[0]", "edits[1]"]


def test_the_faults_of_all_nodes_below_a_refused_one_are_told():
    rows = [("root", None, "root"), ("a", "root", "null"), ("b!", "a", "B"), ("c", "a", "<b>x</b>")]
    nodes = [{"id": name, "parent": parent, "label": label} for name, parent, label in rows]
    with pytest.raises(DataError) as caught:
        ScenarioTree.parse({"nodes": nodes})
    assert [issue.path for issue in caught.value.issues] == [f"nodes[{i}]" for i in (1, 2, 3)]


def test_fifty_levels_are_the_most():
    assert chain(51).depth == 50
    with pytest.raises(DataError, match="more than 50 levels"):
        chain.__wrapped__(52)


@pytest.mark.parametrize(
    ("label", "found"),
    [
        ("Fog — or Smoke!", "fog-or-smoke"),
        ("Überfluteter Tunnel", "uberfluteter-tunnel"),
        ("x" * 60, "x" * 48),
        ("x" * 47 + " y", "x" * 47),
        ("霧", "node"),
    ],
)
def test_a_slug_is_the_plain_words_of_a_label(label, found):
    assert slug(label) == found


def test_a_node_that_moves_and_returns_stands_where_it_stood():
    tree = ScenarioTree.initial().apply(
        *(TreeEdit(op="add", node=name, parent="environmental", label=name) for name in "abc"),
        TreeEdit(op="move", node="b", parent="interactional"),
    )
    assert tree.children["environmental"] == ("a", "c")
    back = tree.apply(TreeEdit(op="move", node="b", parent="environmental"))
    assert back.children["environmental"] == ("a", "b", "c")


def test_siblings_below_a_parent_that_came_later_keep_their_order():
    tree = ScenarioTree.initial().apply(
        *(TreeEdit(op="add", node=name, parent="environmental", label=name) for name in "abcp"),
        *(TreeEdit(op="move", node=name, parent="p") for name in "cab"),
    )
    assert tree.children["p"] == ("a", "b", "c")
    assert [node.id for node in tree.nodes][3:] == ["p", "a", "b", "c"]


def test_a_node_that_was_removed_and_added_again_stands_where_it_stood():
    tree = ScenarioTree.initial().apply(
        *(TreeEdit(op="add", node=name, parent="environmental", label=name) for name in "abc"),
        TreeEdit(op="remove", node="a"),
        TreeEdit(op="add", node="a", parent="environmental", label="a"),
    )
    assert tree.children["environmental"] == ("a", "b", "c")


def test_a_branch_keeps_its_own_order_of_nodes_that_another_branch_added_too():
    trunk = ScenarioTree.initial()
    fog, ice = (TreeEdit(op="add", node=n, parent="environmental", label=n) for n in ("fog", "ice"))
    for edits in ((fog, ice), (ice, fog), (fog, ice)):
        tree = trunk.apply(*edits)
        assert [node.id for node in tree.nodes[3:]] == [edit.node for edit in edits]


def test_undoing_a_label_takes_back_what_it_attested():
    tree = FOG.apply(
        TreeEdit(op="add", node="ice", parent="environmental", label="Ice"),
        TreeEdit(op="broaden", node="ice", label="Ice or snow", attested="paper"),
    )
    assert tree.by_id["ice"].attested == "paper"
    assert tree.undo().by_id["ice"] == tree.at(edit=len(tree.edits) - 1).by_id["ice"]


@few
@given(changes)
def test_siblings_stand_in_the_order_in_which_they_were_first_added(steps):
    tree = grown(steps)
    first = {edit.node: index for index, edit in reversed(list(enumerate(tree.edits)))}
    for below in tree.children.values():
        assert list(below) == sorted(below, key=first.__getitem__)


def test_a_free_id_is_that_of_the_version_whatever_came_later():
    trees = [FOG]
    for name in ("ice", "ice-2", "ice-3"):
        trees.append(
            trees[-1].apply(
                TreeEdit(op="add", node=name, parent="environmental", label=name.replace("-", " "))
            )
        )
    for tree in (*reversed(trees), *trees):
        number = trees.index(tree) + 1
        assert tree.new_id("Ice") == ("ice" if number == 1 else f"ice-{number}")


def test_a_list_with_a_fault_applies_nothing():
    tree = ScenarioTree(FOG.edits)
    good = TreeEdit(op="add", node="ice", parent="environmental", label="Ice")
    with pytest.raises(DataError):
        tree.apply(good, TreeEdit(op="keep", node="nobody"))
    assert "ice" not in tree.by_id
    assert tree.apply(good).by_id["ice"].label == "Ice"


def test_what_comes_back_stands_below_the_parent_that_was_removed_with_it():
    pair = FOG.apply(
        TreeEdit(op="add", node="mist", parent="fog", label="Mist"),
        TreeEdit(op="add", node="ice", parent="environmental", label="Ice"),
    )
    gone = pair.apply(*(TreeEdit(op="remove", node=node) for node in ("mist", "fog", "ice")))
    back = gone.undo(len(pair.edits))
    assert back.path("mist") == pair.path("mist")
    assert "ice" not in back


@pytest.mark.parametrize(
    ("op", "field"),
    [
        ("keep", {"label": "Mist"}),
        ("keep", {"parent": "root"}),
        ("remove", {"label": "Mist"}),
        ("move", {"parent": "root", "label": "Mist"}),
        ("broaden", {"label": "Mist", "parent": "root"}),
        ("narrow", {"label": "Mist", "parent": "root"}),
        ("remove", {"attested": "paper"}),
    ],
)
def test_an_edit_with_a_field_that_it_would_not_use_is_refused(op, field):
    with pytest.raises(DataError, match=f"a '{op}' edit has no `{list(field)[-1]}`"):
        FOG.apply(TreeEdit(op=op, node="fog", **field))


def test_the_label_that_a_node_has_in_another_tree_stays_with_a_merged_keep():
    told = TreeEdit(op="keep", node="fog", label="Mist", origin="other", origin_node="mist")
    assert FOG.apply(told).by_id["fog"].label == "Fog or smoke"


@pytest.mark.parametrize("field", ["round", "undoes"])
@pytest.mark.parametrize("value", [True, "1", " 1 ", 1.5, -1, 10**30])
def test_a_round_is_a_number_of_rounds(field, value):
    with pytest.raises(DataError, match=field):
        TreeEdit(op="keep", node="fog", **{field: value})
