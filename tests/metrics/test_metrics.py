import copy
import json
import math
import pickle
from typing import get_args

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen import Metrics
from oodscen._seeding import stream
from oodscen.baselines._baseline import Baseline
from oodscen.baselines._ordinary import ordinary_driving
from oodscen.data._scenario import Scenario
from oodscen.encoders._cached import CachedEncoder
from oodscen.errors import DataError, EncoderError, UnknownComponent, UsageError
from oodscen.metrics._oodness import Measure
from oodscen.metrics._report import MetricsReport
from oodscen.statistics._auroc import auroc
from oodscen.testing._encoder import HashEncoder


class Directions:
    """Every text is a random direction of its own; "zero" has none."""

    name = "directions"
    dimension = 7

    def encode(self, texts):
        rows = [np.zeros(7) if t == "zero" else stream(0, t).normal(0.3, 1.0, 7) for t in texts]
        return np.array(rows, np.float32).reshape(-1, 7)

    def exact(self, texts):
        rows = self.encode(texts).astype(np.float64)
        lengths = np.linalg.norm(rows, axis=1)[:, None]
        return np.divide(rows, lengths, out=np.zeros_like(rows), where=lengths > 0)


ENCODER = Directions()
words = st.lists(
    st.text("abcdefgh", min_size=1, max_size=3) | st.just("zero"), min_size=2, max_size=12
)
quick = settings(deadline=None, max_examples=25)


@quick
@given(words, words)
def test_figures_agree_with_an_independent_float64_computation(texts, ordinary):
    metrics = Metrics(ENCODER, ordinary)
    a, b = ENCODER.exact(texts), ENCODER.exact(ordinary)
    cosines, own = a @ b.T, a @ a.T
    report = metrics.report(texts)
    np.testing.assert_allclose(report.oodness.per_text, -cosines.max(axis=1), atol=1e-6)
    assert report.oodness.mean == pytest.approx(-cosines.max(axis=1).mean(), abs=1e-6)
    printed = metrics.oodness(texts, "printed")
    np.testing.assert_allclose(printed.per_text, cosines.min(axis=1), atol=1e-6)
    pairs = own[np.triu_indices(len(texts), 1)]
    assert report.diversity.pairwise == pytest.approx(-pairs.mean(), abs=1e-6)
    np.fill_diagonal(own, -np.inf)
    assert report.diversity.nearest == pytest.approx(-own.max(axis=1).mean(), abs=1e-6)


@quick
@given(words, words, st.randoms(use_true_random=False))
def test_the_order_of_texts_and_baseline_plays_no_part(texts, ordinary, random):
    mixed, shuffled = random.sample(texts, len(texts)), random.sample(ordinary, len(ordinary))
    one = Metrics(ENCODER, ordinary).report(texts)
    other = Metrics(ENCODER, shuffled).report(mixed)
    assert one.oodness.mean == pytest.approx(other.oodness.mean, abs=1e-6)
    assert one.diversity.nearest == pytest.approx(other.diversity.nearest, abs=1e-6)
    assert one.diversity.pairwise == pytest.approx(other.diversity.pairwise, abs=1e-6)


@quick
@given(words, words, words)
def test_a_larger_baseline_makes_nothing_more_ood(texts, ordinary, more):
    small = Metrics(ENCODER, ordinary).oodness(texts)
    large = Metrics(ENCODER, ordinary + more).oodness(texts)
    assert np.all(np.array(large.per_text) <= np.array(small.per_text) + 1e-6)


@quick
@given(words, st.text("xyz", min_size=1, max_size=4))
def test_more_texts_lower_the_nearest_diversity_of_those_there(texts, more):
    metrics = Metrics(ENCODER, ["b"])
    few, many = metrics.diversity(texts), metrics.diversity([*texts, more])
    similarity = ENCODER.exact([*texts, more])
    cosines = similarity @ similarity.T
    np.fill_diagonal(cosines, -np.inf)
    before = cosines[:-1, :-1].max(axis=1).mean()
    assert few.nearest == pytest.approx(-before, abs=1e-6)
    assert many.nearest * many.n <= few.nearest * few.n + 1.0 + 1e-6


