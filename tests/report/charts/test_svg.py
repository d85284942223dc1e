from typing import Any

from hypothesis import given
from hypothesis import strategies as st
from lxml import etree
from markupsafe import Markup

from oodscen.report._charts.svg import Point, Strip, growth, histogram, shares, signed, whisker

SCORES = st.lists(st.floats(-1, 1), min_size=1, max_size=30)


def parse(svg: Markup) -> Any:
    return etree.fromstring(str(svg))


def numbers(svg: Markup, attribute: str) -> list[float]:
    return [float(value) for value in parse(svg).xpath(f"//@{attribute}")]


@given(st.lists(st.integers(1, 5_000), min_size=1, max_size=50), st.integers(1, 5_000))
def test_growth_is_well_formed_and_stays_inside(sizes: list[int], start: int) -> None:
    points = [Point(index, size, "add") for index, size in enumerate(sizes, start=1)]
    svg = growth(points, start, 77)
    width, height = map(float, parse(svg).get("viewBox").split()[2:])
    for attribute, bound in (("x", width), ("x1", width), ("x2", width), ("y1", height)):
        assert all(-1 <= value <= bound for value in numbers(svg, attribute))


@given(st.lists(SCORES, min_size=1, max_size=4), st.none() | st.floats(-1, 1))
def test_histogram_is_well_formed_and_stays_inside(
    sets: list[list[float]], marker: float | None
) -> None:
    strips = [Strip(f"s{i}", values, sum(values) / len(values)) for i, values in enumerate(sets)]
    svg = histogram(strips, marker, "ordinary")
    width, height = map(float, parse(svg).get("viewBox").split()[2:])
    assert all(-1 <= value <= width for value in numbers(svg, "x"))
    assert all(0 <= value <= height for value in numbers(svg, "y"))


def test_labels_are_escaped() -> None:
    svg = histogram([Strip("<b>&", [0.1], 0.1)])
    assert "<b>" not in svg
    assert "&lt;b&gt;&amp;" in svg
    assert "<x" not in growth([Point(1, 4, '"><x')], 3)


def test_whisker_and_shares_are_well_formed() -> None:
    parse(whisker(0.5, 0.4, 0.6))
    bars = parse(shares([("safe", 3), ("unsafe", 1), ("unavailable", 0)]))
    assert [float(bar.get("width")) for bar in bars] == [164, 54]
    assert len(parse(shares([("safe", 0)]))) == 0


def test_signed_has_a_true_minus_and_no_negative_zero() -> None:
    assert signed(-0.5) == "−0.500"
    assert signed(-0.0001) == "0.000"
