"""Shares, intervals and differences as people write them."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.judging._leaderboard.rows import Estimate
from oodscen.judging._rates_in_words import bracketed_points, lead, number_of
from oodscen.statistics._intervals import Interval

SHARES = st.floats(-1.0, 1.0)


@given(SHARES)
def test_a_lead_says_how_much_and_which_way(difference: float) -> None:
    words = lead(difference, "it")
    points = round(100 * difference)
    if points == 0:
        assert words == "as many as it"
    else:
        found = re.fullmatch(r"(\d+) percentage (points?) (more|fewer) than it", words)
        assert found
        assert int(found[1]) == abs(points)
        assert (found[2] == "point") == (abs(points) == 1)
        assert (found[3] == "more") == (points > 0)


@given(SHARES, SHARES)
def test_zero_has_no_sign_in_an_interval(low: float, high: float) -> None:
    words = bracketed_points(
        Estimate(interval=Interval(low=low, high=high, method="wilson", units=2))
    )
    for number in re.findall(r"[+\N{MINUS SIGN}]?\d+", words):
        assert (number[0] in "+\N{MINUS SIGN}") == (number.strip("+\N{MINUS SIGN}") != "0")


@pytest.mark.parametrize(("count", "words"), [(0, "0 scenes"), (1, "1 scene"), (2, "2 scenes")])
def test_a_count_agrees_with_its_noun(count: int, words: str) -> None:
    assert number_of(count, "scene") == words
