import re
from pathlib import Path

from oodscen.interchange._reading.actions import _KNOWN
from oodscen.interchange._support import ELEMENTS, behaviour_table, element_table

PAGE = (Path(__file__).parents[2] / "docs" / "interchange.md").read_text("utf-8")


def test_the_tables_of_the_page_are_those_of_the_code():
    for name, table in (("elements", element_table()), ("behaviours", behaviour_table())):
        found = re.search(rf"<!-- {name} -->\n(.*?)<!-- end -->", PAGE, re.DOTALL)
        assert found, name
        assert found[1] == table


def test_every_action_that_is_read_is_listed_as_read():
    assert {one.element for one in ELEMENTS if one.read} >= _KNOWN
