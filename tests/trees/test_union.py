"""Laws of the merge of two trees."""

from hypothesis import given

from oodscen.testing import HashEncoder
from oodscen.tree import ScenarioTree, TreeEdit
from oodscen.trees import diff, match, merge
from tests.trees.woods import broad, chain, few, trees

ENCODER = HashEncoder()


@few
@given(trees, trees)
def test_a_merge_is_a_valid_tree_that_begins_with_the_first_log(one, other):
    merged = merge(one, other, encoder=ENCODER)
    assert ScenarioTree.parse(merged.to_json()) == merged
    assert merged.edits[: len(one.edits)] == one.edits
    assert merged.nodes[: len(one)] == one.nodes
    assert merged == merge(one, other, encoder=ENCODER)


@few
@given(trees, trees)
def test_everything_of_the_second_tree_is_in_the_merge(one, other):
    merged = merge(one, other)
    paired = {pair.after: pair.before for pair in match(one, other)}
    added = [node for node in other.nodes if node.id not in paired]
    came = merged.nodes[len(one) :]
    assert [(node.label, node.attested) for node in came] == [
        (node.label, node.attested) for node in added
    ]
    place = paired | {node.id: new.id for node, new in zip(added, came, strict=True)}
    for node, new in zip(added, came, strict=True):
        assert new.parent == place.get(node.parent)


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
        return ScenarioTree.planted().apply(*edits)

    one, other = grow("one", "Fog at night", "Hail"), grow("other", "Snow", "At night fog")
    other = other.apply(TreeEdit(op="broaden", node="leaf-0", label="Snow or ice", model="other"))
    merged = merge(one, other, encoder=ENCODER)
    assert [leaf.label for leaf in merged.leaves] == ["Fog at night", "Hail", "Snow or ice"]
    snow = merged.provenance("snow")
    assert (snow.stage, snow.round, snow.model) == ("redteam", 0, "other")
    assert (snow.prompt, snow.reason, snow.source) == (
        "place-scenario@other",
        "other says so",
        "Snow ahead.",
    )
    assert [one.edit.stage for one in snow.later] == ["", "merge"]
    fog = merged.provenance("leaf-0").later[-1].edit
    assert (fog.op, fog.stage, fog.model, fog.source) == (
        "keep",
        "merge",
        "other",
        "At night fog ahead.",
    )
    assert "At night fog" in fog.reason
    assert not diff(merged, other, encoder=ENCODER).added
    assert len(merged.at(round=1)) == len(one)


def test_size_and_depth_are_no_obstacle():
    merged = merge(broad(10_000), chain(10_000))
    assert len(merged) == 19_999
