"""Laws of the difference between two trees."""

import math
from typing import ClassVar

import numpy as np
import pytest
from hypothesis import given

from oodscen.errors import UsageError
from oodscen.testing._encoder import HashEncoder
from oodscen.tree._comparison import TreeDiff, diff
from oodscen.tree._edit_log import MAX_DEPTH
from oodscen.tree._matching import match
from oodscen.tree._scenario_tree import ROOT, ScenarioTree, TreeEdit
from tests.tree.woods import broad, chain, changes, few, grown, trees

ENCODER = HashEncoder()
BEFORE = ScenarioTree.initial().apply(
    TreeEdit(op="add", node="weather", parent="environmental", label="Weather"),
    TreeEdit(op="add", node="fog", parent="weather", label="Fog"),
    TreeEdit(op="add", node="hail", parent="weather", label="Hail"),
    TreeEdit(op="add", node="animals", parent="interactional", label="Animals"),
    TreeEdit(op="add", node="deer", parent="animals", label="A deer on the road"),
)


def planted_apart(*nodes):
    """Return a tree of other ids."""
    edits = [TreeEdit(op="add", node="top", label="Rare scenes")]
    edits += [
        TreeEdit(op="add", node=name, parent=parent, label=label) for name, parent, label in nodes
    ]
    return ScenarioTree().apply(*edits)


@few
@given(trees)
def test_a_tree_does_not_differ_from_itself(tree):
    found = diff(tree, tree)
    assert found.is_empty
    assert found.unchanged == len(tree)


@few
@given(trees, trees)
def test_every_node_is_paired_or_alone(one, other):
    for encoder in (None, ENCODER):
        found = diff(one, other, encoder=encoder)
        pairs = {pair.before: pair.after for pair in found.matches}
        assert len(set(pairs.values())) == len(pairs)
        assert [node.id for node in one.nodes if node.id not in pairs] == [
            item.id for item in found.removed
        ]
        assert len(pairs) + len(found.added) == len(other)
        assert TreeDiff.parse(found.to_json()) == found
        shown = (*found.added, *found.removed, *found.broadened, *found.moved)
        assert len(str(found).splitlines()) == 1 + len(shown)


def top(tree, node_id):
    """Return the id of the node right below the root that a node lies below."""
    above = [node_id]
    while above[-1] is not None:
        above.append(tree.by_id[above[-1]].parent)
    return above[-3] if len(above) > 2 else ""


@few
@given(trees, trees)
def test_words_and_meaning_pair_nothing_across_the_classes(one, other):
    classes = {"environmental", "interactional"}
    for pair in match(one, other, encoder=ENCODER, threshold=-1.0):
        tops = {top(one, pair.before), top(other, pair.after)}
        assert pair.by == "id" or len(tops & classes) < 2


@few
@given(trees, trees)
def test_pairs_are_the_same_from_either_side(one, other):
    there = {pair.before: pair.after for pair in match(one, other) if pair.by == "id"}
    back = {pair.after: pair.before for pair in match(other, one) if pair.by == "id"}
    assert there == back


@few
@given(changes)
def test_what_edits_did_is_what_the_diff_says(steps):
    after = grown(steps, BEFORE)
    found = diff(BEFORE, after)
    kept = [node for node in after.nodes if node.id in BEFORE.by_id]
    paired = {pair.before for pair in found.matches if pair.by == "id"}
    assert {node.id for node in kept} - {"deer"} <= paired | {ROOT}
    for item in found.broadened:
        assert item.label_before != item.label_after
    for item in found.moved:
        assert BEFORE.by_id[item.before].parent == item.parent_before
        assert after.by_id[item.after].parent == item.parent_after


def test_each_kind_of_change_is_told():
    after = BEFORE.apply(
        TreeEdit(op="add", node="snow", parent="weather", label="Snow"),
        TreeEdit(op="broaden", node="fog", label="Fog or smoke"),
        TreeEdit(op="move", node="deer", parent="interactional"),
        TreeEdit(op="remove", node="hail"),
    )
    found = diff(BEFORE, after)
    assert [item.id for item in found.added] == ["snow"]
    assert [item.id for item in found.removed] == ["hail"]
    assert [(b.label_before, b.label_after) for b in found.broadened] == [("Fog", "Fog or smoke")]
    assert [(m.parent_before, m.parent_after) for m in found.moved] == [
        ("animals", "interactional")
    ]
    assert found.unchanged == len(BEFORE) - 3
    chart = found.to_mermaid()
    for style in ("added", "removed", "broadened", "moved"):
        assert sum(line.endswith(f" {style}") for line in chart.splitlines()) == 1


