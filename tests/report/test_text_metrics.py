"""The figures and pictures of the measures, from real measurements and from those of the test study."""

import pytest
from lxml import html

from oodscen import Metrics, Study
from oodscen.data._scenario import Scenario
from oodscen.metrics._measurements import Measurements, measurements
from oodscen.report import _text_metrics as measures
from oodscen.report._load import Material, read
from oodscen.report._render import render_part
from oodscen.report._sections import RenderedPart
from oodscen.testing._encoder import HashEncoder

ORDINARY = [f"The ego follows vehicle {i} in its lane on street {i % 7}." for i in range(120)]
TEXTS = [
    Scenario(id=f"s-{i}", text=f"A cow of kind <{i}> stands in fog.", leaf=f"leaf-{i % 5}")
    for i in range(10)
]


@pytest.fixture(scope="module")
def measured() -> Measurements:
    """Return real measurements."""
    return measurements(Metrics(HashEncoder(), ORDINARY), {"simulatable": TEXTS, "10": TEXTS[:6]})


def known(study: Study) -> Measurements:
    found = read(study).metrics
    assert found is not None
    return found


def test_a_real_report_is_read_in_full(measured: Measurements) -> None:
    rows = measures.rows(measured)
    assert [row.label.split(",")[0] for row in rows[1:]] == ["Diverse tree", "Simulatable tree"]
    for row in rows:
        assert row.oodness.value
        assert row.nearest.value
        assert row.pairwise.value
        assert row.oodness.bounds
    assert "simulatable, 10 texts" in measures.chart(measured).__html__()


def test_all_pictures_are_drawn_inside_their_boxes(study: Study, measured: Measurements) -> None:
    data = measures.pictures(study, Material(metrics=measured))
    assert data is not None
    page = html.fromstring(f"<div>{render_part(RenderedPart('', 'pictures', data))}</div>")
    boxes = page.xpath("//svg")
    assert len(boxes) == len(page.xpath("//figcaption")) == 4
    for box in boxes:
        width, height = map(float, box.get("viewbox").split()[2:])
        for axis, bound in (("x", width), ("y", height)):
            for name in (axis, f"c{axis}", f"{axis}1", f"{axis}2"):
                assert all(-1 <= float(value) <= bound + 1 for value in box.xpath(f".//@{name}"))
        for path in box.xpath(".//path/@d"):
            for point in path[1:].split("L"):
                x, y = map(float, point.split(","))
                assert 0 <= x <= width
                assert 0 <= y <= height


def test_examples_are_the_ends_of_a_set(study: Study) -> None:
    found, metrics = read(study), known(study)
    shown = measures.examples(metrics, {**found.texts, "simulatable": found.scenarios})
    assert [item.label for item in shown] == [
        measures.label_of(n) for n in ("10", "20", "simulatable")
    ]
    scores = metrics.sets["20"].oodness.per_text
    assert shown[1].highest[0].oodness == f"−{-max(scores):.3f}"
    assert shown[1].lowest[-1].oodness == f"−{-min(scores):.3f}"


def test_scores_that_do_not_fit_the_texts_are_not_shown(study: Study) -> None:
    found = read(study)
    assert measures.examples(known(study), {"10": found.texts["10"][:-1]}) == []


def test_nothing_measured_is_nothing_shown(study: Study) -> None:
    shown = measures.text_metric_variables(Material())
    assert not any(shown.values())
    assert measures.pictures(study, Material()) is None


def test_margins_are_measured_from_ordinary_driving(study: Study) -> None:
    metrics = known(study)
    mean = metrics.sets["10"].oodness.mean
    assert measures.margins(metrics)[0] == ("Diverse tree, 10 texts", f"{mean + 0.93:.3f} above")
    batch = metrics.baseline_batch.model_copy(update={"mean": mean + 0.1})
    lower = metrics.model_copy(update={"baseline_batch": batch})
    assert measures.margins(lower)[0][1] == "0.100 below"
