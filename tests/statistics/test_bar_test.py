import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from oodscen.statistics import _bar_test
from oodscen.statistics._bar_test import MOST_TIMES, p_below, p_below_many, times_needed


@settings(deadline=None, max_examples=20)
@given(hits=st.integers(0, 8), misses=st.integers(0, 8), bar=st.sampled_from([0.5, 0.8, 0.9]))
def test_with_paths_all_right_or_all_wrong_it_is_the_exact_binomial_test(hits, misses, bar):
    gaps = np.r_[np.full(hits, 1.0 - bar), np.full(misses, -bar)]
    exact = stats.binom.sf(hits - 1, hits + misses, bar)
    assert p_below(gaps, -bar) == pytest.approx(exact, abs=0.015)


@settings(deadline=None, max_examples=20)
@given(st.lists(st.floats(-0.5, 0.5), min_size=1, max_size=8), st.floats(0.0, 0.5))
def test_larger_gaps_have_no_larger_p(gaps, more):
    lower = np.array(gaps)
    sets = np.stack([lower, lower + more], axis=1)
    p_lower, p_higher = p_below_many(sets, -0.5, draws=2_000)
    assert 1 / 2_001 <= p_higher <= p_lower <= 1.0


def test_without_a_path_nothing_is_shown():
    assert p_below(np.zeros(0), -0.5) == 1.0
    assert times_needed(np.zeros(0), -0.5, 0.05) is None
    assert times_needed(np.array([0.5, -0.5]), -0.5, 0.05) is None


@pytest.mark.parametrize("gaps", [(0.5, 0.5, 0.5), (0.5, -0.1), (0.3, 0.3, -0.4, 0.2)])
def test_a_study_so_many_times_as_large_shows_it_and_one_a_little_smaller_does_not(gaps):
    column = np.array(gaps)[:, None]
    times = times_needed(column[:, 0], -0.5, 0.05)
    drawn = {"seed": 0, "draws": _bar_test._PLANNED_DRAWS}
    assert p_below_many(column, -0.5, times=times, **drawn)[0] <= 0.05
    assert p_below_many(column, -0.5, times=0.97 * times, **drawn)[0] > 0.05


def test_a_study_up_to_the_largest_that_is_planned_for_is_found(monkeypatch):
    monkeypatch.setattr(
        _bar_test, "p_below_many", lambda *_, times, **__: np.array([0.0 if times >= 700 else 1.0])
    )
    assert times_needed(np.ones(3), -0.5, 0.05) == pytest.approx(700, rel=0.03)
    for most, is_found in ((701.0, True), (699.0, False)):
        monkeypatch.setattr(_bar_test, "MOST_TIMES", most)
        assert (times_needed(np.ones(3), -0.5, 0.05) is not None) == is_found
    assert MOST_TIMES == 1_000
