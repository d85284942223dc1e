"""The fit of rarity's head: what is left out is left out wholly, and intervals cover what they say."""

import numpy as np
import pytest

from oodscen.metrics._rarity.head import interval_ends
from tools.rarity.train import MISS, Fit, Rated, interval, rated, registers_moved


def some(draws, count):
    values = draws.normal(4.0, 2.0, count)
    origins = np.array(["pairs 1", "author"] * (count // 2))
    event = np.array([f"event {place // 4}" for place in range(count)])
    plain = np.array([place % 4 < 2 for place in range(count)])
    twin = np.zeros(count, bool)
    return Rated(["a car"] * count, values, origins, origins, twin, event, plain)


def of(data, own):
    left = {name: getattr(data, name)[own] for name in Rated._fields if name != "texts"}
    return data._replace(texts=["a car"] * int(own.sum()), **left)


def test_texts_left_out_have_the_estimates_of_a_fit_that_never_saw_them(monkeypatch):
    draws = np.random.default_rng(0)
    data = some(draws, 40)
    rows, points = draws.normal(size=(40, 6)), draws.normal(size=(5, 6))
    weights = draws.uniform(0.5, 2.0, 40).astype(np.float32)
    framed = [(np.arange(40), rows + draws.normal(size=(40, 6)))]
    out = np.arange(40) < 8
    monkeypatch.setattr(Fit, "_weights", lambda fit: weights[-len(fit.data.values) :])
    whole = Fit(rows, points, data, framed)
    rest = Fit(rows[~out], points, of(data, ~out), [(np.arange(32), framed[0][1][~out])])
    assert whole.without(out) == pytest.approx(rest._features(rows[out]) @ rest.theta, abs=0.02)
    assert np.abs(whole.without(out) - whole.features[out] @ whole.theta).max() > 0.1


def test_intervals_cover_as_much_as_they_say_where_the_error_grows_with_the_estimate():
    draws = np.random.default_rng(1)
    best = draws.uniform(0.0, 8.0, 4_000)
    values = best + draws.normal(size=4_000) * (0.3 + 0.2 * best)
    origins = np.array(["pairs 1", "registers", "baseline, people", "baseline, sights"] * 1_000)
    low, high = interval_ends(best, *interval(best, values, origins))
    inside = (low <= values) & (values <= high)
    for part in (best < 4.0, best >= 4.0):
        assert inside[part].mean() == pytest.approx(1.0 - 2.0 * MISS, abs=0.02)


def test_a_hand_with_many_texts_counts_as_much_as_one_with_few():
    draws = np.random.default_rng(3)
    best = draws.uniform(0.0, 8.0, 2_200)
    is_few = np.arange(2_200) < 200
    values = best + draws.normal(size=2_200) * np.where(is_few, 2.0, 0.5)
    origins = np.where(is_few, "pairs 1", "registers")
    low, high = interval_ends(best, *interval(best, values, origins))
    assert (high - low).mean() > 4.0


def test_a_register_moves_an_event_by_its_distance_from_the_plain_mean():
    data = some(np.random.default_rng(2), 8)
    data = data._replace(coarse=np.array(["author"] * 8))
    best = np.array([1.0, 3.0, 2.5, 1.0, 0.0, 0.0, 0.0, 2.0])
    assert registers_moved(best, data).tolist() == [0.5, 1.0, 0.0, 2.0]


def test_the_texts_written_for_the_head_can_be_read_and_wordings_are_alike(tmp_path):
    data = rated(tmp_path)
    assert np.isfinite(data.values).all()
    hands = {"describer", "press", "captions", "talk", "reports"}
    assert set(data.fine) == hands | {"pairs 1", "pairs 2", "registers", "wordings", "incidents"}
    for event in set(data.event) - {""}:
        own = data.values[data.event == event]
        assert len(own) > 1
        assert np.ptp(own) == 0.0
