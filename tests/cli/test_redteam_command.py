"""The red-team command writes the tree and its log, and says how much is left."""

import json
from itertools import islice

import pytest
from click.testing import CliRunner

from oodscen import RedTeamer, ScenarioTree
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


def test_an_unwritable_log_costs_the_log_only(grown, tmp_path):
    out = tmp_path / "out.json"
    result = call(grown, "--iterations", 2, "--open-loop", "--log", "/dev/full", "-o", out)
    assert (result.exit_code, "/dev/full" in result.output) == (1, True)
    assert len(ScenarioTree.load(out).edits) > len(ScenarioTree.load(grown).edits)


def test_a_log_without_rounds_is_empty(grown, tmp_path):
    log = tmp_path / "log.jsonl"
    assert call(grown, "--iterations", 0, "--open-loop", "--log", log).exit_code == 0
    assert log.read_bytes() == b""


def test_an_interruption_keeps_the_rounds_that_were_played(grown, tmp_path, monkeypatch):
    played = RedTeamer.rounds

    def interrupted(teamer, tree):
        yield from islice(played(teamer, tree), 4)
        raise KeyboardInterrupt

    monkeypatch.setattr(RedTeamer, "rounds", interrupted)
    log, out = tmp_path / "log.jsonl", tmp_path / "out.json"
    result = call(grown, "--iterations", 9, "--open-loop", "--log", log, "-o", out)
    assert result.exit_code == 130
    rounds = [Round.parse(line) for line in log.read_text().splitlines()]
    assert len(rounds) == 4
    edits = [edit for item in rounds for edit in item.edits]
    assert ScenarioTree.load(out) == ScenarioTree.load(grown).apply(*edits)
