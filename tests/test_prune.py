"""Pruning: a decision with a reason for every node; parents live exactly when a child does."""

from hypothesis import given
from hypothesis import strategies as st

from oodscen import Pruner, ScenarioTree
from oodscen.errors import LLMError
from oodscen.prune import PruneDecision, all_decisions, pruned
from oodscen.testing import FlatSimulator, FunctionLLM
from oodscen.tree import TreeEdit


def grown(parents):
    """Hang nodes below the two classes: each below the class or an earlier node."""
    tree = ScenarioTree.planted()
    ids = ["environmental", "interactional"]
    for number, choice in enumerate(parents):
        parent = ids[choice % len(ids)]
        ids.append(f"n{number}")
        tree = tree.apply(TreeEdit(op="add", node=ids[-1], parent=parent, label=f"Label {number}"))
    return tree


@given(st.lists(st.integers(0, 50), min_size=1, max_size=30), st.randoms(use_true_random=False))
def test_parents_survive_exactly_when_a_child_does(parents, random):
    tree = grown(parents)
    keep = {leaf.id: random.random() < 0.5 for leaf in tree.leaves}
    judged = [
        PruneDecision(id=name, path=tree.path(name), keep=value) for name, value in keep.items()
    ]
    result = pruned(tree, judged)
    expected = {"root"}
    for name, value in keep.items():
        cursor = name if value else None
        while cursor is not None:
            expected.add(cursor)
            cursor = tree.by_id[cursor].parent
    assert set(result.by_id) == expected
    assert {leaf.id for leaf in result.leaves} == {name for name, value in keep.items() if value}
    assert [item.id for item in all_decisions(tree, judged)] == [n.id for n, _ in tree.walk()]
    assert ScenarioTree.parse(result.to_json()) == result


def test_a_model_that_fails_on_one_leaf_costs_only_that_leaf():
    tree = grown([0, 0, 1])

    def judge(request):
        if request.prompt.path[-1] == "Label 1":
            raise LLMError("no answer")
        return {"reasoning": "it has one", "simulatable": True, "assets": ["deer"]}

    pruner = Pruner(FunctionLLM(judge), FlatSimulator().catalogue())
    decisions = {item.id: item for item in pruner.decisions(tree)}
    assert decisions["n1"].status == "failed"
    assert decisions["n0"].assets == ("deer",)
    assert {leaf.id for leaf in pruner.run(tree).leaves} == {"n0", "n2"}


def test_an_asset_that_does_not_exist_is_sent_back_with_close_matches():
    answers = iter(
        [
            {"reasoning": "", "simulatable": True, "assets": ["cardbord_box"]},
            {"reasoning": "", "simulatable": True, "assets": ["cardboard_box"]},
        ]
    )
    asked = []

    def judge(request):
        asked.append(request)
        return next(answers)

    pruner = Pruner(FunctionLLM(judge), FlatSimulator().catalogue())
    (decision,) = pruner.decisions(grown([0]))
    assert decision.assets == ("cardboard_box",)
    assert "did you mean cardboard_box" in asked[1].messages[-1].text
