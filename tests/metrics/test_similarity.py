import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.metrics import similarity
from oodscen.metrics.similarity import extremes, unit


def vectors(seed: int, n: int, d: int) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(n, d)).astype(np.float32)


@settings(deadline=None)
@given(st.integers(0, 999), st.integers(1, 30), st.integers(1, 30), st.integers(2, 9))
def test_it_agrees_with_float64(seed, n, m, d):
    a, b = vectors(seed, n, d), vectors(seed + 1, m, d)
    wide = [
        x.astype(np.float64) / np.linalg.norm(x.astype(np.float64), axis=1)[:, None] for x in (a, b)
    ]
    cosines = wide[0] @ wide[1].T
    found = extremes(unit(a), unit(b))
    np.testing.assert_allclose(found.largest, cosines.max(axis=1), atol=1e-6)
    np.testing.assert_allclose(found.smallest, cosines.min(axis=1), atol=1e-6)
    chosen = cosines[np.arange(n), found.nearest]
    np.testing.assert_allclose(chosen, cosines.max(axis=1), atol=1e-6)


@pytest.mark.parametrize("skip", [False, True])
def test_the_size_of_the_blocks_plays_no_part(monkeypatch, skip):
    a = unit(vectors(1, 23, 6))
    own = np.arange(23) if skip else None
    whole = extremes(a, a, own)
    monkeypatch.setattr(similarity, "_ROWS", 4)
    monkeypatch.setattr(similarity, "_COLUMNS", 5)
    parts = extremes(a, a, own)
    np.testing.assert_allclose(parts.largest, whole.largest, atol=1e-6)
    np.testing.assert_allclose(parts.smallest, whole.smallest, atol=1e-6)
    assert np.array_equal(parts.nearest, whole.nearest)


def test_a_skipped_reference_is_never_found():
    a = unit(vectors(2, 12, 4))
    found = extremes(a, a, np.arange(12))
    assert np.all(found.nearest != np.arange(12))
    assert np.all(found.largest < 1.0)


def test_a_zero_row_has_no_direction():
    a = unit(np.array([[0, 0], [3, 4]], np.float32))
    np.testing.assert_allclose(a, [[0, 0], [0.6, 0.8]], atol=1e-7)
    assert extremes(a, a[1:]).largest.tolist()[0] == 0.0


def test_the_first_of_equals_is_nearest():
    a = np.array([[1, 0]], np.float32)
    assert extremes(a, np.repeat(a, 5, axis=0)).nearest.tolist() == [0]
