"""Of a large tree the part that matters is shown, and it is a tree."""

from hypothesis import given
from hypothesis import strategies as st

from oodscen import ScenarioTree
from oodscen.prompts._tree.place_scenario import PlaceScenario
from oodscen.stages._redteam.excerpt import by_words, corner, excerpt, list_leaves, thin
from oodscen.tree._scenario_tree import TreeEdit


def grown(shape):
    """Return a tree with these numbers of leaves per family, the families in turn in each class."""
    edits = []
    for number, leaves in enumerate(shape):
        top = ("environmental", "interactional")[number % 2]
        edits.append(TreeEdit(op="add", node=f"f{number}", parent=top, label=f"Family {number}"))
        edits += [
            TreeEdit(
                op="add", node=f"f{number}-{n}", parent=f"f{number}", label=f"Leaf {number} {n}"
            )
            for n in range(leaves)
        ]
    return ScenarioTree.initial().apply(*edits)


shapes = st.lists(st.integers(1, 6), min_size=1, max_size=12)


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


@given(shapes, st.integers(5, 60))
def test_every_leaf_is_listed_in_some_turn(shape, tokens):
    tree = grown(shape)
    labels = {leaf.label for leaf in tree.leaves}
    seen = set()
    for turn in range(60):
        found, unlisted = list_leaves(tree, tokens=tokens, turn=turn)
        assert len(found) + unlisted == len(labels)
        assert sum(len(label) + 2 for label in found) <= 4 * tokens
        seen |= set(found)
    assert seen == labels


def test_the_thinnest_groups_are_named():
    tree = grown([5, 1, 4, 2, 4, 9])
    assert thin(tree)[:3] == ("Family 1", "Family 3", "Family 2")
    assert set(thin(tree)) == {"Family 1", "Family 2", "Family 3"}
    assert "Interactional" in thin(grown([5]))
    assert thin(ScenarioTree.initial()) == ()
    assert set(thin(grown([2, 4]))) == {"Family 0"}
    assert set(thin(grown([2, 3, 1, 4, 3]))) == {"Family 2", "Family 0", "Family 4"}


def test_words_rank_labels():
    labels = ["Fallen tree across the road", "Dog on the road", "Thick fog at night"]
    scores = by_words("The dogs run towards the ego vehicle.", labels)
    assert max(scores) == scores[1]
    assert by_words("", labels) == [0.0, 0.0, 0.0]


@given(shapes, st.integers(2, 8), st.integers(1, 30))
def test_proposals_in_flight_together_look_at_different_families(shape, flying, first):
    tree = grown(shape)
    found = [corner(tree, number, of=flying) for number in range(first, first + flying)]
    assert len(set(found)) == min(flying, len(shape))
    assert set(found) <= {f"Family {number}" for number in range(len(shape))}
    assert corner(tree, first, of=1) == ""


def test_rare_words_weigh_more_than_common_ones():
    labels = ["Icy bridge", "Road bridge", "Road works", "Closed road"]
    icy, _, works, closed = by_words("The road is icy.", labels)
    assert icy > 0.5 > works == closed > 0.0