def test_a_text_of_the_baseline_is_not_ood_and_a_copy_not_diverse():
    texts = ["alpha", "beta", "gamma"]
    metrics = Metrics(ENCODER, texts)
    assert metrics.oodness(texts).mean == pytest.approx(-1.0, abs=1e-6)
    assert [n.text for n in metrics.oodness(texts).nearest] == texts
    twice = metrics.diversity(["alpha", "alpha"])
    assert twice.nearest == pytest.approx(-1.0, abs=1e-6)
    assert twice.pairwise == pytest.approx(-1.0, abs=1e-6)
    assert twice.nearest_index == (1, 0)


def test_pairwise_diversity_does_not_depend_on_the_size_but_nearest_does():
    metrics = Metrics(ENCODER, ["b"])
    small = metrics.diversity([f"t{i}" for i in range(30)])
    large = metrics.diversity([f"t{i}" for i in range(600)])
    assert abs(small.pairwise - large.pairwise) < 0.1
    assert large.nearest < small.nearest - 0.1


def test_one_text_has_oodness_and_no_diversity():
    report = Metrics(ENCODER, ["b"]).report(["a"])
    assert report.oodness.interval is None
    assert (report.diversity.nearest, report.diversity.pairwise) == (None, None)
    assert report.diversity.reason


@pytest.mark.parametrize(
    ("texts", "places"),
    [
        ([], [""]),
        ("a text", [""]),
        (["a", "", "b", " \n"], ["[1]", "[3]"]),
        (["a", None, 3], ["[1]", "[2]"]),
        (["half a \ud83d"], ["[0]"]),
    ],
)
def test_bad_texts_are_refused_each_with_its_place(texts, places):
    metrics = Metrics(ENCODER, ["b"])
    for ask in (metrics.oodness, metrics.diversity, metrics.report):
        with pytest.raises(DataError) as caught:
            ask(texts)
        assert [issue.path for issue in caught.value.issues] == places


def test_an_empty_baseline_is_refused():
    with pytest.raises(DataError):
        Metrics(ENCODER, [])


@pytest.mark.parametrize("result", [np.ones((1, 7)), np.ones((1, 6), np.float32), [[0.0] * 7]])
def test_an_encoder_that_breaks_its_contract_is_named(monkeypatch, result):
    monkeypatch.setattr(Directions, "encode", lambda self, texts: result)
    with pytest.raises(EncoderError, match="directions"):
        Metrics(Directions(), ["b"]).oodness(["a"])


def test_a_report_round_trips_and_reads_like_a_mapping():
    report = Metrics(ENCODER, ["b", "c"], seed=4).report(list("adefgh"), list("ppqrst"))
    assert MetricsReport.parse(report.to_json()) == report
    plain = json.loads(report.to_json())
    assert dict(report) == plain
    assert all(name in report for name in plain)
    assert "nothing" not in report
    assert plain["oodness"]["mean"] == report.oodness.mean
    assert (plain["n"], plain["N"], plain["encoder"]) == (6, 2, "directions")
    assert {label: group["n"] for label, group in plain["groups"].items()} == {
        "p": 2,
        "q": 1,
        "r": 1,
        "s": 1,
        "t": 1,
    }
    assert report.oodness.interval.is_clustered
    with pytest.raises(KeyError):
        report["nothing"]


@pytest.mark.parametrize(
    "groups",
    [
        [("r", "a"), ("r", "a"), ("r", "b")],
        [["r", "a"], ["r", "a"], ["r", "b"]],
        np.array([["r", "a"], ["r", "a"], ["r", "b"]]),
    ],
)
def test_groups_may_be_paths_of_labels(groups):
    report = Metrics(ENCODER, ["b", "c"]).report(["a", "d", "e"], groups)
    assert {label: group.n for label, group in report.groups.items()} == {"r / a": 2, "r / b": 1}


