"""Pruning, catalogues and knowledge bases from the command line."""

import json

import pytest
from click.testing import CliRunner

from oodscen import Pruner, ScenarioTree, TreeGrower
from oodscen._cli import main
from oodscen._registry import make_catalogue
from oodscen.author._builtin import BuiltinAuthor
from oodscen.stages._prune.decisions import PruneDecision
from oodscen.stages._prune.restoration import Restoration


def call(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    path = tmp_path_factory.mktemp("tree") / "tree.json"
    path.write_text(TreeGrower(BuiltinAuthor()).run().to_json())
    return path


def test_a_catalogue_given_twice_is_refused(tree):
    for more in ((), ("--catalogue", "pybullet")):
        result = call("prune", tree, "--catalogue", "flat", "--catalogue", "flat", *more)
        assert (result.exit_code, result.stdout) == (2, "")
        assert "--catalogue flat is given twice" in result.stderr


def test_two_catalogues_are_compared(tree):
    result = call("prune", tree, "--catalogue", "pybullet", "--catalogue", "carla-0.9.16")
    assert result.exit_code == 0, result.output
    assert "nothing at all of: animal, snow" in result.stdout
    assert "it has no animals at all" in result.stdout


def test_a_comparison_is_json_as_well_and_takes_files(tree, tmp_path):
    own = tmp_path / "own.json"
    own.write_text(make_catalogue("flat").to_json())
    options = ("--catalogue", own, "--catalogue", "flat", "--json")
    result = call("prune", tree, *options)
    found = json.loads(result.stdout)
    assert found["catalogues"] == [str(own), "flat"]
    assert found["tallies"][0]["kept"] == found["tallies"][1]["kept"] > 0


def test_decisions_and_the_way_back_are_files(tree, tmp_path):
    out, told, back = (tmp_path / name for name in ("out.json", "told.jsonl", "back.json"))
    options = ("--catalogue", "carla-0.9.16", "--decisions", told, "--restore", back)
    assert call("prune", tree, *options, "-o", out).exit_code == 0
    decisions = [PruneDecision.parse(line) for line in told.read_text().splitlines()]
    assert len(decisions) == len(ScenarioTree.load(tree))
    kept = {decision.id for decision in decisions if decision.keep}
    assert kept == set(ScenarioTree.load(out).by_id)
    assert Restoration.load(back).dropped > 0


def test_decisions_made_before_an_interruption_are_kept(tree, tmp_path, monkeypatch):
    made = []

    def interrupted(self, *arguments, real=Pruner.decisions):
        for decision in real(self, *arguments):
            if len(made) == 3:
                raise KeyboardInterrupt
            made.append(decision)
            yield decision

    monkeypatch.setattr(Pruner, "decisions", interrupted)
    told, out = tmp_path / "told.jsonl", tmp_path / "out.json"
    result = call("prune", tree, "--catalogue", "flat", "--decisions", told, "-o", out)
    assert result.exit_code != 0
    assert [PruneDecision.parse(line) for line in told.read_text().splitlines()] == made
    assert not out.exists()


@pytest.mark.parametrize("name", ["carla-0.9.1", "nowhere.json"])
def test_an_unknown_catalogue_is_one_line(tree, name):
    result = call("prune", tree, "--catalogue", name)
    assert result.exit_code == 2
    assert name in result.stderr


def test_an_own_knowledge_base_answers(tmp_path):
    own = tmp_path / "own.toml"
    own.write_text(
        """
[[hazard]]
id = "grand-piano"
class = "environmental"
family = "Musical instruments on the road"
label = "Grand piano on the road"
places = ["urban"]
events = [
  "A grand piano stands in the ego's lane {where}",
  "A black concert piano blocks the way of the ego vehicle {where}",
  "Somebody has left a piano on three legs in the middle of the lane {where}",
  "The ego's lane is taken up {where} by a piano with its lid open",
  "Movers have put down a piano in front of the ego vehicle and gone",
]
ordinary = "the lane ahead is free"
needs = { assets = ["piano"] }
"""
    )
    tree = ScenarioTree.initial()
    tree = tree.apply(
        tree.edits[0].model_copy(
            update={"node": "piano", "parent": "environmental", "label": "Grand piano on the road"}
        )
    )
    (tmp_path / "t.json").write_text(tree.to_json())
    told = tmp_path / "told.jsonl"
    options = ("--llm", f"builtin:{own}", "--catalogue", "flat", "--decisions", told)
    assert call("prune", tmp_path / "t.json", *options).exit_code == 0
    decisions = {one.id: one for one in map(PruneDecision.parse, told.read_text().splitlines())}
    assert decisions["piano"].missing[0] == "an asset: piano"
    assert decisions["piano"].model == "builtin:own.toml"
    result = call("doctor", "knowledge", own)
    assert result.exit_code == 0, result.output
    assert "1 hazards in 1 families" in result.stdout


def test_a_faulty_knowledge_base_gives_exit_code_one(tmp_path):
    (tmp_path / "own.toml").write_text('[[hazard]]\nid = "x"\n')
    result = call("doctor", "knowledge", tmp_path / "own.toml")
    assert result.exit_code == 1
    assert "own.toml:1: hazard[0] x: class" in result.stdout


def test_an_own_knowledge_base_that_is_not_there_is_one_line(tree):
    result = call("prune", tree, "--llm", "builtin:nowhere.toml", "--catalogue", "flat")
    assert result.exit_code == 2
    assert "nowhere.toml" in result.stderr
