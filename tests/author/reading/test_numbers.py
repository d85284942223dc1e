"""Numbers: read whole or not at all."""

import re

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from oodscen.author._reading.numbers import NUMBER, number_at, whole_number

ONES = "zero one two three four five six seven eight nine".split()
TEENS = "ten eleven twelve thirteen fourteen fifteen sixteen seventeen eighteen nineteen".split()
TENS = "- - twenty thirty forty fifty sixty seventy eighty ninety".split()


def in_words(number, *, joint="-", link=" and "):
    if number < 10:
        return ONES[number]
    if number < 20:
        return TEENS[number - 10]
    if number < 100:
        return TENS[number // 10] + (joint + ONES[number % 10] if number % 10 else "")
    if number == 1000:
        return "one thousand"
    rest = link + in_words(number % 100, joint=joint, link=link) if number % 100 else ""
    return f"{ONES[number // 100]} hundred{rest}"


@given(st.integers(1, 1000), st.sampled_from("- "), st.sampled_from((" and ", " ")))
def test_every_number_is_read_in_digits_and_in_words(number, joint, link):
    words = in_words(number, joint=joint, link=link)
    assert whole_number(words) == whole_number(words.upper()) == number
    assert whole_number(str(number)) == whole_number(f"{number}.0") == number


@given(st.integers(1, 999), st.sampled_from("- "))
def test_a_number_is_matched_whole(number, joint):
    for words in (in_words(number, joint=joint), str(number), f"{number}.5", f"{number},000"):
        assert re.match(NUMBER, f"{words} metres").group(0) == words


@pytest.mark.parametrize(
    "words",
    "0|00|007|1001|1,001|10,5|12.25|2.500|1.000|0.5|half|zero|hundred|٥٠|fifty hundred|two thousand"
    "|one two|twenty ten|and|a|".split("|"),
)
def test_what_is_no_whole_number_up_to_a_thousand_is_none(words):
    assert whole_number(words) is None


@pytest.mark.parametrize(
    "lead",
    [
        "50 to",
        "50 or",
        "fifty to",
        "50 -",
        "between",
        "less than",
        "more than",
        "over",
        "within",
        "up to",
        "not even",
        "twice",
        "60 km and",
        "60 metres plus",
        "1 in",
        "10 metres by",
    ],
)
def test_a_bound_and_an_end_of_a_range_are_none(lead):
    text = f"It is {lead} 60"
    assert number_at(text, len(text) - 2, len(text)) is None


SIGNS = st.characters(categories=["P", "S"])
ENDS = ".;!?()[]"
"""Signs that end a clause."""
BLANKS = st.sampled_from(["", " ", "\u00a0"])


@given(
    st.sampled_from(["60", "sixty", "6.5"]),
    st.sampled_from(["", " metres", "m", " km"]),
    BLANKS,
    st.text(SIGNS, min_size=1, max_size=3).filter(lambda signs: not set(signs) & set(ENDS)),
    BLANKS,
)
@example("60", "", " ", "_", " ")
@example("60", " metres", " ", "±", " ")
@example("60", "", "", "…", " ")
def test_no_sign_between_two_numbers_leaves_the_second(first, unit, before, signs, after):
    lead = f"A box is {first}{unit}{before}{signs}{after}"
    text = f"{lead}5 metres ahead"
    assert number_at(text, len(lead), len(lead) + 1) is None


@given(SIGNS.filter(lambda sign: sign not in ".,:;!?)]}\"'”’([“‘–—-"), BLANKS)
@example("_", " ")
def test_only_signs_of_sentences_stand_before_a_number(sign, blank):
    lead = f"A box is {sign}{blank}"
    assert number_at(f"{lead}5 metres ahead", len(lead), len(lead) + 1) is None


@given(
    st.sampled_from(["A box stands", "a two-lane road", "of three lorries", "Ten cows (large)"]),
    st.sampled_from([" ", ", ", "; ", ". ", ": ", " - ", " – ", "—", " — ", " (", ' "', ", ("]),
)
def test_a_number_may_begin_after_words_and_signs_of_sentences(words, sign):
    lead = words + sign
    assert number_at(f"{lead}60 metres ahead", len(lead), len(lead) + 2) == 60


@pytest.mark.parametrize("lead", ["about", "some", "a good", "the lane is one of two;", "At noon,"])
def test_other_words_before_a_number_leave_it(lead):
    text = f"{lead} 60"
    assert number_at(text, len(text) - 2, len(text)) == 60


@given(
    st.characters(categories=["L", "M", "N", "S", "P"]).filter(
        lambda sign: sign not in ".,:;!?)]}\"'”’–—-mM"
    )
)
@example("O")
@example("²")
@example("%")
def test_a_number_with_anything_but_a_sign_of_sentences_or_metres_behind_it_is_none(sign):
    assert number_at(f"a box 60{sign} ahead", 6, 8) is None


@pytest.mark.parametrize(
    "after", ["", " ", ".", ", ", "; ", ") ", "m", " m", "-metre", "\u00a0m", "—"]
)
def test_a_number_ends_at_a_blank_a_sign_of_sentences_or_metres(after):
    assert number_at(f"a box 60{after}", 6, 8) == 60


@pytest.mark.parametrize("after", [".5 m", ",5 m", ":30", "mm²", "O m", "'5"])
def test_half_of_a_number_is_none(after):
    assert number_at(f"a box 60{after}", 6, 8) is None
