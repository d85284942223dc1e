"""The documented matcher of open answers: concepts, not shared words."""

import json
import re
from functools import cache
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.author._knowledge.loading import load_knowledge
from oodscen.data._base import Data
from oodscen.errors import UsageError
from oodscen.judging._aspects.matching import MOST_THINGS, names_aspect
from oodscen.judging._constant_answerers import ASPECT


class Answer(Data):
    """An answer that a person wrote down for a label, and whether it is right."""

    label: str
    answer: str
    is_right: bool
    round: int
    """Of writing: the answers of a round were written without a look at the table as it then was."""


@cache
def answers() -> tuple[Answer, ...]:
    lines = Path(__file__).with_name("aspects.jsonl").read_text(encoding="utf-8").splitlines()
    return tuple(Answer.model_validate(json.loads(line)) for line in lines)


@cache
def labels() -> tuple[str, ...]:
    return tuple(dict.fromkeys(answer.label for answer in answers()))


HELD_OUT = (4, 5)
"""Rounds for which nothing was added to the table."""


def share_right(*, is_right: bool, is_held_out: bool = False) -> float:
    """Return the share of the right answers, or of the wrong ones, that count as right."""
    found = [
        names_aspect(answer.answer, ("OOD", answer.label))
        for answer in answers()
        if answer.is_right == is_right and (answer.round in HELD_OUT) == is_held_out
    ]
    return sum(found) / len(found)


@pytest.mark.parametrize(
    ("aspect", "label", "is_right"),
    [
        ("a flipped car", "Overturned vehicle ahead", True),
        ("car lying on its roof", "Overturned vehicle ahead", True),
        ("dense mist", "Thick fog at night with a vehicle ahead", True),
        ("night", "Thick fog at night with a vehicle ahead", False),
        ("a crate in the lane", "Large cardboard box on the road", True),
        ("a carton in the lane", "Large cardboard box on the road", True),
        ("a stag", "Deer on the road", True),
        ("a demonstration", "Large group of people (parade, protest)", True),
        ("no deer, only a box", "Deer on the road", False),
        ("the deer is not there", "Deer on the road", False),
        ("traffic lights not working", "Traffic lights failing in rush hour", True),
        ("a vehicle ahead", "Overturned vehicle ahead", False),
        ("heavy rain", "Heavy snowfall covering the road", False),
        ("a fire hydrant", "Fire on or beside the road", False),
        ("vehicle stopped ahead", "Stop sign knocked down into the lane", False),
        ("fog, snow, deer, box, parade, police, tree, wreck", "Deer on the road", False),
        ("a meteorite in the lane", "Glowing meteorite on the road", True),
        ("a glowing lamp", "Glowing meteorite on the road", False),
        ("camper van coming the wrong way", "Camper van broken down on a country road", False),
        ("camper van stopped in the lane", "Camper van broken down on a country road", True),
        ("the traffic light is dark", "Traffic light showing all its colours at once", False),
        ("the traffic light is dark", "Traffic lights failing in rush hour", True),
        ("", "Deer on the road", False),
    ],
)
def test_other_words_for_the_same_count_and_other_things_do_not(aspect, label, is_right):
    assert names_aspect(aspect, ("OOD", label)) is is_right


def test_of_the_right_answers_nine_tenths_count_and_of_the_wrong_ones_three_hundredths_at_most():
    assert share_right(is_right=True) >= 0.9
    assert share_right(is_right=False) <= 0.03


def test_answers_that_the_table_was_not_made_for_are_mostly_judged_as_a_person_would():
    assert share_right(is_right=True, is_held_out=True) >= 0.8
    assert share_right(is_right=False, is_held_out=True) <= 0.05


def test_clauses_and_wider_labels_of_a_hazard_mostly_name_it_and_rarely_another():
    hazards = load_knowledge().hazards
    told = [
        (clause.replace("{where}", ""), hazard)
        for hazard in hazards
        for clause in hazard.events[:2]
    ]
    own = [names_aspect(clause, ("OOD", one.label)) for clause, one in told]
    assert sum(own) >= 0.75 * len(own)
    wider = [
        names_aspect(hazard.wider, ("OOD", hazard.label)) for hazard in hazards if hazard.wider
    ]
    assert sum(wider) >= 0.8 * len(wider)
    foreign = [
        names_aspect(clause, ("OOD", other.label))
        for clause, one in told[::20]
        for other in hazards
        if other is not one and other.id not in one.kin
    ]
    assert sum(foreign) <= 0.015 * len(foreign)


def test_the_corpus_has_right_and_wrong_answers_to_every_label_of_a_default_study():
    assert len(labels()) >= 72
    assert sum(answer.is_right for answer in answers()) >= 250
    assert sum(not answer.is_right for answer in answers()) >= 150


def test_a_label_is_right_for_itself_and_for_hardly_any_other():
    pairs = [(said, meant) for said in labels() for meant in labels() if said != meant]
    taken = [(said, meant) for said, meant in pairs if names_aspect(said, ("OOD", meant))]
    assert len(taken) < 0.01 * len(pairs)
    assert all(names_aspect(label, ("OOD", label)) for label in labels())


