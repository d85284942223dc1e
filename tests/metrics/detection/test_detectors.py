import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen import Metrics
from oodscen.metrics._detection.anchors import load_anchors
from oodscen.metrics._detection.detectors import DETECTORS, clauses, ledoit_wolf, shrunk
from oodscen.testing._encoder import HashEncoder

ORDINARY = [
    f"A {colour} {kind} {act}, and the lights are {light}."
    for colour in ("red", "blue", "white")
    for kind in ("car", "van", "bus", "lorry")
    for act in ("waits at the kerb", "turns left", "follows the tram")
    for light in ("green", "amber")
]
STRANGE = ["A crocodile crawls out of the drain, while flames engulf the bridge."]


@pytest.mark.parametrize("name", DETECTORS)
def test_what_is_unlike_the_baseline_scores_higher(name):
    metrics = Metrics(HashEncoder(), ORDINARY)
    ordinary = metrics.oodness(["A red van waits at the kerb, and the lights are amber."], name)
    strange = metrics.oodness(STRANGE, name)
    assert strange.mean > ordinary.mean
    assert strange.definition == name
    assert np.isfinite(strange.per_text).all()


@pytest.mark.parametrize("name", DETECTORS)
@pytest.mark.parametrize("baseline", [["a car waits"], ["a car waits"] * 3, ["a", "b c d"]])
def test_tiny_and_repeated_baselines_give_finite_scores(name, baseline):
    found = Metrics(HashEncoder(), baseline).oodness(["a deer jumps, and a van brakes", "a"], name)
    assert np.isfinite(found.per_text).all()


@pytest.mark.parametrize("name", DETECTORS)
def test_a_text_scores_the_same_alone_and_among_others(name):
    metrics = Metrics(HashEncoder(), ORDINARY)
    texts = [*STRANGE, *ORDINARY[:3], "A deer. It jumps, because a dog barks at it."]
    together = metrics.oodness(texts, name).per_text
    alone = [metrics.oodness([text], name).mean for text in texts]
    np.testing.assert_allclose(together, alone, atol=1e-5)


def test_shrinkage_agrees_with_scikit_learn():
    sklearn = pytest.importorskip("sklearn.covariance")
    rows = np.random.default_rng(0).normal(size=(40, 12)) @ np.diag(np.arange(1.0, 13.0))
    apart = rows - rows.mean(axis=0)
    expected, share = sklearn.ledoit_wolf(rows)
    assert ledoit_wolf(apart) == pytest.approx(share, rel=1e-9)
    np.testing.assert_allclose(shrunk(apart.T @ apart / 40, share), expected, rtol=1e-9)


def test_clauses_lose_no_word_but_lone_ones():
    text = "Bus on its side, windows out, people climbing free, rain."
    assert clauses(text) == ("Bus on its side", "windows out", "people climbing free")
    assert clauses("Fog") == ("Fog",)
    assert clauses("a car waits while a van turns") == ("a car waits", "while a van turns")
    assert len(clauses("so it goes. " * 9000)) == 64


def test_anchors_are_pairs_that_differ():
    for pairs in load_anchors():
        assert all(calm != odd and calm and odd for calm, odd in pairs)
        assert len(set(pairs)) == len(pairs)


@given(st.data())
@settings(max_examples=25, deadline=None)
def test_density_does_not_depend_on_which_of_tied_neighbours_come_first(data):
    words = ["car", "van", "bus", "stops", "waits", "turns", "here", "there", "left", "right"]
    sentence = st.lists(st.sampled_from(words), min_size=1, max_size=3).map(" ".join)
    known = data.draw(st.lists(sentence, min_size=12, max_size=40, unique=True))
    text = data.draw(sentence)
    shuffled = data.draw(st.permutations(known))
    one, other = (
        Metrics(HashEncoder(), texts).oodness([text], "density").per_text[0]
        for texts in (known, shuffled)
    )
    assert one == pytest.approx(other, abs=1e-4)
