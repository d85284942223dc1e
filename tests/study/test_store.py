"""Files of a study: always valid, whatever happens in between."""

import hashlib
import json
import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.errors import DataError, OodscenError, StudyError, StudyMissing
from oodscen.study import _store
from oodscen.study._store import Store
from oodscen.study._study import Study

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


def test_half_a_surrogate_pair_is_a_gap_in_its_line(tmp_path):
    store = Store(tmp_path)
    store.append("a.jsonl", {"error": "cut \ud83d off"})
    store.write_lines("b.jsonl", [{"error": "cut \ud83d off"}])
    for name in ("a.jsonl", "b.jsonl"):
        assert list(store.lines(name)) == [{"error": "cut \ufffd off"}]


def test_an_empty_file_is_there_and_holds_nothing(tmp_path):
    store = Store(tmp_path)
    assert (store.has("a.jsonl"), store.holds("a.jsonl")) == (False, False)
    store.write_lines("a.jsonl", [])
    assert (store.has("a.jsonl"), store.holds("a.jsonl")) == (True, False)
    store.append("a.jsonl", {"id": "x"})
    assert store.holds("a.jsonl") is True
    store.write("a.jsonl", "\n")
    assert store.holds("a.jsonl") is True


@given(ROWS.filter(bool), st.data())
def test_reading_changes_nothing_and_only_whole_lines_count(tmp_path_factory, rows, data):
    store = Store(tmp_path_factory.mktemp("store"))
    store.write_lines("a.jsonl", rows)
    content = store.path("a.jsonl").read_bytes()
    left = content[: data.draw(st.integers(0, len(content)))]
    store.path("a.jsonl").write_bytes(left)
    os.utime(store.path("a.jsonl"), (1, 1))
    lacks_only_its_end = not left.endswith(b"\n") and content[len(left) :].startswith(b"\n")
    whole = rows[: left.count(b"\n") + lacks_only_its_end]
    assert list(store.lines("a.jsonl")) == whole
    assert store.path("a.jsonl").read_bytes() == left
    assert store.path("a.jsonl").stat().st_mtime == 1
    store.append("a.jsonl", {"id": "next"})
    assert list(store.lines("a.jsonl")) == [*whole, {"id": "next"}]
    store.append("a.jsonl", {"id": "last"})
    lines = [json.loads(line) for line in store.path("a.jsonl").read_bytes().split(b"\n")[:-1]]
    assert lines == [*whole, {"id": "next"}, {"id": "last"}]


def test_a_long_torn_line_is_cut_off_whole(tmp_path):
    store = Store(tmp_path)
    store.path("a.jsonl").write_text('{"id":1}\n{"text":"' + "x" * 200_000)
    store.append("a.jsonl", {"id": 2})
    assert store.path("a.jsonl").read_text() == '{"id":1}\n{"id":2}\n'


def test_lines_end_at_line_feeds_alone(tmp_path):
    store = Store(tmp_path)
    store.path("a.jsonl").write_bytes('{"a":"x\u2028y\u0085z"}\r\n\n{"a":1}'.encode())
    assert list(store.numbered("a.jsonl")) == [(1, {"a": "x\u2028y\u0085z"}), (3, {"a": 1})]


@pytest.mark.parametrize(
    "line",
    [
        b"[1]",
        b"null",
        b'{"a":NaN}',
        b'{"a":-Infinity}',
        b'{"a":1e999}',
        b'{"a":1,"a":1}',
        b'{"a":"\xff"}',
        b'{"a":"\\ud800"}',
        b'{"a":' + b"9" * 400 + b"}",
        b'{"a":' * 100_000,
        b"\0",
    ],
)
def test_what_is_no_plain_object_is_one_line(tmp_path, line):
    store = Store(tmp_path)
    store.path("a.jsonl").write_bytes(line + b'\n{"a":1}\n')
    with pytest.raises(DataError, match="line 1") as caught:
        list(store.lines("a.jsonl"))
    assert len(caught.value.issues) == 1
    with pytest.raises(DataError):
        store.read("a.jsonl")


def test_a_folder_in_place_of_a_file_is_refused(tmp_path):
    store = Store(tmp_path)
    store.path("a.jsonl").mkdir()
    for read in (store.read, lambda name: list(store.lines(name))):
        with pytest.raises(DataError, match="not a regular file"):
            read("a.jsonl")


def test_names_lead_nowhere_else(tmp_path):
    store = Store(tmp_path / "study")
    store.prepare()
    store.write("frames/a/first.jpg", b"")
    (tmp_path / "priv").mkdir()
    store.path("frames/b").symlink_to(tmp_path / "priv")
    store.path("frames/c").symlink_to("a")
    assert store.inside("frames/a/first.jpg").is_file()
    assert store.inside("frames/c/first.jpg").is_file()
    for name in ("", "../priv/x.jpg", "/etc/passwd", "frames/../../x", "frames/b/x.jpg", "a\0b"):
        with pytest.raises(DataError):
            store.inside(name)


def test_what_a_killed_writer_left_goes_when_the_next_one_writes(tmp_path):
    store = Store(tmp_path)
    (tmp_path / "frames").mkdir()
    part = tmp_path / "frames" / ".1-01234567-01234567-01234567.oodscen-part"
    users = tmp_path / ".mine.part"
    for path in (part, users):
        path.write_text("")
    with store.writing():
        assert not part.exists()
    assert users.exists()


def test_a_folder_that_stays_empty_is_not_left_behind(tmp_path):
    with Store(tmp_path / "a" / "b").writing():
        pass
    assert not list(tmp_path.iterdir())


