"""The two definitions of OOD-ness, by every pair of cosines."""

from functools import cache
from typing import get_args

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from oodscen import Metrics
from oodscen._seeding import stream
from oodscen.baselines._baseline import Baseline
from oodscen.encoders._similarity import unit
from oodscen.errors import DataError, UnknownComponent
from oodscen.metrics._oodness import Definition, NearestText, Oodness, oodness, scores
from oodscen.metrics._vectors.space import BaselineSpace
from oodscen.statistics._intervals import FEWEST_CLUSTERS
from oodscen.testing._encoder import HashEncoder

ENCODER = HashEncoder(16)
TEXTS = st.lists(
    st.lists(
        st.sampled_from(["car", "van", "waits", "turns", "deer", "fog", "!"]),
        min_size=1,
        max_size=4,
    ).map(" ".join),
    min_size=1,
    max_size=8,
)


BASELINES = (
    ("car waits",),
    ("car waits", "van turns !"),
    ("!", "fog", "deer waits waits", "car turns", "fog", "van van turns"),
)


@cache
def space(baseline: tuple[str, ...], seed: int = 0) -> BaselineSpace:
    return BaselineSpace(ENCODER, Baseline(texts=baseline), seed, "cpu")


def vectors(seed: int, n: int) -> np.ndarray:
    return unit(np.random.default_rng(seed).normal(size=(n, 5)).astype(np.float32))


def cosines(texts: list[str], baseline: tuple[str, ...]) -> NDArray[np.float64]:
    return ENCODER.encode(texts).astype(float) @ ENCODER.encode(baseline).astype(float).T


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


@given(TEXTS, st.sampled_from(BASELINES), st.sampled_from(get_args(Definition)), st.integers(0, 3))
def test_scores_and_neighbours_are_those_of_a_plain_computation(
    texts: list[str], baseline: tuple[str, ...], definition: Definition, seed: int
) -> None:
    found = oodness(space(baseline, seed), texts, None, definition)
    every = cosines(texts, baseline)
    expected = -every.max(axis=1) if definition == "tabulated" else every.min(axis=1)
    assert found.per_text == pytest.approx(expected, abs=1e-6)
    assert found.mean == pytest.approx(expected.mean(), abs=1e-6)
    assert len(found.nearest) == len(texts)
    for row, neighbour in zip(every, found.nearest, strict=True):
        assert neighbour.cosine == pytest.approx(row.max(), abs=1e-6)
        assert row[neighbour.index] == pytest.approx(row.max(), abs=1e-6)
        assert neighbour.text == baseline[neighbour.index]
    assert (found.n, found.N, found.seed) == (len(texts), len(baseline), seed)
    assert (found.definition, found.encoder) == (definition, "hash-16")
    assert Oodness.parse(found.to_json()) == found


@settings(max_examples=15)
@given(TEXTS, st.sampled_from(get_args(Definition)), st.integers(0, 3), st.data())
def test_the_interval_draws_whole_clusters(
    texts: list[str], definition: Definition, seed: int, data: st.DataObject
) -> None:
    labels = st.lists(st.sampled_from("abcde"), min_size=len(texts), max_size=len(texts))
    clusters = data.draw(st.none() | labels)
    found = oodness(space(BASELINES[1], seed), texts, clusters, definition)
    own = [str(place) for place in np.argsort(np.argsort(found.per_text, kind="stable"))]
    labels_of = clusters or own
    names = sorted(set(labels_of), key=lambda name: (len(name), name))
    if len(names) < FEWEST_CLUSTERS:
        assert found.interval is None
        return
    assert found.interval is not None
    kept = np.array([[label == name for label in labels_of] for name in names], float)
    draws = stream(seed, "bootstrap", "mean").multinomial(
        len(names), np.full(len(names), 1 / len(names)), size=2000
    )
    means = draws @ (kept @ np.array(found.per_text)) / (draws @ kept.sum(axis=1))
    expected = np.quantile(means, [0.025, 0.975])
    assert (found.interval.low, found.interval.high) == pytest.approx(tuple(expected), abs=2e-6)
    assert found.interval.units == len(names)
    assert found.interval.is_clustered == (clusters is not None)


def test_a_detector_scores_the_texts_and_the_neighbours_stay() -> None:
    texts = ["deer waits", "car waits", "fog"]
    room = space(BASELINES[2])
    found, plain = (oodness(room, texts, None, name) for name in ("kth", "tabulated"))
    assert found.per_text == tuple(room.scores(texts, "kth").tolist()) != plain.per_text
    assert found.mean == pytest.approx(np.mean(found.per_text))
    assert (found.definition, found.nearest) == ("kth", plain.nearest)


def test_a_result_is_of_at_least_one_text_and_one_of_the_baseline() -> None:
    nearest = (NearestText(index=0, text="car", cosine=0.5),)
    fields = {"mean": -0.5, "per_text": (-0.5,), "nearest": nearest, "interval": None}
    fields |= {"n": 1, "N": 1, "definition": "tabulated", "encoder": "hash-16"}
    assert Oodness(**fields).seed == 0
    for name in ("n", "N"):
        with pytest.raises(DataError):
            Oodness(**{**fields, name: 0})
    for name, more in (("per_text", (-0.5, -0.4)), ("nearest", nearest * 2), ("n", 2)):
        with pytest.raises(DataError, match="lengths differ"):
            Oodness(**{**fields, name: more})


def test_an_array_without_dimensions_is_no_set_of_texts():
    metrics = Metrics(HashEncoder(), ["A car drives.", "A van waits."])
    for value in (np.ma.masked, np.array("A car.")):
        with pytest.raises(DataError):
            metrics.oodness(value)
