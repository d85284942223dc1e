"""Short texts of models: refusals, marks of lists and options are found, what a driver says is not."""

import pytest

from oodscen._words.wording import appearance_fault, description_fault, wording_fault

DECLINED = (
    "Unfortunately, I cannot fulfil this request.",
    "I cannot provide such content.",
    "I'm sorry, but I can\N{RIGHT SINGLE QUOTATION MARK}t describe accidents.",
    "I can't write about collisions with pedestrians.",
    "I am unable to describe violent traffic accidents.",
    "I apologize, but I can't create texts about harm.",
    "This request violates the content policy.",
    "Sorry, but describing injuries is against my guidelines.",
)
TOLD = (
    "I cannot stop in time because a cow lies across my lane.",
    "Unfortunately, I cannot see past the lorry ahead of me.",
    "I'm sorry for the cyclist who slips on the ice ahead of my car.",
    "Two-lane rural road at dusk: a fallen tree bars ego's lane 65 m ahead.",
    "A driver who ignores the rules of the road cuts in against the traffic.",
    "A text on the sign says that the bridge is closed.",
)


@pytest.mark.parametrize("text", DECLINED)
def test_words_that_decline_to_be_a_text_are_a_refusal(text):
    assert "is a refusal" in description_fault(text)


@pytest.mark.parametrize("text", TOLD)
def test_what_a_driver_tells_is_a_text(text):
    assert not description_fault(text)


@pytest.mark.parametrize("mark", ["Text 1: ", "Scenario: ", "#1 ", "#12. ", "1. ", "B) ", "- "])
def test_the_mark_of_a_list_is_found(mark):
    assert "mark of a list" in description_fault(f"{mark}A cow stands in the lane.")


@pytest.mark.parametrize("text", ["A cow stands {distance} m ahead.", "{fog}", "a{b}c", "{{ x }}"])
def test_braces_are_no_plain_words(text):
    assert "markup" in wording_fault(text)


@pytest.mark.parametrize(
    "text",
    [
        "x.com crate",
        "10.0.0.1",
        "a net at localhost:8000",
        "a crate (A)",
        "a crate, B) a dog",
        "none of these",
    ],
)
def test_a_made_thing_reads_like_no_option_and_no_address(text):
    assert appearance_fault(text)


@pytest.mark.parametrize(
    "text", ["a crate (red)", "a crate of 1.5 m", "a St. Bernard dog", "a sign that reads: 50"]
)
def test_a_made_thing_may_have_brackets_and_stops(text):
    assert not appearance_fault(text)
