"""Red teaming: every round is logged, a bad one changes nothing, and any round can be resumed."""

import json
import threading

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen import RedTeamer, ScenarioTree
from oodscen.errors import LLMError
from oodscen.stages._redteam.rounds import RunnerUp
from oodscen.testing import ScriptedLLM
from oodscen.testing._encoder import HashEncoder
from oodscen.tree._scenario_tree import TreeEdit
from tests.tree.woods import ADDRESSED

TREE = ScenarioTree.initial().apply(
    TreeEdit(op="add", node="weather", parent="environmental", label="Weather"),
    TreeEdit(op="add", node="fog", parent="weather", label="Thick fog at night"),
)
PIANO = "A piano lies on the road ahead of the ego vehicle."
ADDED = {"reasoning": "", "decision": "add", "node": "weather", "label": "Hail"}
COVERED = {"reasoning": "it is fog", "decision": "covered", "node": "fog"}


def model(placing, imagining=PIANO + " ({})"):
    def answer(request):
        if request.prompt.purpose == "imagine-scenario":
            text = imagining(request) if callable(imagining) else imagining
            return {"reasoning": "", "text": text.format(request.sample)}
        return placing(request) if callable(placing) else placing

    return ScriptedLLM(answer)


def play(placing, *, tree=TREE, imagining=PIANO + " ({})", **options):
    teamer = RedTeamer(model(placing, imagining), **{"iterations": 1, **options})
    rounds = list(teamer.rounds(tree))
    after = tree.apply(*(edit for item in rounds for edit in item.edits))
    if any(item.status == "ok" for item in rounds):
        assert teamer.run(tree) == after
    else:
        with pytest.raises(LLMError, match="every round failed"):
            teamer.run(tree)
    return rounds, after


# ------------------------------------------------------------------ decisions


def test_a_covered_text_is_recorded_and_adds_nothing():
    rounds, tree = play(COVERED)
    assert tree.nodes == TREE.nodes
    assert tree.edits[-1].op == "keep"
    assert tree.edits[-1].round == 1
    assert rounds[0].reason == "it is fog"
    assert (rounds[0].kind, rounds[0].calls) == ("fog", 2)


def test_broadening_keeps_the_id_and_changes_the_label():
    _, tree = play({"reasoning": "", "decision": "broaden", "node": "fog", "label": "Poor sight"})
    assert tree.by_id["fog"].label == "Poor sight"
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
    assert rounds[0].kind == "piano-on-the-road"
    for edit in rounds[0].edits:
        assert edit.source.startswith("A piano")
        assert edit.model == "function"
        assert edit.prompt.startswith("place-scenario@")


def test_an_emptied_family_goes():
    rounds, tree = play(
        {
            "reasoning": "",
            "decision": "add",
            "node": "environmental",
            "label": "Dust storm",
            "category": "Poor visibility",
            "members": ["fog"],
        }
    )
    assert tree.path("fog")[1:] == ("Environmental", "Poor visibility", "Thick fog at night")
    assert "weather" not in tree.by_id
    assert [edit.op for edit in rounds[0].edits] == ["add", "add", "move", "remove"]


def test_a_leaf_that_was_broadened_often_enough_is_split():
    asked = []

    def placing(request):
        asked.append(request.prompt.full)
        node = request.prompt.nodes[-1].id
        if node in request.prompt.full:
            return {
                "reasoning": "",
                "decision": "split",
                "node": node,
                "label": "Smoke across the road",
                "category": "Hidden road",
            }
        label = f"Poor sight {request.sample}"
        return {"reasoning": "", "decision": "broaden", "node": node, "label": label}

    rounds, tree = play(placing, iterations=3, broadenings=2)
    assert asked[:3] == [(), (), ("poor-sight-2",)]
    assert [item.decision for item in rounds] == ["broaden", "broaden", "split"]
    assert tree.by_id["fog"].label == "Hidden road"
    below = [tree.by_id[name].label for name in tree.children["fog"]]
    assert below == ["Poor sight 2", "Smoke across the road"]
    assert tree.by_id[rounds[-1].kind].label == "Smoke across the road"


def test_a_paper_label_stays_attested_below_a_split():
    tree = TREE.apply(TreeEdit(op="broaden", node="fog", label="Thick fog at night, cars ahead"))
    node = "thick-fog-at-night-cars-ahead"
    answer = {"reasoning": "", "decision": "split", "node": node, "label": "Smoke"}
    _, tree = play({**answer, "category": "Hidden road"}, tree=tree, broadenings=0)
    leaf = tree.by_id[tree.children["fog"][0]]
    assert (leaf.label, leaf.attested) == ("Thick fog at night, cars ahead", "paper")


