"""Laws of the merge of two trees."""

from collections import Counter

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from oodscen.errors import DataError, UsageError
from oodscen.testing._encoder import HashEncoder
from oodscen.tree._comparison import diff
from oodscen.tree._edit_log import MAX_DEPTH
from oodscen.tree._labels import same_words
from oodscen.tree._matching import match
from oodscen.tree._merge import merge
from oodscen.tree._scenario_tree import ROOT, ScenarioTree, TreeEdit
from tests.tree.woods import WORDS, broad, chain, few, numbered, steps, trees

ENCODER = HashEncoder()


def weather_tree(*nodes, top="environmental", **why):
    """Return a tree with a family of weather."""
    return ScenarioTree.initial().apply(
        TreeEdit(op="add", node="weather", parent=top, label="Weather", **why),
        *(
            TreeEdit(op="add", node=name, parent=parent, label=label, **why)
            for name, parent, label in nodes
        ),
    )


SNOW = ("snow", "weather", "Snow")
BLIZZARD = ("blizzard", "snow", "Blizzard")


@few
@given(trees, trees)
def test_a_merge_is_a_valid_tree_that_begins_with_the_first_log(one, other):
    merged = merge(one, other, encoder=ENCODER)
    assert ScenarioTree.parse(merged.to_json()) == merged
    assert merged.edits[: len(one.edits)] == one.edits
    assert merged.nodes[: len(one)] == one.nodes
    assert merged == merge(one, other, encoder=ENCODER)


@few
@given(trees, trees, st.sampled_from([None, ENCODER]))
def test_everything_of_the_second_tree_is_in_the_merge(one, other, encoder):
    merged = merge(one, other, encoder=encoder, threshold=0.3)
    paired = {pair.after for pair in match(one, other, encoder=encoder, threshold=0.3)}
    words = {same_words(node.label) for node in merged.nodes}
    for node in other.nodes:
        if node.id not in paired:
            assert same_words(node.label) in words
    came = [edit for edit in merged.edits[len(one.edits) :] if edit.op == "add"]
    assert all(edit.origin.partition("/")[0] == "merge-1" for edit in came)
    assert len(came) == len(merged) - len(one)


@few
@given(trees, trees, st.sampled_from([None, ENCODER]))
def test_the_second_tree_merged_in_again_changes_nothing(one, other, encoder):
    merged = merge(one, other, encoder=encoder, threshold=0.3)
    assert merge(merged, other, encoder=encoder, threshold=0.3) == merged
    assert merge(one, one, encoder=encoder) == one


@few
@given(trees, trees, trees, st.sampled_from([None, ENCODER]))
def test_a_tree_merged_in_again_after_another_changes_nothing(one, second, third, encoder):
    merged = merge(merge(one, second, encoder=encoder), third, encoder=encoder)
    assert merge(merged, second, encoder=encoder) == merged


def test_one_id_with_one_label_in_two_classes_is_known_again_in_each():
    def tree(family, top):
        return weather_tree((family, "weather", "Weathers"), ("fog", family, "Fog"), top=top)

    second, third = tree("calm", "environmental"), tree("wild", "interactional")
    merged = merge(merge(ScenarioTree.initial(), second), third)
    assert merge(merged, second) == merge(merged, third) == merged


def test_a_node_that_was_relabelled_before_the_merge_keeps_its_pair():
    """The second tree's `fog` has the label that the first gave to a node of both."""
    weather = TreeEdit(op="add", node="weather", parent="environmental", label="Weather")
    both = ScenarioTree.initial().apply(weather)
    one = both.apply(TreeEdit(op="narrow", node="weather", label="Fog"))
    other = both.apply(TreeEdit(op="add", node="fog", parent="environmental", label="Fog"))
    merged = merge(one, other)
    assert merge(merged, other) == merged


@few
@given(trees, trees)
def test_every_path_of_the_first_tree_stays_a_path(one, other):
    paths = set(merge(one, other).paths.values())
    for path in one.paths.values():
        below = {longer[len(path) :] for longer in paths if longer[: len(path)] == path}
        assert any(
            {same_words(label) for label in rest} <= {same_words(path[-1])} for rest in below
        )


