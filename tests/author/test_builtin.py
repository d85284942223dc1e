import io
import pickle
import subprocess
import sys
from contextlib import redirect_stdout

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen import Describer
from oodscen._words.text import folded_words
from oodscen.author._builtin import BuiltinAuthor
from oodscen.author._knowledge.base import Knowledge
from oodscen.author._writing.compose import Composer
from oodscen.errors import LLMError
from oodscen.prompts._digest import CatalogueDigest
from oodscen.prompts._judging.describe_frame import DescribeFrame
from oodscen.prompts._scenario.describe_path import DescribePath
from oodscen.prompts._scenario.stage_scene import StageScene
from oodscen.prompts._tree.classify_examples import ClassifyExamples
from oodscen.prompts._tree.give_examples import GiveExamples
from oodscen.prompts._tree.imagine_scenario import ImagineScenario
from oodscen.protocols import LLM, Request


def test_it_is_a_language_model_to_the_core(author: BuiltinAuthor) -> None:
    assert isinstance(author, LLM)
    assert author.name == "builtin"


@given(count=st.integers(1, 60), seed=st.integers(0, 999))
@settings(max_examples=10, deadline=None)
def test_examples_are_distinct_and_of_both_classes(ask, count: int, seed: int) -> None:
    author = BuiltinAuthor(seed)
    question = GiveExamples(shown=("A fallen tree lies across the road.",), count=count)
    given = ask(author, question).examples
    hazards = [author._recogniser.recognise(text).hazard for text in given]
    assert len({hazard.id for hazard in hazards}) == count
    assert "fallen-tree" not in {hazard.id for hazard in hazards}
    sorted_out = ask(author, ClassifyExamples(asked=question, given=tuple(given)))
    assert [item.scenario_class for item in sorted_out.examples] == [h.class_name for h in hazards]
    if count > 1:
        assert len({hazard.class_name for hazard in hazards}) == 2


def test_examples_that_run_out_are_told_of(monkeypatch, ask):
    monkeypatch.setattr(Composer, "texts", lambda *arguments: iter(()))
    with pytest.raises(LLMError, match="after 0 of 3"):
        ask(BuiltinAuthor(), GiveExamples(shown=(), count=3))


def test_unknown_examples_are_classified_by_their_words(author: BuiltinAuthor, ask) -> None:
    asked = GiveExamples(shown=(), count=1)
    given = ("A llama jumps and runs about.", "Custard pours from the sky.")
    answer = ask(author, ClassifyExamples(asked=asked, given=given))
    assert [item.scenario_class for item in answer.examples] == ["interactional", "environmental"]


def test_rounds_of_red_teaming_differ(author: BuiltinAuthor, ask) -> None:
    question = ImagineScenario(shown=("x",))
    texts = {ask(author, question, sample).text for sample in range(50)}
    assert len(texts) == 50


def test_covered_kinds_are_mostly_avoided(author: BuiltinAuthor, ask, knowledge: Knowledge) -> None:
    covered = tuple(hazard.label for hazard in knowledge.hazards[::2])
    known = {hazard.id for hazard in knowledge.hazards[::2]}
    question = ImagineScenario(shown=("x",), covered=covered)
    found = [
        author._recogniser.recognise(ask(author, question, sample).text).hazard
        for sample in range(120)
    ]
    repeats = sum(hazard.id in known for hazard in found)
    assert 5 <= repeats <= 40


@pytest.mark.parametrize("count", [1, 25])
def test_texts_of_a_path_are_distinct(
    author: BuiltinAuthor, ask, knowledge: Knowledge, count: int
) -> None:
    for hazard in knowledge.hazards[::18]:
        path = ("x", hazard.class_name, hazard.family, hazard.label)
        first = ask(author, DescribePath(path=path, count=count)).texts
        more = ask(author, DescribePath(path=path, count=count, avoid=tuple(first))).texts
        assert len({folded_words(text) for text in (*first, *more)}) == 2 * count


