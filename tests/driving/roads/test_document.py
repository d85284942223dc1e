import contextlib
from importlib.resources import files
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

from oodscen.driving._roads.building import find_map, load_corridor
from oodscen.driving._roads.opendrive import read_network
from oodscen.driving.maps._shipped import SHIPPED_MAPS
from oodscen.errors import DataError
from tests.driving.networks import file, lane, road
from tests.driving.staging import CATALOGUE

MAPS = {
    one.id: files("oodscen.driving").joinpath(f"maps/{one.id}.xodr").read_bytes()
    for one in SHIPPED_MAPS
}
TINY = '<geometry s="{0}" x="{0}" y="0" hdg="0" length="1"><line/></geometry>'
BOMB = b"<!DOCTYPE a [<!ENTITY b 'bbbbbbbbbb'>" + b"".join(
    f"<!ENTITY c{i} '{(f'&c{i - 1};' if i else '&b;') * 10}'>".encode() for i in range(9)
)

HOSTILE = {
    "billion laughs": lambda: BOMB + b"]>" + file("&c8;"),
    "deep": lambda: b"<OpenDRIVE>" + b"<a>" * 100_000 + b"</a>" * 100_000 + b"</OpenDRIVE>",
    "roads": lambda: file('<road id="1" length="1"/>' * 20_000),
    "lanes": lambda: file(road("1", 9.0, right="".join(lane(-i) for i in range(1, 9_000)))),
    "geometries": lambda: file(
        '<road id="1" length="9"><planView>' + TINY.format(1) * 100_001 + "</planView></road>"
    ),
    "zero length": lambda: file(road("1", 0.0, right=lane(-1))),
    "nan": lambda: file(road("1", float("nan"), right=lane(-1))),
    "endless number": lambda: file(road("1", 9.0, right=lane(-1, width=3.0)))
    .replace(b'a="3.0"', b'a="' + b"1" * 100_000 + b'"'),
    "long": lambda: file(*(road(str(i), 49_999.0, right=lane(-1)) for i in range(11))),
    "turns": lambda: file(
        road("1", 49_000.0, right=lane(-1), shape='<spiral curvStart="-2" curvEnd="2"/>')
    ),
    "width": lambda: file(road("1", 900.0, right=lane(-1).replace('b="0"', 'b="7"'))),
    "many wide lanes": lambda: file(
        road("1", 50_000.0, right="".join(lane(-i) for i in range(1, 61)))
    ),
    "link to nowhere": lambda: file(
        road("1", 9.0, right=lane(-1), link='<successor elementType="road" elementId="x"/>')
    ),
    "same id": lambda: file(road("1", 9.0, right=lane(-1)), road("1", 9.0, right=lane(-1))),
    "no lane to drive on": lambda: file(road("1", 9.0, right=lane(-1, "sidewalk"))),
}  # fmt: skip


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_networks_are_data_errors(name: str, tmp_path: Path) -> None:
    path = tmp_path / "own.xodr"
    path.write_bytes(HOSTILE[name]())
    with pytest.raises(DataError) as caught:
        find_map(str(path), CATALOGUE)
    assert 0 < len(caught.value.issues) <= 100
    assert len(str(caught.value)) < 50_000


values = st.one_of(
    st.sampled_from(
        ["nan", "inf", "-1", "0", "1e308", "", "x", "-2", "end", "100", "12", "junction"]
    ),
    st.floats(width=32).map(repr),
    st.integers(-5, 5).map(str),
)


@settings(max_examples=60, deadline=None)
@given(st.sampled_from(["t_junction", "roundabout", "bridge"]), st.data())
def test_changed_networks_are_drivable_or_data_errors(name: str, data: st.DataObject) -> None:
    root = etree.fromstring(MAPS[name])
    places = [(element, key) for element in root.iter() for key in element.attrib]
    for _ in range(data.draw(st.integers(1, 3))):
        element, key = data.draw(st.sampled_from(places))
        element.set(key, data.draw(values))
    text = etree.tostring(root)
    with contextlib.suppress(DataError):
        read_network(text)


@settings(max_examples=12, deadline=None)
@given(st.data())
def test_changed_links_lead_to_a_corridor_or_a_data_error(tmp_path_factory, data) -> None:
    root = etree.fromstring(MAPS["t_junction"])
    links = [
        (element, key)
        for element in root.iter("predecessor", "successor", "connection", "laneLink")
        for key in element.attrib
    ]
    for _ in range(data.draw(st.integers(1, 4))):
        element, key = data.draw(st.sampled_from(links))
        element.set(
            key, data.draw(st.sampled_from(["1", "2", "3", "12", "-1", "-3", "start", "end"]))
        )
    path = tmp_path_factory.mktemp("own") / "own.xodr"
    path.write_bytes(etree.tostring(root))
    with contextlib.suppress(DataError):
        corridor = load_corridor(str(path), CATALOGUE)
        assert corridor.driving


def test_all_faults_of_all_roads_are_listed() -> None:
    data = file(road("1", -1.0, right=lane(-1)), road("2", 9.0, right=lane(-2, width=-7.0)))
    with pytest.raises(DataError) as caught:
        read_network(data)
    paths = {issue.path for issue in caught.value.issues}
    assert "road[1]@length" in paths
    assert "road[2]/lanes/laneSection[0]" in paths
    assert "road[2]/lanes/laneSection[0]/right/lane[-2]/width[0]" in paths
