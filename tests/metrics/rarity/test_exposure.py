"""Exposure: shares of meetings add up, and common kinds rule."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen import Metrics
from oodscen.errors import UsageError
from oodscen.metrics._rarity.estimates import Rarity, TextRarity
from oodscen.metrics._rarity.exposure import TreeRarity, exposure
from oodscen.testing import ScriptedLLM
from oodscen.testing._encoder import HashEncoder

TEXTS = ["The bridge ahead has collapsed.", "12345", "The car ahead waits at the red light."]


def told(value):
    return TextRarity(low=value - 1.0, best=value, high=value + 1.0)


@settings(deadline=None, max_examples=30)
@given(st.lists(st.tuples(st.floats(0.0, 9.0), st.booleans()), min_size=1, max_size=20))
def test_the_shares_of_a_choice_and_of_the_rest_add_up(kinds):
    per_text = [told(value) for value, _ in kinds]
    chosen = [is_chosen for _, is_chosen in kinds]
    own, rest = exposure(per_text, chosen), exposure(per_text, [not one for one in chosen])
    assert own.share + rest.share == pytest.approx(1.0)
    assert 0.0 <= own.low <= own.share <= own.high <= 1.0


@given(st.lists(st.floats(0.0, 9.0), min_size=1, max_size=40))
def test_all_kinds_are_all_meetings(rarities):
    found = exposure([told(value) for value in rarities], [True] * len(rarities))
    assert (found.low, found.share, found.high) == (1.0, 1.0, 1.0)


def test_one_common_kind_outweighs_a_hundred_rare_ones():
    found = exposure([told(2.0)] + [told(6.0)] * 100, [True] + [False] * 100)
    assert found.share == pytest.approx(1.0 / 1.01)


@pytest.mark.parametrize(
    ("rarity", "words", "of_the_rest"),
    [(4.5, "0.3% ", "99.7% "), (7.0, "<0.1% ", ">99.9% "), (3.0, "9% ", "91% ")],
)
def test_a_rare_kind_is_not_said_to_be_no_part_of_what_a_driver_meets(rarity, words, of_the_rest):
    kinds = [told(2.0), told(rarity)]
    assert str(exposure(kinds, [False, True])).startswith(words)
    assert str(exposure(kinds, [True, False])).startswith(of_the_rest)
    assert str(exposure(kinds, [False, False])).startswith("0% ")
    assert str(exposure(kinds, [True, True])).startswith("100% ")


def test_what_cannot_be_told_counts_in_neither_sum():
    per_text = [told(3.0), TextRarity(flags=("far",)), told(3.0)]
    found = exposure(per_text, [True, True, False])
    assert (found.share, found.unknown) == (0.5, 1)
    assert "1 of 3 kinds cannot be told" in str(found)
    assert exposure(per_text, [False, True, False]) is None
    assert exposure(per_text, [False, False, False]).share == 0.0
    assert exposure([TextRarity(flags=("far",))], [True]) is None
    with pytest.raises(UsageError):
        exposure(per_text, [True])


@pytest.mark.parametrize(
    "chosen", [[5, -3], [0.5, 0.5], "00", ["False", "False"], [math.nan] * 2, iter([True, False])]
)
def test_a_choice_is_true_or_false(chosen):
    metrics = Metrics(HashEncoder(64), ["A car waits at the light."])
    with pytest.raises(UsageError):
        metrics.exposure(TEXTS[:2], chosen)
    assert metrics.exposure(TEXTS[:2], np.array([True, False])) is not None


def test_choices_that_do_not_fit_cost_no_question():
    metrics = Metrics(HashEncoder(64), ["A car waits at the light."])
    llm = ScriptedLLM(lambda request: pytest.fail("is asked"))
    with pytest.raises(UsageError, match="1 choices do not fit 3 texts"):
        metrics.exposure(TEXTS, [True], llm)


@pytest.mark.parametrize("draws", [0, 101, 1.5])
def test_a_wrong_number_of_draws_is_refused_offline_too(draws):
    with pytest.raises(UsageError, match="draws"):
        Metrics(HashEncoder(64), ["A car waits."]).rarity(TEXTS, draws=draws)


def test_a_tree_weights_its_leaves():
    paths = TreeRarity(
        leaves=("a", "b"),
        rarity=Rarity(by="words", per_text=(told(3.0), told(4.0)), median=3.5, unknown=0),
    )
    assert paths.per_km() == pytest.approx({"a": 1e-3, "b": 1e-4})
    assert paths.of({"a"}).share == pytest.approx(1.0 / 1.1)
    assert TreeRarity.parse(paths.to_json()) == paths


def test_a_suite_is_chosen_by_exposure_or_against_it():
    metrics = Metrics(HashEncoder(64), ["A car waits at the light."])
    assert metrics.select(TEXTS, 2, method="commonest").indices == (2, 0)
    assert metrics.select(TEXTS, 2, method="rarest").indices == (0, 2)
    with pytest.raises(UsageError):
        metrics.select(TEXTS, 3, method="rarest")
    assert metrics.exposure(TEXTS, [True, False, False]).share < 0.5
