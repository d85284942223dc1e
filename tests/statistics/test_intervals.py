import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from oodscen.statistics._intervals import (
    cluster_interval,
    percentile_interval,
    share_interval,
    wilson,
)


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
    for hits, n in ((0, 1), (1, 1), (0, 7), (3, 10), (86, 130), (130, 130)):
        found = stats.binomtest(hits, n).proportion_ci(method="wilson")
        assert wilson(hits, n) == pytest.approx((found.low, found.high), abs=1e-12)


def test_intervals_do_not_pretend_where_all_agree_or_paths_are_few() -> None:
    perfect = share_interval(130, 130, 13, np.ones(10))
    assert perfect is not None
    assert (perfect.method, perfect.units) == ("wilson", 13)
    assert perfect.low == pytest.approx(wilson(13, 13)[0], abs=1e-6)
    few = share_interval(7, 20, 2, np.linspace(0, 1, 50))
    assert few is not None
    assert (few.method, few.units) == ("wilson", 2)
    assert share_interval(0, 0, 0) is None


def test_five_paths_are_enough_for_a_bootstrap_and_four_are_not() -> None:
    found = np.linspace(0.2, 0.8, 50)
    assert cluster_interval(found, 4) is None
    assert cluster_interval(found, 5) == percentile_interval(found, 5, is_clustered=True)
    assert share_interval(7, 20, 5, found) == cluster_interval(found, 5)
    for hits in (0, 20):
        few, enough = share_interval(hits, 20, 4), share_interval(hits, 20, 5)
        assert few is not None
        assert enough is not None
        assert (few.units, enough.units) == (4, 5)


@given(st.integers(1, 12), st.integers(1, 12), st.integers(0, 144))
def test_without_replicates_a_path_counts_as_one_item(paths: int, each: int, hits: int) -> None:
    n = paths * each
    found, fewer = share_interval(hits % (n + 1), n, paths), share_interval(hits % (n + 1), n, 1)
    assert found is not None
    assert fewer is not None
    assert (found.method, found.units) == ("wilson", paths)
    ends = wilson(hits % (n + 1) / each, paths)
    assert (found.low, found.high) == pytest.approx(ends, abs=1e-6)
    assert found.high - found.low <= fewer.high - fewer.low + 1e-6


@given(st.integers(1, 300))
def test_nothing_and_everything_reach_the_ends(n: int) -> None:
    assert wilson(0, n)[0] == 0.0
    assert wilson(n, n)[1] == 1.0
    for hits in (0, n):
        found = share_interval(hits, n, min(n, 7))
        assert found is not None
        assert found.units == min(n, 7)


def test_an_interval_of_replicates_is_between_their_quantiles_and_says_what_was_drawn() -> None:
    found = np.r_[np.arange(1001.0), np.nan]
    for is_clustered, method in ((False, "bootstrap"), (True, "cluster bootstrap")):
        interval = percentile_interval(found, 9, is_clustered=is_clustered)
        assert (interval.low, interval.high, interval.units) == (25.0, 975.0, 9)
        assert (interval.method, interval.is_clustered) == (method, is_clustered)


def test_ends_are_rounded_to_six_digits() -> None:
    found = np.linspace(1 / 7, 6 / 7, 50)
    ends = [round(end, 6) for end in np.quantile(found, [0.025, 0.975]).tolist()]
    interval = percentile_interval(found, 9, is_clustered=False)
    assert [interval.low, interval.high] == ends
    shared = share_interval(7, 20, 3)
    assert shared is not None
    assert [shared.low, shared.high] == [round(end, 6) for end in wilson(7 * 3 / 20, 3)]


def test_replicates_without_spread_or_without_values_give_no_interval() -> None:
    assert cluster_interval(np.ones(40), 9) is None
    assert cluster_interval(np.full(40, np.nan), 9) is None


@given(st.integers(1, 4), st.integers(5, 80))
def test_few_hits_are_told_no_more_surely_than_none(hits: int, paths: int) -> None:
    """Replicates cannot have a hit of a path that had none, however many are drawn."""
    n, replicates = 10 * paths, np.linspace(0.0, 2 * hits / (10 * paths), 200)
    none, few = (share_interval(count, n, paths, replicates) for count in (0, hits))
    lost = share_interval(n - hits, n, paths, 1.0 - replicates)
    assert none
    assert few
    assert lost
    assert {one.method for one in (none, few, lost)} == {"wilson"}
    assert few.high >= none.high
    assert lost.low <= 1.0 - none.high + 1e-6
