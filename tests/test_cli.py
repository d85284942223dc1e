"""The command line: thin, with exit codes that a CI can use and one line per mistake."""

import json
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from click.testing import CliRunner

from oodscen import ScenarioTree, __version__
from oodscen._cli import main
from oodscen.judging._constant_answerers import RandomAnswerer
from oodscen.testing._scenes import example_scene
from tests.pipeline.quick import ORDINARY

PROJECT = Path(__file__).parent.parent / "pyproject.toml"

QUICK = ["--quick", "--simulator", "flat", "--encoder", "hash", "--workers", "1"]
QUICK += ["--baseline", str(ORDINARY), "--width", "160", "--height", "120", "--max-paths", "1"]
QUICK += ["--iterations", "2", "--no-demands"]


class Guesser(RandomAnswerer):
    """A model that draws its answers, under a name of its own."""

    def __init__(self):
        super().__init__()
        self.name = "guesser"


def call(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cli") / "out"
    result = call("run", folder, *QUICK)
    assert result.exit_code == 0, result.output
    assert str(folder / "report.html") in result.output
    return folder


def test_run_says_who_wrote_the_texts_and_where_the_report_is(out):
    result = call("run", out, *QUICK)
    assert result.exit_code == 0
    assert "not a language model" in result.output
    assert "trees: 24 ->" in result.output


def test_run_prints_json(out):
    info = json.loads(call("run", out, *QUICK, "--json").stdout)
    assert info["status"] == "success"


def test_python_dash_m_is_the_same_program():
    command = [sys.executable, "-m", "oodscen", "--version"]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert printed == f"oodscen, version {__version__}\n"


@pytest.mark.parametrize("module", ["click", "oodscen._cli", "oodscen._cli.commands.tree"])
def test_an_interruption_while_modules_are_imported_is_one_line(module):
    code = f"""
import sys
from oodscen.__main__ import main

class Interrupting:
    def find_spec(self, name, path=None, target=None):
        if name == {module!r}:
            raise KeyboardInterrupt

sys.meta_path.insert(0, Interrupting())
main()
"""
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (found.returncode, found.stdout, found.stderr) == (130, "", "oodscen: interrupted\n")


@pytest.mark.parametrize(("word", "exit_code"), [("--version", 0), ("no-such-command", 2)])
def test_threads_that_a_plug_in_leaves_do_not_hold_the_command(word, exit_code):
    code = f"""
import sys, threading, time
from oodscen import __main__ as entry

entry._GRACE_S = 0.2
sys.argv[1:] = [{word!r}]
threading.Thread(target=time.sleep, args=(600,)).start()
entry.main()
"""
    found = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=120
    )
    assert found.returncode == exit_code
    assert found.stderr.endswith("oodscen: threads of plug-ins still ran: 1\n")


def test_the_command_and_python_dash_m_have_one_entry():
    scripts = tomllib.loads(PROJECT.read_text())["project"]["scripts"]
    assert scripts == {"oodscen": "oodscen.__main__:main"}


@pytest.mark.parametrize(
    ("option", "wrong", "hint"),
    [
        ("--simulator", "pybulet", "did you mean pybullet"),
        ("--encoder", "minilmm", "did you mean minilm"),
        ("--llm", "bultin", "did you mean builtin"),
    ],
)
def test_an_unknown_name_is_one_line_with_close_matches(tmp_path, option, wrong, hint):
    result = call("run", tmp_path / "out", "--quick", option, wrong)
    assert result.exit_code == 2
    assert hint in result.stderr
    assert "Traceback" not in result.stderr
    assert not (tmp_path / "out").exists()


def test_a_folder_of_another_configuration_is_refused_with_the_difference(out):
    result = call("run", out, *QUICK, "--seed", "9")
    assert result.exit_code == 2
    assert "seed: the study has 0, you asked for 9" in result.stderr


