"""What commands write lands where it was said to, and takes nothing else's place."""

import json
import os
import signal
import stat
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path

import pytest
from click.testing import CliRunner

from oodscen import TreeGrower, _cli, make_llm
from oodscen._cli import _interruptible, main
from oodscen._cli.output import if_stopped, read_lines, write
from oodscen.data._scenario import Scenario
from oodscen.errors import DataError, FolderTaken, OodscenError
from tests.forks import ended_fork


def test_a_file_is_replaced_where_a_link_leads_and_keeps_its_mode(tmp_path):
    file, link = tmp_path / "real" / "a.json", tmp_path / "link"
    file.parent.mkdir()
    file.write_text("old")
    file.chmod(0o640)
    link.symlink_to("real/a.json")
    write(link, "new")
    assert link.is_symlink()
    assert file.read_text() == "new\n"
    assert stat.S_IMODE(file.stat().st_mode) == 0o640
    assert [path.name for path in file.parent.iterdir()] == ["a.json"]


def test_a_pipe_is_written_through(tmp_path):
    pipe, read = tmp_path / "pipe", []
    os.mkfifo(pipe)
    reader = threading.Thread(target=lambda: read.append(pipe.read_text()))
    reader.start()
    write(pipe, "text")
    reader.join()
    assert read == ["text\n"]
    assert pipe.is_fifo()


def test_a_device_stays_one(tmp_path):
    link = tmp_path / "null"
    link.symlink_to("/dev/null")
    write(link, "text")
    assert link.is_char_device()


@pytest.mark.parametrize("place", ["/dev/full", "file/below", "folder"])
def test_what_cannot_be_written_is_one_line(tmp_path, place):
    (tmp_path / "file").write_text("")
    (tmp_path / "folder").mkdir()
    with pytest.raises(OodscenError, match=r"^cannot write .*: [A-Z][^\n]*$"):
        write(tmp_path / place, "text")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "folder"]


def test_no_file_of_a_study_is_replaced(tmp_path):
    (tmp_path / "study.json").write_text("{}")
    for name in ("study.json", "tree.initial.json", "scenes.jsonl", "texts.diverse.10.jsonl"):
        with pytest.raises(FolderTaken) as caught:
            write(tmp_path / name, "text")
        assert caught.value.names == (name,)
    assert [path.name for path in tmp_path.iterdir()] == ["study.json"]
    for name in ("mine.json", "catalogues.json"):
        write(tmp_path / name, "text")
    with pytest.raises(FolderTaken):
        write(tmp_path / "catalogues.json", "text")


def test_closed_or_full_output_is_one_line(monkeypatch):
    def full(*words, **more):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("oodscen._cli.output.click.echo", full)
    monkeypatch.setattr("oodscen._cli.say", lambda words, err: said.append(words))
    said: list[str] = []
    assert CliRunner().invoke(main, ["grow", "--nodes", "12"]).exit_code == 1
    monkeypatch.setattr("sys.stdout", None)
    with pytest.raises(SystemExit) as caught:
        main(["grow", "--nodes", "12"])
    assert caught.value.code == 2
    assert ["No space left" in said[0], "closed" in said[1], len(said)] == [True, True, 2]


def test_lines_are_split_at_line_feeds_alone(tmp_path):
    file = tmp_path / "a.jsonl"
    rows = [Scenario(id="a", text="x\u2028y\u0085z\x0b"), Scenario(id="b", text="w")]
    file.write_bytes(b"\r\n".join(row.to_json().encode() for row in rows))
    assert read_lines(Scenario, file) == rows


@pytest.mark.parametrize(
    "content", [b"\xff", b'{"id":' * 50_000, b'{"id":"a","id":"b","text":"x"}']
)
def test_a_malformed_line_is_a_data_error(tmp_path, content):
    (tmp_path / "a.jsonl").write_bytes(content)
    with pytest.raises(DataError):
        read_lines(Scenario, tmp_path / "a.jsonl")