def test_nodes_of_trees_grown_apart_are_paired_by_label_then_by_meaning():
    other = planted_apart(
        ("fog", "top", "Environmental"),
        ("weather-2", "fog", "WEATHER"),
        ("a", "weather-2", "fog "),
        ("b", "fog", "Hail"),
        ("c", "top", "Interactional"),
        ("d", "c", "Animals loose"),
        ("e", "d", "On the road a deer"),
    )
    by_label = {pair.before: pair.after for pair in match(BEFORE, other)}
    assert by_label == {
        ROOT: "top",
        "environmental": "fog",
        "weather": "weather-2",
        "fog": "a",
        "hail": "b",
        "interactional": "c",
    }
    by_meaning = {
        pair.before: (pair.after, pair.similarity)
        for pair in match(BEFORE, other, encoder=ENCODER)
        if pair.by == "meaning"
    }
    assert by_meaning == {"animals": ("d", 0.8206), "deer": ("e", 1.0)}
    assert [item.before for item in diff(BEFORE, other, encoder=ENCODER).moved] == ["hail"]
    assert not [p for p in match(BEFORE, other, encoder=ENCODER, threshold=1.0) if p.after == "d"]


def test_the_same_label_twice_is_paired_below_its_own_parent():
    edit = TreeEdit(op="add", node="fog-2", parent="animals", label="Fog")
    one = BEFORE.apply(edit)
    other = planted_apart(
        ("a", "top", "Interactional"),
        ("b", "a", "Animals"),
        ("c", "b", "Fog"),
        ("d", "top", "Environmental"),
        ("e", "d", "Weather"),
        ("f", "e", "Fog"),
    )
    pairs = {pair.before: pair.after for pair in match(one, other)}
    assert (pairs["fog"], pairs["fog-2"]) == ("f", "c")


def test_a_number_that_two_models_gave_to_different_things_pairs_nothing():
    one = planted_apart(("fog-2", "top", "Dense fog"))
    other = planted_apart(("fog-2", "top", "Freezing fog"))
    assert [pair.before for pair in match(one, other)] == ["top"]
    bare = ScenarioTree.parse({"nodes": [node.model_dump() for node in other.nodes]})
    assert [pair.by for pair in match(one, bare)] == ["id", "id"]


@pytest.mark.parametrize("threshold", [2.0, -1.1, math.nan, math.inf, True, False])
def test_a_threshold_is_a_cosine(threshold):
    with pytest.raises(UsageError, match="threshold"):
        diff(BEFORE, BEFORE, threshold=threshold)


def test_size_is_no_obstacle():
    deep, wide = chain(MAX_DEPTH + 1), broad(10_000)
    found = diff(deep, wide)
    assert len(found.added) == 9_999
    assert len(found.removed) == MAX_DEPTH
    assert max(len(item.path) for item in found.removed) < 20
    assert len(found.to_mermaid().splitlines()) > 15_000
    assert diff(deep, deep).is_empty


class Drawn:
    """An encoder of a few labels that are drawn in a plane; all others are nothing."""

    name, dimension = "drawn", 2
    angles: ClassVar[dict[str, float]] = {"Fog": 0.0, "Thick fog": 0.2, "Smoke": 0.5}

    def encode(self, texts):
        rows = [
            (math.cos(self.angles[text]), math.sin(self.angles[text]))
            if text in self.angles
            else (0.0, 0.0)
            for text in texts
        ]
        return np.array(rows, np.float32).reshape(-1, 2)


def test_only_nearest_neighbours_of_each_other_pair_by_meaning():
    one = planted_apart(("a", "top", "Smoke"), ("b", "top", "Thick fog"))
    other = planted_apart(("c", "top", "Fog"))
    found = {pair.before: pair.after for pair in match(one, other, encoder=Drawn(), threshold=0.5)}
    assert found == {"top": "top", "b": "c"}
