import json
import os
import shutil
import sys

import pytest
from click.testing import CliRunner

from oodscen import Study
from oodscen._cli import main
from oodscen.report._load import read

STACK = """
from oodscen.driving._motion.actions import Cruise

def make():
    print("a stack talks")
    return Cruise()

class Broken:
    def act(self, observation):
        raise RuntimeError("no")
"""


@pytest.fixture
def with_stack(small, tmp_path, monkeypatch):
    """Return a function that puts a module beside a study `out`, in the working folder."""
    shutil.copytree(small, tmp_path / "out")
    monkeypatch.chdir(tmp_path)

    def put(module, code):
        (tmp_path / f"{module}.py").write_text(code)

    return put


def test_a_stack_in_the_current_folder_drives(with_stack, tmp_path, capfd) -> None:
    with_stack("stack_beside", STACK)
    paths = list(sys.path)
    run = CliRunner().invoke
    found = run(main, ["drive", "out", "--driver", "stack_beside:make", "--json"])
    assert found.exit_code == 0
    assert [(row["n"], row["failed"]) for row in json.loads(found.stdout)] == [(1, 0), (1, 0)]
    scenes, twins = json.loads(found.stdout)
    assert capfd.readouterr() == ("", "a stack talks\n" * 2)
    assert (scenes["kind"], twins["kind"], twins["paired"]) == ("scenes", "twins", None)
    assert scenes["paired"]["n"] == 1
    page = (tmp_path / "out" / "report.html").read_text()
    assert "Driving stacks" in page
    assert "stack_beside:make" in page
    broken = run(main, ["drive", "out", "--driver", "stack_beside:Broken", "--workers", "0"])
    del sys.modules["stack_beside"]
    assert broken.exit_code == 1
    assert "stack_beside:Broken, twins: 0 of 1 passed" in broken.output
    assert "1 failed" in broken.output
    assert "@stack_beside:Broken: RuntimeError: no\n" in broken.stderr
    for unknown in ("stack", "stack_beside:Nobody", "no_such_stack:Driver"):
        refused = run(main, ["drive", "out", "--driver", unknown])
        assert refused.exit_code == 2
        assert "driver" in refused.output
        assert "simulator" not in refused.output
    scenes = tmp_path / "out" / "scenes.jsonl"
    scenes.write_text(scenes.read_text().replace('"horizon_s":', '"horizon_s":1'))
    told = run(main, ["report", "out"])
    assert "1 scene, or its text, has changed or been removed since it was run: " in told.stderr
    page = (tmp_path / "out" / "report.html").read_text()
    assert "1 scene, or its text, has changed or been removed since it was run: " in page
    assert "Driving stacks" not in page
    refused = run(main, ["drive", "out"])
    assert (refused.exit_code, refused.output.count("\n")) == (2, 1)
    assert "removed since it was run" in refused.output
    study = Study(tmp_path / "out")
    made_from = {"made_from": study.scenes[0].digest()}
    study.store.write_lines(
        "episodes.jsonl", [episode.model_copy(update=made_from) for episode in study.episodes]
    )
    study.store.remove("staged.jsonl")
    ruled = run(main, ["drive", "out", "--workers", "0"])
    assert "; needless braking in 0 of 1 [" in ruled.output
    assert "  means: least TTC " in ruled.output
    assert "4 earlier results are dropped" in ruled.output
    drives = (tmp_path / "out" / "drives.jsonl").read_text().splitlines()
    assert [json.loads(line)["driver"] for line in drives] == ["rule-based", "rule-based"]
    run(main, ["drive", "out", "--workers", "0"])
    assert (tmp_path / "out" / "drives.jsonl").read_text().splitlines() == drives
    assert sys.path == paths
    assert "stack_beside" not in sys.modules


def test_a_driver_runs_in_this_process_for_debuggers(with_stack, tmp_path) -> None:
    with_stack("stack_here", STACK)
    found = CliRunner().invoke(
        main, ["drive", "out", "--driver", "stack_here:make", "--workers", "0", "--json"]
    )
    assert sys.modules.pop("stack_here")
    assert found.exit_code == 0
    assert [row["n"] for row in json.loads(found.stdout)] == [1, 1]
    assert "a stack talks" in found.stderr


