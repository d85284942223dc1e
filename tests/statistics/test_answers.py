import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from oodscen.statistics._answers import above_chance, d_prime, intraclass, two_proportions

COUNTS = st.integers(0, 60)


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


@given(COUNTS, COUNTS, COUNTS, COUNTS)
def test_d_prime_is_finite_and_changes_sign_with_the_roles(a: int, b: int, c: int, d: int) -> None:
    found = d_prime(a, a + b, c, c + d)
    if a + b == 0 or c + d == 0:
        assert found is None
    else:
        assert found is not None
        assert math.isfinite(found)
        assert found == pytest.approx(-(d_prime(c, c + d, a, a + b) or 0.0))


@pytest.mark.parametrize(("signals", "noises"), [(130, 130), (4, 8), (7, 3), (1, 300)])
@pytest.mark.parametrize("share", [0.0, 1.0])
def test_d_prime_of_who_always_says_the_same_is_nil(
    signals: int, noises: int, share: float
) -> None:
    found = d_prime(share * signals, signals, share * noises, noises)
    assert found == pytest.approx(0)


def test_chance_is_nought_and_perfect_is_one() -> None:
    assert above_chance(0.4, 0.4) == 0
    assert above_chance(1.0, 0.4) == 1
    assert above_chance(1.0, 1.0) is None
    assert above_chance(0.0, 0.5) == -1


def test_two_proportions_of_the_papers_best_and_worst() -> None:
    assert two_proportions(86, 130, 66, 130) == pytest.approx(0.0118, abs=5e-4)
    assert two_proportions(5, 5, 7, 7) == 1
