import csv
import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen._words.text import is_visible
from oodscen.baselines._reading import read_records
from oodscen.errors import DataError

plain = st.lists(
    st.text(st.characters(codec="utf-8", exclude_categories=["Cc"]), min_size=1)
    .map(str.strip)
    .filter(is_visible),
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
        ("a.json", b"```json\n[\n]\n```", [""]),
        ("a.json", b"// texts\n[]", [""]),
        ("a.jsonl", b'{"text": "a", "text": "b"}', "1"),
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
    rows = [{"path": ["r", "x"], "leaf": "y"}, {"leaf": "y"}, {"group": "z"}, {}]
    rows += [{"leaf": 12}, {"path": ["r", 0]}, {"path": [], "leaf": None, "group": " z "}]
    rows += [{"path": ["", " "], "leaf": "y"}, {"path": [" r ", "x "]}, {"path": [""]}]
    path = tmp_path / "a.jsonl"
    path.write_text("\n".join(json.dumps({"text": "t"} | row) for row in rows))
    groups = ["r / x", "y", "z", None, "12", "r / 0", "z", "y", "r / x", None]
    assert [record.group for record in read_records(path)] == groups


@given(st.integers() | st.text("abc0", min_size=1))
def test_a_label_is_the_same_in_json_and_csv(tmp_path_factory, label):
    folder = tmp_path_factory.mktemp("labels")
    (folder / "a.jsonl").write_text(json.dumps({"text": "A deer.", "leaf": label}))
    (folder / "a.csv").write_text(f"text,leaf\nA deer.,{label}\n")
    assert read_records(folder / "a.jsonl") == read_records(folder / "a.csv")


@pytest.mark.parametrize("path", [["r", ""], ["", "r"], ["r", " ", "x"]])
def test_a_path_with_a_blank_label_is_refused(tmp_path, path):
    (tmp_path / "a.jsonl").write_text(json.dumps({"text": "A deer.", "path": path}))
    with pytest.raises(DataError, match="line 1: `path` holds a blank label"):
        read_records(tmp_path / "a.jsonl")


@pytest.mark.parametrize("label", [1.5, True, {"a": "b"}, ["r", None], ["r", ["x"]]])
def test_a_label_that_is_no_text_is_refused(tmp_path, label):
    rows = [{"text": "A deer."}, {"text": "A sofa.", "path": label}]
    (tmp_path / "a.jsonl").write_text("\n".join(map(json.dumps, rows)))
    with pytest.raises(DataError, match="`path` holds") as caught:
        read_records(tmp_path / "a.jsonl")
    assert [issue.path for issue in caught.value.issues] == ["line 2"]


LINES = st.lists(
    st.text(st.characters(exclude_characters="\r\n\0", codec="utf-8"), min_size=1)
    .map(str.strip)
    .filter(lambda line: is_visible(line) and line[0] not in '[{"'),
    min_size=1,
    max_size=6,
)


@given(lines=LINES, ends=st.lists(st.sampled_from(["\n", "\r\n", "\r"]), min_size=6, max_size=6))
def test_lines_end_as_on_any_machine_and_nowhere_else(tmp_path_factory, lines, ends):
    path = tmp_path_factory.mktemp("lines") / "texts.txt"
    content = "".join(line + end for line, end in zip(lines, ends, strict=False))
    path.write_bytes(b"\xef\xbb\xbf" + content.encode())
    assert [record.text for record in read_records(path)] == [line.strip() for line in lines]


@pytest.mark.parametrize("mark", ["\u2028", "\u2029", "\x85", "\x0b", "\x0c", "\x1c"])
def test_a_separator_inside_a_text_ends_no_line(tmp_path, mark):
    text = f"A deer{mark}jumps."
    for name, content in (
        ("t.txt", text),
        ("t.jsonl", json.dumps({"text": text}, ensure_ascii=mark < " ")),
        ("t.csv", f"text\n{text}"),
    ):
        (tmp_path / name).write_text(content + "\n", encoding="utf-8", newline="")
        assert [record.text for record in read_records(tmp_path / name)] == [text]


@given(rows=st.lists(st.tuples(LINES, LINES), min_size=1, max_size=4), end=st.sampled_from("\r\n"))
def test_csv_of_any_texts_is_read_as_it_was_written(tmp_path_factory, rows, end):
    path = tmp_path_factory.mktemp("rows") / "texts.csv"
    plain = [("\n".join(text), '", '.join(leaf)) for text, leaf in rows]
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator=end, quoting=csv.QUOTE_ALL)
        writer.writerows([("text", "leaf"), *plain])
    assert [tuple(record) for record in read_records(path)] == [
        (text.strip(), leaf.strip()) for text, leaf in plain
    ]


