import errno
import json
import os
import shutil
import signal
import sys
import time
from contextlib import contextmanager

import pytest
from click.testing import CliRunner

from oodscen import ScenarioTree, Study
from oodscen._cli import EXIT_CODES, main
from tests.pipeline.quick import SMALL

ORDER = (
    "--quick --simulator flat --encoder hash --seed 3 --max-paths 1 --iterations 2 --no-demands "
    "--width 160 --height 120 --baseline"
).split()


SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def invoke(*order):
    return CliRunner().invoke(main, [str(word) for word in order])


@pytest.fixture
def study(small, tmp_path):
    return shutil.copytree(small, tmp_path / "study")


def test_a_run_that_goes_on_keeps_who_was_judged_and_how(study) -> None:
    found = invoke("evaluate", study, "--vlm", "constant:stop", "--protocol", "paper")
    assert found.exit_code == 0
    assert "notices, both" in found.output
    verdicts = (study / "verdicts.jsonl").read_bytes()
    assert invoke("run", study, *ORDER, SMALL.baseline).exit_code == 0
    assert (study / "verdicts.jsonl").read_bytes() == verdicts
    assert Study.open(study).config.protocols == ("ours", "paper")


@pytest.mark.parametrize("command", [["evaluate", "--vlm", "random"], ["report"], ["drive"]])
def test_a_folder_without_a_study_exits_with_2(tmp_path, command) -> None:
    found = invoke(command[0], tmp_path, *command[1:])
    assert found.exit_code == 2
    assert "holds no study" in found.output


@pytest.mark.parametrize(
    ("simulator", "is_told"), [("oodscen.testing._new.adapter:MySimulator", True), ("flat", False)]
)
def test_a_catalogue_that_shows_little_is_told_before_the_work(
    tmp_path, simulator, is_told
) -> None:
    words = ["--quick", "--simulator", simulator, "--encoder", "hash", "--dry-run"]
    found = invoke("run", tmp_path / "out", *words)
    assert found.exit_code == 0, found.stderr
    assert ("(3 maps, 4 assets, 4 behaviours) shows" in found.stderr) == is_told


@pytest.mark.parametrize("content", [b"", b"\0\0", b"\xff", b"[1, 2]", b"[" * 100_000])
def test_a_dry_run_opens_the_texts_of_ordinary_driving(tmp_path, content) -> None:
    (tmp_path / "texts.json").write_bytes(content)
    words = ["--quick", "--simulator", "flat", "--encoder", "hash", "--dry-run", "--baseline"]
    found = CliRunner().invoke(
        main, ["run", str(tmp_path / "o"), *words, str(tmp_path / "texts.json")]
    )
    assert (found.exit_code, found.output.count("texts.json")) == (2, 1)
    assert not (tmp_path / "o").exists()


def test_the_help_lists_the_exit_codes() -> None:
    words = invoke("--help").output
    assert all(f"{code}  {said}" in words for code, said in EXIT_CODES.items())


@pytest.mark.parametrize("command", ["evaluate", "report"])
def test_an_interruption_exits_with_130_and_names_the_command(study, monkeypatch, command) -> None:
    def interrupt(*args, **more):
        raise KeyboardInterrupt

    monkeypatch.setattr("oodscen._pipeline.run_study", interrupt)
    monkeypatch.setattr("oodscen.report._render.write_report", interrupt)
    monkeypatch.setattr("oodscen._pipeline.dropping.drop_models", lambda study, names: {})
    order = (
        ("evaluate", study, "--drop", "x", "--vlm", "a b")
        if command == "evaluate"
        else ("report", study)
    )
    found = invoke(*order)
    assert found.exit_code == 130
    assert "interrupted" in found.output
    again = f"this command continues: oodscen evaluate {study} --vlm 'a b'"
    assert (again in found.output) is (command == "evaluate")


def test_an_interrupted_estimate_has_nothing_to_continue(tmp_path, monkeypatch) -> None:
    def interrupt(*args, **more):
        raise KeyboardInterrupt

    monkeypatch.setattr("oodscen._pipeline.estimate", interrupt)
    found = invoke("run", tmp_path / "out", "--quick", "--dry-run")
    assert (found.exit_code, found.output) == (130, "oodscen: interrupted\n")


@pytest.mark.parametrize(
    ("words", "is_shown"), [((), False), (("--debug",), True)], ids=["plain", "debug"]
)
def test_too_little_memory_is_one_line(tmp_path, monkeypatch, words, is_shown) -> None:
    def full(*args, **more):
        raise MemoryError("Unable to allocate 9 GiB")

    monkeypatch.setattr("oodscen._pipeline.estimate", full)
    found = invoke(*words, "run", tmp_path / "out", "--quick", "--dry-run")
    assert found.exit_code == 1
    assert isinstance(found.exception, MemoryError if is_shown else SystemExit)
    assert ("not enough memory" in found.output) is not is_shown


