import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.metrics._detection.separation import (
    auroc,
    auroc_interval,
    permutation_test,
    sign_flip_test,
)

scores = st.lists(st.integers(0, 6), min_size=1, max_size=12).map(lambda x: np.array(x, float))


@settings(deadline=None)
@given(scores, scores)
def test_auroc_is_the_share_of_ordered_pairs(a, b):
    pairs = np.mean([(y > x) + 0.5 * (y == x) for x in a for y in b])
    assert auroc(a, b) == pytest.approx(pairs)
    assert auroc(b, a) == pytest.approx(1.0 - pairs)
    assert auroc(np.exp(a), np.exp(b)) == pytest.approx(pairs)


def test_the_interval_holds_the_value_and_repeats():
    draws = np.random.default_rng(1)
    a, b = draws.normal(0, 1, 60), draws.normal(0.7, 1, 60)
    for paired in (False, True):
        found = auroc_interval(a, b, is_paired=paired, seed=3)
        assert found.low < found.value < found.high
        assert found == auroc_interval(a, b, is_paired=paired, seed=3)
    labels = [str(i // 30) for i in range(60)]
    assert auroc_interval(a, b, labels).high is not None
    assert auroc_interval(a, b, ["x"] * 60).low is None
    assert auroc_interval(a[:1], b).low is None


def test_p_values_are_small_where_sets_differ_and_never_0():
    draws = np.random.default_rng(2)
    a, b = draws.normal(0, 1, 50), draws.normal(1.2, 1, 50)
    for p in (permutation_test(a, b, draws=999), sign_flip_test(a - b, draws=999)):
        assert 0.0 < p < 0.01
    assert permutation_test(a, a.copy(), draws=99) == 1.0
    assert sign_flip_test(np.zeros(9), draws=99) == 1.0


def test_clusters_move_as_one():
    a, b = np.repeat([0.0, 1.0], 20), np.repeat([0.2, 1.4], 20)
    labels = [str(i // 20) for i in range(40)]
    assert permutation_test(a, b, draws=500) < 0.2
    assert permutation_test(a, b, (labels, labels), draws=500) > 0.5


def test_under_no_difference_small_p_values_are_rare():
    draws = np.random.default_rng(3)
    p = [permutation_test(draws.normal(size=8), draws.normal(size=8), draws=99) for _ in range(200)]
    assert np.mean(np.array(p) <= 0.1) < 0.17
