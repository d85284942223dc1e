"""The probability that a verdict states."""

from hypothesis import given
from hypothesis import strategies as st

from oodscen.data import Verdict


def verdict(is_ood, confidence):
    return Verdict(id="a@b", scene_id="a", model="b", is_ood=is_ood, confidence=confidence)


@given(st.none() | st.floats(0, 1))
def test_yes_and_no_with_one_confidence_are_complements(confidence):
    yes, no = verdict(True, confidence).p_ood, verdict(False, confidence).p_ood
    assert yes == (1.0 if confidence is None else confidence)
    assert no == 1.0 - yes


def test_without_an_answer_there_is_no_probability():
    assert verdict(None, 0.7).p_ood is None