@pytest.mark.parametrize("number", SIGNALS)
def test_a_signal_interrupts_and_the_next_one_ends_at_once(tmp_path, monkeypatch, number) -> None:
    handlers = []

    def stop(stage, done, total):
        if stage == "prune":
            try:
                os.kill(os.getpid(), number)
            finally:
                handlers.extend(map(signal.getsignal, SIGNALS))

    @contextmanager
    def stopping(ledger=None):
        yield stop

    monkeypatch.setattr("oodscen._cli.commands.study.bars", stopping)
    before = [*map(signal.getsignal, SIGNALS)]
    found = invoke("run", tmp_path / "out", *ORDER, SMALL.baseline, "--workers", "1")
    assert found.exit_code == 128 + number
    assert f"this command continues: oodscen run {tmp_path / 'out'} --quick" in found.output
    assert Study.open(tmp_path / "out").info["status"] == "stopped"
    assert handlers == [signal.SIG_DFL] * len(SIGNALS)
    assert [*map(signal.getsignal, SIGNALS)] == before


def test_an_interruption_with_a_full_disk_keeps_the_code_of_the_signal(
    tmp_path, monkeypatch
) -> None:
    def interrupted(pipeline) -> None:
        monkeypatch.setattr("oodscen.study._store.replace", full)
        signal.raise_signal(signal.SIGTERM)

    def full(target, data) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("oodscen._pipeline.pipeline.Pipeline._stages", interrupted)
    words = ["--quick", "--simulator", "flat", "--encoder", "hash", "--workers", "1"]
    found = CliRunner().invoke(main, ["run", str(tmp_path / "o"), *words])
    assert (found.exit_code, "interrupted" in found.output) == (143, True)


def test_an_interruption_that_a_finaliser_swallows_comes_again(tmp_path, monkeypatch) -> None:
    class Last:
        def __del__(self) -> None:
            signal.raise_signal(signal.SIGTERM)

    def swallow(study, bars, **more):
        Last()
        time.sleep(60.0)

    reported: list[object] = []
    monkeypatch.setattr(sys, "unraisablehook", reported.append)

    (tmp_path / "study.json").write_text('{"config": {}}')
    monkeypatch.setattr("oodscen.report._render.write_report", swallow)
    assert invoke("report", tmp_path).exit_code == 143
    assert not reported
    assert sys.unraisablehook == reported.append


def test_a_signal_that_shall_be_ignored_is(tmp_path, monkeypatch) -> None:
    def hang_up(study, bars, **more):
        os.kill(os.getpid(), signal.SIGHUP)
        return tmp_path

    (tmp_path / "study.json").write_text('{"config": {}}')
    monkeypatch.setattr("oodscen.report._render.write_report", hang_up)
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        assert invoke("report", tmp_path).exit_code == 0
    finally:
        signal.signal(signal.SIGHUP, before)


@pytest.mark.parametrize("content", ["", '{"config": {"se'])
@pytest.mark.parametrize(
    "order",
    ["show OUT", "tree show OUT", "tree coverage OUT", "report OUT", "serve OUT --carla 0"],
)
def test_a_record_that_is_empty_or_cut_is_noticed_by_every_reader(order, content, tmp_path) -> None:
    texts = {"study.json": content, "report.html": "good", "scenes.jsonl": ""}
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
    done = invoke(*order.replace("OUT", str(tmp_path)).split())
    assert (done.exit_code, done.stdout) == (2, "")
    assert f"malformed study in {tmp_path / 'study.json'}" in done.stderr
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == texts


@pytest.mark.parametrize(
    ("idle", "said"),
    [
        (("--context", "4096"), "--context has no effect on the built-in author"),
        (("--price", "zzz=1,1"), "--price has no effect for zzz"),
        (("--encoder", "none"), "a study measures its texts and needs an encoder"),
    ],
)
def test_what_a_run_has_no_use_for_is_refused(idle, said, tmp_path) -> None:
    for more in ((), ("--dry-run",)):
        refused = invoke("run", tmp_path / "new", "--quick", "--simulator", "flat", *idle, *more)
        assert refused.exit_code == 2
        assert said in refused.output
        assert not (tmp_path / "new").exists()


def test_a_study_that_grew_its_tree_takes_no_other(study) -> None:
    for name in ("missing.json", study / "tree.diverse.json"):
        refused = invoke("run", study, *ORDER, SMALL.baseline, "--tree", name)
        assert (refused.exit_code, "tree" in refused.stderr) == (2, True)


def test_a_study_needs_the_file_of_its_tree_only_to_begin(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    file, out = tmp_path / "tree.json", tmp_path / "out"
    words = ["--iterations", "0", "--quick", "--simulator", "flat", "--encoder", "hash"]
    words += ["--baseline", SMALL.baseline, "--workers", "1"]
    assert invoke("run", out, "--tree", "tree.json", *words).exit_code == 2
    file.write_text(ScenarioTree.initial().to_json())
    assert "has no path" in invoke("run", out, "--tree", "tree.json", *words).stderr
    assert not out.exists()
    nodes = [("root", None, "OOD"), ("a", "root", "Weather"), ("b", "a", "Thick fog")]
    plain = {"nodes": [{"id": i, "parent": p, "label": label} for i, p, label in nodes]}
    file.write_text(json.dumps(plain))
    assert invoke("run", out, "--tree", "tree.json", *words).exit_code == 0
    tables = (out / "verdicts.jsonl").read_bytes()
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    for given in (["--tree", file], ["--tree", "gone.json"], []):
        assert invoke("run", out, *given, *words).exit_code == 0
    assert (out / "verdicts.jsonl").read_bytes() == tables
    file.write_text(json.dumps(plain).replace("Thick", "Patchy"))
    assert "tree: the study has" in invoke("run", out, "--tree", file, *words).stderr
