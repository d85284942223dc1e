"""Ids in a question follow the labels; those of the tree stay."""

from hypothesis import given
from hypothesis import strategies as st

from oodscen import ScenarioTree
from oodscen.prompts._tree.place_scenario import PlacedScenario, PlaceScenario
from oodscen.stages._redteam.naming import Names
from oodscen.tree._labels import slug
from oodscen.tree._scenario_tree import TreeEdit

TREE = ScenarioTree.initial().apply(
    TreeEdit(op="add", node="animals", parent="interactional", label="Animals"),
    *(
        TreeEdit(op="add", node=name, parent="animals", label=name)
        for name in ("dog", "cat", "cow")
    ),
)


@given(
    st.lists(
        st.sampled_from(["Beast", "Dog!", "Herd of beasts", "Cow, pig"]), max_size=3, unique=True
    )
)
def test_names_are_unique_follow_the_labels_and_lead_back(labels):
    nodes = ("dog", "cat", "cow")[: len(labels)]
    tree = TREE.apply(
        *(
            TreeEdit(op="broaden", node=n, label=label)
            for n, label in zip(nodes, labels, strict=True)
        )
    )
    names = Names.of(tree, nodes)
    question = names.in_question(PlaceScenario(text="A cow.", nodes=tree.nodes, full=nodes))
    shown = [node.id for node in question.nodes]
    assert len(set(shown)) == len(shown)
    assert set(question.full) <= set(shown)
    assert "outline" in question.variables()
    for before, node in zip(tree.nodes, question.nodes, strict=True):
        assert node.label == before.label
        if before.id in nodes:
            assert node.id in (before.id, slug(before.label))
        answer = PlacedScenario(
            reasoning="",
            decision="covered",
            node=node.id,
            members=[node.id],
            also=[{"node": node.id}],
        )
        back = names.in_tree(answer)
        assert (back.node, back.members, back.also[0].node) == (before.id, [before.id], before.id)


@given(
    st.lists(
        st.sampled_from(["pedestrian", "suddenly", "crosses", "x" * 70, "a", "Straße"]),
        max_size=4,
        unique=True,
    )
)
def test_an_id_that_is_cut_ends_with_a_word_and_makes_a_tree(words):
    label = " ".join(["Someone", *words])
    edit = TreeEdit(op="add", node=TREE.new_id(label), parent="animals", label=label)
    tree = TREE.apply(edit)
    names = Names.of(tree, ())
    question = names.in_question(PlaceScenario(text="A cow.", nodes=tree.nodes))
    assert len(ScenarioTree.parse({"nodes": question.nodes})) == len(tree)
    (shown,) = set(names.shown.values()) or {edit.node}
    if shown != edit.node:
        assert shown.startswith(edit.node)
        assert f"{slug(label, longest=200)}-".startswith(f"{shown}-")