def test_groups_may_be_numbers_and_nothing_else():
    metrics = Metrics(ENCODER, ["b", "c"])
    assert set(metrics.report(["a", "d"], [1, np.int64(2)]).groups) == {"1", "2"}
    for label in (None, True, 1.5, (), ("r", 2), {}, 10**5000):
        with pytest.raises(UsageError, match="each element of groups"):
            metrics.report(["a", "d"], ["p", label])


@pytest.mark.parametrize(
    "call",
    [
        lambda metrics: metrics.oodness(["a"], np.array(["tabulated", "printed"])),
        lambda metrics: metrics.rarity(["a"], anchors=3),
        lambda metrics: metrics.near_duplicates(["a"], by_meaning="no"),
        lambda metrics: metrics.report(["a"], checks="no"),
        lambda metrics: metrics.compare(["a"], ["b"], paired=np.array([True, False])),
    ],
)
def test_arguments_of_other_kinds_are_named(call):
    with pytest.raises(UsageError, match=r"must be|unknown"):
        call(Metrics(ENCODER, ["b", "c"]))


def test_groups_are_a_sequence_in_an_order():
    metrics = Metrics(ENCODER, ["b", "c"])
    for groups in ("pq", {"p", "q"}, 2):
        with pytest.raises(UsageError, match="groups"):
            metrics.report(["a", "d"], groups)


def test_an_unknown_definition_lists_all():
    metrics = Metrics(ENCODER, ["b", "c"])
    for measure in (metrics.oodness, metrics.report):
        with pytest.raises(UnknownComponent, match="printed") as caught:
            measure(["a"], definition="print")
        assert set(caught.value.known) == set(get_args(Measure))


def test_a_report_prints_its_figures():
    report = Metrics(ENCODER, ["b", "c"]).report(["a", "d"])
    assert f"{report.oodness.mean:+.3f}" in str(report)
    assert f"{report.diversity.pairwise:+.3f}" in str(report)
    assert "none" in str(Metrics(ENCODER, ["b"]).report(["a"]))


def test_the_same_seed_gives_the_same_report():
    texts = [f"t{i}" for i in range(20)]
    one, same, other = (Metrics(ENCODER, ["b", "c"], seed=seed).report(texts) for seed in (1, 1, 2))
    assert one.to_json() == same.to_json()
    assert one.oodness.interval != other.oodness.interval


def test_scenarios_are_resampled_by_their_paths():
    scenarios = [Scenario(id=f"s-{i}", text=f"t{i}", path=("root", f"p{i % 5}")) for i in range(9)]
    report = Metrics(ENCODER, ["b"]).report(scenarios)
    assert report.oodness.interval.units == 5
    assert set(report.groups) == {f"root / p{i}" for i in range(5)}
    assert (
        report.oodness.per_text
        == Metrics(ENCODER, ["b"]).oodness([f"t{i}" for i in range(9)]).per_text
    )


def test_labels_that_do_not_fit_are_refused():
    with pytest.raises(DataError):
        Metrics(ENCODER, ["b"]).report(["a", "c"], ["p"])


@quick
@given(words, st.floats(-1, 1), st.floats(-1, 1))
def test_a_band_keeps_what_lies_in_it(texts, x, y):
    low, high = min(x, y), max(x, y)
    band = Metrics(ENCODER, ["b", "c"]).band(texts, low, high)
    kept = [i for i, score in enumerate(band.scores) if low <= score <= high]
    assert list(band.indices) == kept
    assert list(band.texts) == [texts[i] for i in kept]
    assert band.below + band.above + len(kept) == len(texts)


