import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen._io.xml_numbers import double

NUMBERS = st.floats(-1e6, 1e6)
LAXER = [
    "1_000",
    "٣",
    "１０",
    "0x10",
    "nan",
    "NaN",
    "inf",
    "INF",
    "-INF",
    "1e999",
    "\u20035",
    "",
    " ",
    "1 0",
]
"""Texts that Python takes for numbers and XML Schema does not, or that are no finite number."""


@given(NUMBERS, st.text(" \t\r\n", max_size=3))
def test_a_number_is_what_xml_schema_says(value, blanks):
    for text in (repr(value), f"{value:e}", f"{value:+.3f}"):
        assert double(f"{blanks}{text}{blanks}") == float(text)


@pytest.mark.parametrize("text", LAXER)
def test_what_is_no_number_in_xml_schema_is_refused(text):
    with pytest.raises(ValueError, match="is not a finite number"):
        double(text)
