"""Files of a study: always valid, whatever happens in between."""

import json
import os

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.errors import StudyError
from oodscen.study import Store

ROWS = st.lists(
    st.fixed_dictionaries(
        {"id": st.text(max_size=8), "value": st.integers() | st.text(max_size=8)}
    ),
    max_size=6,
)


@given(ROWS)
def test_lines_come_back_as_they_were_written(tmp_path_factory, rows):
    store = Store(tmp_path_factory.mktemp("store"))
    for row in rows[: len(rows) // 2]:
        store.append("a.jsonl", row)
    assert list(store.lines("a.jsonl")) == rows[: len(rows) // 2]
    store.write_lines("a.jsonl", rows)
    assert list(store.lines("a.jsonl")) == rows


@given(ROWS.filter(bool), st.data())
def test_a_torn_last_line_is_dropped_and_the_file_is_whole_again(tmp_path_factory, rows, data):
    store = Store(tmp_path_factory.mktemp("store"))
    store.write_lines("a.jsonl", rows)
    content = store.path("a.jsonl").read_bytes()
    cut = data.draw(st.integers(0, len(content)))
    store.path("a.jsonl").write_bytes(content[:cut])
    whole = content[:cut].count(b"\n")
    assert list(store.lines("a.jsonl")) == rows[:whole]
    store.append("a.jsonl", {"id": "next"})
    assert list(store.lines("a.jsonl")) == [*rows[:whole], {"id": "next"}]


def test_a_fault_in_the_middle_is_an_error_that_names_the_line(tmp_path):
    store = Store(tmp_path)
    store.path("a.jsonl").write_text('{"id": 1}\nnot json\n{"id": 2}\n')
    with pytest.raises(StudyError, match="line 2"):
        list(store.lines("a.jsonl"))


def test_a_full_disk_leaves_the_old_file_and_says_so(tmp_path, monkeypatch):
    store = Store(tmp_path)
    store.write("a.json", "old")

    def full(descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(StudyError, match="No space left"):
        store.write("a.json", "new")
    assert store.path("a.json").read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["a.json"]


def test_a_folder_that_cannot_be_made_is_a_study_error(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(StudyError, match="cannot read or write"):
        Store(tmp_path / "file" / "out").prepare()


def test_lines_are_canonical(tmp_path):
    store = Store(tmp_path)
    store.append("a.jsonl", {"b": 1, "a": "ü"})
    assert store.path("a.jsonl").read_text(encoding="utf-8") == '{"a":"ü","b":1}\n'
    assert json.loads(store.path("a.jsonl").read_text(encoding="utf-8")) == {"a": "ü", "b": 1}