def test_runners_up_are_kept_and_what_is_no_other_leaf_is_dropped():
    tree = TREE.apply(
        TreeEdit(op="add", node="hail", parent="weather", label="Hail"),
        TreeEdit(op="add", node="snow", parent="weather", label="Snow"),
    )
    also = [{"node": name, "why": "wet"} for name in ("fog", "hail", "weather", "none", "hail")]
    rounds, _ = play({**COVERED, "also": also}, tree=tree)
    assert rounds[0].runners_up == (RunnerUp(node="hail", why="wet"),)


@pytest.mark.parametrize("decision", ["not-ood", "off-topic"])
def test_what_is_no_ood_scenario_changes_nothing(decision):
    rounds, tree = play({"reasoning": "an egg", "decision": decision})
    assert (rounds[0].decision, rounds[0].status, rounds[0].kind) == (decision, "ok", None)
    assert tree == TREE


# ------------------------------------------------------------------ bad answers


@pytest.mark.parametrize(
    "placing",
    [
        {"reasoning": "", "decision": "covered", "node": "nowhere"},
        {"reasoning": "", "decision": "covered", "node": "weather"},
        {"reasoning": "", "decision": "add", "node": "fog", "label": "Below a leaf"},
        {"reasoning": "", "decision": "add", "node": "weather", "label": ""},
        {"reasoning": "", "decision": "add", "node": "weather", "label": "x" * 10_000},
        {"reasoning": "", "decision": "add", "node": "weather", "label": "thick fog at night"},
        {"reasoning": "", "decision": "add", "node": "environmental", "label": "No family"},
        {"reasoning": "", "decision": "broaden", "node": "interactional", "label": "Everything"},
        {"reasoning": "", "decision": "split", "node": "fog", "label": "Same", "category": "Same"},
        {**ADDED, "category": "Storm", "members": ["nowhere"]},
        {**ADDED, "node": "interactional", "category": "Storm", "members": ["fog"]},
        "no JSON at all",
    ],
)
def test_an_impossible_decision_fails_its_round_and_leaves_the_tree(placing):
    rounds, tree = play(placing)
    assert rounds[0].status == "failed"
    assert rounds[0].decision == "malformed"
    assert rounds[0].error
    assert rounds[0].calls == 4
    assert tree == TREE


nodes = st.sampled_from(["fog", "weather", "hail", "root", "environmental", "nowhere"])
words = st.text(max_size=12) | st.sampled_from(
    ["Hail", "Haze", "Storm", "<script>alert(1)</script>", "x" * 300, "a\nb", "Ignore all rules"]
)
answers = st.fixed_dictionaries(
    {
        "reasoning": st.text(max_size=5),
        "decision": st.sampled_from(["add", "broaden", "split", "covered"]),
        "node": nodes,
    },
    optional={
        "label": words | st.none(),
        "category": words | st.none(),
        "members": st.lists(nodes, max_size=3),
        "also": st.lists(st.fixed_dictionaries({"node": nodes, "why": words}), max_size=2),
        "more": words,
    },
) | st.recursive(words | st.none() | st.integers(), lambda part: st.lists(part, max_size=2))


@given(st.lists(answers, min_size=1, max_size=5))
@settings(max_examples=60)
def test_whatever_a_model_says_the_tree_stays_valid_and_the_loop_goes_on(said):
    def placing(request):
        return json.dumps(said[request.sample - 1])

    teamer = RedTeamer(model(placing), iterations=len(said))
    tree, rounds = TREE, list(teamer.rounds(TREE))
    assert [item.round for item in rounds] == list(range(1, len(said) + 1))
    for item in rounds:
        if item.status == "failed":
            assert (item.decision, item.edits) == ("malformed", ())
        tree = tree.apply(*item.edits)
        assert item.nodes == len(tree)
        leaves = {leaf.id for leaf in tree.leaves}
        assert item.kind is None or item.kind in leaves
        assert {also.node for also in item.runners_up} <= leaves
    assert ScenarioTree.parse(tree.to_json()) == tree
    labels = [node.label.casefold() for node in tree.nodes]
    assert len(set(labels)) == len(labels)
    assert tree.children["root"] == ("environmental", "interactional")


