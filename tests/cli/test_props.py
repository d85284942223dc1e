import json

import pytest
from click.testing import CliRunner

from oodscen._cli import main
from tests.made import WALL


def invoke(*order):
    return CliRunner().invoke(main, ["props", *map(str, order), "--simulator", "flat"])


def test_a_design_has_a_line_with_its_size_and_mass(tmp_path):
    (tmp_path / "wall.json").write_text(json.dumps(WALL))
    shown = invoke(tmp_path)
    assert shown.exit_code == 0
    assert shown.stdout.startswith("low_wall")
    assert f"{WALL['mass_kg']:g} kg" in shown.output
    assert json.loads(invoke(tmp_path, "--json").stdout)[0]["id"] == "low_wall"


@pytest.mark.parametrize("order", [(), (".", "--details"), ("--details",)])
def test_designs_or_details_are_shown_and_only_those_that_there_are(order):
    shown = invoke(*order)
    assert shown.exit_code == 2
    assert "Traceback" not in shown.output
