import json
import shutil

import pytest
from click.testing import CliRunner

from oodscen import Study
from oodscen.cli import EXIT_CODES, main
from oodscen.study import run_study
from tests.study.quick import QUICK

SMALL = QUICK.model_copy(update={"max_paths": 1, "iterations": 2})
ORDER = (
    "--quick --simulator flat --encoder hash --seed 3 --max-paths 1 --iterations 2 --baseline"
).split()


def invoke(*order):
    return CliRunner().invoke(main, [str(word) for word in order])


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("made") / "study"
    run_study(folder, SMALL)
    return folder


@pytest.fixture
def study(made, tmp_path):
    return shutil.copytree(made, tmp_path / "study")


def test_a_model_that_nobody_knows_leaves_the_study_as_it_was(study) -> None:
    before = (study / "study.json").read_bytes()
    for order in (("--vlm", "no-such-model"), ("--vlm", "random", "--judge", "no-such-model")):
        assert invoke("evaluate", study, *order).exit_code == 2
        assert (study / "study.json").read_bytes() == before


def test_a_run_that_goes_on_keeps_who_was_judged_and_how(study) -> None:
    found = invoke("evaluate", study, "--vlm", "constant:stop", "--protocol", "paper")
    assert found.exit_code == 0
    assert "balanced accuracy" in found.output
    verdicts = (study / "verdicts.jsonl").read_bytes()
    assert invoke("run", study, *ORDER, SMALL.baseline).exit_code == 0
    assert (study / "verdicts.jsonl").read_bytes() == verdicts
    assert Study.open(study).config.protocols == ("ours", "paper")


def test_a_model_without_usable_answers_exits_with_1_and_later_ones_do_not(study, tmp_path) -> None:
    (tmp_path / "mute.jsonl").write_text("")
    order = ("evaluate", study, "--vlm")
    assert invoke(*order, f"replay:{tmp_path / 'mute.jsonl'}").exit_code == 1
    later = invoke(*order, "random", "--json")
    assert later.exit_code == 0
    assert {row["model"] for row in json.loads(later.output)["standings"]} >= {"random", "oracle"}


@pytest.mark.parametrize("command", [["evaluate", "--vlm", "random"], ["report"], ["drive"]])
def test_a_folder_without_a_study_exits_with_2(tmp_path, command) -> None:
    found = invoke(command[0], tmp_path, *command[1:])
    assert found.exit_code == 2
    assert "holds no study" in found.output


def test_the_help_lists_the_exit_codes() -> None:
    words = invoke("--help").output
    assert all(f"{code}  {said}" in words for code, said in EXIT_CODES.items())
