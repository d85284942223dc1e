import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from oodscen.statistics._resampling import wilson
from oodscen.statistics._tests import (
    Resampler,
    above_chance,
    auroc,
    d_prime,
    holm,
    intraclass,
    mcnemar,
    paired,
    percentiles,
    share_bounds,
    sign_flip,
    two_proportions,
)

COUNTS = st.integers(0, 60)


@given(COUNTS, COUNTS)
def test_mcnemar_is_a_symmetric_p_and_mid_p_is_the_smaller(a: int, b: int) -> None:
    exact, mid = mcnemar(a, b)
    assert 0 < mid <= exact <= 1
    assert mcnemar(b, a) == pytest.approx((exact, mid))
    if a == b:
        assert mid == 1


def test_mcnemar_agrees_with_the_binomial_test() -> None:
    for a, b in ((19, 0), (63, 44), (5, 12), (1, 0), (700, 640)):
        expected = stats.binomtest(min(a, b), a + b).pvalue
        assert mcnemar(a, b)[0] == pytest.approx(expected, rel=1e-9)
        mid = expected - stats.binom.pmf(min(a, b), a + b, 0.5)
        assert mcnemar(a, b)[1] == pytest.approx(mid, rel=1e-9)


@given(st.lists(st.floats(0, 1), max_size=12))
def test_holm_never_lowers_keeps_order_and_is_at_most_bonferroni(values: list[float]) -> None:
    found = holm(values)
    for raw, corrected in zip(values, found, strict=True):
        assert raw <= corrected <= min(1.0, raw * len(values)) + 1e-12 or corrected == 1
    order = sorted(range(len(values)), key=lambda index: values[index])
    assert [found[i] for i in order] == sorted(found)


def test_holm_by_hand() -> None:
    assert holm([0.04, 0.01, 0.03]) == pytest.approx([0.06, 0.03, 0.06])


def test_swapping_two_answerers_changes_the_sign_only() -> None:
    rng = np.random.default_rng(0)
    first, second = rng.integers(0, 2, (2, 60)).astype(float)
    first[:4] = np.nan
    clusters = [f"path-{index // 5}" for index in range(60)]
    one, two = paired(first, second, clusters), paired(second, first, clusters)
    assert one.n == two.n == 56
    assert one.difference == pytest.approx(-two.difference)
    assert (one.first_only, one.second_only) == (two.second_only, two.first_only)
    assert one.p_mcnemar == pytest.approx(two.p_mcnemar)
    assert one.p_clustered == pytest.approx(two.p_clustered)


def test_flipping_single_items_is_mcnemars_exact_test() -> None:
    gaps = np.array([1.0] * 8 + [-1.0] * 2 + [0.0] * 30)
    assert sign_flip(gaps) == pytest.approx(mcnemar(8, 2)[0])


def test_whole_paths_count_for_less_than_their_scenes() -> None:
    gaps = np.array([1.0] * 30)
    clusters = [f"{index // 10}" for index in range(30)]
    assert sign_flip(gaps) < 0.001
    assert sign_flip(gaps, clusters) == pytest.approx(2 / 2**3)
    assert sign_flip(np.zeros(0)) == 1


def test_a_clustered_interval_is_wider_where_paths_are_alike() -> None:
    clusters = [f"{index // 10}" for index in range(200)]
    alike = np.repeat(np.arange(20) % 2, 10).astype(float)[:, None]
    mixed = np.tile(np.arange(10) % 2, 20).astype(float)[:, None]
    resampler = Resampler(clusters)
    ones = np.ones((200, 1))
    wide = percentiles(resampler.ratios(alike, ones)[:, 0], 20)
    assert wide is not None
    low, high = wilson(100, 200)
    assert wide.high - wide.low > 2 * (high - low)
    assert percentiles(resampler.ratios(mixed, ones)[:, 0], 20) is None
    assert intraclass(alike[:, 0], clusters) == pytest.approx(1)
    assert intraclass(mixed[:, 0], clusters) == 0


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


@given(st.lists(st.integers(1, 6), min_size=2, max_size=6), st.integers(0, 99))
def test_the_intraclass_correlation_follows_from_the_analysis_of_variance(
    sizes: list[int], seed: int
) -> None:
    groups = [np.random.default_rng([seed, i]).normal(size=n) for i, n in enumerate(sizes)]
    clusters = [str(i) for i, group in enumerate(groups) for _ in group]
    found = intraclass(np.concatenate(groups), clusters)
    if max(sizes) == 1:
        assert found is None
        return
    ratio = stats.f_oneway(*groups).statistic
    mean = np.mean(sizes)
    # Donner's n0, written as the mean size less its relative variance.
    size = mean - np.var(sizes, ddof=1) / (len(sizes) * mean)
    assert found == pytest.approx(min(max((ratio - 1) / (ratio - 1 + size), 0.0), 1.0), abs=1e-9)


