import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from oodscen.statistics._auroc import auroc, auroc_interval, auroc_of_items
from oodscen.statistics._resampling import Resampler

scores = st.lists(st.integers(0, 6), min_size=1, max_size=12).map(lambda x: np.array(x, float))


@settings(deadline=None)
@given(scores, scores)
def test_auroc_is_the_share_of_ordered_pairs(a, b):
    pairs = np.mean([(y > x) + 0.5 * (y == x) for x in a for y in b])
    assert auroc(a, b) == pytest.approx(pairs)
    assert auroc(b, a) == pytest.approx(1.0 - pairs)
    assert auroc(np.exp(a), np.exp(b)) == pytest.approx(pairs)


def test_the_interval_holds_the_value_and_repeats():
    draws = np.random.default_rng(1)
    a, b = draws.normal(0, 1, 60), draws.normal(0.7, 1, 60)
    for paired in (False, True):
        found = auroc_interval(a, b, is_paired=paired, seed=3)
        assert found.interval.low < found.value < found.interval.high
        assert found == auroc_interval(a, b, is_paired=paired, seed=3)
    labels = [str(i // 10) for i in range(60)]
    assert auroc_interval(a, b, labels).interval.is_clustered
    assert auroc_interval(a, b, labels).interval.units == 6
    assert auroc_interval(a, b, ["x"] * 60).interval is None
    assert auroc_interval(a[:1], b).interval is None


def test_the_replicates_draw_each_set_by_itself_or_pairs_together():
    draws = np.random.default_rng(4)
    a, b = (np.sort(draws.integers(low, low + 9, 9)).astype(float) for low in (0, 1))
    ood = Resampler(9, seed=5, replicates=50, purpose="ood").weights.astype(int)
    others = Resampler(9, seed=5, replicates=50, purpose="ordinary").weights.astype(int)
    assert (ood != others).any()
    for paired in (False, True):
        areas = [
            auroc(np.repeat(a, one if paired else other), np.repeat(b, one))
            for one, other in zip(ood, others, strict=True)
        ]
        found = auroc_interval(a, b, is_paired=paired, seed=5, replicates=50).interval
        expected = np.quantile(areas, [0.025, 0.975])
        assert (found.low, found.high) == pytest.approx(tuple(expected), abs=1e-6)


@given(scores, scores, st.booleans(), st.data())
def test_the_order_of_the_texts_changes_no_interval(a, b, is_paired, data):
    if is_paired:
        a, b = a[: len(b)], b[: len(a)]
    order = data.draw(st.permutations(range(len(b))))
    first = order if is_paired else data.draw(st.permutations(range(len(a))))
    labels = [str(place % 4) for place in range(len(b))]
    moved = [labels[place] for place in order]
    for one, other in ((None, None), (labels, moved)):
        assert auroc_interval(a, b, one, is_paired=is_paired, replicates=50) == auroc_interval(
            a[first], b[order], other, is_paired=is_paired, replicates=50
        )


@given(
    st.lists(st.sampled_from([0.0, 0.3, 0.5, 1.0]), min_size=1, max_size=12),
    st.lists(st.sampled_from([0.0, 0.3, 0.5, 1.0]), min_size=1, max_size=12),
)
def test_auroc_counts_pairs(signal: list[float], noise: list[float]) -> None:
    scores = np.array([*signal, *noise, np.nan])
    mask = np.array([True] * len(signal) + [False] * len(noise) + [True])
    wins = sum((s > n) + 0.5 * (s == n) for s in signal for n in noise)
    found = auroc_of_items(scores, mask, Resampler(len(scores), replicates=9))
    assert found is not None
    assert found[0] == pytest.approx(wins / len(signal) / len(noise))


def test_auroc_resamples_whole_paths() -> None:
    rng = np.random.default_rng(1)
    mask = np.tile([True, False], 100)
    scores = rng.normal(size=200) + mask
    clusters = [f"{index // 10}" for index in range(200)]
    found = auroc_of_items(scores, mask, Resampler(clusters))
    assert found is not None
    area, bounds = found
    assert bounds is not None
    assert bounds.low < area < bounds.high
    assert auroc_of_items(scores, np.ones(200, np.bool_), Resampler(clusters)) is None


def test_the_interval_of_an_auroc_is_that_of_the_sets_drawn() -> None:
    rng = np.random.default_rng(2)
    mask = rng.integers(0, 2, 60).astype(bool)
    scores = np.round(rng.normal(size=60) + mask, 1)
    clusters = [f"{index // 7}" for index in range(60)]
    resampler = Resampler(clusters, replicates=40)
    areas = []
    for row in resampler.weights.astype(int).tolist():
        drawn = [
            i
            for unit, times in enumerate(row)
            for _ in range(times)
            for i in range(60)
            if i // 7 == unit
        ]
        area = stats.mannwhitneyu(scores[drawn][mask[drawn]], scores[drawn][~mask[drawn]]).statistic
        areas.append(area / mask[drawn].sum() / (~mask[drawn]).sum())
    found = auroc_of_items(scores, mask, resampler)
    assert found is not None
    assert found[1] is not None
    assert (found[1].low, found[1].high) == pytest.approx(
        tuple(np.quantile(areas, [0.025, 0.975])), abs=1e-6
    )


def test_paths_without_a_score_count_for_nothing() -> None:
    scores = np.r_[np.arange(12.0), [np.nan] * 6]
    mask = np.tile([True, False], 9)
    clusters = [f"{index // 3}" for index in range(18)]
    found = auroc_of_items(scores, mask, Resampler(clusters))
    assert found is not None
    assert found[1] is None
    assert found[0] == auroc(scores[1:12:2], scores[0:12:2])


@pytest.mark.parametrize("is_paired", [False, True])
def test_many_scores_are_drawn_in_blocks_of_the_same_draws(monkeypatch, is_paired):
    values = np.random.default_rng(0).normal(size=(2, 9))
    other = values[1] if is_paired else values[1][:4]
    whole = auroc_interval(values[0], other, is_paired=is_paired, replicates=50)
    monkeypatch.setattr("oodscen.statistics._resampling._CELLS", 60)
    assert auroc_interval(values[0], other, is_paired=is_paired, replicates=50) == whole


def test_fewer_than_five_units_have_no_interval():
    scores = np.random.default_rng(2).normal(0, 1, 40)
    assert auroc_interval(scores[:4], scores).interval is None
    assert auroc_interval(scores, scores[:4]).interval is None
    assert auroc_interval(scores, scores, [str(i % 4) for i in range(40)]).interval is None
    assert auroc_interval(scores, scores, [str(i % 5) for i in range(40)]).interval is not None