@few
@given(trees, trees)
def test_every_pair_of_the_second_tree_stays_a_path(one, other):
    merged = merge(one, other)
    leaves = {leaf.id for leaf in other.leaves}
    inner = {node.id for node in merged.nodes if merged.children[node.id]}
    told = {
        edit.origin_node: edit.node
        for edit in merged.edits[len(one.edits) :]
        if edit.stage == "merge" and edit.origin_node in leaves
    }
    for name, here in told.items():
        own = same_words(other.by_id[name].label)
        # A leaf whose counterpart is a family stands below it, under its own label or the family's.
        assert here not in inner or any(
            same_words(merged.by_id[child].label) in (own, same_words(merged.by_id[here].label))
            for child in merged.children[here]
        )


@few
@given(trees, trees)
def test_siblings_that_only_look_different_are_one(one, other):
    merged = merge(one, other)
    ours = set(one.by_id)
    for parent, children in merged.children.items():
        new = [same_words(merged.by_id[name].label) for name in children if name not in ours]
        old = {same_words(merged.by_id[name].label) for name in children if name in ours}
        assert len(set(new)) == len(new), parent
        assert not old & set(new)


def test_a_leaf_that_is_a_family_in_the_other_tree_stays_a_leaf_of_it():
    one, other = weather_tree(SNOW), weather_tree(SNOW, BLIZZARD)
    for first, second in ((one, other), (other, one)):
        merged = merge(first, second)
        assert {leaf.label for leaf in merged.leaves} == {"Snow", "Blizzard"}
        assert merged.path("blizzard")[-3:] == ("Weather", "Snow", "Blizzard")
        assert merge(merged, second) == merged
        assert merge(merged, first).nodes == merged.nodes


def test_siblings_of_one_tree_that_only_look_different_are_one():
    other = weather_tree(SNOW, ("snow-2", "weather", "  SNOW "), ("blizzard", "snow-2", "Blizzard"))
    merged = merge(ScenarioTree.initial(), other)
    assert [merged.path(leaf.id)[2:] for leaf in merged.leaves] == [
        ("Weather", "Snow", "Snow"),
        ("Weather", "Snow", "Blizzard"),
    ]


def test_the_two_classes_never_mix():
    one = weather_tree(SNOW)
    other = weather_tree(("hail", "weather", "Hail"), SNOW, top="interactional")
    found = match(one, other, encoder=ENCODER, threshold=-1.0)
    assert {pair.before for pair in found} == {"root", "environmental", "interactional"}
    merged = merge(one, other, encoder=ENCODER, threshold=-1.0)
    assert len(merged.leaves) == 3
    moved = one.apply(TreeEdit(op="move", node="weather", parent="interactional"))
    assert [item.before for item in diff(one, moved).moved] == ["weather"]


def third_round(node, label):
    return weather_tree((node, "weather", label), stage="redteam", round=3, model="same")


def test_rounds_of_the_merged_tree_are_undone_apart():
    one, other = third_round("mud", "Mud"), third_round("hail", "Hail")
    merged = merge(one, other)
    assert [leaf.label for leaf in merged.leaves] == ["Mud", "Hail"]
    assert [leaf.label for leaf in merged.undo(round=3, origin="merge-1").leaves] == ["Mud"]
    third = merge(merged, weather_tree(SNOW, round=3), name="third")
    assert [leaf.label for leaf in third.undo(round=3, origin="third").leaves] == ["Mud", "Hail"]


def test_a_round_of_a_merged_tree_is_undone_by_round_and_origin_only():
    own = merge(ScenarioTree.initial(), third_round("hail", "Hail"))
    with pytest.raises(UsageError, match="merge-1"):
        own.undo(round=3)
    with pytest.raises(UsageError):
        own.undo(origin="merge-1")
    assert own.at(round=3) == ScenarioTree.initial()


def test_the_origin_of_a_merged_node_is_told_through_further_merges():
    own = merge(ScenarioTree.initial(), third_round("hail", "Hail"))
    assert "round 3 of merge-1" in str(own.provenance("hail"))
    twice = merge(ScenarioTree.initial(), own, name="outer")
    assert {edit.origin for edit in twice.edits if edit.node == "hail"} >= {"outer/merge-1"}


def test_a_decision_that_was_undone_is_not_merged():
    other = weather_tree(("hail", "weather", "Hail"))
    wider = other.apply(TreeEdit(op="broaden", node="hail", label="Hail or sleet")).undo()
    merged = merge(ScenarioTree.initial(), wider)
    assert merged.nodes == merge(ScenarioTree.initial(), other).nodes
    assert [edit.op for edit in merged.edits if edit.node == "hail"] == ["add", "keep"]


