import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from oodscen.statistics._intervals import percentiles, share_bounds, wilson


@given(st.integers(0, 500), st.integers(1, 500))
def test_wilson_holds_the_share_mirrors_and_narrows(hits: int, more: int) -> None:
    n = hits + more
    low, high = wilson(hits, n)
    assert 0 <= low <= hits / n <= high <= 1
    assert (1 - high, 1 - low) == pytest.approx(wilson(n - hits, n))
    assert wilson(4 * hits, 4 * n)[1] - wilson(4 * hits, 4 * n)[0] < high - low
    assert wilson(hits, n, level=0.99)[0] <= low


def test_wilson_without_anything_knows_nothing() -> None:
    assert wilson(0, 0) == (0, 1)
    assert wilson(110, 130) == pytest.approx((0.7746, 0.8981), abs=5e-4)


def test_wilson_agrees_with_scipy() -> None:
    for hits, n in ((0, 7), (3, 10), (86, 130), (130, 130)):
        found = stats.binomtest(hits, n).proportion_ci(method="wilson")
        assert wilson(hits, n) == pytest.approx((found.low, found.high), abs=1e-12)


def test_intervals_do_not_pretend_where_all_agree_or_paths_are_few() -> None:
    perfect = share_bounds(130, 130, 13, np.ones(10))
    assert perfect is not None
    assert (perfect.method, perfect.units) == ("wilson", 13)
    assert perfect.low == pytest.approx(wilson(13, 13)[0], abs=1e-6)
    few = share_bounds(7, 20, 2, np.linspace(0, 1, 50))
    assert few is not None
    assert (few.method, few.units) == ("wilson", 20)
    assert share_bounds(0, 0, 0) is None


def test_five_paths_are_enough_for_a_bootstrap_and_four_are_not() -> None:
    found = np.linspace(0.2, 0.8, 50)
    assert percentiles(found, 4) is None
    assert percentiles(found, 5) is not None


def test_only_where_all_agree_a_path_counts_as_one_item() -> None:
    mixed, equal = share_bounds(7, 20, 10), share_bounds(20, 20, 10)
    assert mixed is not None
    assert equal is not None
    assert (mixed.method, mixed.units) == ("wilson", 20)
    assert (mixed.low, mixed.high) == pytest.approx(wilson(7, 20), abs=1e-6)
    assert equal.units == 10