@pytest.mark.parametrize(
    ("content", "line", "said"),
    [
        ('text\nA deer.\n"A sofa.\nA car.\n', "line 3", "a quote is not closed"),
        ('text\n"A "deer" jumps."\n', "line 2", "is not CSV"),
        ("text\nA deer, jumping.\n", "line 2", "has 2 fields"),
        ("text,text\nA deer.,A sofa.\n", "line 1", "two columns 'text'"),
        ("text,leaf,leaf\nA deer.,a,b\n", "line 1", "two columns 'leaf'"),
        ("group,text,path,group\na,A deer.,b,c\n", "line 1", "two columns 'group'"),
        ("id, text\n1,A deer.\n", "line 1", "(columns: 'id', ' text')"),
        ("words\nA deer.\n", "line 1", "no column 'text'"),
        ("text,leaf\n,a\nA deer.\n", "line 2", "is blank"),
        ("text,leaf\n\n\n,a\n", "line 4", "is blank"),
        ("\nwords\nA deer.\n", "line 2", "no column 'text'"),
        ("words\n", "line 1", "no column 'text'"),
        ("id,text\n1,one\n2\n", "line 3", "no field 'text'"),
        (f"text\nA deer.\n{'x' * 1_000_001}\n", "line 3", "more than 1,000,000 characters"),
    ],
)
def test_a_faulty_csv_is_refused_with_its_line(tmp_path, content, line, said):
    (tmp_path / "t.csv").write_text(content)
    with pytest.raises(DataError) as caught:
        read_records(tmp_path / "t.csv")
    assert any(issue.path == line and said in issue.message for issue in caught.value.issues)


@given(
    st.lists(st.sampled_from(["", " ", ",", " , ", "A deer.,a", "A sofa."]), max_size=8),
    st.integers(0, 2),
)
def test_blank_rows_of_a_csv_are_skipped(tmp_path_factory, rows, before):
    path = tmp_path_factory.mktemp("rows") / "texts.csv"
    path.write_text("\n" * before + "\n".join(["text,leaf", *rows, "A car."]))
    texts = [row.split(",")[0] for row in rows if row.startswith("A")]
    assert [record.text for record in read_records(path)] == [*texts, "A car."]


@pytest.mark.parametrize("name", ["t.txt", "t"])
@pytest.mark.parametrize(
    "line",
    [
        *("[Night] A deer stands.", "[1] A deer stands.", "[A deer]"),
        *("{deer} on the road", "{ a deer } jumps", "{1}", "[{tag}] A deer."),
    ],
)
def test_a_text_may_begin_with_a_bracket(tmp_path, name, line):
    (tmp_path / name).write_text(f"{line}\nA sofa.\n")
    assert [record.text for record in read_records(tmp_path / name)] == [line, "A sofa."]


def test_the_suffix_of_json_lines_tells_their_form(tmp_path):
    (tmp_path / "a.jsonl").write_text('["A deer."]\n["A sofa."]\n')
    with pytest.raises(DataError) as caught:
        read_records(tmp_path / "a.jsonl")
    assert [issue.path for issue in caught.value.issues] == ["line 1", "line 2"]
    assert all("is list, not a text" in issue.message for issue in caught.value.issues)


@pytest.mark.parametrize("content", ['["A deer."]', '[\n{"text": "A deer."}\n]'])
def test_a_json_list_needs_no_suffix(tmp_path, content):
    (tmp_path / "t.txt").write_text(content)
    assert [record.text for record in read_records(tmp_path / "t.txt")] == ["A deer."]


@pytest.mark.parametrize("first", ["null", "1", '["A fox.", "animals"]'])
def test_a_list_on_several_lines_is_read_as_json_whatever_is_first(tmp_path, first):
    (tmp_path / "texts").write_text(f'[\n  {first},\n  "A deer."\n]\n')
    with pytest.raises(DataError) as caught:
        read_records(tmp_path / "texts")
    assert [issue.path for issue in caught.value.issues] == ["[0]"]