@pytest.mark.parametrize(
    "empty",
    "heavy|large|sudden|thick|night|at night|ahead|vehicle ahead|a car|the road|stopped|vehicle stopped ahead"
    "|an obstacle on the carriageway|something unusual|traffic|unexpected situation|danger".split(
        "|"
    ),
)
def test_modifiers_and_what_every_road_has_name_nothing(empty):
    taken = [label for label in labels() if names_aspect(empty, ("OOD", label))]
    assert not taken


def test_the_constant_answer_is_right_for_a_pedestrian_who_crosses_and_nothing_else():
    taken = [label for label in labels() if names_aspect(ASPECT, ("OOD", label))]
    assert taken == ["Pedestrian crossing where no crossing is expected"]


@given(st.text(min_size=1).filter(str.strip), st.sampled_from([str.upper, str.title, str]))
def test_the_label_itself_is_always_right(label, spelling):
    if label.casefold() == spelling(label).casefold():
        assert names_aspect(spelling(label), ("OOD", label))


@pytest.mark.parametrize("spelling", [r"'\1'", r"\1's", "\\1\u2019s"])
def test_quoted_words_and_possessives_name_the_same(spelling):
    for answer in answers():
        said = re.sub(r"(?<![\w'-])(s\w+)(?![\w'-])", spelling, answer.answer)
        path = ("OOD", answer.label)
        assert names_aspect(said, path) == names_aspect(answer.answer, path), said


@given(st.sampled_from(answers()), st.sampled_from(["there is no {}", "{} is not there"]))
def test_what_is_denied_is_not_named(one, denial):
    said = "deer"
    assert not names_aspect(denial.format(said), ("OOD", "Deer on the road"))
    assert not names_aspect(denial.format("x"), ("OOD", one.label))


@given(st.sampled_from(answers()), st.integers(MOST_THINGS + 1, 20))
def test_a_list_of_many_things_names_none(one, count):
    assert not names_aspect(", ".join([one.answer] * count), ("OOD", one.label))


def test_a_label_that_denies_something_is_right_too():
    for label in (
        "Parked car pulling out without looking",
        "A car, a van, no light, a dog, x, y, z",
    ):
        assert names_aspect(label.lower(), ("OOD", label))


@pytest.mark.parametrize(
    ("aspect", "label"),
    [
        ("a broken fence", "Traffic lights failing in rush hour"),
        ("an overturned wheelbarrow", "Overturned vehicle ahead in the lane"),
        ("a wandering fox", "Disoriented person roaming the road"),
    ],
)
def test_a_state_of_something_unknown_is_not_taken_for_that_of_the_thing_it_implies(aspect, label):
    assert not names_aspect(aspect, ("OOD", label))


WEATHER = {
    "fog": "Thick fog at night",
    "snow": "Heavy snowfall covering the road",
    "rain": "Torrential rain",
}


@given(
    st.sampled_from(sorted(WEATHER)),
    st.sampled_from(["traffic has stopped", "drivers have cleared the lane", "cars had passed"]),
)
def test_weather_in_which_others_stop_is_named(said, event):
    assert names_aspect(f"in {said} {event}", ("OOD", WEATHER[said]))


@given(
    st.sampled_from(sorted(WEATHER)),
    st.sampled_from(
        [
            "{} coats the road",
            "{} lights a lorry from behind",
            "{} has stopped the traffic",
            "{} stopped a bus",
            "{} has gone on for hours",
            "{} is over the road",
            "{} has lifted a roof onto the road",
            "{} has stopped pedestrians",
            "{} earlier than usual on the road",
        ]
    ),
)
def test_weather_that_acts_or_goes_on_is_named(said, wording):
    assert names_aspect(wording.format(said), ("OOD", WEATHER[said]))


@given(
    st.sampled_from(sorted(WEATHER)),
    st.sampled_from(
        [
            "the {} has cleared",
            "the {} is gone",
            "{} has just stopped",
            "the {} stopped a while ago",
            "the {} is finally over",
            "the {} lifted",
            "the {} ended an hour ago",
            "the {} let up",
            "the {} that hid the road has cleared",
            "a {} sensor",
            "a {} plough",
            "the {}-lamps of a car",
        ]
    ),
)
def test_weather_that_is_over_or_in_a_name_is_not_named(said, wording):
    label = ("OOD", WEATHER[said])
    assert names_aspect(f"the {said} is thick", label)
    assert not names_aspect(wording.format(said), label)
    assert names_aspect(f"{wording.format(said)} in {said}", label)


@pytest.mark.parametrize(
    ("aspect", "label"),
    [
        ("a child seat in the car", "Child running onto the road"),
        ("a booster seat with a child's seat", "Child running onto the road"),
        ("a dog trailer", "Dog on the road"),
    ],
)
def test_a_thing_that_another_is_named_after_is_not_named(aspect, label):
    assert not names_aspect(aspect, ("OOD", label))


@pytest.mark.parametrize("path", [{"a": 1}.keys(), {"a": 1}.values(), frozenset("a")])
def test_a_path_without_an_order_is_refused(path):
    with pytest.raises(UsageError):
        names_aspect("fire", path)
