"""The offline head: what it computes is what its formula says, however the texts are dealt out."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from oodscen.metrics._rarity import head as module
from oodscen.metrics._rarity.head import estimate, interval_ends, kernel, load_head

TEXTS = [
    "A deer stands in the lane.",
    "A red light.",
    "",
    "A sofa lies on the motorway.",
    "鹿が道路に飛び出した。",
    "The bridge ahead has collapsed.",
    "Wrxq.",
]


def never(texts):
    raise AssertionError("the head of stems alone needs no vectors")


@pytest.mark.parametrize("count", [0, 3, 4, 7])
def test_estimates_do_not_depend_on_the_blocks(count, monkeypatch):
    whole = load_head("words").estimate(TEXTS[:count])
    monkeypatch.setattr(module, "_BLOCK", 3)
    for found, wanted in zip(load_head("words").estimate(TEXTS[:count]), whole, strict=True):
        assert found.shape == (count,)
        np.testing.assert_allclose(found, wanted, atol=1e-5)


def test_estimates_stay_in_their_interval_and_range():
    head, found, vectors = estimate("words", TEXTS, never)
    assert vectors is None
    assert not head.uses_vectors
    assert np.all((found.low <= found.best) & (found.best <= found.high))
    assert np.all((found.best >= -1.0) & (found.best <= 12.0))
    assert np.all((found.nearness > 0.0) & (found.nearness <= 1.0))
    assert found.known_share[[0, 2, 4, 6]].tolist() == [1.0, 0.0, 0.0, 0.0]


def test_courtesy_changes_no_estimate():
    plain, polite = TEXTS[0], f"Dear colleagues. {TEXTS[0]} Thank you very much."
    for values in estimate("words", [plain, polite], never)[1]:
        assert values[0] == pytest.approx(values[1], abs=1e-5)


ROWS = arrays(np.float64, st.tuples(st.integers(1, 4), st.just(3)), elements=st.floats(-2.0, 2.0))


@given(ROWS, ROWS, st.floats(0.1, 2.0))
def test_the_kernel_is_that_of_distances(rows, points, gamma):
    distances = np.linalg.norm(rows[:, None] - points[None], axis=2)
    found = kernel(rows, points, gamma)
    np.testing.assert_allclose(found, np.exp(-gamma * distances**2), atol=1e-9)


@given(arrays(np.float64, 2, elements=st.floats(-2.0, 2.0)))
def test_an_interval_holds_its_estimate(line):
    best = np.linspace(-1.0, 12.0, 14)
    low, high = interval_ends(best, line, line)
    assert np.all((low <= best) & (best <= high))
