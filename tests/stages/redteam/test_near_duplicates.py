"""What is too near is found, whatever the order in which one resumes."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from oodscen import ScenarioTree
from oodscen.encoders._centring import unit_rows
from oodscen.stages._redteam.near_duplicates import NoveltyFilter
from oodscen.stages._redteam.rounds import Round
from oodscen.testing._encoder import HashEncoder
from oodscen.tree._scenario_tree import TreeEdit

TREE = ScenarioTree.initial().apply(
    TreeEdit(op="add", node="weather", parent="environmental", label="Weather"),
    TreeEdit(op="add", node="fog", parent="weather", label="Thick fog at night"),
    TreeEdit(op="add", node="hail", parent="weather", label="Hail stones on the bonnet"),
)


def covered(number, text, kind="fog"):
    return Round(round=number, text=text, decision="covered", kind=kind)


def test_without_an_encoder_only_repetitions_are_found():
    novelty = NoveltyFilter(TREE)
    assert novelty.closest("Fog.") == (None, None, None, "", False)
    novelty.learn(covered(1, "Thick fog, at night!"), TREE)
    found = novelty.closest("thick fog at night")
    assert (found.similarity, found.node, found.is_too_near) == (1.0, "fog", True)


def test_a_leafs_own_label_is_nearest_to_it():
    found = NoveltyFilter(TREE, HashEncoder()).closest("Hail stones on the bonnet")
    assert (found.node, found.by, found.is_too_near) == ("hail", "label", True)


def test_labels_follow_the_tree():
    novelty = NoveltyFilter(TREE, HashEncoder(), label=0.9)
    edits = (
        TreeEdit(op="broaden", node="fog", label="Bad sight"),
        TreeEdit(op="add", node="sand", parent="weather", label="Sand on the wind"),
    )
    after = TREE.apply(*edits)
    novelty.learn(Round(round=1, edits=edits, decision="add", kind="sand"), after)
    assert not novelty.closest("Thick fog at night").is_too_near
    assert novelty.closest("Bad sight").node == "fog"
    assert novelty.closest("Sand on the wind").node == "sand"
    emptied = after.apply(TreeEdit(op="remove", node="sand"))
    gone = Round(round=2, edits=(TreeEdit(op="remove", node="sand"),))
    novelty.learn(gone, emptied)
    assert novelty.closest("Sand on the wind").node != "sand"


def test_of_a_split_leaf_the_old_meaning_keeps_the_proposals():
    novelty = NoveltyFilter(TREE, HashEncoder())
    text = "A wall of mist stands on the bridge."
    novelty.learn(covered(1, text), TREE)
    edits = (
        TreeEdit(op="broaden", node="fog", label="Hidden road"),
        TreeEdit(op="add", node="old", parent="fog", label="Thick fog at night"),
        TreeEdit(op="add", node="new", parent="fog", label="Smoke"),
    )
    after = TREE.apply(*edits)
    novelty.learn(Round(round=2, edits=edits, decision="split", kind="new"), after)
    assert novelty.closest(text).node == "old"
    assert novelty.closest("Thick fog at night").node == "old"
    near = novelty.closest("A wall of mist stands on the long bridge.")
    assert (near.node, near.by) == ("old", "text")


def test_what_is_as_near_as_the_limit_is_too_near():
    text = "Hail stones everywhere"
    found = NoveltyFilter(TREE, HashEncoder(), label=2.0).closest(text)
    assert not found.is_too_near
    assert NoveltyFilter(TREE, HashEncoder(), label=found.similarity).closest(text).is_too_near


def test_proposals_are_compared_after_centring_on_all_of_them():
    shown, told, text = (
        ("A car waits.", "A bus turns."),
        ("Fog falls.", "A dog barks."),
        "A dog naps.",
    )
    encoder = HashEncoder()
    novelty = NoveltyFilter(TREE, encoder, label=2.0, text=-2.0, shown=shown)
    for number, one in enumerate(told, start=1):
        novelty.learn(covered(number, one), TREE)
    rows = unit_rows(encoder, [*shown, *told, text])
    rows = rows - rows[:-1].mean(axis=0)
    cosines = rows[2:-1] @ rows[-1] / np.linalg.norm(rows[2:-1], axis=1) / np.linalg.norm(rows[-1])
    found = novelty.closest(text)
    assert found.by == "text"
    assert found.similarity == round(float(cosines.max()), 4)


def test_leaves_are_ranked_by_meaning_or_by_words():
    for encoder in (None, HashEncoder()):
        ranked = NoveltyFilter(TREE, encoder).rank_leaves("Hail stones fall on the bonnet.", TREE)
        assert ranked == ["hail", "fog"]


@given(st.lists(st.sampled_from(["Fog.", "A dog barks.", "Hail falls.", "Ice", ""]), max_size=6))
def test_the_figures_are_a_function_of_the_log(texts):
    log = [covered(number, text) for number, text in enumerate(texts, start=1)]
    one, two = (NoveltyFilter(TREE, HashEncoder(32)) for _ in range(2))
    for item in log:
        one.learn(item, TREE)
        one.closest("Something else altogether.")
    for item in log:
        two.learn(item, TREE)
    for text in ("A dog.", "Thick fog at night", ""):
        found = one.closest(text)
        assert found == two.closest(text)
        assert found.similarity is not None
        assert -1.0 <= found.similarity <= 1.0
        assert found.similarity == round(found.similarity, 4)


class Blank:
    """Knows no text."""

    name = "blank"
    dimension = 4

    def encode(self, texts):
        return np.zeros((len(texts), 4), np.float32)


def test_texts_without_a_vector_are_near_to_nothing():
    novelty = NoveltyFilter(TREE, Blank())
    novelty.learn(covered(1, "Fog."), TREE)
    assert novelty.closest("Dog.").similarity == 0.0
    assert not novelty.closest("Dog.").is_too_near
