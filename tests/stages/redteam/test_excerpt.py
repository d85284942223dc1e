"""Of a large tree the part that matters is shown, and it is a tree."""

from hypothesis import example, given
from hypothesis import strategies as st

from oodscen import ScenarioTree
from oodscen.prompts._tree.place_scenario import PlaceScenario
from oodscen.stages._redteam.excerpt import excerpt, list_leaves
from oodscen.tree._scenario_tree import TreeEdit
from tests.stages.redteam.grown import grown, shapes


@given(shapes, st.integers(40, 400), st.randoms(use_true_random=False))
def test_an_excerpt_is_a_tree_that_fits_and_counts_what_it_leaves_out(shape, tokens, random):
    tree = grown(shape)
    ranked = [leaf.id for leaf in tree.leaves]
    random.shuffle(ranked)
    part = excerpt(tree, lambda: ranked, tokens=tokens)
    shown = {node.id for node in part.nodes}
    assert ScenarioTree.parse({"nodes": part.nodes})
    assert {"root", "environmental", "interactional"} <= shown
    left_out = [leaf.id for leaf in tree.leaves if leaf.id not in shown]
    assert sum(item.leaves for item in part.hidden) == len(left_out)
    assert {item.id for item in part.hidden} <= shown
    outline = PlaceScenario(text="x", nodes=part.nodes, hidden=part.hidden).variables()["outline"]
    assert len(outline) <= 4 * tokens or len(shown) == 3
    leaves = {leaf.id for leaf in tree.leaves} & shown
    upper = {"root", "environmental", "interactional"} | {tree.by_id[one].parent for one in leaves}
    branches = tuple(node for node in part.nodes if node.id in leaves | upper)
    if left_out and leaves:
        outline = PlaceScenario(text="x", nodes=branches).variables()["outline"]
        assert len(outline) <= 0.75 * 4 * tokens
    if left_out:
        first = [name for name in ranked if name in shown]
        assert first == ranked[: len(first)]


def test_a_small_tree_is_shown_whole_and_nothing_is_ranked():
    tree = grown([3, 2])
    part = excerpt(tree, lambda: 1 / 0, tokens=4000)
    assert part.nodes == tree.nodes
    assert part.hidden == ()


def test_nothing_that_is_hidden_counts_as_a_leaf():
    tree = grown([6] * 10)
    part = excerpt(tree, lambda: [leaf.id for leaf in tree.leaves], tokens=150)
    assert part.hidden
    prompt = PlaceScenario(text="x", nodes=part.nodes, hidden=part.hidden)
    for item in part.hidden:
        answer = prompt.answer(reasoning="", decision="covered", node=item.id)
        assert prompt.check(answer)


@given(st.lists(st.integers(3, 60), min_size=1, max_size=40), st.integers(16, 60))
@example([3] + [58] * 34, 60)
def test_every_leaf_is_listed_in_some_turn_however_long_the_labels_are(lengths, tokens):
    names = [f"{number:03}".ljust(length, "x") for number, length in enumerate(lengths)]
    edits = [TreeEdit(op="add", node=name, parent="environmental", label=name) for name in names]
    tree = ScenarioTree.initial().apply(*edits)
    labels = {leaf.label for leaf in tree.leaves}
    seen = set()
    for turn in range(len(labels)):
        found, unlisted = list_leaves(tree, tokens=tokens, turn=turn)
        assert len(found) + unlisted == len(labels)
        assert sum(len(label) + 2 for label in found) <= 4 * tokens
        seen |= set(found)
    assert seen == labels
