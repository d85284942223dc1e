"""Words are whole words of any alphabet; sentences of courtesy say nothing, and all others are kept."""

from unicodedata import normalize

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen import Metrics
from oodscen.metrics._rarity.words import Words, stems, without_courtesy
from oodscen.testing._encoder import HashEncoder


@pytest.mark.parametrize(
    ("text", "kept"),
    [
        (
            "Dear all, good morning. A deer stands in the lane. Kind regards.",
            "A deer stands in the lane.",
        ),
        ("Sorry to bother you! A van brakes. Many thanks for your time.", "A van brakes."),
        ("Please read the following: A van brakes.", "A van brakes."),
        ("Please stop at the line. A van brakes.", "Please stop at the line. A van brakes."),
        ("It is evening. A van brakes.", "It is evening. A van brakes."),
        ("Thank you very much.", "Thank you very much."),
        ("Sorry, 前方有一辆车. A van brakes.", "Sorry, 前方有一辆车. A van brakes."),
        ("", ""),
    ],
)
def test_only_sentences_of_courtesy_are_dropped(text, kept):
    assert without_courtesy(text) == kept
    assert without_courtesy(kept) == kept


KNOWN = Words(["car", "on", "fire", "caf"], np.ones(4))


@given(st.text("caronfire é火1_-' "))
def test_a_share_of_words_is_one_of_the_whole_whatever_joins_them(text):
    assert 0.0 <= KNOWN.known_share(text) <= 1.0
    assert KNOWN.known_share(text) == KNOWN.known_share(text.replace("_", " "))


def test_a_part_of_a_word_is_no_word():
    assert KNOWN.known_share("œuf caføn") == 0.0
    assert KNOWN.known_share("car_brennt_heute_abend") == 0.25


@pytest.mark.parametrize("form", ["NFC", "NFD"])
def test_accents_change_no_word(form):
    assert stems(normalize(form, "A naïve driver at a Café")) == stems("a naive driver at a cafe")


def test_courtesy_does_not_change_an_estimate():
    metrics = Metrics(HashEncoder(64), ["A car waits at the light.", "A van drives ahead."])
    bare, courteous = metrics.rarity(
        [
            "A sofa lies in the lane.",
            "Hello there. A sofa lies in the lane. Thank you, kind regards.",
        ]
    ).per_text
    assert bare.best == pytest.approx(courteous.best, abs=0.011)