def test_simulating_touches_no_study_and_nothing_simulated_before(tmp_path):
    from oodscen.testing._scenes import example_scene

    scenes = tmp_path / "scenes.jsonl"
    scenes.write_text(example_scene().to_json() + "\n")

    def simulate(out):
        order = ["simulate", str(scenes), str(out), "--simulator", "flat"]
        return CliRunner().invoke(main, order)

    for name in ("study.json", "traces"):
        folder = tmp_path / name.partition(".")[0]
        (folder / name).mkdir(parents=True)
        found = simulate(folder)
        assert found.exit_code == 2
        assert f"holds {name} already" in found.output
        assert [path.name for path in folder.iterdir()] == [name]
    assert simulate(tmp_path / "new").exit_code == 0
    before = files(tmp_path / "new")
    scenes.write_text(example_scene().model_copy(update={"horizon_s": 7.0}).to_json() + "\n")
    found = simulate(tmp_path / "new")
    assert found.exit_code == 2
    assert "episodes.jsonl" in found.output
    assert files(tmp_path / "new") == before


def files(folder):
    """Return the content of all files below a folder."""
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_an_id_too_long_for_a_file_is_refused_before_anything_runs(tmp_path):
    from oodscen.testing._scenes import example_scene

    row = json.loads(example_scene().to_json()) | {"id": "x" * 300}
    (tmp_path / "scenes.jsonl").write_text(json.dumps(row))
    order = ["simulate", str(tmp_path / "scenes.jsonl"), str(tmp_path / "out")]
    found = CliRunner().invoke(main, order)
    assert found.exit_code == 2
    assert "line 1: id: String should have at most 210" in found.output
    assert not (tmp_path / "out").exists()


@pytest.fixture
def named(tmp_path):
    """The names of one file: plain, by another way, by a symbolic link, by a hard link."""
    (tmp_path / "tree.json").write_text(TreeGrower(make_llm("builtin"), nodes=12).run().to_json())
    (tmp_path / "link").symlink_to("tree.json")
    os.link(tmp_path / "tree.json", tmp_path / "hard")
    return [tmp_path / "tree.json", f"{tmp_path}/./tree.json", tmp_path / "link", tmp_path / "hard"]


@pytest.mark.parametrize(
    "command",
    [
        "redteam ONE --budget 1 --encoder none -o OTHER",
        "redteam ONE --budget 1 --encoder none --log OTHER",
        "prune ONE --simulator flat -o OTHER",
        "prune ONE --simulator flat --decisions OTHER",
        "describe ONE -o OTHER",
        "tree replay ONE -o OTHER",
        "tree merge ONE ONE -o OTHER",
        "tree export ONE -o OTHER",
        "grow --llm replay:ONE -o OTHER",
        "grow --llm replay:ONE#m -o OTHER",
        "grow --llm replay:ONE#org/m#2 -o OTHER",
        "prune TREE --catalogue ONE -o OTHER",
    ],
)
def test_no_output_replaces_an_input(named, tmp_path, command):
    (tmp_path / "other.json").write_bytes(named[0].read_bytes())
    command = command.replace("TREE", str(tmp_path / "other.json"))
    before = named[0].read_bytes()
    for name in named:
        words = command.replace("ONE", str(named[0])).replace("OTHER", str(name)).split()
        found = CliRunner().invoke(main, words)
        assert (found.exit_code, found.output.count("\n")) == (2, 1)
        assert "would replace a file that" in found.output
    assert named[0].read_bytes() == before


def test_no_two_outputs_are_one_file(named, tmp_path):
    (tmp_path / "tree.new").symlink_to("new")
    twice = [(named[0], name) for name in named]
    twice += [(tmp_path / "new", f"{tmp_path}/./new"), (tmp_path / "new", tmp_path / "tree.new")]
    (tmp_path / "other.json").write_bytes(named[0].read_bytes())
    before = named[0].read_bytes()
    for options in (("-o", "--decisions"), ("--decisions", "--restore"), ("-o", "--restore")):
        for one, other in twice:
            words = [options[0], str(one), options[1], str(other)]
            order = ["prune", str(tmp_path / "other.json"), "--simulator", "flat", *words]
            found = CliRunner().invoke(main, order)
            assert (found.exit_code, found.output.count("\n")) == (2, 1)
            assert "name the same file" in found.output
    assert named[0].read_bytes() == before
    assert not (tmp_path / "new").exists()
    order = ["--simulator", "flat", "--decisions", "/dev/null", "--restore", "/dev/null"]
    found = CliRunner().invoke(main, ["prune", str(named[0]), *order, "-o", "/dev/null"])
    assert found.exit_code == 0


def test_a_fork_of_the_command_ends_at_a_signal_without_a_word(capfd):
    with _interruptible():
        assert ended_fork() == -signal.SIGTERM
    assert capfd.readouterr().err == ""