def test_a_band_may_be_open_but_not_reversed():
    metrics = Metrics(ENCODER, ["b"])
    band = metrics.band(["a", "c"], -math.inf, math.inf)
    assert (band.low, band.high, band.indices) == (None, None, (0, 1))
    for low, high in (
        (0.5, 0.1),
        (math.nan, 0.0),
        (0.0, math.nan),
        (math.inf, math.inf),
        (-math.inf, -math.inf),
    ):
        with pytest.raises(UsageError):
            metrics.band(["a"], low, high)


def test_a_batch_of_the_baseline_is_measured_against_its_rest():
    ordinary = [f"t{i}" for i in range(40)]
    metrics = Metrics(ENCODER, ordinary)
    batch = metrics.baseline_batch(size=39, repeats=200)
    rows = ENCODER.exact(ordinary)
    cosines = rows @ rows.T
    expected = np.mean(
        [-np.delete(cosines[:, i], i).mean() for i in range(40)]  # one text is the rest of 39
    )
    assert batch.mean == pytest.approx(expected, abs=0.03)
    assert batch == metrics.baseline_batch(size=39, repeats=200)
    assert (batch.N, len(batch.per_repeat)) == (40, 200)
    for size in (0, 40, 100):
        with pytest.raises(UsageError):
            metrics.baseline_batch(size=size)


def test_copies_in_the_baseline_bring_a_batch_to_minus_one():
    assert Metrics(ENCODER, ["a", "b"] * 20).baseline_batch(5).mean == pytest.approx(-1.0, abs=1e-6)


def test_the_diversity_of_the_baseline_may_be_sampled():
    ordinary = [f"t{i}" for i in range(40)]
    metrics = Metrics(ENCODER, ordinary)
    assert metrics.baseline_diversity() == metrics.diversity(ordinary)
    assert metrics.baseline_diversity(10).n == 10
    with pytest.raises(UsageError):
        metrics.baseline_diversity(41)


def test_sets_are_compared_at_equal_size():
    metrics = Metrics(ENCODER, ["b", "c"])
    large, small = [f"t{i}" for i in range(60)], [f"u{i}" for i in range(12)]
    found = metrics.compare(large, small)
    assert (found.size, found.n_a, found.n_b) == (12, 60, 12)
    assert found.nearest.b == pytest.approx(metrics.diversity(small).nearest, abs=1e-6)
    assert found.nearest.a > metrics.diversity(large).nearest
    assert found.pairwise.a == pytest.approx(metrics.diversity(large).pairwise, abs=0.05)
    assert found.nearest.low <= found.nearest.difference <= found.nearest.high
    assert found == metrics.compare(large, small)
    with pytest.raises(UsageError):
        metrics.compare(large, small, size=13)
    with pytest.raises(UsageError):
        metrics.compare(["a"], small)


