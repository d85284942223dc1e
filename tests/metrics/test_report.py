"""A report tells in words which texts it is of, on the terminal and in a notebook alike."""

import math
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen import Metrics
from oodscen.baselines._baseline import Baseline
from oodscen.metrics._detection.guard import OffTopicFlags
from oodscen.metrics._report import MetricsReport
from oodscen.testing._encoder import HashEncoder

TEXTS = ["a deer jumps onto the road", "a car waits at the light", "a sofa lies in the lane"]
ORDINARY = ["a car waits at the light", "a van turns left", "a bus stops"]


@pytest.fixture(scope="module")
def report() -> MetricsReport:
    return Metrics(HashEncoder(), Baseline(texts=ORDINARY)).report(TEXTS)


def caption(report: MetricsReport) -> str:
    return re.search(r"<caption>(.*?)</caption>", report._repr_html_())[1]


@pytest.mark.parametrize(
    ("band", "words"),
    [
        ((-0.9, 0.5), "from -0.9 to 0.5; below it: 1, above: 0"),
        ((-math.inf, -0.9), "up to -0.9; below it: 0, above: 2"),
        ((-0.9, math.inf), "from -0.9; below it: 1, above: 0"),
        ((-math.inf, math.inf), "without bounds; below it: 0, above: 0"),
    ],
)
def test_a_band_is_told_by_the_bounds_that_it_has(tmp_path, band, words):
    path = tmp_path / "texts.txt"
    path.write_text("\n".join(TEXTS))
    found = Metrics(HashEncoder(), Baseline(texts=ORDINARY)).score_file(path, band=band)
    assert str(found).splitlines()[1] == f"texts of the band {words}"
    assert caption(found).endswith(f"; texts of the band {words}")


def test_the_view_has_the_interval_of_rarity():
    report = Metrics(HashEncoder(), Baseline(texts=ORDINARY)).report([*TEXTS, *ORDINARY])
    found = report.rarity.interval
    shown = re.search(r"rarity, median.*?</tr>", report._repr_html_(), re.DOTALL)[0]
    assert f"{found.low:.3f} to {found.high:.3f}" in shown


def test_a_report_of_all_texts_tells_of_no_band(report):
    assert "band" not in str(report) + report._repr_html_()


@given(st.sets(st.integers(0, 40), min_size=1).map(sorted))
def test_texts_that_are_not_about_driving_are_counted_from_1(report, flagged):
    flags = OffTopicFlags(
        flagged=tuple(flagged), scores=(), threshold=0.0, share=0.5, calibrated=True
    )
    told = str(report.model_copy(update={"off_topic": flags}))
    (line,) = [one for one in told.splitlines() if "driving a car" in one]
    assert line.startswith(f"{len(flagged)} text")
    named = re.search(r"\((?:text|texts) (.*)\)", line)[1]
    numbers, _, left = named.partition(" and ")
    assert [int(number) for number in numbers.split(", ")] == [n + 1 for n in flagged[:10]]
    assert left == (f"{len(flagged) - 10} more" if len(flagged) > 10 else "")
