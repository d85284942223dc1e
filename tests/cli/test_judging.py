import json

import pytest
from click.testing import CliRunner

from oodscen.cli import main


def test_power_says_how_many_scenes_it_takes() -> None:
    found = CliRunner().invoke(main, ["power", "0.66", "0.51", "--per-path", "10", "--icc", "0.2"])
    assert found.exit_code == 0
    assert "480 scenes = 48 paths of 10" in found.output
    machine = CliRunner().invoke(main, ["power", "0.66", "0.51", "--unpaired", "--json"])
    assert json.loads(machine.output)["independent"] == 169


def test_power_of_a_given_number() -> None:
    found = CliRunner().invoke(main, ["power", "0.66", "0.51", "--scenes", "130", "--icc", "0"])
    assert found.output == "130 scenes show that difference with a chance of 68%\n"


@pytest.mark.parametrize("rates", [["0.5", "0.5"], ["0", "0.5"], ["0.5", "1.5"]])
def test_what_cannot_be_told_apart_exits_with_2(rates: list[str]) -> None:
    assert CliRunner().invoke(main, ["power", *rates]).exit_code == 2
