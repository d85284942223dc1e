"""Describing: the right number of texts, ids known before, near duplicates drawn again."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen import Describer, Metrics, ScenarioTree
from oodscen._words.text import folded_words
from oodscen.author._builtin import BuiltinAuthor
from oodscen.data._scenario import Scenario
from oodscen.errors import AnswerError, UsageError
from oodscen.prompts._scenario.describe_ordinary import DescribeOrdinary
from oodscen.prompts._scenario.describe_path import STYLES
from oodscen.protocols import Completion
from oodscen.testing import ScriptedLLM
from oodscen.testing._encoder import HashEncoder
from oodscen.tree._scenario_tree import TreeEdit

BUILTIN = ("OOD", "Environmental", "Debris", "Large cardboard box on the road")
PATH = ("OOD", "Environmental", "Debris", "Box on the road")


class CountingLLM:
    """Counts the calls of a model."""

    def __init__(self, llm):
        self.name, self.calls, self.llm = llm.name, 0, llm

    def complete(self, request):
        self.calls += 1
        return self.llm.complete(request)


def writer(texts):
    """Return a model that hands out prepared texts, skipping those to avoid."""

    def answer(request):
        fresh = [text for text in texts if text not in request.prompt.avoid]
        return {"texts": fresh[: request.prompt.count]}

    return ScriptedLLM(answer)


def test_ids_are_numbered_within_the_leaf_and_batches_avoid_earlier_texts():
    texts = [f"The ego meets obstacle number {number} on its way." for number in range(25)]
    scenarios = Describer(writer(texts), batch=10).path("box", PATH, 23)
    assert [item.id for item in scenarios][:2] == ["box-001", "box-002"]
    assert [item.text for item in scenarios] == texts[:23]
    assert all(item.path == PATH and item.leaf == "box" for item in scenarios)


def test_a_text_that_a_model_insists_on_stays_and_the_other_repetitions_are_reworded():
    texts = [f"The ego meets obstacle number {number} on its way." for number in range(3)]
    other = (*PATH[:-1], "Tyre on the road")
    scenarios = [
        Scenario(id=f"leaf-{number}", leaf=f"leaf-{len(path[-1])}", path=path, text=texts[0])
        for number, path in enumerate((PATH, other, PATH))
    ]

    def answer(request):
        insists = request.prompt.path == other
        return {"texts": [texts[0 if insists else len(request.prompt.avoid)]]}

    (reworded,) = Describer(ScriptedLLM(answer)).reworded(scenarios)
    assert (reworded.id, reworded.text) == (scenarios[2].id, texts[2])


def test_a_writer_knows_what_was_made_for_its_kind_only():
    asked = []

    def answer(request):
        asked.append(request.prompt)
        return {"texts": [f"A large box lies {len(asked)} m ahead of ego."]}

    other = (*PATH[:-1], "Train on the road")
    describer = Describer(ScriptedLLM(answer), made={other: ["train: a red locomotive"]})
    describer.path("box", PATH, 1)
    describer.path("train", other, 1)
    assert [one.made for one in asked] == [(), ("train: a red locomotive",)]
    assert ["a red locomotive" in one.question() for one in asked] == [False, True]
    assert asked[0].instructions() == asked[1].instructions()


def test_near_duplicates_are_replaced():
    first = "A large cardboard box lies in the middle of the lane ahead of the ego vehicle."
    near = "In the middle of the lane ahead of the ego vehicle lies a large cardboard box."
    other = "Under a bridge the ego comes upon a carton blown there by the wind at dusk."
    describer = Describer(writer([first, near, other]), HashEncoder(), nearest=0.9)
    assert {item.text for item in describer.path("b", PATH, 2)} == {first, other}


@given(st.integers(1, 12), st.integers(1, 12), st.integers(1, 12))
def test_a_path_has_as_many_texts_as_its_kind_bears(bears, wanted, batch):
    texts = [f"The ego meets obstacle number {number} on its way." for number in range(bears)]
    llm = CountingLLM(writer(texts))
    found = Describer(llm, batch=batch).path("box", PATH, wanted)
    assert [item.text for item in found] == texts[:wanted]
    assert llm.calls <= -(-min(bears, wanted) // batch) + 1


def test_a_writer_that_has_run_dry_is_not_asked_again_and_its_near_duplicates_go():
    first = "A large cardboard box lies in the middle of the lane ahead of the ego vehicle."
    near = "In the middle of the lane ahead of the ego vehicle lies a large cardboard box."
    llm = CountingLLM(writer([first, near]))
    found = Describer(llm, HashEncoder(), nearest=0.9).path("b", PATH, 3)
    assert [item.text for item in found] == [first]
    assert llm.calls == 1


COWS = [
    f"A brown cow stands in front of house number {number} on the street." for number in range(10)
]
FAULTY = (
    "Unfortunately, I cannot fulfil this request.",
    "Text 1: A cow stands in the lane.",
    "A cow.",
)


def same(*texts):
    """Return a model that has these texts only, whatever it is asked to avoid."""
    return CountingLLM(ScriptedLLM(lambda request: {"texts": [*texts][: request.prompt.count]}))


@given(st.lists(st.sampled_from([*COWS, *FAULTY]), min_size=1, max_size=12), st.integers(1, 12))
def test_what_is_at_fault_in_every_attempt_costs_no_other_text(texts, wanted):
    first = texts[: min(wanted, 10)]
    kept = [text for text in dict.fromkeys(first) if text in COWS]
    describer = Describer(same(*texts), batch=10)
    if not kept:
        with pytest.raises(AnswerError):
            describer.path("cow", PATH, wanted)
        return
    assert [found.text for found in describer.path("cow", PATH, wanted)] == kept


def test_a_model_that_repeats_itself_has_run_dry():
    assert len(Describer(same(*COWS), batch=10).path("cow", PATH, 12)) == 10
    near = "In front of house number 0 on the street a brown cow stands."
    asked = []

    def answer(request):
        asked.append(request.prompt.count)
        return {"texts": [COWS[0], near] if request.prompt.count == 2 else [near]}

    found = Describer(ScriptedLLM(answer), HashEncoder(), nearest=0.9).path("cow", PATH, 2)
    assert [one.text for one in found] == [COWS[0]]
    assert asked == [2, 1, 1, 1]


def test_an_answer_that_was_cut_off_leaves_no_half_a_text():
    def answer(request):
        return Completion(text='{"texts": ["' + COWS[0] + '", "' + COWS[1][:40], is_cut_off=True)

    with pytest.raises(AnswerError):
        Describer(ScriptedLLM(answer), batch=10).path("cow", PATH, 2)


def author_scenarios(**options):
    return Describer(BuiltinAuthor(), **options).path("box", BUILTIN, 6)


@pytest.mark.parametrize("style", STYLES)
def test_every_style_is_distinct_repeatable_and_kept(style):
    first, again = author_scenarios(style=style), author_scenarios(style=style)
    assert first == again
    assert {item.style for item in first} == {style}
    assert len({folded_words(item.text) for item in first}) == 6
    assert all("box" in item.text or "carton" in item.text for item in first)


def test_styles_differ_in_register():
    texts = {style: [item.text for item in author_scenarios(style=style)] for style in STYLES}
    words = {style: sum(len(text.split()) for text in found) for style, found in texts.items()}
    assert words["terse"] < words["natural"] < words["verbose"]
    assert all(": " in text for text in texts["terse"])
    assert not any(re.search(r"\bego\b", text, re.I) for text in texts["first-person"])
    assert all(re.search(r"\bego\b", text, re.I) for text in texts["natural"] + texts["paper"])


def test_of_many_candidates_the_most_diverse_inside_the_band_are_kept():
    metrics = Metrics(HashEncoder(), ["A car waits at a red light.", "A box lies on the road."])
    plenty = author_scenarios(candidates=5, metrics=metrics)
    few = author_scenarios()
    assert [item.id for item in plenty] == [item.id for item in few]
    spread = [metrics.diversity([item.text for item in found]).nearest for found in (plenty, few)]
    assert spread[0] > spread[1]
    middle = metrics.oodness([item.text for item in plenty]).mean
    inside = author_scenarios(candidates=5, metrics=metrics, band=(-1.0, middle))
    assert max(metrics.oodness([item.text for item in inside]).per_text) <= middle
    with pytest.raises(UsageError):
        author_scenarios(candidates=2, metrics=metrics, band=(0.9, 1.0))


@pytest.mark.parametrize("options", [{"style": "rude"}, {"candidates": 0}, {"candidates": 2}])
def test_what_cannot_be_is_refused_at_once(options):
    with pytest.raises(UsageError):
        Describer(BuiltinAuthor(), **options)


@pytest.mark.parametrize("candidates", [1, 2])
def test_a_path_of_no_texts_is_refused(candidates):
    metrics = Metrics(HashEncoder(), ["a car drives"]) if candidates > 1 else None
    describer = Describer(BuiltinAuthor(), candidates=candidates, metrics=metrics)
    with pytest.raises(UsageError, match="count must be a whole number from 1"):
        describer.path("box", PATH, 0)


def test_texts_of_different_paths_that_agree_are_written_again():
    texts = ["The ego vehicle meets a box.", "A carton lies ahead of the ego vehicle."]
    tree = ScenarioTree.initial().apply(
        TreeEdit(op="add", node="a", parent="environmental", label="Box"),
        TreeEdit(op="add", node="b", parent="environmental", label="Carton"),
    )
    found = Describer(writer(texts), per_path=1).run(tree)
    assert [item.text for item in found] == texts
    assert [item.id for item in found] == ["a-001", "b-001"]


def test_twins_are_written_on_demand_and_left_out_where_no_answer_is_valid():
    found = author_scenarios(twins=True)
    assert all(
        item.ordinary and folded_words(item.ordinary) != folded_words(item.text) for item in found
    )
    assert all(item.ordinary is None for item in author_scenarios())

    def answer(request):
        if isinstance(request.prompt, DescribeOrdinary):
            return {"text": request.prompt.text}
        return {"texts": ["A large box lies in the lane of the ego vehicle."]}

    assert Describer(ScriptedLLM(answer), twins=True).path("b", PATH, 1)[0].ordinary is None