def test_what_was_decided_before_a_removal_is_merged_only_if_the_removal_is_undone():
    gone = weather_tree(("hail", "weather", "Hail"), model="first").apply(
        TreeEdit(op="broaden", node="hail", label="Hail or sleet"),
        TreeEdit(op="remove", node="hail"),
    )
    again = TreeEdit(op="add", node="hail", parent="weather", label="Hail", model="second")
    for other, model, ops in (
        (gone.undo(), "first", ["add", "broaden", "keep"]),
        (gone.apply(again), "second", ["add", "keep"]),
    ):
        merged = merge(ScenarioTree.initial(), other)
        told = [edit for edit in merged.edits if edit.node == "hail"]
        assert (told[0].model, [edit.op for edit in told]) == (model, ops)
        assert merged.nodes == other.nodes


@few
@given(trees)
def test_a_tree_merged_with_itself_or_with_nothing_stays(tree):
    assert merge(tree, tree).nodes == tree.nodes
    assert merge(tree, ScenarioTree()).nodes == tree.nodes
    assert [node.label for node in merge(ScenarioTree(), tree).nodes] == [
        node.label for node in tree.nodes
    ]


def test_nodes_keep_who_put_them_there():
    def grow(model, *leaves):
        edits = [
            TreeEdit(op="add", node="weather", parent="environmental", label="Weather", model=model)
        ]
        edits += [
            TreeEdit(
                op="add",
                node=f"leaf-{number}",
                parent="weather",
                label=label,
                stage="redteam",
                round=number,
                model=model,
                prompt=f"place-scenario@{model}",
                reason=f"{model} says so",
                source=f"{label} ahead.",
                attested="paper",
            )
            for number, label in enumerate(leaves)
        ]
        return ScenarioTree.initial().apply(*edits)

    one, other = grow("one", "Fog at night", "Hail"), grow("other", "Snow", "At night fog")
    other = other.apply(TreeEdit(op="broaden", node="leaf-0", label="Snow or ice", model="other"))
    merged = merge(one, other, encoder=ENCODER)
    assert [leaf.label for leaf in merged.leaves] == ["Fog at night", "Hail", "Snow or ice"]
    first, broadened, kept = (edit for edit in merged.edits if edit.node == "snow")
    assert first == other.edits[4].model_copy(
        update={"node": "snow", "origin": "merge-1", "origin_node": "leaf-0"}
    )
    assert (broadened.stage, kept.stage) == ("", "merge")
    assert merged.provenance("snow").model == "other"
    fog = merged.provenance("leaf-0").later[-1].edit
    assert fog == TreeEdit(
        op="keep",
        node="leaf-0",
        label="At night fog",
        stage="merge",
        round=1,
        reason=fog.reason,
        source="At night fog ahead.",
        model="other",
        prompt="place-scenario@other",
        origin="merge-1",
        origin_node="leaf-1",
    )
    assert "At night fog" in fog.reason
    assert not diff(merged, other, encoder=ENCODER).added
    assert len(merged.at(round=1)) == len(one)


def test_size_is_no_obstacle():
    merged = merge(broad(10_000), chain(MAX_DEPTH + 1))
    assert len(merged) == 10_000 + MAX_DEPTH


SAYS = {"model": "m", "prompt": "p@1", "source": "seen", "reason": "because"}


def test_a_node_that_both_have_is_kept_with_what_the_second_says_of_it():
    one = weather_tree(("snow", "weather", "Snow"))
    other = weather_tree(("snow", "weather", "Snow"), ("ice", "weather", "Ice")).apply(
        TreeEdit(op="broaden", node="snow", label="Snow or sleet", round=2, **SAYS)
    )
    for name, origin in ((None, "merge-1"), ("theirs", "theirs")):
        merged = merge(one, other, name=name)
        kept = [edit for edit in merged.edits[len(one.edits) :] if edit.node == "snow"]
        assert kept == [
            TreeEdit(
                op="keep",
                node="snow",
                label="Snow or sleet",
                stage="merge",
                round=2,
                reason="the other tree has it as “Snow or sleet” (same id)",
                source="seen",
                model="m",
                prompt="p@1",
                origin=origin,
                origin_node="snow",
            )
        ]
        assert merged.by_id["snow"].label == "Snow"


