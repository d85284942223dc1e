import pytest

from oodscen.metrics import Metrics
from oodscen.report import _measures as measures
from oodscen.report._load import read
from oodscen.study import Study
from oodscen.testing import HashEncoder

ORDINARY = [f"The ego follows vehicle {i} in its lane on street {i % 7}." for i in range(120)]
TEXTS = [f"A cow of kind {i} stands in fog." for i in range(10)]


def test_a_real_report_is_read_in_full() -> None:
    metrics = Metrics(HashEncoder(), ORDINARY)
    report = metrics.report(TEXTS)
    content = {
        "sets": {
            "simulatable": report.model_dump(mode="json"),
            "10": report.model_dump(mode="json"),
        },
        "baseline_batch": metrics.baseline_batch(size=20, repeats=3).model_dump(mode="json"),
        "baseline_diversity": metrics.baseline_diversity().model_dump(mode="json"),
    }
    rows = measures.rows(content)
    assert [row.label.split(",")[0] for row in rows[1:]] == ["Diverse tree", "Simulatable tree"]
    for row in rows:
        assert row.oodness.value
        assert row.nearest.value
        assert row.pairwise.value
        assert row.oodness.bounds
    assert measures.scores(content, "10") == pytest.approx(list(report.oodness.per_text))
    assert measures.chart(content)


def test_examples_are_the_ends_of_a_set(study: Study) -> None:
    found = read(study)
    shown = measures.examples(found.metrics, {**found.texts, "simulatable": found.scenarios})
    assert [item.label for item in shown] == [
        measures.label_of(n) for n in ("10", "20", "simulatable")
    ]
    scores = measures.scores(found.metrics, "20")
    assert shown[1].highest[0].oodness == f"−{-max(scores):.3f}"
    assert shown[1].lowest[-1].oodness == f"−{-min(scores):.3f}"


def test_scores_that_do_not_fit_the_texts_are_not_shown(study: Study) -> None:
    found = read(study)
    assert measures.examples(found.metrics, {"10": found.texts["10"][:-1]}) == []


def test_nothing_measured_is_nothing_shown() -> None:
    assert measures.rows({}) == []
    assert measures.margins({}) == []
    assert measures.chart({}) == ""
    assert measures.scores({"sets": {"10": {"oodness": {"per_text": [1, None]}}}}, "10") == []


def test_margins_are_measured_from_ordinary_driving(study: Study) -> None:
    metrics = read(study).metrics
    mean = metrics["sets"]["10"]["oodness"]["mean"]
    assert measures.margins(metrics)[0] == ("Diverse tree, 10 texts", f"{mean + 0.93:.3f} above")
    metrics["baseline_batch"]["mean"] = mean + 0.1
    assert measures.margins(metrics)[0][1] == "0.100 below"
