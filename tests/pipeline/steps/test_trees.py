"""A study begins with the tree that it is given."""

import json

import pytest

from oodscen import ScenarioTree, Study
from oodscen._pipeline import run_study
from oodscen.errors import DataError, StudyMismatch, UsageError
from tests.pipeline.quick import SMALL, content, lines

LABELS = {
    "root": (None, "OOD scenarios"),
    "things": ("root", "Things on the road"),
    "truck": ("things", "Overturned truck ahead in the ego's lane"),
    "fog": ("things", "Thick fog"),
}
CONFIG = SMALL.model_copy(update={"iterations": 0, "max_paths": None, "sets": ()})


def tree_of(labels=LABELS, model=""):
    nodes = [
        {"id": name, "parent": parent, "label": label} for name, (parent, label) in labels.items()
    ]
    tree = ScenarioTree.parse(json.dumps({"nodes": nodes}))
    return ScenarioTree(edit.model_copy(update={"model": model}) for edit in tree.edits)


def test_a_study_of_a_given_tree_has_its_paths(tmp_path):
    tree, out = tree_of(model="gpt-4o"), tmp_path / "out"
    study = run_study(out, CONFIG, tree=tree)
    assert study.tree("initial") == tree
    assert {scenario.path[-1] for scenario in study.scenarios} == {
        "Overturned truck ahead in the ego's lane",
        "Thick fog",
    }
    stages = {line["stage"] for line in lines(out, "calls.jsonl")}
    assert "grow" not in stages
    assert "prune" in stages
    page = (out / "report.html").read_text()
    assert "was given" in page
    assert f"given (digest {tree.digest()[:16]}), written by gpt-4o" in page
    assert "No language model wrote the tree" not in page

    before = content(out)
    (out / "scenarios.jsonl").unlink()
    run_study(out, CONFIG)  # The study has the tree.
    assert content(out) == before
    (out / "tree.initial.json").unlink()
    with pytest.raises(UsageError, match="--tree"):
        run_study(out, CONFIG)
    run_study(out, CONFIG, tree=tree)
    assert content(out) == before
    assert Study.open(out).info["authors"]["tree"].endswith("gpt-4o")
    assert set(Study.open(out).info["authors"]) == {"llm", "tree"}

    with pytest.raises(StudyMismatch) as caught:
        run_study(out, CONFIG, tree=tree_of(LABELS | {"hail": ("things", "Hail")}))
    assert set(caught.value.differences) == {"tree"}
    assert content(out) == before


@pytest.mark.parametrize(
    ("labels", "fault"),
    [
        ({}, "has no path"),
        ({"root": LABELS["root"]}, "has no path"),
        (LABELS | {"deer": ("root", "Deer in the lane")}, "'Deer in the lane' lies directly below"),
        ({"all": (None, "OOD"), "deer": ("all", "Deer")}, "'Deer' lies directly below"),
    ],
)
def test_a_tree_that_cannot_begin_a_study_is_refused_before_any_work(tmp_path, labels, fault):
    out = tmp_path / "out"
    with pytest.raises(DataError, match=fault):
        run_study(out, CONFIG, tree=tree_of(labels))
    assert not out.exists()


def test_a_given_tree_must_be_there_when_the_study_begins(tmp_path):
    config = CONFIG.model_copy(update={"tree": tree_of().digest()})
    with pytest.raises(UsageError, match="is to be given"):
        run_study(tmp_path / "out", config)
    assert not (tmp_path / "out").exists()


def test_red_teaming_may_begin_at_the_classes(tmp_path):
    config = CONFIG.model_copy(update={"iterations": 3, "max_paths": 1})
    study = run_study(tmp_path / "out", config, tree=ScenarioTree.initial())
    assert len(study.tree("initial")) == 3
    assert len(study.tree("diverse")) > 3


def test_rounds_count_on_from_those_of_the_given_tree(tmp_path):
    config = CONFIG.model_copy(update={"iterations": 2, "max_paths": 1})
    first = run_study(tmp_path / "first", config, tree=ScenarioTree.initial()).tree("diverse")
    second = run_study(tmp_path / "second", config, tree=first).tree("diverse")
    rounds = [edit.round for edit in second.edits if edit.stage == "redteam"]
    assert rounds == sorted(rounds)
    assert len(set(rounds)) == 4
