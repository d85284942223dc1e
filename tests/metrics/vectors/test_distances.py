import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen import Metrics
from oodscen.encoders._similarity import unit
from oodscen.errors import UsageError
from oodscen.metrics._variety import compression_ratio, distinct_n
from oodscen.metrics._vectors.distances import frechet, mmd, remote_clique, vendi
from oodscen.testing._encoder import HashEncoder


def rows(seed: int, n: int, shift: float = 0.0) -> np.ndarray:
    return unit((np.random.default_rng(seed).normal(size=(n, 6)) + shift).astype(np.float32))


def test_equal_sources_are_near_and_others_far():
    a, same, other = rows(0, 300), rows(1, 300), rows(2, 300, 1.0)
    assert abs(mmd(a, same)) < 0.01 < mmd(a, other)
    assert frechet(a, a) == pytest.approx(0.0, abs=1e-6)
    assert frechet(a, same) < frechet(a, other)


def test_mmd_agrees_with_its_definition():
    a, b = rows(3, 8), rows(4, 11)
    gap = np.array([[np.square(x - y).sum() for y in b] for x in b])
    scale = np.median(gap[np.triu_indices(11, 1)])

    def kernel(x, y):
        return np.exp(-np.square(x - y).sum() / (2.0 * scale))

    within = [
        np.mean([kernel(x, y) for i, x in enumerate(s) for j, y in enumerate(s) if i != j])
        for s in (a, b)
    ]
    between = np.mean([kernel(x, y) for x in a for y in b])
    assert mmd(a, b) == pytest.approx(sum(within) - 2.0 * between, abs=1e-5)


def test_vendi_counts_different_texts():
    base = np.eye(6, dtype=np.float32)
    assert vendi(base[:4]) == pytest.approx(4.0)
    assert vendi(np.repeat(base[:3], 5, axis=0)) == pytest.approx(3.0)
    assert vendi(base[:1]) == pytest.approx(1.0)
    assert vendi(np.vstack([base[:2], np.zeros((1, 6), np.float32)])) == pytest.approx(3.0)
    set_ = rows(5, 40)
    values = np.linalg.eigvalsh(np.float64(set_) @ np.float64(set_).T / 40)[-6:]
    assert vendi(set_) == pytest.approx(np.exp(-(values * np.log(values)).sum()), rel=1e-4)


def test_remote_clique_is_the_mean_distance():
    set_ = rows(6, 9)
    pairs = (1.0 - set_ @ set_.T)[np.triu_indices(9, 1)]
    assert remote_clique(set_) == pytest.approx(pairs.mean(), abs=1e-6)
    with pytest.raises(UsageError):
        remote_clique(set_[:1])


def test_repetition_compresses_and_is_not_distinct():
    same, varied = ["a car waits at the light"] * 20, [f"word{i} other{i * 7}" for i in range(20)]
    assert compression_ratio(same) > compression_ratio(varied)
    assert distinct_n(same, 2) == pytest.approx(1 / 20)
    assert distinct_n(varied, 2) == 1.0


@given(st.randoms(use_true_random=False))
def test_the_order_of_texts_changes_neither_repetition_nor_distinct_words(random):
    texts = [f"A car {number % 4} waits at light {number % 3}." for number in range(12)]
    mixed = random.sample(texts, len(texts))
    assert compression_ratio(mixed) == compression_ratio(texts)
    assert distinct_n(mixed, 2) == distinct_n(texts, 2)
    assert distinct_n(["one"], 2) is None


def test_sets_are_compared_as_wholes_at_equal_size():
    metrics = Metrics(HashEncoder(), [f"a car {i} waits" for i in range(30)])
    near = metrics.distance([f"a car {i} waits" for i in range(50, 70)])
    far = metrics.distance([f"deer {i} jumps over" for i in range(20)])
    assert (near.size, near.n_a, near.n_b) == (20, 20, 30)
    assert near.mmd < far.mmd
    assert near.frechet < far.frechet
    variety = metrics.variety(["one text alone"])
    assert variety.vendi == pytest.approx(1.0)
    assert variety.remote_clique is None