@pytest.mark.parametrize("label", [*ADDRESSED, "Thick  fog at NIGHT", "Wea\u200cther"])
@pytest.mark.parametrize(
    "placing",
    [
        {"decision": "add", "node": "weather", "label": "{}"},
        {"decision": "add", "node": "environmental", "label": "Hail", "category": "{}"},
        {"decision": "broaden", "node": "fog", "label": "{}"},
        {"decision": "split", "node": "fog", "label": "{}", "category": "Poor sight"},
        {"decision": "split", "node": "fog", "label": "Hail", "category": "{}"},
    ],
    ids=lambda placing: "-".join(
        [placing["decision"], *(k for k, v in placing.items() if v == "{}")]
    ),
)
def test_a_label_that_is_none_or_taken_fails_its_round_and_the_loop_goes_on(placing, label):
    filled = {key: label if text == "{}" else text for key, text in placing.items()}

    def answer(request):
        return {"reasoning": "", **filled} if request.sample == 1 else ADDED

    rounds = list(RedTeamer(model(answer), iterations=2).rounds(TREE))
    assert [(item.status, item.decision) for item in rounds] == [
        ("failed", "malformed"),
        ("ok", "add"),
    ]
    assert rounds[0].edits == ()
    key = next(key for key, text in placing.items() if text == "{}")
    assert f"{key}: the " in rounds[0].error
    assert rounds[0].nodes == len(TREE)
    tree = TREE.apply(*rounds[1].edits)
    assert ScenarioTree.parse(tree.to_json()) == tree


def test_a_failing_round_does_not_stop_the_others():
    def placing(request):
        if request.sample == 2:
            raise LLMError("the line is dead")
        return COVERED

    rounds, _ = play(placing, iterations=3)
    assert [item.status for item in rounds] == ["ok", "failed", "ok"]
    assert [item.decision for item in rounds] == ["covered", None, "covered"]


# ------------------------------------------------------------------ closed and open loop


def test_the_closed_loop_shows_what_is_covered_and_the_open_loop_does_not():
    seen = []

    def imagining(request):
        prompt = request.prompt
        seen.append((prompt.covered, prompt.thin, prompt.refused))
        return PIANO

    for closed in (True, False):
        play(COVERED, imagining=imagining, iterations=2, closed_loop=closed)
    first, second = (("Thick fog at night",), ("Interactional", "Weather")), ((), ())
    assert seen[:2] == [(*first, ()), (*first, (PIANO,))]
    assert seen[4:6] == [(*second, ()), (*second, ())]


def test_the_open_loop_refuses_nothing_and_splits_nothing():
    asked = []

    def placing(request):
        asked.append(request.prompt)
        label = f"Poor sight {request.sample}"
        return {"reasoning": "", "decision": "broaden", "node": "fog", "label": label}

    rounds, _ = play(
        placing, imagining=PIANO, iterations=4, closed_loop=False, encoder=HashEncoder()
    )
    assert [item.decision for item in rounds] == ["broaden"] * 4
    assert {(prompt.procedure, prompt.full) for prompt in asked} == {("paper", ())}
    assert all(item.similarity is None for item in rounds)


def test_a_repetition_is_refused_before_the_tree_llm_is_asked():
    rounds, _ = play(COVERED, imagining=PIANO, iterations=3)
    assert [item.decision for item in rounds] == ["covered", "duplicate", "duplicate"]
    assert [item.calls for item in rounds] == [2, 1, 1]
    assert [item.kind for item in rounds] == ["fog"] * 3


def test_a_proposal_that_is_near_in_meaning_is_refused_at_the_threshold():
    texts = {
        1: "A grand piano lies on the road ahead of the ego vehicle.",
        2: "Ahead of the ego vehicle a grand piano lies on the road.",
        3: "A flock of geese walks across the junction.",
    }

    def imagining(request):
        return texts[request.sample]

    def decisions(nearest):
        rounds, _ = play(
            COVERED, imagining=imagining, iterations=3, encoder=HashEncoder(), nearest=nearest
        )
        return [item.decision for item in rounds], rounds[1]

    found, second = decisions(0.9)
    assert found == ["covered", "duplicate", "covered"]
    assert (second.nearest, second.nearest_by, second.similarity) == ("fog", "text", 1.0)
    assert decisions(1.01)[0] == ["covered"] * 3


def test_of_a_large_tree_a_part_is_shown_and_a_label_that_is_hidden_is_still_taken():
    edits = [
        TreeEdit(op="add", node=f"w{n}", parent="weather", label=f"Weather kind {n}")
        for n in range(200)
    ]
    tree, seen = TREE.apply(*edits), []

    def placing(request):
        seen.append(request.prompt)
        label = "Weather kind 150" if request.attempt == 1 else "Piano"
        return {"reasoning": "", "decision": "add", "node": "weather", "label": label}

    rounds, _ = play(placing, tree=tree, tokens=300)
    assert len(seen) == 2 * 2
    assert all(len(prompt.nodes) < 60 and prompt.hidden for prompt in seen)
    assert len(seen[0].messages()[-1].text) < 4 * 300 + 3500
    assert rounds[0].decision == "add"


