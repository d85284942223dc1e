"""TOML from outside is parsed, or refused in one line."""

import json
import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen._io.toml import parse_toml


@given(st.dictionaries(st.from_regex(r"[a-z]{1,8}", fullmatch=True), st.integers() | st.booleans()))
def test_a_document_is_what_it_says(table):
    assert parse_toml("".join(f"{key} = {json.dumps(table[key])}\n" for key in table)) == table


@pytest.mark.parametrize("depth", [50, 5_000])
def test_what_nests_too_deep_is_refused(depth):
    text = "a = " + "[" * depth + "]" * depth
    if depth < 100:
        assert list(parse_toml(text)) == ["a"]
    else:
        with pytest.raises(ValueError, match="nested too deep"):
            parse_toml(text)


def test_a_number_with_too_many_digits_is_refused_and_a_syntax_error_keeps_its_line():
    with pytest.raises(ValueError, match="too many digits"):
        parse_toml("a = " + "1" * 5_000)
    with pytest.raises(tomllib.TOMLDecodeError, match="line 2"):
        parse_toml("a = 1\n= 1")
