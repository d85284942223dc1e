import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen._seeding import stream
from oodscen.encoders._similarity import unit
from oodscen.statistics import _resampling
from oodscen.statistics._answers import intraclass
from oodscen.statistics._intervals import FEWEST_CLUSTERS, cluster_interval, wilson
from oodscen.statistics._resampling import (
    Resampler,
    bootstrap_mean,
    bootstrap_median,
    bootstrap_pairwise,
)


@settings(deadline=None, max_examples=30)
@given(
    st.lists(st.tuples(st.floats(-9, 9), st.sampled_from("abcdefg")), min_size=2, max_size=12),
    st.booleans(),
    st.integers(0, 3),
)
def test_the_interval_of_a_median_is_that_of_resampled_medians(items, is_clustered, seed):
    values = np.array([value for value, _ in items])
    clusters = [label for _, label in items] if is_clustered else None
    found = bootstrap_median(values, clusters, seed=seed, replicates=50)
    resampler = Resampler(clusters or len(values), seed=seed, replicates=50, purpose="median")
    if resampler.units < FEWEST_CLUSTERS:
        assert found is None
        return
    ranked = values if is_clustered else np.sort(values)
    medians = [
        np.median(np.repeat(ranked, counts[resampler.cluster].astype(int)))
        for counts in resampler.weights
    ]
    assert (found.low, found.high) == pytest.approx(np.quantile(medians, [0.025, 0.975]), abs=2e-6)
    assert (found.units, found.is_clustered) == (resampler.units, is_clustered)


