"""Progress of long calls: every callable is told the same, and bars end."""

import io

import pytest
from hypothesis import given
from hypothesis import strategies as st

import oodscen
from oodscen._progress import counted, reporting
from oodscen.author._builtin import BuiltinAuthor
from oodscen.data import Scenario
from oodscen.driving._drivers.rule_based import RuleBasedDriver
from oodscen.metrics._metrics import Metrics
from oodscen.stages._drive import drive
from oodscen.testing import example_scene
from oodscen.testing._encoder import HashEncoder
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._flat_catalogue import FLAT_CATALOGUE


class Told(list):
    def __call__(self, stage, done, total):
        self.append((stage, done, total))


def is_whole(told, stage):
    """Return whether a stage went from its start to its end in order."""
    done = [one for name, one, _ in told if name == stage]
    return done[0] == 0 and done == sorted(done) and told[-1][1] == told[-1][2]


@given(st.lists(st.integers()))
def test_items_are_counted_as_they_are_done(items):
    told = Told()
    assert list(counted(items, "x", len(items), told)) == items
    assert told == [("x", done, len(items)) for done in range(len(items) + 1)]


@pytest.mark.parametrize("progress", [None, False])
def test_silence_is_the_default(progress, capsys):
    with reporting(progress) as told:
        told("grow", 1, 2)
    assert capsys.readouterr() == ("", "")


def test_true_shows_a_bar_with_its_note(monkeypatch):
    shown = io.StringIO()
    monkeypatch.setattr("sys.stderr", shown)
    with reporting(True, "3 calls") as told:
        told("grow", 1, 2)
        told("grow", 2, 2)
        told("prune", 1, 9)
    assert "grow" in shown.getvalue()
    assert "2/2" in shown.getvalue()
    assert "3 calls" in shown.getvalue()


def test_every_stage_reports_to_its_end():
    author = BuiltinAuthor()
    told = Told()
    tree = oodscen.TreeGrower(author, nodes=20).run(progress=told)
    assert is_whole(told, "grow")
    told = Told()
    tree = oodscen.RedTeamer(author, iterations=2).run(tree, progress=told)
    assert is_whole(told, "redteam")
    told = Told()
    tree = oodscen.Pruner(author, FLAT_CATALOGUE).run(tree, progress=told)
    assert is_whole(told, "prune")
    told = Told()
    texts = oodscen.Describer(author, per_path=1).run(tree, progress=told)
    assert is_whole(told, "describe")
    assert told[-1] == ("describe", len(tree.leaves), len(tree.leaves))
    told = Told()
    report = Metrics(HashEncoder(), ["A car drives.", "A van waits."]).report(texts, progress=told)
    assert report.n == len(texts)
    assert is_whole(told, "metrics")


def test_staging_and_driving_report_to_their_ends():
    told = Told()
    text = "On a highway, a large brown cardboard box lies in the lane ahead of ego."
    scenario = Scenario(id="a-001", text=text, leaf="a", path=("r", "b", "a"))
    augmenter = oodscen.Augmenter(BuiltinAuthor(), FLAT_CATALOGUE)
    augmenter.run(scenario, progress=told)
    assert is_whole(told, "augment")
    told = Told()
    with FlatSimulator() as flat:
        found = drive([example_scene()], RuleBasedDriver, flat, twins=False, progress=told)
    assert len(found) == 1
    assert is_whole(told, "drive")


def test_a_stage_that_comes_again_has_a_bar_again_but_an_ended_one_has_none(capfd):
    with reporting(True) as told:
        for done, total in ((0, 2), (2, 2), (2, 2), (3, 7), (7, 7)):
            told("simulate", done, total)
    shown = capfd.readouterr().err
    assert shown.count("2/2") == 1
    assert "7/7" in shown


def test_a_bar_begins_at_what_was_done_before(capfd):
    with reporting(True) as told:
        told("simulate", 500, 740)
    assert " 0/740" not in capfd.readouterr().err
