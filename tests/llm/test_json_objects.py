"""Objects in a text: where each begins and ends, and how many are looked for."""

import json

import pytest

from oodscen.llm._json_objects import (
    Found,
    Members,
    clean_surrogates,
    find_objects,
    is_cut_off,
    scan,
)

ONE = '{"a": 1}'


def values(text: str) -> list[object]:
    return [found.value for found in find_objects(text)]


def test_an_object_is_found_where_it_stands() -> None:
    assert scan(f"so {ONE}, and {{b: 2,}}") == (
        [Found({"a": 1}, 8, True, 3, False), Found({"b": 2}, 7, True, 17, True)],
        None,
    )
    assert scan('{"a": "x\ny"}')[0] == [Found({"a": "x\ny"}, 12, True, 0, False)]
    assert Found({}, 3) == Found({}, 3, is_complete=True, start=0, is_mended=False)


def test_the_last_object_comes_first_and_what_it_wraps_after_it() -> None:
    wrapped = '{"answer": {"a": 2}}'
    assert list(find_objects(f"{ONE} {wrapped}")) == [
        Found({"answer": {"a": 2}}, 20, True, 9),
        Found({"a": 2}, 0),
        Found({"a": 1}, 8, True, 0),
    ]
    assert list(find_objects('{"b": {"a": 2}, "c": 1}')) == [
        Found({"b": {"a": 2}, "c": 1}, 23, True, 0)
    ]
    assert values(f"{ONE}</think>{{'b': 2}}") == [{"b": 2}, {"b": 2}, {"a": 1}]


def test_objects_in_a_json_string_have_no_width() -> None:
    assert list(find_objects(json.dumps(f'{ONE} {{"b": 2}}')))[-2:] == [
        Found({"b": 2}, 0),
        Found({"a": 1}, 0),
    ]


@pytest.mark.parametrize("text", ['{"a": "x"', '{"a": [1, 2]', '{"a": {"b": 1}', "{'a': {'b': 'x'}"])  # fmt: skip
def test_only_the_closing_brace_may_be_missing(text: str) -> None:
    assert is_cut_off(text)
    *_, found = find_objects(f"so {text}")
    assert (found.width, found.is_complete, list(found.value)) == (len(text), False, ["a"])
    assert not is_cut_off(text + "}")


@pytest.mark.parametrize("text", ['{"a": 1', '{"a": "x', '{"a": [1', '{"a": {"b": 1', '{"a":', '{"a": [[], 1'])  # fmt: skip
def test_an_object_that_is_cut_off_inside_is_none(text: str) -> None:
    assert is_cut_off(text)
    assert values(text) == []
    assert scan(f"so {text} {{x: ")[1] == 3


def test_what_is_whole_or_no_object_is_not_cut_off() -> None:
    for text in (ONE, "{a: 1,}", "f(x) = {x | x > 0}", "no brace", "{1, 2"):
        assert not is_cut_off(text)
    assert scan("{// nothing\n}") == ([], None)


def test_lone_surrogates_are_replaced_and_pairs_kept() -> None:
    assert clean_surrogates("a\ud800b\\ud800c\\ude00d") == "a\ufffdb\\ufffdc\\ufffdd"
    for kept in ("\\ud83d\\ude00", "\\\\ud800", "\\n\\u00e9", "\U0001f600"):
        assert clean_surrogates(kept) == kept


def test_members_that_repeat_with_other_values_are_remembered() -> None:
    ((value, *_),) = scan('{"a": 1, "b": 2, "a": 3, "b": 2}')[0]
    assert isinstance(value, Members)
    assert (value, value.repeated) == ({"a": 3, "b": 2}, {"a"})
    ((value, *_),) = scan('{"a": 1, "a": 1}')[0]
    assert type(value) is dict


def test_commas_are_dropped_before_a_bracket_and_nowhere_else() -> None:
    text = '{"a": "1, ]", "b": [1, 2, ], }'
    assert [one.value for one in scan(text)[0]] == [{"a": "1, ]", "b": [1, 2]}]


@pytest.mark.parametrize(("starts", "count"), [(19, 1), (20, 0)])
def test_twenty_false_starts_are_enough(starts: int, count: int) -> None:
    found, broken_off = scan("{x: " * starts + ONE)
    assert (len(found), broken_off) == (count, 0)


def test_a_hundred_faulty_objects_are_mended_and_any_number_of_whole_ones_read() -> None:
    assert len(scan("{a: 1} " * 105)[0]) == 100
    assert len(scan(f"{ONE} " * 105)[0]) == 105


@pytest.mark.parametrize(("length", "count"), [(20_000, 1), (20_001, 0)])
def test_a_long_object_is_not_mended(length: int, count: int) -> None:
    text = '{"a": "' + "x" * (length - 10) + '",}'
    assert len(text) == length
    assert len(scan(text)[0]) == count