def test_an_unwritable_folder_is_one_line(tmp_path):
    (tmp_path / "file").write_text("")
    result = call("run", tmp_path / "file" / "out", *QUICK)
    assert result.exit_code == 1
    assert "cannot write" in result.stderr


def test_the_stages_alone_lead_from_a_tree_to_frames(tmp_path):
    def step(*arguments):
        result = call(*arguments)
        assert result.exit_code == 0, result.output

    paths = {name: tmp_path / name for name in ("a.json", "b.json", "c.json", "t.jsonl", "s.jsonl")}
    step("grow", "--nodes", 20, "-o", paths["a.json"])
    step("redteam", paths["a.json"], "--iterations", 3, "--open-loop", "-o", paths["b.json"])
    step("prune", paths["b.json"], "--simulator", "flat", "-o", paths["c.json"])
    step("describe", paths["c.json"], "--per-path", 1, "-o", paths["t.jsonl"])
    lines = paths["t.jsonl"].read_text().splitlines()
    paths["t.jsonl"].write_text("\n".join(lines[:2]) + "\n")
    step("augment", paths["t.jsonl"], "--simulator", "flat", "-o", paths["s.jsonl"])
    out = tmp_path / "sim"
    step("simulate", paths["s.jsonl"], out, "--simulator", "flat", "--traces", "--video", "bird")
    episodes = [json.loads(x) for x in (out / "episodes.jsonl").read_text().splitlines()]
    assert [episode["status"] for episode in episodes] == ["ok", "ok"]
    for file in ("frames/{}/last.jpg", "traces/{}.parquet", "videos/{}.mp4"):
        assert (out / file.format(episodes[0]["id"])).stat().st_size > 1_000
    assert len(ScenarioTree.load(paths["a.json"])) == 20


def test_a_scene_that_fails_gives_exit_code_one_and_its_reason(tmp_path):
    scene = example_scene().model_copy(update={"map": "nowhere"})
    (tmp_path / "s.jsonl").write_text(scene.to_json() + "\n")
    result = call("simulate", tmp_path / "s.jsonl", tmp_path / "sim", "--simulator", "flat")
    assert result.exit_code == 1
    assert "nowhere" in result.stderr


def test_scenes_of_one_name_are_refused_before_anything_runs(tmp_path):
    line = example_scene().to_json() + "\n"
    (tmp_path / "s.jsonl").write_text(line + line)
    result = call("simulate", tmp_path / "s.jsonl", tmp_path / "sim", "--simulator", "flat")
    assert result.exit_code == 2
    assert "'example-001' occurs more than once" in result.stderr
    assert not (tmp_path / "sim").exists()


def test_a_file_that_is_no_text_is_one_line(tmp_path):
    (tmp_path / "s.jsonl").write_bytes(b"\xff\xfe\x00")
    result = call("simulate", tmp_path / "s.jsonl", tmp_path / "sim", "--simulator", "flat")
    assert result.exit_code == 2
    assert "is not UTF-8 text" in result.stderr


def test_a_malformed_file_reports_every_line_and_path(tmp_path):
    scene = example_scene().model_dump(mode="json")
    scene["actors"][0]["placement"]["lane"] = "left"
    scene["ego"]["speed"] = -1
    (tmp_path / "s.jsonl").write_text(json.dumps(scene) + "\n{}\n")
    result = call("simulate", tmp_path / "s.jsonl", tmp_path / "sim", "--simulator", "flat")
    assert result.exit_code == 2
    for part in ("line 1: actors[0].placement.lane", "line 1: ego.speed", "line 2: map"):
        assert part in result.stderr


def test_a_malformed_tree_reports_every_fault(tmp_path):
    nodes = [
        {"id": "root", "parent": None, "label": "OOD"},
        {"id": "root", "parent": None, "label": "again"},
        {"id": "x", "parent": "nowhere", "label": ""},
    ]
    (tmp_path / "t.json").write_text(json.dumps({"nodes": nodes}))
    result = call("prune", tmp_path / "t.json", "--simulator", "flat")
    assert result.exit_code == 2
    assert result.stderr.count("\n  - ") >= 2


