"""JSON from outside: what json writes comes back, everything odd is one line."""

import json
from codecs import BOM_UTF8

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen._io.json import object_lines, parse_json, parse_object

characters = st.text(st.characters(exclude_categories=("Cs",)), max_size=8)
values = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(10**90), 10**90)
    | st.floats(allow_nan=False, allow_infinity=False)
    | characters,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(characters, inner, max_size=4),
)


@given(values, st.booleans())
def test_what_was_written_comes_back(value, is_ascii):
    text = json.dumps(value, ensure_ascii=is_ascii)
    assert parse_json(text) == value
    assert parse_json(text.encode()) == value


@given(st.binary(max_size=60) | st.text(max_size=60) | st.text('{}[]",:\\u0d8 1e9-', max_size=60))
def test_anything_else_is_a_value_error_of_one_line(text):
    said = ""
    try:
        parse_json(text)
    except ValueError as error:
        said = str(error)
    assert "\n" not in said


@pytest.mark.parametrize(
    "text",
    [
        "NaN",
        "[-Infinity]",
        "1e999",
        "9" * 200,
        '{"a":1,"b":2,"a":1}',
        '{"x":{"a":1,"a":1}}',
        '"\\ud800"',
        "[" * 100_000,
        "[" * 300 + "]" * 300,
        '{"a":' * 100_000 + "1" + "}" * 100_000,
        b"\xff",
        b"\xef\xbb\xbf{}",
        '{"a":1}'.encode("utf-16"),
    ],
    ids=range(13),
)
def test_what_other_readers_let_through_is_refused(text):
    with pytest.raises(ValueError) as caught:
        parse_json(text)
    assert len(str(caught.value)) < 200


def test_only_objects_are_objects():
    assert parse_object('{"a":[]}') == {"a": []}
    with pytest.raises(ValueError, match="object"):
        parse_object("[]")


@given(st.lists(st.dictionaries(characters, values, max_size=3), max_size=4), st.booleans())
def test_lines_end_at_line_feeds_alone_and_the_last_need_not_end(rows, ends):
    lines = "\n".join(json.dumps(row, ensure_ascii=False) for row in rows) + "\n" * ends
    assert [row for _, row in object_lines(lines.encode())] == rows


@pytest.mark.parametrize("end", [b"", b"\n", b"\r\n"])
def test_a_byte_order_mark_is_no_part_of_the_first_line(end: bytes) -> None:
    marked = BOM_UTF8 + b'{"a": 1}' + end
    assert parse_object(marked) == {"a": 1}
    assert list(object_lines(marked)) == [(1, {"a": 1})]


def test_lines_that_end_with_cr_alone_are_no_torn_line() -> None:
    ((number, error),) = object_lines(b'{"a": 1}\r{"a": 2}\r')
    assert number == 1
    assert "end with CR alone" in str(error)
    assert not list(object_lines(b'{"a": 1, "b"'))
