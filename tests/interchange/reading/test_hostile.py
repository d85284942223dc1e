"""Files that are broken, or written to do harm, are refused with the line and the element."""

from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lxml import etree

from oodscen.errors import DataError, OodscenError
from oodscen.interchange._reading.tree import OpenScenarioFile
from tests.interchange.reading.test_scenario import FOREIGN, foreign

__all__ = ["foreign"]

ENTITIES = "".join(f'<!ENTITY a{n} "{f"&a{n - 1};" * 10 if n else "lol"}">' for n in range(12))
ATTRIBUTES = [
    (index, name)
    for index, element in enumerate(etree.fromstring(FOREIGN).iter())
    for name in element.attrib
]
NUMBERS = [
    (index, name)
    for index, element in enumerate(etree.fromstring(FOREIGN).iter())
    for name in ("s", "value", "visualRange", "frictionScaleFactor", "elevation", "intensity")
    if name in element.attrib
    and (element.tag, name) != ("Sun", "intensity")
    and element.tag not in ("ParameterDeclaration", "SpeedActionDynamics")
]
VALUES = st.one_of(
    st.sampled_from(
        [
            "",
            "nan",
            "-inf",
            "1e308",
            "-1",
            "54km/h",
            "1,5",
            "0x10",
            "１０",
            "$kph",
            "$",
            "${",
            "${}",
            "${$kph}",
            "${9**9**9}",
            "${pow(10, 400)}",
            "${(1).__class__}",
            "${round()}",
            "${sqrt(-1)}",
            "${" + "-" * 150 + "1}",
            "${" + "(" * 150 + "1}",
            "${1e999 * 10}",
            "../../../../etc/passwd",
            "x" * 100_000,
        ]
    ),
    st.text(st.characters(exclude_categories=["Cc", "Cs"], exclude_characters="\ufffe\uffff")),
)


def changed(changes):
    """Return the file of somebody else with some attributes replaced."""
    elements = list(etree.fromstring(FOREIGN).iter())
    for (index, name), value in changes:
        elements[index].set(name, value)
    return etree.tostring(elements[0], encoding="unicode")


@given(st.lists(st.tuples(st.sampled_from(ATTRIBUTES), VALUES), min_size=1, max_size=3))
@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_attribute_gives_a_scene_or_a_typed_error(foreign, changes):
    with suppress(OodscenError):
        foreign(changed(changes))


@pytest.mark.parametrize(
    "unit", ["54km/h", "54 km/h", "1,5", "30mph", "10 m", "fast", "1_0", "٣", "0x10", "INF"]
)
@pytest.mark.parametrize("place", NUMBERS, ids=str)
def test_a_number_with_a_unit_is_refused_with_line_and_element(foreign, place, unit):
    with pytest.raises(DataError) as caught:
        foreign(changed([(place, unit)]))
    (issue,) = caught.value.issues
    assert issue.path.startswith("line ")
    assert issue.path.endswith(f"@{place[1]}")


@pytest.mark.parametrize(
    "head",
    [
        f"<!DOCTYPE a [{ENTITIES}]>",
        '<!DOCTYPE a [<!ENTITY a11 SYSTEM "file:///etc/passwd">]>',
        '<!DOCTYPE a [<!ENTITY % a11 SYSTEM "http://localhost/x"> %a11;]>',
    ],
    ids=["bomb", "file", "network"],
)
def test_entities_are_refused(foreign, head):
    with pytest.raises(DataError):
        foreign(head + FOREIGN.replace('"x" description="x"', '"&a11;" description="x"'))


@pytest.mark.parametrize(
    "inside",
    [
        "<Story>" * 5_000 + "</Story>" * 5_000,
        f'<Story name="{"x" * 11_000_000}"/>',
        "<Story " + " ".join(f'a{n}="1"' for n in range(100_000)) + "/>",
        "<Story/>" * 150_000,
        "<!--" + "x" * 11_000_000 + "-->",
    ],
    ids=["depth", "attribute", "attributes", "elements", "comment"],
)
def test_a_file_of_any_size_is_read_or_refused(foreign, inside):
    with suppress(OodscenError):
        foreign(FOREIGN.replace("<StopTrigger/>", inside + "<StopTrigger/>"))


def test_unknown_elements_are_listed_and_passed_over(foreign):
    odd = '<LateralAction><TeleportToMars speed="9"/></LateralAction>'
    weird = FOREIGN.replace("<StopTrigger/>", "<Unknown><Unknown/></Unknown><StopTrigger/>")
    found = foreign(weird, ACTION=odd)
    assert any(omission.path.endswith("TeleportToMars") for omission in found.omissions)


def test_a_catalogue_that_refers_to_itself_is_refused(foreign, tmp_path):
    (tmp_path / "loop.xosc").write_text(
        '<OpenSCENARIO><FileHeader/><Catalog name="c"><Maneuver name="m"><Event name="e">'
        '<CatalogReference catalogName="c" entryName="m"/></Event></Maneuver></Catalog>'
        "</OpenSCENARIO>"
    )
    text = FOREIGN.replace(
        "<CatalogLocations/>",
        '<CatalogLocations><ManeuverCatalog><Directory path="."/></ManeuverCatalog>'
        "</CatalogLocations>",
    ).replace("<Maneuver ", '<CatalogReference catalogName="c" entryName="m"/><Maneuver ')
    with pytest.raises(DataError) as caught:
        foreign(text)
    (issue,) = caught.value.issues
    assert issue.path.startswith("line ")
    assert issue.path.endswith("CatalogReference")


def test_each_parameter_is_worked_out_once(foreign):
    """Each parameter names the one before it four times."""
    grown = "".join(
        f'<ParameterDeclaration name="p{n}" value="{value}"/>'
        for n in range(40)
        for value in ["${" + "+".join([f"$p{n - 1}"] * 4) + "}" if n else "1"]
    )
    found = foreign(PARAMETERS=grown, START="${$p39 / 4e22}")
    assert found.scene.actors[0].behaviour.parameters["speed"] == pytest.approx(7.556)


def test_long_chains_of_parameters_are_refused(foreign):
    chain = "".join(f'<ParameterDeclaration name="p{n}" value="$p{n + 1}"/>' for n in range(5_000))
    with pytest.raises(DataError):
        foreign(PARAMETERS=chain, START="$p0")


def test_starts_that_wait_for_each_other_are_refused(foreign):
    place = '<RelativeObjectPosition entityRef="Other" dx="1" dy="0"/>'
    with pytest.raises(DataError):
        foreign(PLACE=place)


@pytest.mark.parametrize("name", ["a.osi", "a.MCAP"])
def test_a_trace_is_told_from_a_scenario(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(b"\x0a\0\0\0")
    with pytest.raises(DataError, match="oodscen verdict"):
        OpenScenarioFile(tmp_path / name)


def test_names_of_files_may_be_longer_than_a_system_allows(foreign):
    road = FOREIGN.replace('filepath="road.xodr"', f'filepath="{"x" * 300}.xodr"')
    with pytest.raises(DataError, match="there is no OpenDRIVE file"):
        foreign(road)
    folder = f'<ManeuverCatalog><Directory path="{"y" * 300}"/></ManeuverCatalog>'
    text = FOREIGN.replace("<CatalogLocations/>", f"<CatalogLocations>{folder}</CatalogLocations>")
    with pytest.raises(DataError, match="there is no folder 'yyy"):
        foreign(text, ENTITY='<CatalogReference catalogName="c" entryName="m"/>')