TWICE = """
import os, signal, threading, time
from oodscen._cli import _interruptible

def signals():
    for _ in range(2):
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(0.02)

try:
    with _interruptible():
        threading.Thread(target=signals).start()
        time.sleep(60)
except KeyboardInterrupt:
    print("interrupted once")
"""


def test_a_signal_that_comes_twice_at_once_is_one():
    done = subprocess.run([sys.executable, "-c", TWICE], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (0, "interrupted once\n"), done.stderr


@pytest.mark.parametrize("is_told", [True, False])
def test_a_foreign_error_after_a_dropped_interruption_counts_as_it(is_told):
    def compiling() -> None:
        with _interruptible():
            with suppress(KeyboardInterrupt):
                if is_told:
                    signal.raise_signal(signal.SIGTERM)
            raise RuntimeError("no compiled object yet")

    with pytest.raises(KeyboardInterrupt if is_told else RuntimeError) as found:
        compiling()
    assert getattr(found.value, "signal", None) == (signal.SIGTERM if is_told else None)


@pytest.mark.parametrize(
    "words",
    [
        ("redteam", "TREE", "--llm", "nobody", "--log", "redteam.jsonl"),
        ("describe", "TREE", "--llm", "nobody", "-o", "scenarios.jsonl"),
        ("prune", "TREE", "--llm", "nobody", "-o", "verdicts.jsonl"),
        ("grow", "--llm", "nobody", "-o", "tree.initial.json"),
        ("props", "--details", "--simulator", "nobody", "-o", "study.json"),
        ("tree", "export", "TREE", "-o", "frames/a/last.jpg"),
        ("tree", "merge", "TREE", "TREE", "-o", "traces/a.parquet"),
        ("init", "--force", "--quick", "-o", "videos/a.mp4"),
        ("grow", "--llm", "nobody", "-o", ".oodscen.lock"),
    ],
)
def test_a_study_s_file_is_refused_before_the_work(tmp_path, words):
    (tmp_path / "study.json").write_text("{}")
    tree = tmp_path / "mine.json"
    tree.write_text("{}")
    *order, last = [str(tree) if word == "TREE" else word for word in words]
    (tmp_path / last).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / last).touch()
    found = CliRunner().invoke(main, [*order, str(tmp_path / last)])
    assert (found.exit_code, found.output.count("\n")) == (2, 1)
    assert f"holds {last} already" in found.output
    assert "nobody" not in found.output


@pytest.mark.parametrize("is_terminal", [True, False])
def test_a_document_steers_no_terminal_and_is_kept_as_it_is_elsewhere(
    monkeypatch, capsys, is_terminal
):
    monkeypatch.setattr(sys.stdout, "isatty", lambda: is_terminal)
    text = json.dumps({"model": "gnp.\u202eexe"}, ensure_ascii=False)
    write(None, text)
    shown = capsys.readouterr().out
    assert ("\u202e" in shown) == (not is_terminal)
    assert json.loads(shown) == json.loads(text)


STEERING = "\u202e\x07\u2066\x9b"


@pytest.mark.parametrize("name", ["init", "grow", "show", "report", "tree show", "check-claims"])
@pytest.mark.parametrize("place", ["argument", "option", "file"])
def test_no_word_of_the_caller_s_steers_a_terminal(tmp_path, name, place):
    file = tmp_path / f"a{STEERING}b.jsonl"
    file.write_text(json.dumps({"id": STEERING, STEERING: 1}, ensure_ascii=False))
    words = {"argument": [STEERING], "option": [f"--{STEERING}"], "file": [str(file)]}[place]
    found = CliRunner().invoke(main, [*name.split(), *words])
    assert found.exit_code
    assert not set(STEERING) & set(found.output)


def test_foreign_text_reaches_the_terminal_at_one_place():
    found = {
        path.stem
        for path in Path(_cli.__file__).parent.rglob("*.py")
        if "click.echo(" in path.read_text(encoding="utf-8")
    }
    assert found == {"output", "show", "completion"}  # Pictures and a script of our own.


@pytest.mark.parametrize("error", [None, OodscenError("down"), KeyboardInterrupt(), SystemExit(3)])
@pytest.mark.parametrize("items", [[], ["a scene"]])
def test_what_is_finished_is_saved_when_work_is_stopped(items, error):
    finished, saved = [], []
    stop = suppress(OodscenError, KeyboardInterrupt, SystemExit)
    with stop, if_stopped(finished, lambda: saved.extend(finished)):
        finished += items
        if error:
            raise error
    assert saved == (items if error else [])
