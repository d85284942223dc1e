"""Sheets: a row per thing, in an order that tells nothing unless captions are asked for."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.errors import UsageError
from oodscen.stages._making.looking import DISTANCES_M, PropLook, PropView, ShownProp
from oodscen.stages._making.sheet import caption, row_order, sheet, views_of


def shown(name, grey):
    views = tuple(
        PropView(distance_m=distance, is_night=is_night, pixels=300, contrast=40.0)
        for is_night in (False, True)
        for distance in DISTANCES_M
    )
    picture = np.full((48, 64, 3), grey, np.uint8)
    return ShownProp(PropLook(id=name, views=views), (picture,) * len(views))


THINGS = [shown("low_wall", 90), shown("thin_post", 140), shown("kerb", 200)]


def test_captions_change_the_words_and_the_order_alone():
    named, blind = sheet(THINGS, captions=True), sheet(THINGS)
    assert named.shape == blind.shape
    assert not np.array_equal(named, blind)
    for grey in (90, 140, 200):
        assert np.count_nonzero(named == grey) == np.count_nonzero(blind == grey) > 0


def test_a_sheet_of_nothing_is_refused():
    with pytest.raises(UsageError, match="nothing to show"):
        sheet([])


@given(st.integers(0, 30), st.integers(0, 9))
def test_the_order_of_rows_is_a_permutation_that_the_seed_fixes(count, seed):
    assert sorted(row_order(count, seed)) == list(range(count))
    assert row_order(count, seed) == row_order(count, seed)


@given(st.text("abz AZ09-", max_size=300), st.integers(40, 900))
def test_a_caption_is_as_wide_as_its_row_whatever_it_says(text, width):
    assert caption(text, width).shape[1:] == (width, 3)


def test_a_thing_is_shown_by_day_above_and_by_night_below():
    picture = views_of(THINGS[0])
    one = views_of(shown("x", 1)).shape
    assert picture.shape == one == (48, 32 * len(DISTANCES_M), 3)