def test_a_baseline_is_kept_on_disk_only_for_encoders_that_allow_it(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    Metrics(HashEncoder(), ["b"]).oodness(["a"])
    assert not list(tmp_path.rglob("*"))

    class Slow(HashEncoder):
        cacheable = True

    baseline = Baseline(texts=("b", "c"))
    Metrics(CachedEncoder(Slow()), baseline).oodness(["a"])
    (file,) = tmp_path.rglob("*.npz")
    assert file.parent.name == baseline.digest()[:16]
    file.write_bytes(b"rubbish")
    assert Metrics(Slow(), baseline).oodness(["b"]).mean == pytest.approx(-1.0, abs=1e-6)


def test_what_is_out_of_distribution_scores_higher_than_ordinary_text(minilm):
    metrics = Metrics(minilm, ordinary_driving().texts[::20])
    strange = [
        "Ego is driving on a two-lane residential road in clear weather, and a sofa lies in its lane.",
        "The ego vehicle is travelling on a highway when a deer leaps over the barrier.",
        "Ego is moving on a three-lane road, with an overturned vehicle ahead in the same lane.",
    ]
    usual = [
        "Ego is driving on a two-lane residential road in clear weather, and a van drives ahead.",
        "The ego vehicle is travelling on a highway when a car merges from the ramp.",
        "Ego is moving on a three-lane road, with another vehicle ahead in the same lane.",
    ]
    ood, ordinary = metrics.oodness(strange), metrics.oodness(usual)
    assert all(x > y for x, y in zip(ood.per_text, ordinary.per_text, strict=True))


def test_a_report_says_how_its_texts_stand_to_ordinary_ones():
    metrics = Metrics(HashEncoder(), ordinary_driving().texts[::40])
    report = metrics.report(["a crocodile crawls from the drain", "flames engulf the viaduct"])
    assert report.control.n == 95
    assert report.control.auroc.n_ood == 2
    assert report.calibration.held_out == len(metrics.baseline)
    assert "AUROC" in str(report)
    bare = metrics.report(["a car waits"], checks=False)
    assert (bare.control, bare.calibration, bare.off_topic) == (None, None, None)


def test_a_difference_is_tested():
    metrics = Metrics(ENCODER, [f"b{i}" for i in range(20)])
    near, far = [f"b{i}" for i in range(12)], [f"t{i}" for i in range(12)]
    assert metrics.compare(far, near).oodness.p_value < 0.01
    assert metrics.compare(near, near).oodness.p_value > 0.9
    paired = metrics.compare(far, near, paired=True)
    assert paired.is_paired
    assert paired.oodness.p_value < 0.01
    assert "p = " in str(paired)
    with pytest.raises(UsageError):
        metrics.compare(far, near[:5], paired=True)


def test_a_very_long_text_is_scored():
    found = Metrics(HashEncoder(), ["a car waits"]).oodness(["a car waits " * 9000])
    assert found.mean == pytest.approx(-1.0, abs=1e-5)


def test_torch_looks_up_the_same_neighbours():
    texts, ordinary = [f"t{i}" for i in range(20)], [f"b{i}" for i in range(30)]
    ours, torchs = (Metrics(ENCODER, ordinary, device=d).oodness(texts) for d in ("cpu", "auto"))
    np.testing.assert_allclose(ours.per_text, torchs.per_text, atol=1e-6)


@pytest.mark.parametrize("device", ["meta", "hpu", "nonsense", ""])
def test_a_device_that_cannot_compute_is_refused(device):
    pytest.importorskip("torch")
    with pytest.raises(UsageError, match="torch cannot use the device"):
        Metrics(ENCODER, ["a car waits"], device=device)


def scenarios(count: int, paths: int, word: str = "t") -> list[Scenario]:
    return [
        Scenario(id=f"{word}-{i}", text=f"{word}{i}", path=("root", f"p{i % paths}"))
        for i in range(count)
    ]


def test_every_interval_draws_whole_paths_and_lies_about_its_figure():
    report = Metrics(ENCODER, ["b", "c", "d"]).report(scenarios(40, 8))
    figures = (
        (report.oodness.mean, report.oodness.interval),
        (report.diversity.nearest, report.diversity.nearest_interval),
        (report.diversity.pairwise, report.diversity.pairwise_interval),
        (report.control.auroc.value, report.control.auroc.interval),
    )
    for value, interval in figures:
        assert (interval.method, interval.units) == ("cluster bootstrap", 8)
        assert interval.low < value < interval.high
    assert (report.N, report.oodness.N, report.n, report.oodness.n) == (3, 3, 40, 40)


@pytest.mark.parametrize("definition", ["tabulated", "printed", "kth"])
def test_the_checks_are_by_the_definition_of_the_report(definition):
    metrics = Metrics(ENCODER, [f"b{i}" for i in range(30)])
    report = metrics.report([f"t{i}" for i in range(9)], definition=definition)
    controls = np.array(metrics.control_scores(definition))
    assert report.control.mean == pytest.approx(controls.mean())
    assert report.control.auroc.value == auroc(controls, np.array(report.oodness.per_text))
    held_out = metrics.held_out_scores(definition)
    assert report.calibration.held_out_mean == pytest.approx(np.mean(held_out))


def test_whole_paths_are_exchanged_in_a_test_of_two_sets():
    metrics = Metrics(ENCODER, [f"b{i}" for i in range(20)])
    far = scenarios(12, 4)
    near = [one.model_copy(update={"text": f"b{i}"}) for i, one in enumerate(far)]
    assert metrics.compare(far, near, paired=True).oodness.p_value == pytest.approx(2 / 2**4)
    assert metrics.compare(far, near).oodness.p_value > 2 / 70 * 0.7
    plain = [[text.text for text in texts] for texts in (far, near)]
    for pairs in ((far, plain[1]), (plain[1], far)):
        assert metrics.compare(*pairs, paired=True).oodness.p_value == pytest.approx(2 / 2**4)
    assert metrics.compare(*plain).oodness.p_value < 0.001
    assert metrics.compare(far, far, paired=True, size=5).pairwise.high == 0


@pytest.mark.parametrize("definition", ["tabulated", "printed", "kth", "events"])
def test_nothing_is_held_out_of_a_baseline_of_one_text(definition):
    metrics = Metrics(HashEncoder(64), ["A car waits at the light."])
    with pytest.raises(UsageError, match="one text"):
        metrics.held_out_scores(definition)
    assert metrics.report(["A deer."], definition=definition).calibration is None


def test_the_spread_of_batches_is_that_of_a_sample():
    found = Metrics(ENCODER, [f"b{i}" for i in range(9)]).baseline_batch(3, 4)
    assert found.spread == pytest.approx(np.std(found.per_repeat, ddof=1))


@pytest.mark.parametrize("is_on_disk", [False, True])
@given(st.integers(0, 9), st.integers(2, 40), st.booleans())
@settings(max_examples=5)
def test_a_pickled_copy_gives_the_same_figures(tmp_path_factory, is_on_disk, seed, size, is_cached):
    encoder = HashEncoder(size)
    baseline = ["a car waits", "the road is dry", "a bus stops"]
    if is_on_disk:
        file = tmp_path_factory.mktemp("pickled") / "rows.npy"
        Metrics(encoder, baseline).write_embeddings(file, baseline)
        baseline = file
    metrics = Metrics(CachedEncoder(encoder) if is_cached else encoder, baseline, seed=seed)
    texts = ["a deer runs", "a car waits in fog", "the road is gone"]
    found = metrics.oodness(texts)
    assert pickle.loads(pickle.dumps(metrics)).oodness(texts) == found
    assert copy.deepcopy(metrics).diversity(texts) == metrics.diversity(texts)


def test_the_default_metrics_are_pickled_without_their_model_and_vectors(monkeypatch):
    few = Baseline(texts=ordinary_driving().texts[::20])
    monkeypatch.setattr("oodscen.metrics._metrics.ordinary_driving", lambda: few)
    metrics = Metrics()
    metrics.oodness(["A deer runs."])
    data = pickle.dumps(metrics)
    assert len(data) < metrics.baseline_vectors.nbytes
    assert pickle.loads(data).oodness(["A deer runs."]) == metrics.oodness(["A deer runs."])


class Sorted(Directions):
    """Sorts its texts by length, and forgets to sort the rows back."""

    def encode(self, texts):
        return super().encode(sorted(texts, key=len))


class Random(Directions):
    """Gives a text another vector in every call."""

    def __init__(self):
        self.rng = np.random.default_rng(0)

    def encode(self, texts):
        return self.rng.normal(size=(len(texts), 7)).astype(np.float32)


@pytest.mark.parametrize("encoder", [Sorted(), Random()])
def test_an_encoder_that_mixes_up_rows_or_changes_them_is_named(encoder):
    with pytest.raises(EncoderError, match=r"directions gave text . of 3 another vector"):
        Metrics(encoder, ["a", "bb"]).oodness(["A car that waits.", "A deer.", "A bus turns."])