def test_a_path_has_as_many_texts_in_many_questions_as_in_one(author: BuiltinAuthor) -> None:
    path = ("x", "Fallen tree across the road")
    assert len(Describer(author, batch=220).path("tree", path, 660)) == 660


def test_a_widened_leaf_tells_of_its_kin_only_if_that_is_as_easily_shown(
    author: BuiltinAuthor, ask, knowledge: Knowledge
) -> None:
    for hazard in knowledge.hazards:
        if not hazard.wider:
            continue
        texts = ask(author, DescribePath(path=("x", hazard.wider), count=6)).texts
        told = {author._recogniser.recognise(text).hazard.id for text in texts}
        assert hazard.id in told
        assert told <= {hazard.id, *hazard.kin}
        if hazard.stage is not None:
            for name in told:
                assert knowledge.by_id[name].stage is not None
                assert set(knowledge.by_id[name].needs.assets) <= set(hazard.needs.assets)


def test_it_does_not_invent_what_it_does_not_know(author: BuiltinAuthor, ask) -> None:
    with pytest.raises(LLMError):
        ask(author, DescribePath(path=("x", "Alien invasion"), count=3))


def test_it_cannot_see(author: BuiltinAuthor) -> None:
    question = DescribeFrame.model_construct()
    with pytest.raises(LLMError, match="cannot see"):
        author.complete(Request(prompt=question, messages=(), schema={}))


QUESTIONS = """
from oodscen.author._builtin import BuiltinAuthor
from oodscen.prompts._scenario.describe_path import DescribePath
from oodscen.prompts._tree.imagine_scenario import ImagineScenario
from oodscen.protocols import Request
author = BuiltinAuthor(3)
for question in (DescribePath(path=("x", "Fallen tree across the road"), count=5), ImagineScenario(shown=())):
    print(author.complete(Request(prompt=question, messages=(), schema={}, sample=2)).text)
"""
LIGHT = """
import sys
for name in ("torch", "litellm", "numba", "pybullet", "cv2", "oodscen.stages._grow", "oodscen.stages._redteam.red_teamer"):
    assert name not in sys.modules, name
"""


def test_a_fresh_process_gives_the_same_bytes_and_loads_nothing_heavy() -> None:
    with redirect_stdout(io.StringIO()) as here:
        exec(QUESTIONS, {})
    program = [sys.executable, "-c", QUESTIONS + LIGHT]
    there = subprocess.run(program, capture_output=True, text=True, check=True).stdout
    assert there == here.getvalue()
    assert there


def test_answers_depend_on_seed_and_sample_and_on_nothing_before(ask) -> None:
    question = DescribePath(path=("x", "Fallen tree across the road"), count=4)
    one, two = BuiltinAuthor(1), BuiltinAuthor(1)
    ask(two, ImagineScenario(shown=("x",)), 5)
    assert ask(one, question) == ask(two, question)
    assert ask(one, question, 1) != ask(one, question, 2)
    assert ask(one, question) != ask(BuiltinAuthor(2), question)


def test_it_survives_pickling(author: BuiltinAuthor, ask, digest: CatalogueDigest) -> None:
    text = "Ego drives on a two-lane residential road. A large cardboard box lies in its lane."
    question = StageScene(text=text, path=(), catalogue=digest)
    assert ask(pickle.loads(pickle.dumps(author)), question) == ask(author, question)


def test_answers_carry_no_identifier_of_the_knowledge(
    author: BuiltinAuthor, ask, knowledge: Knowledge
) -> None:
    for hazard in knowledge.hazards:
        if "-" in hazard.id and hazard.id not in hazard.label.casefold():
            texts = ask(author, DescribePath(path=("x", hazard.label), count=5)).texts
            assert all(f" {hazard.id} " not in text.casefold() for text in texts) or any(
                hazard.id in event.casefold() for event in hazard.events
            )
