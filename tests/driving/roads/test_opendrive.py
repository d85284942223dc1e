import contextlib
import math
import re
from importlib.resources import files

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

from oodscen.driving._roads.document import MAX_BYTES
from oodscen.driving._roads.geometry import Arc, Line, ParamPoly3, Poly3, Spiral, piecewise
from oodscen.driving._roads.sampling import build_corridor
from oodscen.errors import DataError
from tests.driving import networks
from tests.driving.networks import read_road

RURAL = files("oodscen.driving").joinpath("maps/rural_curve.xodr").read_bytes()
AVENUE = files("oodscen.driving").joinpath("maps/urban_avenue.xodr").read_bytes()


def edited(pattern: str, replacement: str, data: bytes = AVENUE) -> bytes:
    text, count = re.subn(pattern, replacement, data.decode(), count=1)
    assert count == 1
    return text.encode()


def issues(data: bytes) -> dict[str, str]:
    with pytest.raises(DataError) as caught:
        read_road(data)
    return dict(caught.value.issues)


def test_reads_what_the_file_says() -> None:
    road = read_road(RURAL)
    assert road.id == "1"
    assert road.length == 1100.0
    assert math.isclose(road.speed_limit(0.0), 80 / 3.6)
    assert [type(curve) for curve in road.curves] == [
        Line, Spiral, Arc, Spiral, Line, Spiral, Arc, Spiral, Line,
    ]  # fmt: skip
    assert [lane.id for lane in road.sections[0].lanes] == [3, 2, 1, 0, -1, -2, -3]


@pytest.mark.parametrize(
    ("pattern", "replacement", "where"),
    [
        (r'x="600"', 'x="nan"', "road[1]/planView/geometry[1]@x"),
        (r'x="600"', 'x="6_00"', "road[1]/planView/geometry[1]@x"),
        (r'x="600"', 'x="1e400"', "road[1]/planView/geometry[1]@x"),
        (r'x="600"', 'x="six"', "road[1]/planView/geometry[1]@x"),
        (r'x="600"', "", "road[1]/planView/geometry[1]@x"),
        (r'x="600"', 'x="601"', "road[1]/planView/geometry[1]"),
        (r's="600"', 's="610"', "road[1]/planView/geometry[1]@s"),
        (r'(x="600" y="0" hdg=)"0"', r'\1"0.3"', "road[1]/planView/geometry[1]@hdg"),
        (r'length="600"', 'length="0"', "road[1]/planView/geometry[0]@length"),
        (r'length="1000"', 'length="-4"', "road[1]@length"),
        (r'length="1000"', 'length="1200"', "road[1]@length"),
        (r"<line/>", "<helix/>", "road[1]/planView/geometry[0]"),
        (r'curvature="[^"]*"', 'curvature="900"', "road[1]/planView/geometry[2]/arc@curvature"),
        (r'(?s)<planView>.*</planView>', "", "road[1]/planView"),
        (r'(?s)<lanes>.*</lanes>', "", "road[1]/lanes"),
        (r'(?s)<laneSection .*</laneSection>', "", "road[1]/lanes"),
        (r'(?s)<center>.*</center>', "", "road[1]/lanes/laneSection[0]/center"),
        (r'id="-1"', 'id="-7"', "road[1]/lanes/laneSection[0]"),
        (r'id="-1"', 'id="x"', "road[1]/lanes/laneSection[0]/right/lane@id"),
        (r'id="-1"', 'id="-1_0"', "road[1]/lanes/laneSection[0]/right/lane@id"),
        (r'id="2"', 'id="-2"', "road[1]/lanes/laneSection[0]/left/lane[-2]@id"),
        (
            r'<width sOffset="0" a="3.4"[^>]*>',
            "",
            "road[1]/lanes/laneSection[0]/left/lane[2]/width",
        ),
        (r'a="3.4"', 'a="inf"', "road[1]/lanes/laneSection[0]/left/lane[2]/width[0]@a"),
        (r'speed max="', 'speed max="-', "road[1]/type/speed@max"),
        (r'unit="km/h"', 'unit="kmh"', "road[1]/type/speed@unit"),
        (r"<road ", "<lane ", ""),
    ],
)  # fmt: skip
def test_every_fault_is_found_where_it_is(pattern: str, replacement: str, where: str) -> None:
    data = edited(pattern, replacement)
    if replacement == "<lane ":
        data = data.replace(b"</road>", b"</lane>")
    assert where in issues(data)


def test_all_faults_are_listed_at_once() -> None:
    data = edited('x="600"', 'x="nan"', edited('a="3.4"', 'a="b"', edited('id="-1"', 'id="q"')))
    assert len(issues(data)) >= 3


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"no xml",
        b"<OpenDRIVE/>",
        b"<Other/>",
        b"\xff\xfe\x00",
        b"<!DOCTYPE a [<!ENTITY x 'y'>]><OpenDRIVE>&x;</OpenDRIVE>",
        b"<!DOCTYPE a [<!ENTITY x SYSTEM 'file:///etc/passwd'>]><OpenDRIVE>&x;</OpenDRIVE>",
        b"<!DOCTYPE a SYSTEM 'http://127.0.0.1/x.dtd'><OpenDRIVE/>",
        b"<OpenDRIVE>" + b"<a>" * 5000 + b"</a>" * 5000 + b"</OpenDRIVE>",
        b"<OpenDRIVE>" + b"<a>" * 60 + b"</a>" * 60 + b"</OpenDRIVE>",
        b"<OpenDRIVE" + b" " * MAX_BYTES + b"/>",
    ],
    ids=range(11),
)
def test_hostile_files_are_data_errors(data: bytes) -> None:
    with pytest.raises(DataError):
        read_road(data)


