"""Calibration on rates."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.errors import DataError, UsageError
from oodscen.metrics._rarity.anchors import (
    PublishedRate,
    calibrate,
    chosen_rates,
    left_out,
    load_rates,
    published_rates,
)


def rate(log10_km, kind="met"):
    km = 10.0**log10_km
    return PublishedRate(
        event="event", kind=kind, km=(km, km, km), source="own fleet", texts=("A deer.",)
    )


@settings(deadline=None)
@given(
    st.floats(0.5, 2.0),
    st.floats(-2.0, 2.0),
    st.lists(st.integers(0, 60), min_size=8, max_size=12, unique=True),
)
def test_a_linear_relation_is_found_and_leaves_no_error(slope, offset, tenths):
    values = [tenth / 10 for tenth in tenths]
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


def test_published_rates_have_sources_and_five_wordings():
    rates = published_rates()
    assert len({one.number for one in rates}) == len(rates) == 53
    assert all(len(set(one.texts)) == 5 for one in rates)
    assert {one.kind for one in rates} == {"own", "occurring", "met"}


@pytest.mark.parametrize(
    "content",
    ["", "rate = 3", "[[rate]]\nevent = 'x'", "[[rate", "[[rate]]\nevent='x'\nkm=[3,2,1]\nsource='s'\ntexts=['t']",
     "[[rate]]\nevent='x'\nkm=[1e-300,1,2]\nsource='s'\ntexts=['t']",
     "[[rate]]\nevent='x'\nkm=[1,2,'3 miles']\nsource='s'\ntexts=['t']",
     2 * "[[rate]]\nnumber=4\nevent='x'\nkm=[1,2,3]\nsource='s'\ntexts=['t']\n"],
)  # fmt: skip
def test_malformed_files_are_refused(content, tmp_path):
    file = tmp_path / "rates.toml"
    file.write_text(content)
    with pytest.raises(DataError):
        load_rates(file)


def test_rates_from_a_file(tmp_path):
    file = tmp_path / "rates.toml"
    file.write_text(
        "[[rate]]\nevent='deer'\nkm=[1e5,2e5,4e5]\nsource='fleet'\ntexts=['A deer jumps out.']"
    )
    (found,) = load_rates(file)
    assert found.kind == "met"
    assert found.log10_km == pytest.approx(5.30103)


def test_rates_are_named_given_or_in_a_file(tmp_path):
    assert chosen_rates(None) is None
    assert chosen_rates("published") == published_rates()
    assert chosen_rates(list(published_rates())) == published_rates()
    with pytest.raises(DataError):
        chosen_rates([])
    with pytest.raises(DataError):
        chosen_rates(tmp_path / "missing.toml")
    for other in (["x"], 5, {"rate": 1.0}):
        with pytest.raises(UsageError, match="anchors"):
            chosen_rates(other)
