from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen._words.text import folded_words
from oodscen.baselines._duplicates import similar_meaning, similar_wording
from oodscen.baselines._ordinary import ordinary_driving
from oodscen.errors import UsageError

quick = settings(deadline=None, max_examples=40)
sentences = st.lists(st.text("ab c", min_size=1).filter(str.strip), min_size=1, max_size=12)
rows = st.lists(st.lists(st.integers(-3, 3), min_size=3, max_size=3), min_size=1, max_size=12).map(
    lambda values: np.array(values, np.float32)
)


def _grams(text):
    letters = f" {folded_words(text)} "
    return {letters[i : i + 3] for i in range(len(letters) - 2)}


def _expected(similarity, threshold):
    """List (index, of) by comparing each item with each earlier one that is kept."""
    found, kept = [], []
    for index, values in enumerate(similarity):
        of = max(kept, key=lambda one: values[one], default=None)
        if of is not None and values[of] >= threshold - 1e-6:
            found.append((index, of))
        else:
            kept.append(index)
    return found


@quick
@given(sentences, st.sampled_from([0.2, 0.5, 0.8, 1.0]))
def test_texts_are_compared_as_sets_of_three_letters(texts, threshold):
    grams = [_grams(text) for text in texts]
    similarity = np.array([[np.float32(len(a & b) / len(a | b)) for b in grams] for a in grams])
    report = similar_wording(texts, threshold)
    assert [(item.index, item.of) for item in report.found] == _expected(similarity, threshold)
    assert (report.n, report.measure, report.threshold) == (len(texts), "trigrams", threshold)


@quick
@given(rows, st.sampled_from([0.3, 0.9, 1.0]))
def test_embeddings_are_compared_by_cosine(vectors, threshold):
    lengths = np.linalg.norm(vectors.astype(np.float64), axis=1)[:, None]
    unit = np.divide(vectors, lengths, out=np.zeros(vectors.shape), where=lengths > 0)
    cosines = unit @ unit.T
    report = similar_meaning(vectors, threshold)
    assert [item.index for item in report.found] == [i for i, _ in _expected(cosines, threshold)]
    for item in report.found:
        assert item.similarity == pytest.approx(cosines[item.index, item.of], abs=1e-6)
        kept = [one for one in report.kept if one < item.index]
        assert item.similarity == pytest.approx(cosines[item.index, kept].max(), abs=1e-6)


def test_blocks_change_nothing(monkeypatch):
    texts = ordinary_driving().texts[::12]
    whole = similar_wording(texts, 0.6)
    assert whole.found
    monkeypatch.setattr("oodscen.baselines._duplicates._BLOCK", 7)
    assert similar_wording(texts, 0.6) == whole


def test_case_and_punctuation_play_no_part():
    report = similar_wording(["A car waits.", "Ego turns.", "a CAR waits", "a car, waits!"], 1.0)
    assert [(item.index, item.of) for item in report.found] == [(2, 0), (3, 0)]
    assert report.kept == (0, 1)
    assert similar_wording(["\u00c9cole here", "E\u0301cole here"], 1.0).found


def test_a_chain_of_similar_texts_does_not_collapse_to_its_first():
    words = [f"word{number}" for number in range(40)]
    texts = [" ".join(words[start : start + 20]) for start in range(21)]
    assert len(similar_wording(texts, 0.8).kept) > 3


def test_words_that_differ_by_a_vowel_sign_are_not_equal():
    assert not similar_wording(["\u0930\u092e\u093e", "\u0930\u092e"], 1.0).found


def test_a_report_of_many_copies_is_no_larger_than_they_are():
    report = similar_wording(["a car waits"] * 1500)
    assert len(report.found) == 1499
    assert report.kept == (0,)


def test_zero_vectors_resemble_nothing():
    assert not similar_meaning(np.zeros((3, 4), np.float32), 0.1).found


@pytest.mark.parametrize("threshold", [1e-12, 1e-7, 1e-6, 2e-6])
def test_what_has_nothing_in_common_is_no_duplicate_at_any_threshold(threshold):
    assert not similar_wording(["abc def", "xyz uvw"], threshold).found
    assert not similar_meaning(np.eye(3, dtype=np.float32), threshold).found


@pytest.mark.parametrize("threshold", [np.float32(0.5), Fraction(1, 2)])
def test_a_threshold_of_another_library_is_reported_as_a_number(threshold):
    report = similar_wording(["a car waits"] * 2, threshold)
    assert (type(report.threshold), report.threshold) == (float, 0.5)


@pytest.mark.parametrize("threshold", [0.0, -0.1, 1.1, float("nan"), "0.5", None])
def test_a_threshold_must_make_sense(threshold):
    with pytest.raises(UsageError):
        similar_wording(["a"], threshold)


def test_the_handwritten_part_repeats_nothing():
    report = similar_wording(ordinary_driving().texts, 0.7)
    assert [item for item in report.found if item.index >= 2000] == []


@pytest.mark.parametrize("n_dimensions", [16, 384])
def test_copies_that_differ_by_rounding_resemble_the_first(n_dimensions):
    directions = np.random.default_rng(0).normal(size=(40, n_dimensions)).astype(np.float32)
    rows = np.vstack([directions * length for length in np.linspace(1.0, 3.0, 30)])
    found = similar_meaning(rows.astype(np.float32), 0.999).found
    assert len(found) == 29 * 40
    assert [item.of for item in found] == [item.index % 40 for item in found]