def test_a_permutation_test_is_never_certain() -> None:
    assert sign_flip(np.ones(30), replicates=500) == pytest.approx(1 / 501)


@given(st.integers(1, 80), st.integers(1, 80), st.data())
def test_two_proportions_agree_with_the_chi_square_test(
    n: int, m: int, data: st.DataObject
) -> None:
    one, two = data.draw(st.integers(0, n)), data.draw(st.integers(0, m))
    table = np.array([[one, n - one], [two, m - two]])
    if 0 in table.sum(axis=0):
        assert two_proportions(one, n, two, m) == 1
    else:
        expected = stats.chi2_contingency(table, correction=False).pvalue
        assert two_proportions(one, n, two, m) == pytest.approx(expected, abs=1e-9)


def test_the_same_seed_gives_the_same_draws() -> None:
    clusters = list("aabbccddee")
    assert (Resampler(clusters, seed=3).weights == Resampler(clusters, seed=3).weights).all()
    assert (Resampler(clusters, seed=3).weights != Resampler(clusters, seed=4).weights).any()
    assert Resampler([]).ratios(np.zeros((0, 2)), np.zeros((0, 2))).shape == (2000, 2)


@given(COUNTS, COUNTS, COUNTS, COUNTS)
def test_d_prime_is_finite_and_changes_sign_with_the_roles(a: int, b: int, c: int, d: int) -> None:
    found = d_prime(a, a + b, c, c + d)
    if a + b == 0 or c + d == 0:
        assert found is None
    else:
        assert found is not None
        assert math.isfinite(found)
        assert found == pytest.approx(-(d_prime(c, c + d, a, a + b) or 0.0))


def test_d_prime_of_an_always_ood_answerer_is_nil() -> None:
    assert d_prime(130, 130, 130, 130) == pytest.approx(0)


@given(
    st.lists(st.sampled_from([0.0, 0.3, 0.5, 1.0]), min_size=1, max_size=12),
    st.lists(st.sampled_from([0.0, 0.3, 0.5, 1.0]), min_size=1, max_size=12),
)
def test_auroc_counts_pairs(signal: list[float], noise: list[float]) -> None:
    scores = np.array([*signal, *noise])
    mask = np.array([True] * len(signal) + [False] * len(noise))
    wins = sum((s > n) + 0.5 * (s == n) for s in signal for n in noise)
    found = auroc(scores, mask)
    assert found is not None
    assert found[0] == pytest.approx(wins / len(signal) / len(noise))


def test_auroc_resamples_whole_paths() -> None:
    rng = np.random.default_rng(1)
    mask = np.tile([True, False], 100)
    scores = rng.normal(size=200) + mask
    clusters = [f"{index // 10}" for index in range(200)]
    found = auroc(scores, mask, Resampler(clusters))
    assert found is not None
    area, bounds = found
    assert bounds is not None
    assert bounds.low < area < bounds.high
    assert auroc(scores, np.ones(200, np.bool_)) is None


def test_the_interval_of_an_auroc_is_that_of_the_sets_drawn() -> None:
    rng = np.random.default_rng(2)
    mask = rng.integers(0, 2, 60).astype(bool)
    scores = np.round(rng.normal(size=60) + mask, 1)
    clusters = [f"{index // 7}" for index in range(60)]
    resampler = Resampler(clusters, replicates=40)
    areas = []
    for row in resampler.weights.astype(int).tolist():
        drawn = [
            i
            for unit, times in enumerate(row)
            for _ in range(times)
            for i in range(60)
            if i // 7 == unit
        ]
        area = stats.mannwhitneyu(scores[drawn][mask[drawn]], scores[drawn][~mask[drawn]]).statistic
        areas.append(area / mask[drawn].sum() / (~mask[drawn]).sum())
    found = auroc(scores, mask, resampler)
    assert found is not None
    assert found[1] is not None
    assert (found[1].low, found[1].high) == pytest.approx(
        tuple(np.quantile(areas, [0.025, 0.975])), abs=1e-6
    )


def test_chance_is_nought_and_perfect_is_one() -> None:
    assert above_chance(0.4, 0.4) == 0
    assert above_chance(1.0, 0.4) == 1
    assert above_chance(1.0, 1.0) is None
    assert above_chance(0.0, 0.5) == -1


def test_two_proportions_of_the_papers_best_and_worst() -> None:
    assert two_proportions(86, 130, 66, 130) == pytest.approx(0.0118, abs=5e-4)
    assert two_proportions(5, 5, 7, 7) == 1
