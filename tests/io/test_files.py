"""Files that a user names: regular ones, up to a size, whatever else lies there."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from oodscen._cli import main
from oodscen._io.files import (
    _part_name,
    read_regular,
    read_utf8,
    replace,
    temporary_folder,
    writing,
)
from oodscen._registry import make_catalogue, make_llm
from oodscen.author._knowledge.loading import load_knowledge
from oodscen.baselines import load_baseline
from oodscen.baselines._embedded import open_embeddings
from oodscen.baselines._reading import read_records
from oodscen.driving._roads.building import find_map
from oodscen.errors import DataError, OodscenError, UsageError
from oodscen.llm._replay import RecordingLLM
from oodscen.protocols import Image
from oodscen.testing import ScriptedLLM
from oodscen.testing._encoder import HashEncoder

KINDS = ("fifo", "endless", "folder", "link to fifo", "link to endless", "socket", "nothing")


def put(folder: Path, kind: str, name: str) -> Path:
    """Put something that is not a regular file where one is wanted."""
    path, other = folder / name, folder / "other"
    if kind == "fifo":
        os.mkfifo(path)
    elif kind == "link to fifo":
        os.mkfifo(other)
        path.symlink_to(other)
    elif "endless" in kind:
        path.symlink_to("/dev/zero")
    elif kind == "folder":
        path.mkdir()
    elif kind == "socket":
        os.mknod(path, 0o140600)
    return path


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_no_regular_file_is_refused_at_once(tmp_path, kind):
    with pytest.raises(DataError) as caught:
        read_regular(put(tmp_path, kind, "x"), "thing")
    assert len(caught.value.issues) == 1


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "nothing"])
def test_a_recording_and_a_picture_are_regular_files(tmp_path, kind):
    path = put(tmp_path, kind, "x")
    with pytest.raises(DataError, match="is not a regular file"):
        RecordingLLM(ScriptedLLM([]), path)
    with pytest.raises(DataError, match="is not a regular file"):
        make_llm(f"replay:{path}")
    with pytest.raises(OSError, match="is not a regular file"):
        Image.from_file(path)


def test_a_line_without_an_end_is_no_exchange(tmp_path, monkeypatch):
    monkeypatch.setattr("oodscen.llm._recording._LONGEST", 1_000)
    (tmp_path / "x").write_bytes(b'{"answer":' + b" " * 2_000)
    with pytest.raises(DataError, match="line 1"):
        RecordingLLM(ScriptedLLM([]), tmp_path / "x")


@pytest.mark.parametrize("kind", KINDS)
def test_readers_of_the_library_refuse_it_at_once(tmp_path, kind):
    flat = make_catalogue("flat")
    readers = {
        "x.xodr": lambda path: find_map(str(path), flat),
        "x.txt": load_baseline,
        "x.csv": read_records,
        "x.toml": load_knowledge,
        "x.npy": lambda path: open_embeddings(path, HashEncoder()),
        "x.arrow": lambda path: open_embeddings(path, HashEncoder()),
        "x.jsonl": lambda path: make_llm(f"replay:{path}"),
        "y.jsonl": lambda path: make_llm(f"replay:{path}#m"),
    }
    for name, reader in readers.items():
        where = tmp_path / name.replace(".", "-")
        where.mkdir()
        with pytest.raises(DataError):
            reader(put(where, kind, name))


@pytest.mark.parametrize("kind", KINDS)
def test_commands_refuse_it_in_one_line(tmp_path, kind):
    path = str(put(tmp_path, kind, "x.json"))
    for order in (
        ("score", path),
        ("redteam", path),
        ("prune", path),
        ("describe", path),
        ("augment", path),
        ("simulate", path, str(tmp_path / "out")),
        ("check-claims", path, "--scenarios", path),
        ("tree", "show", path),
    ):
        result = CliRunner().invoke(main, order)
        assert result.exit_code == 2, order
        assert not (tmp_path / "out").exists()


def test_a_file_of_just_the_size_is_read(tmp_path):
    path = tmp_path / "x"
    path.write_bytes(b"x" * 10)
    assert read_regular(path, "thing", limit=10) == b"x" * 10
    with pytest.raises(DataError, match="more than 9 bytes"):
        read_regular(path, "thing", limit=9)


def test_a_huge_file_is_refused_without_being_read(tmp_path):
    with (tmp_path / "x.xodr").open("wb") as file:
        file.truncate(1 << 40)
    with pytest.raises(DataError, match="has more than"):
        find_map(str(tmp_path / "x.xodr"), make_catalogue("flat"))
    with pytest.raises(DataError, match="has more than"):
        load_baseline(tmp_path / "x.xodr")


def test_a_file_without_a_size_is_read_to_its_end():
    assert read_regular("/proc/self/cmdline", "thing")
    with pytest.raises(DataError, match="more than 3 bytes"):
        read_regular("/proc/self/cmdline", "thing", limit=3)


@pytest.mark.parametrize("name", ["", "a\0b", "x" * 100_000, "\ud800"])
def test_a_name_that_no_file_can_have_is_refused(name):
    with pytest.raises(DataError):
        read_regular(name, "thing")


def test_text_is_utf8_with_or_without_a_mark(tmp_path):
    path = tmp_path / "x"
    for content in (b"\xef\xbb\xbfa deer", b"a deer"):
        path.write_bytes(content)
        assert read_utf8(path, "thing") == "a deer"
    for mark in (b"", b"\xef\xbb\xbf"):
        path.write_bytes(mark + b"one\rtwo\r\nthree\n\xff")
        with pytest.raises(DataError) as caught:
            read_utf8(path, "thing")
        (issue,) = caught.value.issues
        assert issue.path == "line 4"
        assert issue.message.endswith(f"byte {len(mark) + 15}")


def test_a_missing_place_for_temporary_files_is_one_line(monkeypatch, tmp_path):
    with temporary_folder() as folder:
        assert Path(folder).is_dir()
    assert not Path(folder).exists()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "gone"))
    with pytest.raises(
        UsageError, match=r"^cannot create a temporary folder: No such file.* TMPDIR"
    ):
        temporary_folder()
    found = CliRunner().invoke(main, ["run", str(tmp_path / "out"), "--quick", "--dry-run"])
    assert (found.exit_code, found.output.count("\n")) == (2, 1)


def test_parts_of_dead_writers_of_the_same_target_go_at_its_next_write(tmp_path):
    target, other = tmp_path / "a.json", tmp_path / "b.json"
    with subprocess.Popen([sys.executable, "-c", ""]) as dead:
        dead.wait()
    names = {}
    for pid in (dead.pid, os.getpid(), 1):
        for path in (target, other):
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr("oodscen._io.files.os.getpid", lambda pid=pid: pid)
                names[pid, path] = tmp_path / _part_name(path)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("oodscen._io.files.gethostname", lambda: "elsewhere")
        names["host", target] = tmp_path / _part_name(target).replace(
            str(os.getpid()), str(dead.pid)
        )
    for path in names.values():
        path.write_text("")
    replace(target, b"new")
    gone = {name for name, path in names.items() if not path.exists()}
    assert gone == {(dead.pid, target)}
    assert target.read_bytes() == b"new"


def test_a_broken_link_in_place_of_a_folder_is_told(tmp_path):
    link = tmp_path / "link"
    link.symlink_to(tmp_path / "nowhere")
    with pytest.raises(OodscenError, match="broken link"), writing(link):
        link.mkdir(exist_ok=True)