def test_the_median_of_many_values_is_resampled_in_blocks(monkeypatch):
    values = np.random.default_rng(1).normal(size=60)
    paths = [str(n // 4) for n in range(60)]
    whole = bootstrap_median(values), bootstrap_median(values, paths)
    monkeypatch.setattr(_resampling, "_CELLS", 500)
    assert (bootstrap_median(values), bootstrap_median(values, paths)) == whole


@settings(deadline=None, max_examples=30)
@given(st.lists(st.floats(-1, 1), min_size=FEWEST_CLUSTERS, max_size=30))
def test_an_interval_lies_within_the_values(values):
    found = bootstrap_mean(np.array(values), replicates=200)
    assert min(values) - 1e-6 <= found.low <= found.high <= max(values) + 1e-6


def test_it_has_the_width_that_theory_gives():
    values = np.random.default_rng(3).normal(size=400)
    found = bootstrap_mean(values)
    expected = 2 * 1.96 * values.std() / np.sqrt(400)
    assert abs((found.high - found.low) / expected - 1.0) < 0.1


def test_the_same_seed_gives_the_same_interval():
    values = np.arange(20.0)
    assert bootstrap_mean(values, seed=1) == bootstrap_mean(values, seed=1)
    assert bootstrap_mean(values, seed=1) != bootstrap_mean(values, seed=2)


def test_texts_that_resemble_one_another_widen_it():
    values = np.repeat(np.random.default_rng(0).normal(size=10), 20)
    paths = [str(i // 20) for i in range(200)]
    alone, together = bootstrap_mean(values), bootstrap_mean(values, paths)
    assert together.high - together.low > 3 * (alone.high - alone.low)
    assert (together.units, together.is_clustered) == (10, True)


def test_clusters_of_one_are_no_clusters():
    labels = list("abcdefghijkl")
    values = np.arange(12.0)
    alone, together = bootstrap_mean(values), bootstrap_mean(values, labels)
    assert (alone.low, alone.high) == (together.low, together.high)
    rows = unit(np.random.default_rng(0).normal(size=(12, 3)).astype(np.float32))
    rows = rows[np.argsort(rows[:, 0])]
    alone = bootstrap_pairwise(rows)
    together = bootstrap_pairwise(rows, labels)
    assert (alone.low, alone.high) == (together.low, together.high)


@given(st.lists(st.sampled_from("abcde"), min_size=2, max_size=12), st.booleans(), st.data())
def test_the_order_of_the_items_changes_no_interval(labels, is_clustered, data):
    n = len(labels)
    values = np.array(data.draw(st.lists(st.floats(0, 1), min_size=n, max_size=n)))
    rows = unit(np.stack([values, np.square(values), 1 - values], axis=1).astype(np.float32))
    order = data.draw(st.permutations(range(n)))
    clusters = labels if is_clustered else None
    moved = [labels[place] for place in order] if is_clustered else None
    for one, other in (
        (bootstrap_mean(values, clusters), bootstrap_mean(values[order], moved)),
        (bootstrap_median(values, clusters), bootstrap_median(values[order], moved)),
        (bootstrap_pairwise(rows, clusters), bootstrap_pairwise(rows[order], moved)),
    ):
        assert one == other


@pytest.mark.parametrize("seed", [4, 14, 26, 27])
def test_the_order_of_the_items_does_not_show_in_the_last_digit_either(seed):
    tenths = np.random.default_rng(seed).integers(0, 50, 40) / 10
    labels = list("abcdefgh") * 5
    forwards = bootstrap_mean(tenths, labels, replicates=200)
    assert forwards == bootstrap_mean(tenths[::-1], labels[::-1], replicates=200)


@pytest.mark.parametrize("columns", [(0, 2), (1, 3), (2, 3)])
def test_rows_that_differ_in_some_columns_alone_may_stand_in_any_order(columns):
    angles = np.random.default_rng(4).uniform(0.0, np.pi, 9)
    rows = np.zeros((9, 4), np.float32)
    rows[:, columns] = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    assert bootstrap_pairwise(rows) == bootstrap_pairwise(rows[::-1])


def test_five_units_have_an_interval():
    values = np.array([1.0, 2.0, 4.0, 8.0, 16.0, 32.0])
    rows = unit(np.random.default_rng(1).normal(size=(6, 4)).astype(np.float32))
    assert bootstrap_mean(values[:5]) is not None
    assert bootstrap_median(values[:5]) is not None
    assert bootstrap_pairwise(rows[:5]) is not None
    for clusters in (list("abcdee"), list("abcdea")):
        for found in (bootstrap_mean(values, clusters), bootstrap_pairwise(rows, clusters)):
            assert (found.units, found.is_clustered) == (5, True)
    assert not bootstrap_mean(values).is_clustered


def test_draws_are_two_thousand_of_seed_0_unless_told_otherwise():
    values = np.random.default_rng(2).normal(size=9)
    rows = unit(np.random.default_rng(2).normal(size=(9, 3)).astype(np.float32))
    for found in (
        lambda **how: Resampler(9, **how).weights.tolist(),
        lambda **how: bootstrap_mean(values, **how),
        lambda **how: bootstrap_pairwise(rows, **how),
    ):
        assert found() == found(seed=0, replicates=2000)
        assert found() != found(seed=1, replicates=2000)
        assert found() != found(seed=0, replicates=2001)


@pytest.mark.parametrize("units", range(1, FEWEST_CLUSTERS))
def test_too_few_units_have_no_interval(units):
    values, rows = np.arange(1.0 * units), np.eye(units, dtype=np.float32)
    paths = [str(n % units) for n in range(12)]
    for bootstrap, few, many in (
        (bootstrap_mean, values, np.arange(12.0)),
        (bootstrap_median, values, np.arange(12.0)),
        (bootstrap_pairwise, rows, np.eye(12, dtype=np.float32)),
    ):
        assert bootstrap(few) is None
        assert bootstrap(many, paths) is None


def test_without_a_pair_in_any_replicate_there_is_no_interval():
    # Five texts, of which one replicate draws a single one once in 625.
    rows = np.eye(5, dtype=np.float32)
    lonely = [bootstrap_pairwise(rows, seed=seed, replicates=1) for seed in range(4_000)]
    assert None in lonely
    assert any(lonely)


def test_pairs_of_a_text_with_its_own_copy_do_not_count():
    rows = np.eye(8, dtype=np.float32)
    found = bootstrap_pairwise(rows)
    assert abs(found.low) < 1e-12
    assert abs(found.high) < 1e-12


def test_pairs_are_those_of_different_paths_and_those_within_a_drawn_path():
    rows = unit(np.random.default_rng(6).normal(0.3, 1.0, size=(11, 4)).astype(np.float32))
    paths = [0, 0, 0, 1, 1, 2, 3, 3, 3, 3, 4]
    draws = stream(7, "bootstrap", "pairwise").multinomial(5, np.full(5, 0.2), size=60)
    means = []
    for weights in draws.tolist():
        drawn = [
            (path, copy, text) for text, path in enumerate(paths) for copy in range(weights[path])
        ]
        cosines = [
            float(rows[a[2]] @ rows[b[2]])
            for a, b in itertools.combinations(drawn, 2)
            if a[0] != b[0] or a[1] == b[1]
        ]
        means += [np.mean(cosines)] if cosines else []
    found = bootstrap_pairwise(rows, list(map(str, paths)), seed=7, replicates=60)
    expected = np.quantile(means, [0.025, 0.975])
    np.testing.assert_allclose((found.low, found.high), expected, atol=1e-6)


def test_an_interval_of_pairs_surrounds_the_figure():
    rows = unit(np.random.default_rng(5).normal(0.5, 1.0, size=(60, 8)).astype(np.float32))
    wide = rows.astype(np.float64)
    cosines = (wide @ wide.T)[np.triu_indices(60, 1)]
    for clusters in (None, [str(i % 12) for i in range(60)]):
        found = bootstrap_pairwise(rows, clusters)
        assert found.low < cosines.mean() < found.high


def test_a_clustered_interval_is_wider_where_paths_are_alike() -> None:
    clusters = [f"{index // 10}" for index in range(200)]
    alike = np.repeat(np.arange(20) % 2, 10).astype(float)[:, None]
    mixed = np.tile(np.arange(10) % 2, 20).astype(float)[:, None]
    resampler = Resampler(clusters)
    ones = np.ones((200, 1))
    wide = cluster_interval(resampler.ratios(alike, ones)[:, 0], 20)
    assert wide is not None
    low, high = wilson(100, 200)
    assert wide.high - wide.low > 2 * (high - low)
    assert cluster_interval(resampler.ratios(mixed, ones)[:, 0], 20) is None
    assert intraclass(alike[:, 0], clusters) == pytest.approx(1)
    assert intraclass(mixed[:, 0], clusters) == 0


def test_the_same_seed_gives_the_same_draws() -> None:
    clusters = list("aabbccddee")
    assert (Resampler(clusters, seed=3).weights == Resampler(clusters, seed=3).weights).all()
    assert (Resampler(clusters, seed=3).weights != Resampler(clusters, seed=4).weights).any()
    assert Resampler([]).ratios(np.zeros((0, 2)), np.zeros((0, 2))).shape == (2000, 2)


@given(st.lists(st.sampled_from("abcd"), min_size=1, max_size=20), st.data())
def test_clusters_are_counted_and_summed(clusters: list[str], data: st.DataObject) -> None:
    mask = np.array(
        data.draw(st.lists(st.booleans(), min_size=len(clusters), max_size=len(clusters)))
    )
    resampler = Resampler(clusters)
    there = {one for one, kept in zip(clusters, mask, strict=True) if kept}
    assert resampler.count(mask) == len(there)
    values = np.arange(float(len(clusters)))
    sums = {c: values[[cluster == c for cluster in clusters]].sum() for c in sorted(set(clusters))}
    assert resampler.summed(values[:, None])[:, 0].tolist() == list(sums.values())


def test_a_ratio_may_have_a_small_denominator() -> None:
    resampler = Resampler(list("aabbccddee"), replicates=50)
    below = np.full((10, 1), 0.02)
    assert resampler.ratios(3 * below, below) == pytest.approx(3.0)
    assert np.isnan(resampler.ratios(below, 0 * below)).all()


def test_many_clusters_are_drawn_in_blocks_of_the_same_draws(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole = Resampler(9, replicates=20).weights
    monkeypatch.setattr(_resampling, "_CELLS", 60)
    blocks = list(Resampler(9, replicates=20).blocks())
    assert [len(block) for block in blocks] == [6, 6, 6, 2]
    assert (np.concatenate(blocks) == whole).all()
    assert (whole.sum(axis=1) == 9).all()
    assert (Resampler(9, replicates=20, purpose="other").weights != whole).any()


@given(st.integers(0, 9), st.integers(1, 30), st.integers(1, 20))
def test_a_block_has_as_many_draws_as_memory_allows_and_at_least_one(
    units: int, replicates: int, cells: int
) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(_resampling, "_CELLS", cells)
        found = list(_resampling.blocks(replicates, units))
        step = max(1, cells // max(1, units))
        assert sum(found) == replicates
        assert all(size == step for size in found[:-1])
        assert 0 < found[-1] <= step
        patch.setattr(_resampling, "_CELLS", max(1, units * replicates))
        resampler = Resampler(units, replicates=replicates)
        assert [block is resampler.weights for block in resampler.blocks()] == [True]