def test_what_paired_two_nodes_is_in_the_reason():
    one = weather_tree(("x", "weather", "Snow on the road"))
    other = weather_tree(("y", "weather", "Snow on a road"), ("z", "weather", "snow on the road"))
    merged = merge(one, other, encoder=ENCODER, threshold=-1.0)
    reasons = [edit.reason for edit in merged.edits if edit.node == "x" and edit.op == "keep"]
    pairs = {pair.after: pair for pair in match(one, other, encoder=ENCODER, threshold=-1.0)}
    assert pairs["z"].similarity is None
    assert reasons == ["the other tree has it as “snow on the road” (same label)"]
    alone = weather_tree(("y", "weather", "Snow on a road"))
    (pair,) = (p for p in match(one, alone, encoder=ENCODER, threshold=-1.0) if p.after == "y")
    merged = merge(one, alone, encoder=ENCODER, threshold=-1.0)
    assert merged.edits[-1].reason == (
        "the other tree has it as “Snow on a road” "
        f"(same {pair.by}, similarity {pair.similarity:.2f})"
    )
    assert len(merge(one, alone, encoder=ENCODER, threshold=1.0)) == len(one) + 1
    assert len(merge(one, alone, threshold=-1.0)) == len(one) + 1


def test_an_added_node_brings_its_decisions_and_ends_as_it_was():
    one, other = ScenarioTree.initial(), weather_tree(("fog", "weather", "Fog"))
    other = other.apply(
        TreeEdit(op="broaden", node="fog", label="Fog or smoke", attested="paper", **SAYS),
        TreeEdit(op="keep", node="fog", round=1, **SAYS),
        TreeEdit(op="broaden", node="fog", label="Fog, smoke or dust", round=2),
    )
    told = {"node": "fog", "origin": "merge-1", "origin_node": "fog"}
    assert [edit for edit in merge(one, other).edits if edit.node == "fog"] == [
        TreeEdit(op="add", parent="weather", label="Fog", **told),
        TreeEdit(op="broaden", label="Fog or smoke", attested="paper", **SAYS, **told),
        TreeEdit(op="keep", round=1, **SAYS, **told),
        TreeEdit(op="broaden", label="Fog, smoke or dust", round=2, **told),
        TreeEdit(
            op="keep",
            label="Fog, smoke or dust",
            stage="merge",
            reason="merged in from another tree, where its id was fog",
            **told,
        ),
    ]


def test_a_label_that_an_undoing_gave_back_is_told_as_such():
    other = weather_tree(("fog", "weather", "Fog")).apply(
        TreeEdit(op="keep", node="weather"),
        TreeEdit(op="narrow", node="fog", label="Fog at night"),
        TreeEdit(op="broaden", node="fog", label="Fog, smoke", undoes=5),
    )
    merged = merge(ScenarioTree.initial(), other)
    assert merged.by_id["fog"] == other.by_id["fog"]
    (given,) = (edit for edit in merged.edits if edit.reason == "its label in the other tree")
    assert given == TreeEdit(
        op="broaden",
        node="fog",
        label="Fog, smoke",
        stage="merge",
        reason="its label in the other tree",
        origin="merge-1",
        origin_node="fog",
    )


def test_an_undoing_gives_back_that_the_paper_names_it():
    other = weather_tree(("fog", "weather", "Fog")).apply(
        TreeEdit(op="broaden", node="fog", label="Fog or smoke", attested="paper"),
        TreeEdit(op="narrow", node="fog", label="Fog at night"),
        TreeEdit(op="broaden", node="fog", label="Fog, smoke", attested="paper", undoes=5),
    )
    merged = merge(ScenarioTree.initial(), other)
    assert merged.by_id["fog"] == other.by_id["fog"]
    assert merged.by_id["fog"].attested == "paper"


def test_a_former_leaf_is_kept_below_the_family_that_it_became():
    one, other = weather_tree(SNOW), weather_tree(SNOW, BLIZZARD)
    (kept,) = (
        edit for edit in merge(one, other).edits if edit.op == "add" and edit.stage == "merge"
    )
    assert kept == TreeEdit(
        op="add",
        node="snow-2",
        parent="snow",
        label="Snow",
        stage="merge",
        reason="a kind of its own, which is a family in the other tree",
        origin="merge-1",
    )


