"""Sentences of courtesy say nothing, and all others are kept."""

import pytest

from oodscen import Metrics
from oodscen.metrics._rarity.words import without_courtesy
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
        ("", ""),
    ],
)
def test_only_sentences_of_courtesy_are_dropped(text, kept):
    assert without_courtesy(text) == kept
    assert without_courtesy(kept) == kept


def test_courtesy_does_not_change_an_estimate():
    metrics = Metrics(HashEncoder(64), ["A car waits at the light.", "A van drives ahead."])
    bare, courteous = metrics.rarity(
        [
            "A sofa lies in the lane.",
            "Hello there. A sofa lies in the lane. Thank you, kind regards.",
        ]
    ).per_text
    assert bare.best == pytest.approx(courteous.best, abs=0.011)
