import json

import pytest

from oodscen import Metrics
from oodscen.baselines._baseline import Baseline
from oodscen.errors import DataError, UsageError
from oodscen.testing._encoder import HashEncoder

TEXTS = ["a deer jumps onto the road", "a car waits at the light", "a sofa lies in the lane"]
ORDINARY = ["a car waits at the light", "a van turns left", "a bus stops"]


@pytest.fixture
def lines(tmp_path):
    path = tmp_path / "texts.txt"
    path.write_text("\n".join(TEXTS) + "\n")
    return path


def test_a_file_scores_as_its_texts_do(lines):
    baseline = Baseline(texts=ORDINARY)
    report = Metrics(HashEncoder(), baseline, seed=3).score_file(lines)
    assert report == Metrics(HashEncoder(), baseline, seed=3).report(TEXTS)


def test_the_baseline_may_be_a_file(lines, tmp_path):
    path = tmp_path / "ordinary.jsonl"
    path.write_text("\n".join(json.dumps({"text": text}) for text in ORDINARY))
    report = Metrics(HashEncoder(), path).score_file(lines)
    assert (report.baseline, report.N) == ("ordinary.jsonl", 3)
    assert report.oodness.per_text[1] == pytest.approx(-1.0, abs=1e-6)


def test_paths_of_scenarios_cluster_the_intervals(tmp_path):
    path = tmp_path / "scenarios.jsonl"
    rows = [{"id": str(i), "text": t, "path": ["r", str(i % 2)]} for i, t in enumerate(TEXTS)]
    path.write_text("\n".join(map(json.dumps, rows)))
    report = Metrics(HashEncoder(), Baseline(texts=ORDINARY)).score_file(path)
    assert set(report.groups) == {"r / 0", "r / 1"}


def test_a_text_without_a_group_beside_others_is_refused(tmp_path):
    path = tmp_path / "texts.jsonl"
    rows = [{"text": text, "group": str(i)} for i, text in enumerate(TEXTS)]
    rows[1].pop("group")
    path.write_text("\n".join(map(json.dumps, rows)))
    metrics = Metrics(HashEncoder(), Baseline(texts=ORDINARY))
    for band in (None, (-0.9, 1.0)):
        with pytest.raises(DataError, match="text 2: has no `path`, `leaf` or `group`"):
            metrics.score_file(path, band=band)


def test_a_band_narrows_the_report(lines):
    baseline = Baseline(texts=ORDINARY)
    report = Metrics(HashEncoder(), baseline).score_file(lines, band=(-0.9, 1.0))
    assert report.n == 2
    assert report.band.texts == (TEXTS[0], TEXTS[2])
    assert report.band.below == 1
    with pytest.raises(UsageError):
        Metrics(HashEncoder(), baseline).score_file(lines, band=(0.99, 1.0))
    for bounds in ((-1,), (-1, 0, 1)):
        with pytest.raises(UsageError, match="two bounds"):
            Metrics(HashEncoder(), baseline).score_file(lines, band=bounds)


def test_a_file_that_is_missing_or_empty_is_a_data_error(tmp_path):
    (tmp_path / "empty.txt").write_text("\n\n")
    for name in ("empty.txt", "missing.txt"):
        with pytest.raises(DataError):
            Metrics(HashEncoder(), Baseline(texts=ORDINARY)).score_file(tmp_path / name)


def test_the_table_has_every_definition_of_every_size(tmp_path):
    path = tmp_path / "many.txt"
    path.write_text("\n".join(f"a deer {i} jumps over car {i % 7}" for i in range(30)))
    baseline = Baseline(texts=[f"a car {i} waits" for i in range(40)])
    table = Metrics(HashEncoder(), baseline).paper_table(path.read_text().splitlines())
    assert [(row.label, row.n) for row in table.rows] == [
        ("baseline, batches", 20),
        ("baseline, all", 40),
        ("texts, draws", 10),
        ("texts, all", 30),
    ]
    report = Metrics(HashEncoder(), baseline).score_file(path)
    assert table.rows[-1].tabulated == pytest.approx(report.oodness.mean)
    assert table.rows[-1].pairwise == pytest.approx(report.diversity.pairwise)
    assert "tabulated" in str(table)


def test_the_table_needs_two_texts_of_a_baseline_and_not_their_embeddings_alone(tmp_path):
    one, two = (Metrics(HashEncoder(), ORDINARY[:count]) for count in (1, 2))
    two.write_embeddings(tmp_path / "two.npy", ORDINARY[:2])
    for metrics in (one, Metrics(HashEncoder(), tmp_path / "two.npy")):
        with pytest.raises(UsageError, match="baseline"):
            metrics.paper_table(["A deer jumps."])
    assert two.paper_table(["A deer jumps."]).rows[-1].n == 1
