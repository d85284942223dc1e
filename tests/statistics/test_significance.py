import itertools
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats
from statsmodels.stats import contingency_tables
from statsmodels.stats.multitest import multipletests

from oodscen.statistics._significance import holm, mcnemar, paired_test, permutation_test, sign_flip

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
    one, two = paired_test(first, second, clusters), paired_test(second, first, clusters)
    assert one.n == two.n == 56
    assert one.difference == pytest.approx(-two.difference)
    assert (one.first_only, one.second_only) == (two.second_only, two.first_only)
    assert one.p_mcnemar == pytest.approx(two.p_mcnemar)
    assert one.p_clustered == pytest.approx(two.p_clustered)


ANSWERS = st.sampled_from((0.0, 1.0, float("nan")))


@given(
    st.lists(st.tuples(ANSWERS, ANSWERS, st.booleans(), st.integers(0, 3)), min_size=1),
    st.randoms(use_true_random=False),
)
def test_two_classes_weigh_alike_as_in_balanced_accuracy(items, random) -> None:
    def compared(rows):
        first, second, classes, paths = map(np.array, zip(*rows, strict=True))
        labels = [str(path) for path in paths]
        return paired_test(first, second, labels, classes=classes), (first, second, classes)

    found, (first, second, classes) = compared(items)
    has_both = np.isfinite(first) & np.isfinite(second)
    sides = [side & has_both for side in (classes, ~classes) if (side & has_both).any()]
    shares = [first[side].mean() - second[side].mean() for side in sides]
    assert found.difference == pytest.approx(np.mean(shares) if shares else 0.0)
    moved = random.sample(items, len(items))
    assert compared(moved)[0] == found
    if len({int(side.sum()) for side in sides}) == 1:
        plain = paired_test(first, second, [str(path) for *_, path in items])
        assert found == plain


@settings(max_examples=30)
@given(st.lists(st.integers(-2, 9), min_size=4, max_size=18), st.booleans(), st.data())
def test_the_order_of_the_items_changes_no_p(gaps: list[int], clustered: bool, data) -> None:
    values = np.array(gaps, float)
    order = data.draw(st.permutations(range(len(gaps))))
    labels = [str(place // 2) for place in range(len(gaps))] if clustered else None
    moved = [labels[place] for place in order] if labels else None
    assert sign_flip(values, labels, replicates=99) == sign_flip(
        values[order], moved, replicates=99
    )
    zero = np.zeros(3)
    one = permutation_test(values, zero, (labels, None), replicates=99)
    assert one == permutation_test(values[order], zero, (moved, None), replicates=99)


def test_flipping_single_items_is_mcnemars_exact_test() -> None:
    gaps = np.array([1.0] * 8 + [-1.0] * 2 + [0.0] * 30)
    assert sign_flip(gaps) == pytest.approx(mcnemar(8, 2)[0])


def test_whole_paths_count_for_less_than_their_scenes() -> None:
    gaps = np.array([1.0] * 30)
    clusters = [f"{index // 10}" for index in range(30)]
    assert sign_flip(gaps) < 0.001
    assert sign_flip(gaps, clusters) == pytest.approx(2 / 2**3)
    assert sign_flip(np.zeros(0)) == 1


def test_a_permutation_test_is_never_certain() -> None:
    assert sign_flip(np.ones(30), replicates=500) == pytest.approx(1 / 501)


def test_p_values_are_small_where_sets_differ_and_never_0():
    draws = np.random.default_rng(2)
    a, b = draws.normal(0, 1, 50), draws.normal(1.2, 1, 50)
    for p in (permutation_test(a, b, replicates=999), sign_flip(a - b, replicates=999)):
        assert 0.0 < p < 0.01
    assert permutation_test(a, a.copy(), replicates=99) == 1.0
    assert sign_flip(np.zeros(9), replicates=99) == 1.0


def test_clusters_move_as_one():
    a, b = np.repeat([0.0, 1.0], 20), np.repeat([0.2, 1.4], 20)
    labels = [str(i // 20) for i in range(40)]
    assert permutation_test(a, b, replicates=500) < 0.2
    assert permutation_test(a, b, (labels, labels), replicates=500) > 0.5


def test_under_no_difference_small_p_values_are_rare():
    draws = np.random.default_rng(3)
    p = [
        permutation_test(draws.normal(size=8), draws.normal(size=8), replicates=99)
        for _ in range(200)
    ]
    assert np.mean(np.array(p) <= 0.1) < 0.17


def test_a_comparison_flips_whole_paths() -> None:
    first, second = np.ones(40), np.zeros(40)
    clusters = [f"{index // 10}" for index in range(40)]
    assert paired_test(first, second, clusters).p_clustered == pytest.approx(2 / 2**4)
    assert paired_test(first, second).p_clustered < 0.01


@settings(max_examples=20, deadline=None)
@given(
    st.lists(st.lists(st.integers(0, 4), min_size=1, max_size=4), min_size=5, max_size=5),
    st.integers(1, 4),
)
def test_whole_clusters_change_sides_and_texts_weigh_alike(
    groups: list[list[int]], first: int
) -> None:
    def gap(chosen: Sequence[int]) -> float:
        sides = [
            [v for i, g in enumerate(groups) if (i in chosen) is s for v in g]
            for s in (True, False)
        ]
        return float(np.mean(sides[0]) - np.mean(sides[1]))

    seen = abs(gap(range(first))) - 1e-9
    every = list(itertools.combinations(range(5), first))
    exact = np.mean([abs(gap(chosen)) >= seen for chosen in every])
    labels = [str(i) for i, group in enumerate(groups) for _ in group]
    cut = sum(map(len, groups[:first]))
    values = np.concatenate([np.array(group, np.float64) for group in groups])
    sides = (labels[:cut], labels[cut:])
    p = permutation_test(values[:cut], values[cut:], sides, replicates=1500)
    assert p == pytest.approx(exact, abs=0.08)


@given(st.lists(st.floats(0, 1), min_size=1, max_size=9))
def test_holm_agrees_with_statsmodels(values: list[float]) -> None:
    assert holm(values) == pytest.approx(multipletests(values, method="holm")[1], abs=1e-12)


@given(COUNTS, COUNTS)
def test_the_exact_test_agrees_with_statsmodels(a: int, b: int) -> None:
    expected = contingency_tables.mcnemar(np.array([[3, a], [b, 3]]), exact=True).pvalue
    assert mcnemar(a, b)[0] == pytest.approx(expected if a + b else 1.0, rel=1e-9)


def test_random_flips_agree_with_all_of_them() -> None:
    gaps = np.random.default_rng(8).normal(0.4, 1.0, 12)
    more = np.r_[gaps, 1e-6]
    assert sign_flip(more, replicates=20_000) == pytest.approx(sign_flip(gaps), abs=0.01)
