import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.baselines import check_texts, read_records
from oodscen.errors import DataError

plain = st.lists(
    st.text(st.characters(codec="utf-8", exclude_categories=["Cc"]), min_size=1)
    .map(str.strip)
    .filter(bool),
    min_size=1,
    max_size=6,
)


@given(plain)
def test_json_lines_and_lists_round_trip(tmp_path_factory, texts):
    folder = tmp_path_factory.mktemp("texts")
    (folder / "a.jsonl").write_text("\n".join(json.dumps({"text": text}) for text in texts))
    (folder / "b.json").write_text(json.dumps(texts, ensure_ascii=False), encoding="utf-8")
    (folder / "c.json").write_text(json.dumps([{"text": text} for text in texts]))
    for name in ("a.jsonl", "b.json", "c.json"):
        assert [record.text for record in read_records(folder / name)] == texts


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.txt", "one\n\n  two  \r\n"),
        ("a.txt", "\ufeffone\ntwo"),
        ("a.jsonl", '{"text": "one"}\n\n{"text": "two", "id": 3}\n'),
        ("a.jsonl", '"one"\n"two"'),
        ("a", '{"text": "one"}\n{"text": "two"}'),
        ("a.json", '["one", {"text": "two"}]'),
        ("a.csv", 'id,text\n1,one\n2,"two"\n'),
        ("a.tsv", "text\tid\none\t1\ntwo\t2\n"),
    ],
)
def test_every_kind_of_file_gives_its_texts(tmp_path, name, content):
    (tmp_path / name).write_text(content, encoding="utf-8")
    assert [record.text for record in read_records(tmp_path / name)] == ["one", "two"]


@pytest.mark.parametrize(
    ("name", "content", "places"),
    [
        ("a.txt", b"", [""]),
        ("a.txt", b" \n\n", [""]),
        ("a.txt", b"fine\n\xff\xfe\n", ["line 2"]),
        ("a.jsonl", b'{"text": "a"}\n{"words": "b"}\n{"text": 3}\n{"text": ""}\n{"tex', "2345"),
        ("a.jsonl", b'{"text": "\\ud800"}', "1"),
        ("a.json", b'["a", {"b": 1}, null]', ["[1]", "[2]"]),
        ("a.json", b'["a", ', [""]),
        ("a.json", b"[" * 100_000, [""]),
        ("a.csv", b"id,words\n1,one\n", ["line 1"]),
        ("a.csv", b"id,text\n1,one\n2\n", ["line 3"]),
        ("a.csv", b"id,text\n", [""]),
    ],
)
def test_every_fault_is_found_with_its_place(tmp_path, name, content, places):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(DataError) as caught:
        read_records(tmp_path / name)
    expected = [f"line {number}" for number in places] if isinstance(places, str) else places
    assert [issue.path for issue in caught.value.issues] == expected
    assert caught.value.source == str(tmp_path / name)


def test_many_faults_are_summed_up(tmp_path):
    (tmp_path / "a.jsonl").write_text('{"a": 1}\n' * 5000)
    with pytest.raises(DataError) as caught:
        read_records(tmp_path / "a.jsonl")
    assert len(caught.value.issues) == 21
    assert "4980 more" in caught.value.issues[-1].message


def test_groups_come_from_path_leaf_or_group(tmp_path):
    rows = [{"path": ["r", "x"]}, {"leaf": "y"}, {"group": "z"}, {}]
    path = tmp_path / "a.jsonl"
    path.write_text("\n".join(json.dumps({"text": "t"} | row) for row in rows))
    assert [record.group for record in read_records(path)] == ["r / x", "y", "z", None]


def test_one_string_is_not_a_set_of_texts():
    with pytest.raises(DataError):
        check_texts("a text")
    assert check_texts(["a text"]) == ("a text",)