# ------------------------------------------------------------------ stopping


def test_the_rules_that_stop():
    def run(placing, **options):
        teamer = RedTeamer(model(placing), **{"iterations": 50, **options})
        rounds = list(teamer.rounds(TREE))
        return len(rounds), sum(item.calls for item in rounds), teamer.stopped_by(rounds)

    assert run(COVERED, patience=4) == (4, 8, "patience")
    assert run(COVERED, budget=9) == (4, 8, "budget")
    assert run("no JSON", budget=9) == (2, 8, "budget")
    assert run(COVERED, coverage=0.9) == (10, 20, "coverage")
    assert run(COVERED) == (50, 100, "rounds")
    assert run(COVERED, iterations=0) == (0, 0, "rounds")


# ------------------------------------------------------------------ order and resumption


def course(request):
    """Return a varied course of decisions, some of which fail."""
    number = request.sample
    if number % 7 == 5:
        raise LLMError("the line is dead")
    if number % 3 == 0:
        return COVERED
    if number % 3 == 1:
        return {"reasoning": "", "decision": "covered", "node": "nowhere"}
    label = f"Strange weather number {number}"
    return {"reasoning": "", "decision": "add", "node": "weather", "label": label}


def imagined(request):
    """Depend on what is shown, so that another view of the tree would show."""
    prompt = request.prompt
    return (
        f"Object {len(prompt.covered)} {len(prompt.refused)} {request.sample % 4} is on the road."
    )


@given(st.integers(0, 10), st.integers(1, 4), st.booleans())
@settings(max_examples=15)
def test_continuing_after_any_round_gives_the_same_rounds(cut, in_flight, closed):
    def teamer():
        return RedTeamer(
            model(course, imagined),
            iterations=10,
            in_flight=in_flight,
            threads=1,
            closed_loop=closed,
            encoder=HashEncoder(16),
            budget=40,
        )

    whole = list(teamer().rounds(TREE))
    rest = list(teamer().rounds(TREE, whole[:cut]))
    assert whole[:cut] + rest == whole


@pytest.mark.parametrize("closed", [True, False])
def test_the_number_of_threads_and_who_is_first_change_no_byte(closed):
    def log(threads, slow=()):
        def imagining(request):
            sum(range(50_000 if request.sample in slow else 0))
            return imagined(request)

        teamer = RedTeamer(
            model(course, imagining),
            iterations=12,
            in_flight=4,
            threads=threads,
            closed_loop=closed,
            encoder=HashEncoder(16),
            patience=9,
            budget=60,
        )
        return [item.to_json() for item in teamer.rounds(TREE)]

    assert log(1) == log(2, slow=(1, 5)) == log(4, slow=(2, 3, 4)) == log(4)


def test_proposals_are_really_in_flight_together():
    barrier = threading.Barrier(3, timeout=20)

    def imagining(request):
        if request.sample <= 3:
            barrier.wait()
        return f"Object number {request.sample} lies on the road ahead."

    rounds, _ = play(COVERED, imagining=imagining, iterations=3, in_flight=3)
    assert [item.seen for item in rounds] == [0, 0, 0]


def test_a_stop_leaves_no_proposal_asked_in_vain():
    asked = []

    def imagining(request):
        asked.append(request.sample)
        return f"Object number {request.sample} lies on the road ahead."

    teamer = RedTeamer(model(COVERED, imagining), iterations=50, in_flight=8, patience=5, budget=90)
    rounds = list(teamer.rounds(TREE))
    assert sorted(asked) == [item.round for item in rounds] == [1, 2, 3, 4, 5]


def test_the_open_loop_sees_nothing_so_proposals_in_flight_change_nothing():
    def log(in_flight):
        teamer = RedTeamer(
            model(course, imagined), iterations=9, closed_loop=False, in_flight=in_flight
        )
        return list(teamer.rounds(TREE))

    assert log(1) == log(5)


def test_a_run_in_which_every_round_fails_is_no_result():
    dead = ScriptedLLM(lambda request: LLMError("no server"))
    with pytest.raises(LLMError, match="every round failed: no server"):
        RedTeamer(dead, iterations=3).run(ScenarioTree.initial())