def test_a_fault_in_the_middle_is_an_error_that_names_the_line(tmp_path):
    store = Store(tmp_path)
    store.path("a.jsonl").write_text('{"id": 1}\nnot json\n{"id": 2}\n')
    with pytest.raises(DataError, match="line 2"):
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
    for folder in (tmp_path / "file" / "out", tmp_path / ("a" * 300), Path("a\0b"), Path("\ud800")):
        with pytest.raises(StudyError, match="cannot write"):
            Store(folder).prepare()
        with pytest.raises(StudyError, match="cannot write"), Store(folder).writing():
            pass
    with Store(tmp_path / "a" / "b").writing():
        assert (tmp_path / "a" / "b").is_dir()


def test_a_folder_that_was_moved_away_is_not_empty(tmp_path):
    study = Study(tmp_path / "study")
    study.store.prepare()
    assert (study.episodes, study.metrics, study.table("scenes")) == ([], {}, [])
    (tmp_path / "study").rename(tmp_path / "elsewhere")
    for name in ("episodes", "scenarios", "scenes", "rounds", "decisions", "metrics"):
        with pytest.raises(OodscenError, match="study"):
            getattr(study, name)
    with pytest.raises(StudyMissing):
        study.table("scenes")


def test_a_folder_that_was_moved_away_is_not_made_again(tmp_path):
    store = Store(tmp_path / "study")
    store.prepare()
    store.folder.rename(tmp_path / "elsewhere")
    with pytest.raises(StudyError, match="cannot write"):
        store.write("frames/a.jpg", b"")
    assert not store.folder.exists()


def test_lines_are_canonical(tmp_path):
    store = Store(tmp_path)
    store.append("a.jsonl", {"b": 1, "a": "ü"})
    assert store.path("a.jsonl").read_text(encoding="utf-8") == '{"a":"ü","b":1}\n'
    assert json.loads(store.path("a.jsonl").read_text(encoding="utf-8")) == {"a": "ü", "b": 1}


def test_nothing_is_written_through_a_folder_that_leads_elsewhere(tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "study").mkdir()
    (tmp_path / "study" / "frames").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(DataError):
        Store(tmp_path / "study").write("frames/a/first.jpg", b"")
    assert not list((tmp_path / "elsewhere").iterdir())


def test_a_pipe_is_refused_at_once(tmp_path):
    os.mkfifo(tmp_path / "verdicts.jsonl")
    with pytest.raises(DataError, match="not a regular file"):
        list(Store(tmp_path).lines("verdicts.jsonl"))


def test_an_unreadable_file_is_not_called_malformed(tmp_path, monkeypatch):
    Store(tmp_path).append("verdicts.jsonl", {})

    def refuse(*_):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(os, "open", refuse)
    with pytest.raises(DataError, match=r"unreadable study in .*\n  - Permission denied"):
        list(Store(tmp_path).lines("verdicts.jsonl"))


def test_a_file_is_there_read_digested_and_removed(tmp_path):
    store = Store(tmp_path / "a" / "study")
    for _ in range(2):
        store.prepare()
    assert not store.has("a.json")
    assert list(store.lines("a.json")) == []
    for content in ('{"a":0}', b'{"a":1}'):
        store.write("frames/deep/a.json", content)
    assert store.has("frames/deep/a.json")
    assert not store.has("frames")
    assert store.read("frames/deep/a.json") == {"a": 1}
    assert store.digest("frames/deep/a.json") == hashlib.sha256(b'{"a":1}').hexdigest()
    for _ in range(2):
        store.remove("frames/deep/a.json")
        assert not store.has("frames/deep/a.json")
    with pytest.raises(DataError):
        store.digest("../a.json")


def test_a_line_that_did_not_fit_is_cut_off_before_the_next_one(tmp_path, monkeypatch):
    store = Store(tmp_path)
    store.append("a.jsonl", {"id": 1})
    opened = Path.open

    class Full:
        def __init__(self, file):
            self.file = file

        def __enter__(self):
            return self

        def __exit__(self, *exc):
            self.file.close()

        def fileno(self):
            return self.file.fileno()

        def write(self, data):
            return self.file.write(data[:3])

    with monkeypatch.context() as patch:
        patch.setattr(Path, "open", lambda path, *how, **more: Full(opened(path, *how, **more)))
        with pytest.raises(StudyError, match=r"a\.jsonl: the disk is full"):
            store.append("a.jsonl", {"id": 2})
    assert store.path("a.jsonl").read_text() == '{"id":1}\n{"i'
    store.append("a.jsonl", {"id": 3})
    assert list(store.lines("a.jsonl")) == [{"id": 1}, {"id": 3}]


def test_a_files_end_is_looked_at_once_and_again_by_the_next_writer(tmp_path, monkeypatch):
    store, mended = Store(tmp_path), []
    mend = _store._mend
    monkeypatch.setattr(_store, "_mend", lambda file: mended.append(file) or mend(file))
    for number in range(3):
        store.append("a.jsonl", {"id": number})
    assert len(mended) == 1
    store.path("a.jsonl").write_text('{"id":0}\n{"i')
    with store.writing():
        store.append("a.jsonl", {"id": 3})
    assert list(store.lines("a.jsonl")) == [{"id": 0}, {"id": 3}]


def test_only_the_end_of_a_long_file_is_read_before_a_line_is_added(tmp_path, monkeypatch):
    store, asked = Store(tmp_path), []
    store.path("a.jsonl").write_text('{"id":1}\n' * 100_000 + '{"i')
    pread = os.pread
    monkeypatch.setattr(os, "pread", lambda *how: asked.append(how[1]) or pread(*how))
    store.append("a.jsonl", {"id": 2})
    assert asked == [65_536]
    assert store.path("a.jsonl").read_text().endswith('{"id":1}\n{"id":2}\n')