@pytest.mark.parametrize("siblings", [(), (BLIZZARD,), (BLIZZARD, ("hail", "snow", "Hail"))])
def test_a_leaf_that_was_kept_remains_a_path_when_it_becomes_a_family_too(siblings):
    other = weather_tree(SNOW, *siblings, ("snow-x", "snow", "Snow"), ("drift", "snow-x", "Drift"))
    merged = merge(weather_tree(SNOW), other)
    assert sorted(path[3:] for path in merged.paths.values()) == [
        *(("Snow", label) for _, _, label in siblings),
        ("Snow", "Snow", "Drift"),
        ("Snow", "Snow", "Snow"),
    ]


def test_a_leaf_that_became_a_family_in_between_is_told_once():
    leaf, family = weather_tree(SNOW), weather_tree(SNOW, BLIZZARD)
    merged = merge(merge(leaf, leaf.apply(TreeEdit(op="keep", node="snow", round=1))), family)
    again = leaf.apply(TreeEdit(op="keep", node="snow", round=1))
    assert merged.path("snow-2")[3:] == ("Snow", "Snow")
    assert merge(merged, again) == merged


def test_a_class_does_not_swallow_the_leaf_that_it_was():
    """Both have the class `fog`; the second moved it, and has another class of that label."""
    one = ScenarioTree.initial().apply(TreeEdit(op="add", node="fog", parent=ROOT, label="Fog"))
    other = one.apply(
        TreeEdit(op="move", node="fog", parent="environmental"),
        TreeEdit(op="add", node="fog-2", parent=ROOT, label="FOG"),
        TreeEdit(op="add", node="dense", parent="fog-2", label="Dense fog"),
    )
    merged = merge(one, other)
    assert [path[1:] for path in merged.paths.values()] == [("Fog", "Fog"), ("Fog", "Dense fog")]
    assert merge(merged, other).nodes == merged.nodes


def test_merged_trees_are_numbered_and_their_own_names_kept():
    tree = ScenarioTree.initial()
    for number, label in enumerate(("Mud", "Hail", "Sand"), 1):
        tree = merge(tree, weather_tree((label.lower(), "weather", label)))
        assert {edit.origin for edit in tree.edits} == {
            "", *(f"merge-{earlier}" for earlier in range(1, number + 1))
        }  # fmt: skip
    outer = merge(ScenarioTree.initial(), tree)
    assert {edit.origin for edit in outer.edits} == {
        "", "merge-1", *(f"merge-1/merge-{number}" for number in (1, 2, 3))
    }  # fmt: skip
    assert {edit.origin for edit in merge(outer, weather_tree(SNOW)).edits} >= {"merge-2"}


@few
@given(
    trees, st.sampled_from([{"round": 1}, {"source": "seen"}, {"model": "new"}, {"prompt": "p"}])
)
def test_a_further_decision_about_a_node_is_told_once(tree, why):
    assume("environmental" in tree.by_id)
    merged = merge(ScenarioTree.initial(), tree)
    more = tree.apply(TreeEdit(op="keep", node="environmental", **{"source": "other", **why}))
    again = merge(merged, more, name="again")
    assert [edit.origin for edit in again.edits[len(merged.edits) :]] == ["again"]
    assert merge(again, more, name="third") == again


def plain(*nodes):
    """Return a tree grown from parents and labels; ids are numbered."""
    tree = ScenarioTree.initial()
    for parent, label in nodes:
        edit = TreeEdit(op="add", node=tree.new_id(label), parent=parent, label=label)
        tree = tree.apply(edit)
    return tree


def kinds(tree):
    """Return the class and the label of every path."""
    return Counter((path[1], same_words(path[-1])) for path in tree.paths.values())


@pytest.mark.parametrize(
    ("one", "other", "paths"),
    [
        (
            plain(("environmental", "Snow"), ("interactional", "Snow")),
            plain(("interactional", "Snow"), ("interactional", "Ice"), ("ice", "Snow")),
            [
                ("Environmental", "Snow"),
                ("Interactional", "Snow"),
                ("Interactional", "Ice", "Snow"),
            ],
        ),
        (
            plain(("interactional", "Snow")),
            plain(("interactional", "Snow"), ("interactional", "Snow"), ("snow-2", "Snow")),
            [("Interactional", "Snow", "Snow")],
        ),
        (
            plain(("interactional", "Snow")),
            plain(("interactional", "Weather"), ("weather", "Snow")),
            [("Interactional", "Snow")],
        ),
    ],
    ids=["numbered ids", "siblings of one label", "a family that brings no leaf"],
)
def test_merged_paths(one, other, paths):
    merged = merge(one, other)
    assert sorted(path[1:] for path in merged.paths.values()) == sorted(paths)
    assert merge(merged, other) == merged
    assert merge(merged, one) == merged


