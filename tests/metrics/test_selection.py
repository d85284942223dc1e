import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen import Metrics
from oodscen.encoders._similarity import unit
from oodscen.errors import UsageError
from oodscen.metrics._selection import most_diverse
from oodscen.testing._encoder import HashEncoder


def rows(seed: int, n: int, d: int = 5) -> np.ndarray:
    return unit(np.random.default_rng(seed).normal(size=(n, d)).astype(np.float32))


@pytest.mark.parametrize("method", ["max-min", "determinantal"])
@settings(deadline=None, max_examples=40)
@given(st.integers(0, 99), st.integers(1, 25), st.data())
def test_a_longer_selection_begins_with_the_shorter(method, seed, n, data):
    k = data.draw(st.integers(1, n))
    full = most_diverse(rows(seed, n), n, method)
    some = most_diverse(rows(seed, n), k, method)
    assert full[:k].tolist() == some.tolist()
    assert len(set(full.tolist())) == len(full)


def test_each_next_text_is_the_farthest_from_those_chosen():
    set_ = rows(3, 40)
    chosen = most_diverse(set_, 12)
    for k in range(1, 12):
        near = (set_ @ set_[chosen[:k]].T).max(axis=1)
        near[chosen[:k]] = np.inf
        assert near[chosen[k]] == pytest.approx(near.min(), abs=1e-6)


def test_the_determinantal_choice_is_the_greedy_one_by_determinants():
    set_ = rows(4, 20, 8)
    chosen = most_diverse(set_, 6, "determinantal").tolist()
    for k in range(1, 6):
        gains = [
            np.linalg.det((set_[[*chosen[:k], j]] @ set_[[*chosen[:k], j]].T).astype(np.float64))
            if j not in chosen[:k]
            else -1.0
            for j in range(20)
        ]
        assert gains[chosen[k]] == pytest.approx(max(gains), rel=1e-3)


@pytest.mark.parametrize("method", ["max-min", "determinantal"])
def test_copies_are_chosen_last(method):
    set_ = np.vstack([rows(5, 4), rows(5, 4)])
    chosen = most_diverse(set_, 8, method)
    assert sorted(chosen[:4] % 4) == [0, 1, 2, 3]
    assert sorted(chosen.tolist()) == list(range(8))


@pytest.mark.parametrize("method", ["max-min", "determinantal"])
@settings(deadline=None, max_examples=60)
@given(st.integers(0, 99), st.integers(3, 60), st.integers(2, 400))
def test_of_copies_the_first_is_chosen_first(method, seed, n, d):
    chosen = most_diverse(np.vstack([rows(seed, n, d)] * 2), 2 * n, method).tolist()
    assert all(chosen.index(row) < chosen.index(row + n) for row in range(n))


@pytest.mark.parametrize("method", ["max-min", "determinantal"])
def test_a_row_without_words_is_farthest_and_does_not_end_the_search(method):
    set_ = np.vstack(
        [unit(np.array([[1, 0, 0], [0.9, 0.1, 0], [0.5, 0.5, 0]], np.float32)), 0 * rows(0, 1, 3)]
    )
    assert most_diverse(set_, 3, method).tolist() == [3, 0, 2]


def test_what_cannot_be_chosen_is_refused():
    for n, method in ((0, "max-min"), (5, "max-min"), (2, "best")):
        with pytest.raises(UsageError):
            most_diverse(rows(0, 4), n, method)


def test_a_selection_stays_inside_the_band():
    metrics = Metrics(HashEncoder(), ["a car waits", "a van turns"])
    texts = ["a car waits", "a deer jumps", "a dog barks", "flames on the bridge", "a van waits"]
    scores = metrics.oodness(texts).per_text
    low, high = sorted(scores)[1], sorted(scores)[3]
    found = metrics.select(texts, 2, low=low, high=high)
    assert all(low <= scores[index] <= high for index in found.indices)
    assert found.texts == tuple(texts[index] for index in found.indices)
    assert (found.inside, found.candidates) == (3, 5)
    with pytest.raises(UsageError):
        metrics.select(texts, 4, low=low, high=high)