def test_what_a_stack_does_to_its_process_harms_no_other(with_stack, tmp_path) -> None:
    (tmp_path / "elsewhere").mkdir()
    with_stack("stack_dying", "import os\nclass Dying:\n    act = lambda *_: os._exit(0)\n")
    with_stack(
        "stack_patching",
        "import numpy as np\n"
        "from oodscen.driving._motion.actions import Cruise\n"
        "class Patching(Cruise):\n"
        "    def act(self, observation):\n"
        "        np.isfinite = None\n"
        "        return super().act(observation)\n",
    )
    with_stack(
        "stack_moving",
        "import os, threading\n"
        "from oodscen.driving._motion.actions import Cruise\n"
        "threading.Thread(target=threading.Event().wait).start()\n"
        "def make():\n"
        "    os.chdir(os.path.join(os.path.dirname(__file__), 'elsewhere'))\n"
        "    return Cruise()\n",
    )
    names = ("stack_dying:Dying", "stack_patching:Patching", "stack_moving:make")
    options = [option for name in names for option in ("--driver", name)]
    found = CliRunner().invoke(main, ["drive", "out", *options])
    assert found.exit_code == 1
    assert "stack_dying:Dying, scenes: 0 of 1 passed" in found.output
    rows = map(json.loads, (tmp_path / "out" / "drives.jsonl").read_text().splitlines())
    drives = [(row["driver"], row["status"], row.get("error", "")) for row in rows]
    assert [row[:2] for row in drives] == [
        *[(names[0], "failed")] * 2,
        *[(names[2], "ok")] * 2,
        *[(names[1], "failed")] * 2,
    ]
    assert "its process died (" in drives[0][2]
    assert "'NoneType' object is not callable" in drives[4][2]
    assert os.path.samefile(os.curdir, tmp_path)
    assert list((tmp_path / "elsewhere").iterdir()) == []


def test_a_stack_that_ends_its_process_when_it_is_made_is_refused(with_stack, tmp_path) -> None:
    with_stack("stack_stillborn", "import os\nos._exit(0)\n")
    found = CliRunner().invoke(main, ["drive", "out", "--driver", "stack_stillborn:Driver"])
    assert found.exit_code == 2
    assert "cannot be made: its process died (exit code 0)" in found.output
    assert not (tmp_path / "out" / "drives.jsonl").exists()


def test_a_stack_that_takes_too_long_fails(with_stack, tmp_path) -> None:
    with_stack(
        "stack_hanging", "import signal\nclass Hanging:\n    act = lambda *_: signal.pause()\n"
    )
    command = ["drive", "out", "--driver", "stack_hanging:Hanging", "--time-limit", "1"]
    found = CliRunner().invoke(main, command)
    assert found.exit_code == 1
    lines = (tmp_path / "out" / "drives.jsonl").read_text().splitlines()
    assert {json.loads(line)["error"] for line in lines} == {"it took longer than 1 s"}
    refused = CliRunner().invoke(main, [*command, "--workers", "0"])
    assert refused.exit_code == 2
    assert "--workers" in refused.output


def test_an_interrupted_command_keeps_the_drives_that_have_ended(with_stack, tmp_path) -> None:
    with_stack(
        "stack_interrupting",
        "class Interrupting:\n    def act(self, _):\n        raise KeyboardInterrupt\n",
    )
    names = ("rule-based", "stack_interrupting:Interrupting")
    drivers = [option for name in names for option in ("--driver", name)]
    found = CliRunner().invoke(main, ["drive", "out", *drivers, "--workers", "0"])
    assert found.exit_code == 130
    lines = (tmp_path / "out" / "drives.jsonl").read_text().splitlines()
    assert [json.loads(line)["driver"] for line in lines] == ["rule-based"] * 2


def test_a_drive_is_kept_as_soon_as_it_has_ended(with_stack, tmp_path) -> None:
    with_stack(
        "stack_peeking",
        "from pathlib import Path\n"
        "from oodscen.protocols import Control\n"
        "class Peeking:\n"
        "    def act(self, _):\n"
        "        assert 'rule-based' in Path('out/drives.jsonl').read_text()\n"
        "        return Control()\n",
    )
    names = ("rule-based", "stack_peeking:Peeking")
    drivers = [option for name in names for option in ("--driver", name)]
    for _ in range(2):
        found = CliRunner().invoke(main, ["drive", "out", *drivers, "--workers", "0"])
        assert found.exit_code == 0, found.output
        results = Study.open(tmp_path / "out").drives
        lines = (tmp_path / "out" / "drives.jsonl").read_text().splitlines()
        assert len(lines) == len(results) == 4
        assert {result.status for result in results} == {"ok"}


def test_of_a_drive_that_was_driven_again_the_last_result_counts(with_stack, tmp_path) -> None:
    CliRunner().invoke(main, ["drive", "out", "--workers", "0"])
    table = tmp_path / "out" / "drives.jsonl"
    study = Study.open(tmp_path / "out")
    results = study.drives
    text = table.read_text()
    first = text.splitlines(keepends=True)[0]
    table.write_text(first.replace("true", "false") + text)
    assert study.drives == results
    assert read(study).drives == results
    assert "drives.jsonl" not in read(study).gaps


def test_a_driver_that_is_named_twice_drives_once(with_stack, tmp_path) -> None:
    with_stack("stack_twice", STACK)
    names = ["--driver", "stack_twice:make"] * 2
    found = CliRunner().invoke(main, ["drive", "out", *names, "--workers", "0"])
    assert found.exit_code == 0
    assert found.stderr.count("a stack talks") == 2  # One in the scene, one in its twin.
    assert "drive: 1 in " in found.stderr
