import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen import Metrics
from oodscen.encoders._similarity import unit
from oodscen.metrics._detection.calibration import calibrate, held_out_scores, like_groups
from oodscen.testing._encoder import HashEncoder


@settings(deadline=None)
@given(st.lists(st.floats(-1, 1), min_size=1, max_size=9), st.lists(st.floats(-1, 1), min_size=1))
def test_percentiles_and_p_values_are_those_of_their_definitions(values, held):
    found = calibrate(values, np.array(held), 1)
    for value, percentile, p in zip(values, found.percentiles, found.p_values, strict=True):
        below = sum(other < value - 1e-9 for other in held)
        assert percentile == 100.0 * below / len(held)
        assert p == (1 + len(held) - below) / (1 + len(held))
        assert 0.0 < p <= 1.0


def test_copies_are_held_out_together():
    rows = unit(np.random.default_rng(0).normal(size=(30, 8)).astype(np.float32))
    values, groups = held_out_scores(np.repeat(rows, 3, axis=0))
    once, same = held_out_scores(rows)
    assert groups == same
    np.testing.assert_allclose(np.repeat(once, 3), values, atol=1e-6)
    assert values.max() <= -0.0 + 1.0
    assert values.min() > -0.8 - 1e-3


def test_groups_are_numbered_in_order_and_alike_within():
    rows = unit(np.random.default_rng(1).normal(size=(1300, 3)).astype(np.float32))
    group = like_groups(rows, 0.9)
    first = [int(np.flatnonzero(group == g)[0]) for g in range(group.max() + 1)]
    assert first == sorted(first)
    for g, leader in enumerate(first):
        assert (rows[group == g] @ rows[leader]).min() >= 0.9 - 1e-6


def joined(rows, threshold: float) -> list[int]:
    """Return each row's group by the definition: it joins the first leader that it resembles."""
    leaders, group = [], []
    for row in rows:
        near = [place for place, leader in enumerate(leaders) if row @ leader >= threshold]
        group.append(near[0] if near else len(leaders))
        leaders += [] if near else [row]
    return group


@settings(deadline=None, max_examples=20)
@given(st.sampled_from([0, 1, 511, 512, 513, 1030]), st.integers(0, 2**32 - 1))
def test_a_row_joins_the_first_leader_that_it_resembles(size, seed):
    # Products of small whole numbers are exact in whatever blocks they are taken.
    rows = np.random.default_rng(seed).integers(-3, 4, size=(size, 4)).astype(np.float32)
    assert like_groups(rows, 14.0).tolist() == joined(rows, 14.0)


def test_text_like_the_baseline_is_not_called_odd():
    texts = [f"{a} {b} {c}" for a in "abcdefgh" for b in "ijklmnop" for c in "qrstuv"]
    metrics = Metrics(HashEncoder(), texts[::2])
    found = metrics.report(texts[1::2]).calibration
    assert found.share_below_5_percent < 0.2
    assert metrics.report(["zebra xylophone"]).calibration.p_values[0] < 0.05


def test_a_p_of_5_percent_is_counted():
    found = calibrate([1.0], np.zeros(19), 19)
    assert (found.p_values, found.share_below_5_percent) == ((0.05,), 1.0)