def test_a_family_that_was_left_out_is_added_when_it_brings_a_leaf():
    other = plain(("interactional", "Weather"), ("weather", "Snow"))
    merged = merge(plain(("interactional", "Snow")), other)
    edit = TreeEdit(op="add", node="hail", parent="weather", label="Hail")
    more = other.apply(edit)
    again = merge(merged, more)
    assert [path[2:] for path in again.paths.values()] == [("Snow",), ("Weather", "Hail")]
    assert merge(again, more) == again


def test_a_node_that_one_tree_has_narrowed_is_not_the_others():
    one = plain(("environmental", "Snow"))
    other = one.apply(TreeEdit(op="narrow", node="snow", label="Snow on a bridge"))
    assert [leaf.label for leaf in merge(one, other).leaves] == ["Snow"]
    alone = ScenarioTree.initial().apply(
        TreeEdit(op="add", node="snow", parent="environmental", label="Snow", round=1),
        TreeEdit(op="narrow", node="snow", label="Snow on a bridge", round=2),
    )
    again = alone.apply(TreeEdit(op="broaden", node="snow", label="Snow", round=3))
    for first, second in ((one, alone), (alone, one)):
        merged = merge(first, second)
        assert {leaf.label for leaf in merged.leaves} == {"Snow", "Snow on a bridge"}
        assert merge(merged, second) == merged
    assert merge(one, again).nodes == one.nodes


@given(steps, steps, st.sampled_from([None, ENCODER]))
def test_the_label_of_every_leaf_of_the_second_tree_is_in_the_merge_or_its_log(one, other, encoder):
    one, other = numbered(one), numbered(other)
    merged = merge(one, other, encoder=encoder, threshold=0.3)
    words = {same_words(node.label) for node in merged.nodes}
    told = words | {same_words(edit.label or "") for edit in merged.edits}
    assert {same_words(leaf.label) for leaf in other.leaves} <= told


grown_alone = st.lists(st.tuples(st.integers(0, 30), st.sampled_from(WORDS)), max_size=12)


@given(grown_alone, grown_alone)
def test_no_kind_is_lost_and_none_comes_from_nowhere(one, other):
    trees = []
    for adds in (one, other):
        tree = ScenarioTree.initial()
        for index, label in adds:
            parent = tree.nodes[1:][index % (len(tree) - 1)].id
            siblings = {same_words(tree.by_id[name].label) for name in tree.children[parent]}
            if same_words(label) not in siblings:
                edit = TreeEdit(op="add", node=tree.new_id(label), parent=parent, label=label)
                tree = tree.apply(edit)
        trees.append(tree)
    found = kinds(merge(*trees))
    own, others = map(kinds, trees)
    assert own | others <= found
    assert set(found) == set(own | others)


@given(steps, steps, steps, steps, st.sampled_from([None, ENCODER]))
def test_a_merge_is_told_once_whatever_was_merged_before(base, one, other, third, encoder):
    base = numbered(base)
    one, other, third = (numbered(own, base) for own in (one, other, third))
    merged = merge(merge(one, third, encoder=encoder), other, encoder=encoder, threshold=0.3)
    assert merge(merged, other, encoder=encoder, threshold=0.3) == merged
    assert merge(merged, one).nodes == merged.nodes


@given(steps, steps, steps)
def test_what_a_merged_tree_has_become_is_told_once(one, other, more):
    one, other = numbered(one), numbered(other)
    merged = merge(one, other)
    more = numbered(more[:3], other)
    again = merge(merged, more)
    assert merge(again, more) == again


def test_a_merge_that_would_grow_too_deep_is_refused():
    deep = ScenarioTree.initial()
    parent = "environmental"
    for number in range(MAX_DEPTH - 1):
        label = "Snow" if number == MAX_DEPTH - 2 else f"Level {number}"
        edit = TreeEdit(op="add", node=f"n{number}", parent=parent, label=label)
        deep, parent = deep.apply(edit), f"n{number}"
    assert deep.depth == MAX_DEPTH
    other = deep.apply(TreeEdit(op="move", node=parent, parent="environmental"))
    other = other.apply(TreeEdit(op="add", node="drift", parent=parent, label="Drift"))
    with pytest.raises(DataError, match="50 levels"):
        merge(deep, other)
