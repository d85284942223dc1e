"""Calibration on rates."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.errors import DataError
from oodscen.metrics._rarity.rate_calibration import calibrate, left_out
from oodscen.metrics._rarity.rates import PublishedRate


def rate(log10_km, kind="met"):
    km = 10.0**log10_km
    return PublishedRate(
        event="event", kind=kind, km=(km, km, km), source="own fleet", texts=("A deer.",)
    )


@settings(deadline=None)
@given(
    st.floats(0.5, 2.0),
    st.floats(-2.0, 2.0),
    st.lists(st.integers(0, 12), min_size=8, max_size=12, unique=True),
)
def test_a_linear_relation_is_found_and_leaves_no_error(slope, offset, halves):
    values = [half / 2 for half in halves]
    rates = [
        rate(offset + slope * x + place % 2, ("met", "own")[place % 2])
        for place, x in enumerate(values)
    ]
    found = calibrate(rates, values)
    assert found.slope == pytest.approx(slope, abs=1e-6)
    assert found.apply(3.0) == pytest.approx(offset + slope * 3.0, abs=1e-6)
    assert found.apply(3.0, "own") == pytest.approx(offset + 1.0 + slope * 3.0, abs=1e-6)
    assert abs(left_out(rates, values)).max() < 1e-6


def test_few_anchors_move_the_offset_alone():
    found = calibrate([rate(5.0), rate(6.0)], [4.0, 5.5])
    assert found.slope == 1.0
    assert found.apply(4.0) == pytest.approx(4.75)
    assert found.factor_left_out is None


def test_anchors_of_nearly_equal_estimates_move_the_offset_alone():
    estimates = [5.0, 5.2, 4.8, 5.3, 4.9, 5.1, 4.7]
    found = calibrate([rate(log10_km) for log10_km in (3, 6, 4, 5, 2, 7, 1)], estimates)
    assert found.slope == 1.0
    assert found.apply(5.0) == pytest.approx(4.0)


@pytest.mark.parametrize("slope", [-1.5, 0.0, 0.2, 5.0])
def test_rates_that_do_not_rise_as_the_estimates_do_are_refused(slope):
    estimates = [place / 2 for place in range(6)]
    rates = [rate(4.0 + slope * (x - 1.25)) for x in estimates]
    with pytest.raises(DataError, match=rf"slope is {slope:g}, not from 0.25 to 4"):
        calibrate(rates, estimates)
    assert calibrate(rates[1:], estimates[1:]).slope == 1.0


@settings(deadline=None)
@given(
    st.lists(st.tuples(st.floats(-1.0, 12.0), st.floats(-2.9, 14.9)), min_size=1, max_size=9),
    st.floats(-10.0, 20.0),
)
def test_a_calibrated_figure_is_one_that_a_rate_can_have(pairs, value):
    rates, estimates = [rate(log10_km) for _, log10_km in pairs], [x for x, _ in pairs]
    try:
        found = calibrate(rates, estimates)
    except DataError:
        found = calibrate(rates[:5], estimates[:5])
    assert -3.0 <= found.apply(value) <= found.apply(value + 1.0) <= 15.0
