"""Objects in a text: where each begins and ends, and how many are looked for."""

import json
import time
from ast import literal_eval

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.llm._json_objects import (
    JsonObject,
    Members,
    find_objects,
    is_cut_off,
    scan,
)

ONE = '{"a": 1}'


def values(text: str) -> list[object]:
    return [found.value for found, *_ in find_objects(text)]


def test_an_object_is_found_where_it_stands() -> None:
    assert scan(f"so {ONE}, and {{b: 2,}}") == (
        [JsonObject({"a": 1}, 8, True, 3), JsonObject({"b": 2}, 7, True, 17)],
        None,
    )
    assert scan('{"a": "x\ny"}')[0] == [JsonObject({"a": "x\ny"}, 12, True, 0)]
    assert JsonObject({}, 3) == JsonObject({}, 3, is_complete=True, start=0, is_altered=False)


def test_line_ends_in_a_string_need_no_mending() -> None:
    text = "x\n" * 20_000
    assert scan(f'{{"a": "{text}"}}')[0][0].value == {"a": text}


def test_what_an_object_wraps_comes_after_it() -> None:
    wrapped = '{"answer": {"a": 2}}'
    assert find_objects(f"{ONE} {wrapped}") == [
        (JsonObject({"a": 1}, 8),),
        (JsonObject({"answer": {"a": 2}}, 20, start=9), JsonObject({"a": 2}, 0)),
    ]
    both = '{"b": {"a": 2}, "c": 1}'
    assert find_objects(both) == [(JsonObject({"b": {"a": 2}, "c": 1}, 23),)]


def test_objects_in_a_json_string_have_no_width() -> None:
    assert find_objects(json.dumps(f'{ONE} {{"b": 2}}')) == [
        (JsonObject({"a": 1}, 0),),
        (JsonObject({"b": 2}, 0),),
    ]


@pytest.mark.parametrize(
    "text",
    ["{a: 1,}", "{'a': 'it is'}", '{"a": "x",\n}', '{"a": [1, 2,],}', '{"a": True, "b": None}', '{"a":1 "b":[1,2]}', "{a: 'é \\u00e9 \U0001f600'}"],
)  # fmt: skip
def test_mending_punctuation_alters_nothing(text: str) -> None:
    ((found, *_),) = find_objects(text)
    assert not found.is_altered


@given(
    st.dictionaries(st.from_regex("[a-z]{1,4}", fullmatch=True), st.integers() | st.booleans()),
    st.sampled_from("!~<>%$^|/&?*+"),
    st.data(),
)
def test_a_sign_beside_a_value_is_never_dropped_without_a_word(value, sign, data) -> None:
    name = data.draw(st.sampled_from([*value, "x"]))
    faulty = {one: said for one, said in value.items() if one != name}
    told = json.dumps({**faulty, name: 0})[:-2]
    for said in (f"{sign}7", f"7{sign}", f"7{sign}8", "7 8", "7,8", "7 or 8", "1_0 0"):
        for found, *_ in find_objects(f"{told}{said}}}"):
            assert found.is_altered or str(found.value.get(name)).replace(" ", "") == said.replace(
                " ", ""
            )


@pytest.mark.parametrize("said", ["moose's calf", "{a} calf}", "}", "a}, {b}} c"])
@pytest.mark.parametrize(
    "shape", ["{{'a': '{}', 'b': 'x'}}", "{{'a': [{{'c': '{}'}}], 'b': [{{'d': 'x'}}]}}"]
)
def test_what_is_quoted_in_a_string_moves_no_member_without_a_word(shape: str, said: str) -> None:
    plain, *_ = values(json.dumps(literal_eval(shape.format("said"))).replace("said", said))
    for found, *_ in find_objects(shape.format(said)):
        assert found.is_altered or found.value == plain


def test_comments_are_told() -> None:
    ((found, *_),) = find_objects('{"a": 1, // or 2\n "b": "//" /* x */, # y\n}')
    assert (found.value, found.is_altered) == ({"a": 1, "b": "//"}, False)
    assert found.comments == ("or 2", "x", "y")


@pytest.mark.parametrize("text", ['{"a": "x"', '{"a": [1, 2]', '{"a": {"b": 1}', "{'a': {'b': 'x'}"])  # fmt: skip
def test_only_the_closing_brace_may_be_missing(text: str) -> None:
    assert is_cut_off(text)
    ((found, *_),) = find_objects(f"so {text}")
    assert (found.width, found.is_complete, list(found.value)) == (len(text), False, ["a"])
    assert not is_cut_off(text + "}")


@pytest.mark.parametrize("text", ['{"a": 1', '{"a": "x', '{"a": [1', '{"a": {"b": 1', '{"a":', '{"a": [[], 1', "{'a': 'x'"])  # fmt: skip
def test_an_object_that_is_cut_off_inside_is_none(text: str) -> None:
    assert is_cut_off(text)
    assert values(text) == []
    assert scan(f"so {text} {{x: ")[1] == 3


def test_what_a_list_without_an_end_holds_is_found_alone() -> None:
    assert values('{"a": [{"b": 1}') == [{"b": 1}]


@pytest.mark.parametrize("text", ['{"a": "' + '\\"' * 50_000, "{'a': '" + '\\"' * 9_900 + "'}"])
def test_many_escaped_quotation_marks_take_no_longer_than_other_text(text: str) -> None:
    begun = time.perf_counter()
    find_objects(text)
    assert time.perf_counter() - begun < 5.0


def test_what_is_whole_or_no_object_is_not_cut_off() -> None:
    for text in (ONE, "{a: 1,}", "f(x) = {x | x > 0}", "no brace", "{1, 2"):
        assert not is_cut_off(text)
    assert scan("{// nothing\n}") == ([], None)


def test_members_that_repeat_with_other_values_are_remembered() -> None:
    (found,) = scan('{"a": 1, "b": 2, "a": 3, "b": 2}')[0]
    assert isinstance(found.value, Members)
    assert (found.value, found.repeated) == ({"a": 3, "b": 2}, ("a",))
    (found,) = scan('{"c": [{"a": 1, "a": 2}]}')[0]
    assert found.repeated == ("a",)
    (found,) = scan('{"a": 1, "a": 2,}')[0]
    assert found.repeated == ("a",)
    (found,) = scan('{"a": 1, "a": 1}')[0]
    assert type(found.value) is dict
    assert found == JsonObject({"a": 1}, 16)


def test_repeated_members_are_told_in_the_order_of_the_text() -> None:
    names = [f"{letter}{number}" for letter in "zyxw" for number in range(9)]
    twice = ", ".join(f'"{name}": 1, "{name}": 2' for name in names)
    (found,) = scan(f'{{{twice}, "inner": {{"z": 1, "z": 2}}}}')[0]
    assert found.repeated == (*names, "z")


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
