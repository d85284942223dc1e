"""The built-in author repeats itself when it is told nothing, and listens when it is told something."""

import pytest

from oodscen._seeding import stream
from oodscen.author._imagining import Habits, Imagination
from oodscen.author._knowledge.base import HazardKind, Knowledge
from oodscen.author._reading.recognition import Recogniser
from oodscen.prompts._tree.imagine_scenario import ImagineScenario


@pytest.fixture(scope="module")
def draw(knowledge: Knowledge, recogniser: Recogniser):
    def drawing(count: int = 100, seed: int = 0, habits: Habits | None = None, **told):
        mind = Imagination(seed, knowledge, recogniser, habits)
        question = ImagineScenario(shown=("x",), **told)
        return [mind.hazard(question, stream(seed, "draw", number)) for number in range(count)]

    return drawing


def test_the_same_question_brings_a_repertoire(draw, knowledge: Knowledge) -> None:
    for seed in range(4):
        kinds = {hazard.id for hazard in draw(seed=seed)}
        assert 36 <= len(kinds) <= 56
    assert {h.id for h in draw(seed=0)} != {h.id for h in draw(seed=1)}
    assert len({h.id for h in draw(2000)}) < len(knowledge.hazards) / 2


def test_what_is_covered_is_mostly_left_out_and_the_next_comes_to_mind(draw) -> None:
    first = {hazard.id: hazard for hazard in draw(400)}
    told = draw(120, covered=tuple(hazard.label for hazard in first.values()))
    repeats = sum(hazard.id in first for hazard in told)
    assert 5 <= repeats <= 40
    assert len({hazard.id for hazard in told} - set(first)) >= 10


def test_a_model_that_does_not_listen_draws_as_if_it_were_told_nothing(draw) -> None:
    told = {"covered": ("Fallen tree across the road",), "refused": ("A dog runs past.",)}
    assert draw(habits=Habits(listens=0.0), **told) == draw()


def test_thin_groups_are_preferred_now_and_then(draw, knowledge: Knowledge) -> None:
    family = knowledge.hazards[0].family
    shares = []
    for thin in ((), (family,)):
        told = draw(200, covered=("Fallen tree across the road",), thin=thin)
        shares.append(sum(hazard.family == family for hazard in told) / 200)
    assert shares[0] < 0.15 < shares[1] < 0.5


def test_a_refused_text_is_left_out_like_what_is_covered(draw) -> None:
    hazard = draw(1)[0]
    text = hazard.events[0].replace("{where}", "ahead")
    told = draw(200, habits=Habits(listens=1.0), refused=(text,))
    assert hazard.id not in {one.id for one in told}


def test_an_author_that_has_told_all_begins_again(draw, knowledge: Knowledge) -> None:
    everything = tuple(hazard.label for hazard in knowledge.hazards)
    assert len(draw(10, covered=everything)) == 10


def test_what_is_marked_as_first_comes_in_every_second_round_until_it_is_covered(
    knowledge: Knowledge,
) -> None:
    own = knowledge.hazards[7].model_copy(
        update={"id": "own", "label": "Harp on the road", "first": True}
    )
    mind = Imagination(0, extended := _with(knowledge, own), Recogniser(extended))

    def drawn(**told) -> list[str]:
        question = ImagineScenario(shown=("x",), **told)
        return [mind.hazard(question, stream(0, "first", n)).id for n in range(100)]

    assert 35 <= drawn().count("own") <= 65
    assert drawn(covered=("Harp on the road",)).count("own") <= 3


def _with(knowledge: Knowledge, hazard: HazardKind) -> Knowledge:
    return knowledge.model_copy(update={"hazards": (*knowledge.hazards, hazard)})
