"""Laws of reading: what does not matter in a text changes no claim and no hazard."""

import re
import unicodedata
from itertools import permutations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.author._reading.claim_extraction import read_claims

SETTINGS = (
    "It rains heavily.",
    "It is night.",
    "The ego drives on a two-lane country road.",
    "The ego is on a motorway with three lanes per direction.",
)
THINGS = (
    "A cardboard box lies in the centre of the ego's lane 60 metres ahead.",
    "A lorry stops in the ego's lane thirty metres further on.",
    "Two dogs cross the road from the left.",
    "A child steps from the right-hand kerb into the ego's lane.",
    "An ambulance with its beacon on comes from behind.",
    "A grey tyre lies beside the road about forty-five metres down the road.",
    "A pedestrian crossing the road stops.",
    "An old cyclist's bicycle lies in front of a café.",
)
IRRELEVANT = (
    "The radio is on.",
    "Nobody else is hurt.",
    "(Scenario 12)",
    "The ego has 2 seats.",
    "The tank is half full.",
)
DIGITS = {"thirty": "30", "forty-five": "45", "two": "2", "three": "3"}
AMERICAN = {"centre": "center", "metre": "meter", "kerb": "curb", "grey": "gray", "tyre": "tire"}


def words_replaced(words):
    def replaced(text):
        for old, new in words.items():
            text = re.sub(old, new, text, flags=re.IGNORECASE)
        return text

    return replaced


REWORDINGS = {
    "no-break spaces": lambda text: text.replace(" ", "\u00a0"),
    "lines": lambda text: text.replace(" ", "\r\n"),
    "curly apostrophes": lambda text: text.replace("'", "\u2019"),
    "hyphens": lambda text: text.replace("-", "\u2010"),
    "hyphens that do not break": lambda text: text.replace("-", "\u2011"),
    "decomposed accents": lambda text: unicodedata.normalize("NFD", text),
    "capitals": str.upper,
    "small letters": str.lower,
    "digits": words_replaced(DIGITS),
    "American spelling": words_replaced(AMERICAN),
    "a truck": words_replaced({"lorry": "truck"}),
    "m": words_replaced({" metres": " m"}),
    "no full stop": lambda text: text.rstrip("."),
}


def told(text):
    return {(claim.kind, claim.value, claim.subject) for claim in read_claims(text)}


@pytest.mark.parametrize("rewording", REWORDINGS)
def test_another_way_of_writing_changes_no_claim(rewording):
    for text in (*SETTINGS, *THINGS):
        assert told(REWORDINGS[rewording](text)) == told(text) != set()


@given(st.sampled_from(SETTINGS), st.sampled_from(THINGS), st.sampled_from(IRRELEVANT))
def test_independent_sentences_may_stand_in_any_order(setting, thing, irrelevant):
    expected = told(setting) | told(thing)
    for sentences in permutations((setting, thing, irrelevant)):
        assert told(" ".join(sentences)) == expected


@pytest.mark.parametrize(
    ("text", "thing"),
    [
        ("A truck stops ahead.", "lorry"),
        ("The bus stops in the ego's lane.", "bus"),
        ("Two buses stop ahead.", "bus"),
        ("In front of the shop a car parks.", "car"),
        ("A deer crossing the road stands still.", "deer"),
        ("A cyclist crossing the road falls.", "cyclist"),
        ("Beside the bus stops nothing happens.", None),
        ("The bus stops are empty, and so is the truck stop.", None),
        ("The ego waits at a pedestrian crossing in the city.", None),
        ("Near the car parks and the tram lines nobody moves.", None),
    ],
)
def test_a_noun_with_its_verb_is_no_compound(text, thing):
    assert {subject for _, _, subject in told(text) if subject} == ({thing} if thing else set())


@pytest.mark.parametrize(
    ("text", "is_empty"),
    [
        ("Nobody else is on the road.", True),
        ("No one else is in sight.", True),
        ("There is nobody else.", True),
        ("Nobody else is hurt.", False),
        ("Nobody else brakes.", False),
    ],
)
def test_a_road_without_others_is_one_on_which_nobody_else_is(text, is_empty):
    assert told(text) == ({("traffic", "none", "")} if is_empty else set())


def test_a_number_after_a_label_of_the_author_changes_no_hazard(knowledge, recogniser):
    for hazard in knowledge.hazards:
        label = hazard.label
        assert recogniser.covered_by(f"{label} (2)") == recogniser.covered_by(label)
    assert recogniser.covered_by("Truck tire lying in the lane") == recogniser.covered_by(
        "Truck tyre lying in the lane"
    )
