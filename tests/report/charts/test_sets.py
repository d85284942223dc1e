from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

from oodscen.report._charts.canvas import Canvas, signed
from oodscen.report._charts.sets import Cloud, HistogramRow, cloud_map, histogram, scatter

SCORES = st.lists(st.floats(-1, 1), min_size=1, max_size=30)


def parse(drawn: Canvas) -> Any:
    return etree.fromstring(drawn.__html__())


def numbers(drawn: Canvas, attribute: str) -> list[float]:
    return [float(value) for value in parse(drawn).xpath(f"//@{attribute}")]


@given(st.lists(SCORES, min_size=1, max_size=4), st.none() | st.floats(-1, 1))
def test_histogram_is_well_formed_and_stays_inside(
    sets: list[list[float]], marker: float | None
) -> None:
    strips = [
        HistogramRow(f"s{i}", values, sum(values) / len(values)) for i, values in enumerate(sets)
    ]
    svg = histogram(strips, marker, "ordinary")
    width, height = map(float, parse(svg).get("viewBox").split()[2:])
    assert all(-1 <= value <= width for value in numbers(svg, "x"))
    assert all(0 <= value <= height for value in numbers(svg, "y"))


def test_labels_are_escaped() -> None:
    svg = histogram([HistogramRow("<b>&", [0.1], 0.1)]).__html__()
    assert "<b>" not in svg
    assert "&lt;b&gt;&amp;" in svg


def test_signed_has_a_true_minus_and_no_negative_zero() -> None:
    assert signed(-0.5) == "−0.500"
    assert signed(-0.0001) == "0.000"


@given(st.lists(SCORES, min_size=1, max_size=4), st.sampled_from([1e-3, 1.0, 40.0, 1e4]))
def test_every_value_is_in_a_bar_on_any_scale(sets: list[list[float]], scale: float) -> None:
    strips = [
        HistogramRow(f"s{i}", [scale * value for value in one], 0.0) for i, one in enumerate(sets)
    ]
    labels = parse(histogram(strips)).xpath("//*[@class='tick middle']/text()")
    assert 2 <= len(labels) <= 12
    bars = parse(histogram(strips)).xpath("//*[@class='bar']/@height")
    assert bars.count("40") >= len(sets)


def test_a_figure_for_files_has_the_words_of_the_picture() -> None:
    pytest.importorskip("matplotlib")
    drawn = histogram([HistogramRow("fog", [0.1, 0.3], 0.2)], 0.25, "ordinary")
    words = [text.get_text() for text in drawn.figure().axes[0].texts]
    assert words == parse(drawn).xpath("//text()[parent::text]")


LABELS = st.lists(
    st.text("abcdefgh ", min_size=1, max_size=90), min_size=1, max_size=5, unique=True
)


@given(LABELS)
def test_names_of_any_length_keep_clear_of_each_other_and_of_the_bars(labels: list[str]) -> None:
    bars = parse(histogram([HistogramRow(label, [0.0, 1.0], 0.5) for label in labels]))
    left = min(map(float, bars.xpath("//*[@class='bar']/@x")))
    assert all(7 * len(name.text) < left for name in bars.xpath("//*[@class='name']"))
    drawn = parse(cloud_map([Cloud(label, [[0.0, 1.0]]) for label in labels], (0.5, 0.2), colour=1))
    *words, _ = drawn.xpath("//*[@class='tick']")
    ends: dict[str, float] = {}
    for word in words:
        assert float(word.get("x")) > ends.get(word.get("y"), 0)
        ends[word.get("y")] = float(word.get("x")) + 6 * len(word.text)
    assert max(ends.values()) < 480
    assert max(map(float, ends)) < float(drawn.get("viewBox").split()[3])


@given(st.floats(-1e3, 1e3), st.just(0.0) | st.floats(1e-6, 1e3))
def test_ticks_of_a_narrow_range_differ(least: float, span: float) -> None:
    drawn = parse(
        scatter([Cloud("a", [[least, least], [least + span, least + span]])], "t", ("a", "b"))
    )
    for kind, most in ("middle", 5), ("end", 4):
        ticks = drawn.xpath(f"//*[@class='tick {kind}']/text()")
        assert len(set(ticks)) == len(ticks) == (most if span else 1)
        assert not any("-" in tick for tick in ticks)
