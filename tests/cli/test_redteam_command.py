"""The red-team command writes the tree and its log, and says how much is left."""

import json

import pytest
from click.testing import CliRunner

from oodscen import ScenarioTree
from oodscen._cli import main
from oodscen._registry import DEFAULT_ENCODER
from oodscen.stages._redteam.rounds import Round
from oodscen.testing._encoder import HashEncoder


@pytest.fixture(scope="module")
def grown(tmp_path_factory):
    path = tmp_path_factory.mktemp("tree") / "tree.json"
    assert CliRunner().invoke(main, ["grow", "--nodes", "24", "-o", str(path)]).exit_code == 0
    return path


def call(*arguments):
    return CliRunner().invoke(main, ["redteam", *map(str, arguments)])


def test_it_stops_at_the_budget_and_leaves_a_log(grown, tmp_path):
    log, out = tmp_path / "log.jsonl", tmp_path / "out.json"
    options = ("--budget", 12, "--encoder", "hash", "--in-flight", 2, "--log", log, "-o", out)
    result = call(grown, *options)
    assert result.exit_code == 0, result.output
    rounds = [Round.parse(line) for line in log.read_text().splitlines()]
    assert sum(item.calls for item in rounds) <= 12
    edits = [edit for item in rounds for edit in item.edits]
    assert ScenarioTree.load(out) == ScenarioTree.load(grown).apply(*edits)
    assert "the budget is spent" in result.output


def test_the_saturation_is_printed_as_json(grown):
    result = call(grown, "--iterations", 3, "--json", "--open-loop")
    assert result.exit_code == 0, result.output
    found = json.loads(result.stdout.splitlines()[-1])
    assert (found["rounds"], found["calls"]) == (3, 6)


def test_impossible_options_are_the_callers_mistake(grown):
    assert call(grown, "--red-coverage", 2).exit_code == 2
    assert call(grown, "--in-flight", 0).exit_code == 2


@pytest.mark.parametrize(
    ("options", "made"),
    [((), [DEFAULT_ENCODER]), (("--encoder", "none"), []), (("--open-loop",), [])],
)
def test_the_closed_loop_compares_meanings_unless_told_otherwise(grown, monkeypatch, options, made):
    asked = []

    def make(name, cache=False):
        asked.append(name)
        return HashEncoder()

    monkeypatch.setattr("oodscen.make_encoder", make, raising=False)
    result = call(grown, "--iterations", 1, *options)
    assert result.exit_code == 0, result.output
    assert asked == made
