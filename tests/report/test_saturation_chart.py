"""The saturation chart is well-formed, labelled, and stays inside its frame."""

import re
import xml.etree.ElementTree as ElementTree

from hypothesis import given
from hypothesis import strategies as st

from oodscen.report._charts.saturation import saturation_chart
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
    svg = ElementTree.fromstring(str(chart))
    _, _, width, height = map(float, svg.attrib["viewBox"].split())
    assert "unseen" in svg.attrib["aria-label"]
    for element in svg.iter():
        for name, most in (("x", width), ("x1", width), ("cx", width), ("y1", height)):
            assert 0 <= float(element.attrib.get(name, 0)) <= most
        for down in re.findall(r"V([\d.]+)", element.attrib.get("d", "")):
            assert 0 <= float(down) <= height
