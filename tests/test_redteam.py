"""Red teaming: every round is logged, a bad one changes nothing, and any round can be resumed."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen import RedTeamer, ScenarioTree
from oodscen.errors import LLMError
from oodscen.testing import FunctionLLM
from oodscen.tree import TreeEdit

TREE = ScenarioTree.planted().apply(
    TreeEdit(op="add", node="weather", parent="environmental", label="Weather"),
    TreeEdit(op="add", node="fog", parent="weather", label="Thick fog at night"),
)


def model(placing, text="A piano lies on the road ahead of the ego vehicle."):
    def answer(request):
        if request.prompt.purpose == "imagine-scenario":
            return {"reasoning": "", "text": f"{text} ({request.sample})"}
        return placing(request) if callable(placing) else placing

    return FunctionLLM(answer)


def play(placing, **options):
    teamer = RedTeamer(model(placing), **{"iterations": 1, **options})
    return list(teamer.rounds(TREE)), teamer.run(TREE)


def test_a_covered_text_is_recorded_and_adds_nothing():
    rounds, tree = play({"reasoning": "it is fog", "decision": "covered", "node": "fog"})
    assert tree.nodes == TREE.nodes
    assert tree.edits[-1].op == "keep"
    assert tree.edits[-1].round == 1
    assert rounds[0].reason == "it is fog"


def test_broadening_keeps_the_id_and_changes_the_label():
    _, tree = play({"reasoning": "", "decision": "broaden", "node": "fog", "label": "Fog or smoke"})
    assert tree.by_id["fog"].label == "Fog or smoke"
    assert len(tree) == len(TREE)


def test_adding_may_bring_a_family_and_its_leaf_at_once():
    rounds, tree = play(
        {
            "reasoning": "",
            "decision": "add",
            "node": "environmental",
            "label": "Piano on the road",
            "category": "Lost cargo",
        }
    )
    assert tree.path("piano-on-the-road")[1:] == (
        "Environmental",
        "Lost cargo",
        "Piano on the road",
    )
    assert rounds[0].nodes == len(TREE) + 2
    assert all(edit.source.startswith("A piano") for edit in rounds[0].edits)


@pytest.mark.parametrize(
    "placing",
    [
        {"reasoning": "", "decision": "covered", "node": "nowhere"},
        {"reasoning": "", "decision": "covered", "node": "weather"},
        {"reasoning": "", "decision": "add", "node": "weather", "label": ""},
        {"reasoning": "", "decision": "add", "node": "weather", "label": "x" * 10_000},
        {"reasoning": "", "decision": "add", "node": "environmental", "label": "No family"},
        {"reasoning": "", "decision": "broaden", "node": "interactional", "label": "Everything"},
        "no JSON at all",
    ],
)
def test_an_impossible_decision_fails_its_round_and_leaves_the_tree(placing):
    rounds, tree = play(placing)
    assert rounds[0].status == "failed"
    assert rounds[0].error
    assert tree == TREE


def test_a_failing_round_does_not_stop_the_others():
    def placing(request):
        if request.sample == 2:
            raise LLMError("the line is dead")
        return {"reasoning": "", "decision": "covered", "node": "fog"}

    rounds, _ = play(placing, iterations=3)
    assert [item.status for item in rounds] == ["ok", "failed", "ok"]


def test_the_closed_loop_shows_what_is_covered_and_the_open_loop_does_not():
    seen = []

    def placing(request):
        return {"reasoning": "", "decision": "covered", "node": "fog"}

    def answer(request):
        if request.prompt.purpose == "imagine-scenario":
            seen.append(request.prompt.covered)
            return {"text": "A piano lies on the road ahead of the ego."}
        return placing(request)

    for closed in (True, False):
        list(RedTeamer(FunctionLLM(answer), iterations=1, closed_loop=closed).rounds(TREE))
    assert seen == [("Thick fog at night",), ()]


@given(st.integers(0, 6))
def test_continuing_after_any_round_gives_the_same_rounds(cut):
    def placing(request):
        number = request.sample
        if number % 3 == 0:
            return {"reasoning": "", "decision": "covered", "node": "fog"}
        return {
            "reasoning": "",
            "decision": "add",
            "node": "weather",
            "label": f"Strange weather number {number}",
        }

    whole = list(RedTeamer(model(placing), iterations=6).rounds(TREE))
    rest = list(RedTeamer(model(placing), iterations=6).rounds(TREE, whole[:cut]))
    assert whole[:cut] + rest == whole
