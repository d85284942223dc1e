"""The two definitions of OOD-ness, by every pair of cosines."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.errors import UnknownComponent
from oodscen.metrics._oodness import scores
from oodscen.metrics._vectors.similarity import unit


def vectors(seed: int, n: int) -> np.ndarray:
    return unit(np.random.default_rng(seed).normal(size=(n, 5)).astype(np.float32))


@given(st.integers(0, 999), st.integers(1, 8), st.integers(1, 8))
def test_scores_are_those_of_the_formulae(seed: int, n: int, m: int) -> None:
    texts, baseline = vectors(seed, n), vectors(seed + 1, m)
    cosines = texts.astype(float) @ baseline.astype(float).T
    for definition, expected in (
        ("tabulated", -cosines.max(axis=1)),
        ("printed", cosines.min(axis=1)),
    ):
        found = scores(texts, baseline, definition)
        assert found == pytest.approx(expected, abs=1e-6)


def test_a_text_of_the_baseline_has_the_least_tabulated_score() -> None:
    baseline = vectors(3, 6)
    assert scores(baseline, baseline, "tabulated") == pytest.approx(-1.0, abs=1e-6)
    assert (scores(baseline, baseline, "printed") < 0.99).all()


def test_only_the_papers_definitions_are_scored_here() -> None:
    with pytest.raises(UnknownComponent):
        scores(vectors(0, 2), vectors(1, 2), "kth")  # type: ignore[arg-type]  # no definition
