"""Charts over rounds are well-formed, labelled, and stay inside their frames."""

import re
import xml.etree.ElementTree as ElementTree

from hypothesis import given
from hypothesis import strategies as st

from oodscen.report._charts.rounds import Point, growth, saturation_chart
from oodscen.stages._redteam.rounds import Round
from oodscen.stages._redteam.saturation import saturation


@given(st.lists(st.sampled_from(["A", "B", "C", "D", "old"]), max_size=40))
def test_the_chart_is_well_formed_and_stays_inside(kinds):
    rounds = [
        Round(round=n, kind=kind, decision="add" if kind not in kinds[: n - 1] else "covered")
        for n, kind in enumerate(kinds, start=1)
    ]
    chart = saturation_chart(saturation(rounds, patience=5))
    assert bool(chart) == bool(rounds)
    if not chart:
        return
    svg = ElementTree.fromstring(chart.__html__())
    _, _, width, height = map(float, svg.attrib["viewBox"].split())
    assert "unseen" in svg.attrib["aria-label"]
    for element in svg.iter():
        for name, most in (("x", width), ("x1", width), ("cx", width), ("y1", height)):
            assert 0 <= float(element.attrib.get(name, 0)) <= most
        for along, down in re.findall(r"([\d.-]+),([\d.-]+)", element.attrib.get("d", "")):
            assert 0 <= float(along) <= width
            assert 0 <= float(down) <= height


@given(st.lists(st.integers(1, 5_000), min_size=1, max_size=50), st.integers(1, 5_000))
def test_growth_is_well_formed_and_stays_inside(sizes, start):
    points = [Point(index, size, "add") for index, size in enumerate(sizes, start=1)]
    svg = ElementTree.fromstring(growth(points, start, 77).__html__())
    _, _, width, height = map(float, svg.attrib["viewBox"].split())
    for element in svg.iter():
        for name, bound in (("x", width), ("x1", width), ("x2", width), ("y1", height)):
            assert -1 <= float(element.attrib.get(name, 0)) <= bound


def test_decisions_are_escaped():
    assert "<x" not in growth([Point(1, 4, '"><x')], 3).__html__()