def test_entities_are_never_expanded() -> None:
    bomb = b"<!DOCTYPE a [<!ENTITY b 'bbbbbbbbbb'>" + b"".join(
        f"<!ENTITY c{i} '{f'&c{i - 1};' * 10 if i else '&b;' * 10}'>".encode() for i in range(9)
    )
    with pytest.raises(DataError):
        read_road(bomb + b"]>" + AVENUE.split(b"?>", 1)[1].replace(b"Avenue", b"&c8;"))


values = st.one_of(
    st.sampled_from(
        ["nan", "inf", "-1", "0", "1e308", "-1e308", "1e-320", "", "٣", "1_0", "x", "-2"]
    ),
    st.floats().map(repr),
    st.integers(-5, 5).map(str),
)


@settings(max_examples=80, deadline=None)
@given(st.data())
def test_changed_attributes_give_a_road_or_a_data_error(data: st.DataObject) -> None:
    root = etree.fromstring(RURAL)
    places = [(element, key) for element in root.iter() for key in element.attrib]
    for _ in range(data.draw(st.integers(1, 4))):
        element, key = data.draw(st.sampled_from(places))
        element.set(key, data.draw(values))
    try:
        road = read_road(etree.tostring(root))
    except DataError:
        return
    corridor = build_corridor(road)
    assert all(math.isfinite(value) for value in corridor.x.tolist() + corridor.curvature.tolist())


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_moved_and_missing_elements_give_a_road_or_a_data_error(data: st.DataObject) -> None:
    root = etree.fromstring(RURAL)
    elements = [element for element in root.iter() if element.getparent() is not None]
    for _ in range(data.draw(st.integers(1, 3))):
        victim, target = data.draw(st.sampled_from(elements)), data.draw(st.sampled_from(elements))
        parent = victim.getparent()
        if parent is None:
            continue
        parent.remove(victim)
        if (
            data.draw(st.booleans())
            and target is not victim
            and victim not in target.iterancestors()
        ):
            target.append(victim)
    with contextlib.suppress(DataError):
        build_corridor(read_road(etree.tostring(root)))


@settings(max_examples=60, deadline=None)
@given(st.binary(max_size=200), st.integers(0, len(AVENUE)))
def test_torn_and_spliced_files_give_a_road_or_a_data_error(noise: bytes, place: int) -> None:
    for data in (AVENUE[:place], AVENUE[:place] + noise + AVENUE[place:], noise):
        with contextlib.suppress(DataError):
            read_road(data)


@settings(max_examples=40, deadline=None)
@given(
    st.recursive(
        st.text("ab", max_size=3),
        lambda inner: st.tuples(
            st.sampled_from(["road", "planView", "geometry", "line", "lanes", "laneSection",
                             "left", "right", "center", "lane", "width", "elevationProfile"]),
            st.dictionaries(
                st.sampled_from(["id", "s", "x", "y", "hdg", "length", "a", "sOffset"]), values
            ),
            st.lists(inner, max_size=3),
        ),
        max_leaves=12,
    )
)  # fmt: skip
def test_random_trees_give_a_data_error(tree: object) -> None:
    root = etree.Element("OpenDRIVE")

    def grow(parent: etree._Element, node: object) -> None:
        if isinstance(node, tuple):
            name, attributes, inner = node
            child = etree.SubElement(parent, name, attributes)
            for one in inner:
                grow(child, one)

    grow(root, tree)
    with pytest.raises(DataError):
        read_road(etree.tostring(root))


@given(
    st.sampled_from(
        [
            '<poly3 a="0" b="0" c="{c}" d="0"/>',
            '<paramPoly3 pRange="arcLength" aU="0" bU="1" cU="0" dU="0" aV="0" bV="0" cV="{c}" dV="0"/>',
            '<paramPoly3 aU="0" bU="100" cU="0" dU="0" aV="0" bV="0" cV="{d}" dV="0"/>',
        ]
    ),
    st.floats(-1e-3, 1e-3),
)
def test_polynomial_roads_are_read(shape: str, c: float) -> None:
    lane = '<lane id="{}" type="driving"><width sOffset="0" a="3" b="0.01" c="0" d="0"/></lane>'
    text = (
        '<OpenDRIVE><road id="9" length="100" junction="-1"><planView>'
        '<geometry s="0" x="0" y="0" hdg="0" length="100">'
        + shape.format(c=c, d=c * 1e4)
        + '</geometry></planView><lanes><laneSection s="0"><center><lane id="0" type="none"/>'
        f"</center><right>{lane.format(-1)}</right></laneSection></lanes></road></OpenDRIVE>"
    )
    road = read_road(text.encode())
    assert isinstance(road.curves[0], Poly3 | ParamPoly3)
    corridor = build_corridor(road)
    assert math.isclose(corridor.y[-1], 1e4 * c, rel_tol=0.05, abs_tol=1e-3)
    assert math.isclose(corridor.edges(0, 50.0)[0], -3.5, abs_tol=1e-6)


def test_a_polynomial_is_judged_only_where_the_road_is() -> None:
    height = '<elevation s="{}" a="0" b="0" c="0" d="{}"/>'
    beyond = "".join(height.format(*piece) for piece in ((0, 0), (50, 0.01), (500, 0), (600, 9)))
    more = f"<elevationProfile>{beyond}</elevationProfile>"

    def of_length(length_m: float) -> bytes:
        right = networks.lane(-1)
        return networks.file(networks.road("1", length_m, right=right, more=more))

    assert piecewise(read_road(of_length(100.0)).elevation, 100.0) == 0.01 * 50.0**3
    assert "road[1]/elevationProfile[1]" in issues(of_length(400.0))
