import json

import pytest
from click.testing import CliRunner

from oodscen._cli import main
from oodscen.data._designs.prop import Prop
from oodscen.stages._making.making import MadeProp
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


def test_what_could_not_be_made_is_named_and_the_others_are_shown(tmp_path):
    table = tmp_path / "assets.jsonl"
    failed = MadeProp(id="small_aircraft", status="failed", error="no valid answer")
    refused = MadeProp(id="deep_water", reason="it flows")
    made = MadeProp(id=WALL["id"], prop=Prop.parse(WALL))
    table.write_text("".join(f"{one.to_json()}\n" for one in (failed, made, refused)))
    for where in (tmp_path, table):
        shown = invoke(where, "-o", tmp_path / "sheet.png")
        assert shown.exit_code == 0
        assert shown.stdout.startswith("low_wall")
        assert shown.stdout.count("\n") == 1
        told = shown.stderr.splitlines()[-1]
        assert told == "not shown, since no design was made: small_aircraft, deep_water"
        assert (tmp_path / "sheet.png").stat().st_size > 0
    table.write_text(f"{failed.to_json()}\n")
    none = invoke(tmp_path)
    assert none.exit_code != 0
    assert "small_aircraft" in none.output


@pytest.mark.parametrize("order", [(), (".", "--details"), ("--details",)])
def test_designs_or_details_are_shown_and_only_those_that_there_are(order):
    shown = invoke(*order)
    assert shown.exit_code == 2
    assert "Traceback" not in shown.output


@pytest.mark.parametrize("name", ["wall.json", "assets.jsonl"])
def test_a_sheet_replaces_no_design_that_it_shows(name, tmp_path):
    file = tmp_path / name
    file.write_text(json.dumps(WALL))
    refused = invoke(tmp_path, "-o", file)
    assert (refused.exit_code, refused.output.count("\n")) == (2, 1)
    assert json.loads(file.read_text()) == WALL
