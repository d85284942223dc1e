import re
from pathlib import Path

from oodscen._cli.interchange import export
from oodscen.interchange._reading.actions import _KNOWN
from oodscen.interchange._support import (
    ELEMENTS,
    FORMATS,
    behaviour_table,
    element_table,
    format_table,
)

PAGE = (Path(__file__).parents[2] / "docs" / "interchange.md").read_text("utf-8")


def test_the_tables_of_the_page_are_those_of_the_code():
    tables = {
        "formats": format_table(),
        "elements": element_table(),
        "behaviours": behaviour_table(),
    }
    for name, table in tables.items():
        found = re.search(rf"<!-- {name} -->\n(.*?)<!-- end -->", PAGE, re.DOTALL)
        assert found, name
        assert found[1] == table


def test_every_action_that_is_read_is_listed_as_read():
    assert {one.element for one in ELEMENTS if one.read} >= _KNOWN


def test_the_formats_are_those_of_the_command():
    (option,) = (one for one in export.params if one.name == "form")
    assert tuple(option.type.choices) == tuple(one.name for one in FORMATS)
