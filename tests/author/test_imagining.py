"""The built-in author repeats itself when it is told nothing, and listens when it is told something."""

from collections import Counter

import pytest

from oodscen._seeding import stream
from oodscen.author._imagining import Habits, Imagination
from oodscen.author._knowledge.base import Knowledge
from oodscen.author._reading.recognition import Recogniser
from oodscen.author._writing.compose import Composer
from oodscen.prompts._tree.imagine_scenario import ImagineScenario


@pytest.fixture(scope="module")
def draw(knowledge: Knowledge, recogniser: Recogniser):
    def drawing(count: int = 100, seed: int = 0, habits: Habits | None = None, **question_fields):
        imagination = Imagination(seed, knowledge, recogniser, habits)
        question = ImagineScenario(shown=("x",), **question_fields)
        return [imagination.hazard(question, stream(seed, "draw", n)) for n in range(count)]

    return drawing


def test_the_same_question_brings_a_repertoire(draw, knowledge: Knowledge) -> None:
    for seed in range(4):
        kinds = {hazard.id for hazard in draw(seed=seed)}
        assert 36 <= len(kinds) <= 56
    assert {h.id for h in draw(seed=0)} != {h.id for h in draw(seed=1)}
    assert len({h.id for h in draw(2000)}) < len(knowledge.hazards) / 2


def test_what_is_covered_is_mostly_left_out_and_the_next_comes_to_mind(draw) -> None:
    first = {hazard.id: hazard for hazard in draw(400)}
    drawn = draw(120, covered=tuple(hazard.label for hazard in first.values()))
    repeats = sum(hazard.id in first for hazard in drawn)
    assert 5 <= repeats <= 40
    assert len({hazard.id for hazard in drawn} - set(first)) >= 10


def test_a_model_that_does_not_listen_draws_as_if_it_were_told_nothing(draw) -> None:
    fields = {"covered": ("Fallen tree across the road",), "refused": ("A dog runs past.",)}
    assert draw(habits=Habits(listens=0.0), **fields) == draw()


def test_thin_groups_are_preferred_now_and_then(draw, knowledge: Knowledge) -> None:
    """The smallest, the middle and the largest family get the rounds that the habits give them."""
    sizes = Counter(hazard.family for hazard in knowledge.hazards)
    by_size = sorted(sizes, key=sizes.__getitem__)
    followed = Habits().listens * Habits().follows
    for family in (by_size[0], by_size[len(by_size) // 2], by_size[-1]):
        shares = []
        for thin in ((), (family,)):
            drawn = draw(200, covered=("Fallen tree across the road",), thin=thin)
            shares.append(sum(hazard.family == family for hazard in drawn) / 200)
        assert shares[1] - shares[0] == pytest.approx(followed * (1.0 - shares[0]), abs=0.1)


def test_a_refused_text_is_left_out_like_what_is_covered(draw, knowledge: Knowledge) -> None:
    hazard = draw(1)[0]
    text = Composer(knowledge).text(hazard, stream(0, "text"))
    listening = Habits(listens=1.0)
    assert hazard in draw(200, habits=listening)
    assert hazard not in draw(200, habits=listening, refused=(text,))


def test_an_author_that_has_told_all_begins_again(draw, knowledge: Knowledge) -> None:
    everything = tuple(hazard.label for hazard in knowledge.hazards)
    assert draw(covered=everything) == draw()


def test_what_is_marked_as_first_comes_in_every_second_round_until_it_is_covered(
    knowledge: Knowledge,
) -> None:
    own = knowledge.hazards[0].model_copy(
        update={"id": "own", "label": "Harp on the road", "first": True}
    )
    extended = knowledge.model_copy(update={"hazards": (*knowledge.hazards, own)})
    imagination = Imagination(0, extended, Recogniser(extended))

    def drawn(**question_fields) -> list[str]:
        question = ImagineScenario(shown=("x",), **question_fields)
        return [imagination.hazard(question, stream(0, "first", n)).id for n in range(100)]

    assert 35 <= drawn().count("own") <= 65
    assert drawn(covered=("Harp on the road",)).count("own") <= 3