def test_empty_fields_at_the_end_of_a_row_are_none(tmp_path):
    (tmp_path / "t.csv").write_text("text,leaf\nA deer.,a,,\n")
    assert [tuple(record) for record in read_records(tmp_path / "t.csv")] == [("A deer.", "a")]


@pytest.mark.parametrize(
    ("content", "line"),
    [
        ("A deer.\n".encode("utf-16"), "line 1"),
        ("A deer.\n".encode("utf-16-le"), "line 1"),
        (b"A deer.\nA so\0fa.\n", "line 2"),
        (b"A deer.\n" + b"x" * 1_000_001, "line 2"),
        (b'{"text": "A deer."}\n3\n[]\nnull\n', "line 2"),
        (b'{"text": "A deer."}\n{"text": NaN}\n', "line 2"),
        (b'{"text": "A deer."}\n' + b"[" * 100_000 + b"\n", "line 2"),
        (b'{"text": "A deer."}\n{"text": "\\u0000"}\n', "line 2"),
        (b'{"text": "A deer."}\n{"text": "\\ud800"}\n', "line 2"),
    ],
)
def test_what_is_no_text_is_refused_with_its_line(tmp_path, content, line):
    (tmp_path / "t.txt").write_bytes(content)
    with pytest.raises(DataError) as caught:
        read_records(tmp_path / "t.txt")
    assert caught.value.issues[0].path == line


@given(
    st.lists(st.text("abc ", min_size=1).filter(str.strip), min_size=1, max_size=4),
    st.dictionaries(st.sampled_from(["text", "id"]), st.text("ab", min_size=1))
    | st.lists(st.text("ab")),
)
def test_json_below_a_plain_line_is_no_text(tmp_path_factory, lines, value):
    path = tmp_path_factory.mktemp("lines") / "texts.txt"
    path.write_text("\n".join([*lines, json.dumps(value)]))
    with pytest.raises(DataError) as caught:
        read_records(path)
    (issue,) = caught.value.issues
    assert issue.path == f"line {len(lines) + 1}"
    assert f"JSON {'object' if isinstance(value, dict) else 'list'}" in issue.message


@pytest.mark.parametrize("name", ["a.json", "a.txt", "a"])
def test_an_object_may_take_several_lines_and_has_one_fault(tmp_path, name):
    text = json.dumps({"text": "A deer.", "leaf": "x", "id": 3}, indent=2)
    (tmp_path / name).write_text(text)
    assert [tuple(record) for record in read_records(tmp_path / name)] == [("A deer.", "x")]
    (tmp_path / name).write_text(text.replace('"x",', '"x"'))
    with pytest.raises(DataError) as caught:
        read_records(tmp_path / name)
    (issue,) = caught.value.issues
    assert "at line 4" in issue.message


@pytest.mark.parametrize("content", ['"Deer"', "5", "null", "true"])
def test_one_json_value_is_no_list_of_texts(tmp_path, content):
    (tmp_path / "a.json").write_text(content)
    with pytest.raises(DataError, match="no list of texts"):
        read_records(tmp_path / "a.json")


@pytest.mark.parametrize("line", ["{'text': 'A deer.'}", "{text: A deer.}", "{}", '{"text"', "{"])
def test_what_was_meant_as_an_object_is_no_text(tmp_path, line):
    (tmp_path / "t.txt").write_text(line)
    with pytest.raises(DataError):
        read_records(tmp_path / "t.txt")


@pytest.mark.parametrize("line", ["foo", '{"text" "A deer."}', '{"text": "A'])
def test_a_fault_of_a_json_line_names_its_line_alone(tmp_path, line):
    (tmp_path / "a.jsonl").write_text(f'"A deer."\n{line}\n')
    with pytest.raises(DataError) as caught:
        read_records(tmp_path / "a.jsonl")
    (issue,) = caught.value.issues
    assert issue.path == "line 2"
    assert "line" not in issue.message
    assert " at column " in issue.message


def test_a_csv_takes_texts_as_long_as_any_other_form_and_leaves_the_limit_of_the_process(tmp_path):
    before = csv.field_size_limit()
    (tmp_path / "t.csv").write_text(f"text\n{'x' * 1_000_000}\n")
    (record,) = read_records(tmp_path / "t.csv")
    assert len(record.text) == 1_000_000
    assert csv.field_size_limit() == before
