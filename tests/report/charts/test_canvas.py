"""Axes, numbers and words of a chart."""

from hypothesis import given
from hypothesis import strategies as st

from oodscen.report._charts.canvas import linear, px, short, signed, whole_axis


@given(st.integers(0, 10**30), st.integers(0, 10**30))
def test_an_axis_of_whole_numbers_holds_its_values_in_a_few_round_steps(first: int, other: int):
    low, high = sorted((first, other))
    bottom, top, step = whole_axis(low, high)
    assert bottom <= low <= high <= top
    assert bottom % step == top % step == 0
    assert 1 <= (top - bottom) // step <= 6
    assert str(step).rstrip("0") in {"1", "2", "25", "5"}


def test_the_steps_of_large_trees_fit_them():
    assert whole_axis(500, 3_000) == (0, 3_000, 1_000)


@given(st.floats(-1e6, 1e6), st.floats(1e-3, 1e6), st.floats(-1e3, 1e3), st.floats(-1e3, 1e3))
def test_the_ends_of_a_linear_map_meet_the_ends_of_its_axis(low, span, start, end):
    along = linear(low, low + span, start, end)
    assert along(low) == start
    assert abs(along(low + span) - end) < 1e-6


@given(st.floats(-1e6, 1e6), st.integers(0, 6))
def test_a_number_in_words_reads_as_itself_and_never_as_minus_nought(value, digits):
    text = signed(value, digits)
    assert float(text.replace("\N{MINUS SIGN}", "-")) == round(value, digits)
    assert not text.startswith("\N{MINUS SIGN}0") or float(text[1:]) > 0
    assert "-" not in text


def test_coordinates_are_short():
    assert [px(value) for value in (3.0, 3.04, 3.25)] == ["3", "3", "3.2"]


@given(st.text(), st.integers(1, 40))
def test_long_words_are_cut(text, most):
    cut = short(text, most)
    assert len(cut) == min(len(text), most)
    assert cut == text or (cut.endswith("…") and text.startswith(cut[:-1]))