def test_score_prints_the_contract(tmp_path):
    (tmp_path / "t.txt").write_text(
        "A deer stands in the ego's lane on a rural road.\nA sofa lies on the highway.\n"
    )
    result = call("score", tmp_path / "t.txt", "--encoder", "hash", "--json")
    report = json.loads(result.stdout)
    assert report["n"] == 2
    assert len(report["oodness"]["per_text"]) == 2
    assert -1 <= report["oodness"]["mean"] <= 1
    assert {"nearest", "pairwise"} <= report["diversity"].keys()
    assert report["N"] >= 1_000


def test_evaluate_adds_a_model_to_a_study(out):
    result = call("evaluate", out, "--vlm", f"{__name__}:Guesser")
    assert result.exit_code == 0, result.output


def test_report_is_written_anew(out):
    (out / "report.html").unlink()
    result = call("report", out)
    assert result.exit_code == 0
    assert (out / "report.html").exists()


def test_plugins_lists_what_is_registered():
    rows = json.loads(call("plugins", "--json").stdout)
    assert {("simulator", "pybullet"), ("encoder", "minilm"), ("llm", "builtin")} <= {
        (row["kind"], row["name"]) for row in rows
    }


def test_doctor_finds_this_installation_healthy():
    result = call("doctor", "--json")
    findings = {row["what"]: row for row in json.loads(result.stdout)}
    assert result.exit_code == 0, findings
    assert set(findings) == {"python", "built-in author", "encoder", "simulator", "language models"}


@pytest.fixture
def own_simulator(tmp_path, monkeypatch):
    """Return the name of a simulator whose steps are the given code."""

    def write(step):
        (tmp_path / "own_simulator.py").write_text(
            "import os\n\nfrom oodscen.testing._flat import FlatSimulator\n\n\nclass Own(FlatSimulator):\n"
            f"    name = 'own'\n\n    def step(self, control):\n        {step}\n"
        )
        monkeypatch.syspath_prepend(str(tmp_path))
        return "own_simulator:Own"

    return write


def test_doctor_judges_an_adapter(own_simulator):
    result = call("doctor", "flat", "--quick")
    assert result.exit_code == 0
    assert "28 behaviours) shows" in result.stdout
    odd = own_simulator("return super().step(type(control)())")
    result = call("doctor", odd, "--quick", "--json")
    assert result.exit_code == 1
    faults = [row["detail"] for row in json.loads(result.stdout)]
    assert "controls: accelerating and braking do not change the speed as they should" in faults
    assert call("doctor", "pybulet").exit_code == 2


def test_doctor_finds_an_adapter_that_ends_its_process(own_simulator):
    result = call("doctor", own_simulator("os._exit(0)"), "--quick", "--json")
    assert result.exit_code == 1
    (finding,) = json.loads(result.stdout)
    assert (finding["is_ok"], finding["detail"]) == (False, "its process died (exit code 0)")


@pytest.mark.parametrize("key", ["sk-proj-AbCdEfGhIjKlMnOpQrSt", "kq7ZpWm3xT9bKEYQQ"])
@pytest.mark.parametrize(
    "order",
    [
        ("{}",),
        ("--{}",),
        ("--{}=1", "run"),
        ("run", "study", "--{}"),
        ("run", "study", "--seed", "{}"),
        ("tree", "{}"),
        ("tree", "show", "--{}"),
        ("import", "/nowhere/{}.xosc"),
        ("report", "{}"),
        ("completion", "{}"),
        ("completion", "bash", "{}"),
    ],
)
def test_no_message_of_the_command_line_repeats_a_key(monkeypatch, order, key):
    monkeypatch.setenv("OPENAI_API_KEY", "kq7ZpWm3xT9bKEYQQ")
    found = CliRunner().invoke(main, [word.format(key) for word in order])
    assert found.exit_code == 2
    assert key not in found.output
    assert "[redacted]" in found.output
