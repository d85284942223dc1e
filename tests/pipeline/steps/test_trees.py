"""A study begins with the tree that it is given."""

import json

import pytest

from oodscen import ScenarioTree
from oodscen._pipeline import run_study
from oodscen.errors import DataError, StudyMismatch
from tests.pipeline.quick import SMALL, content, lines

LABELS = {
    "root": (None, "OOD scenarios"),
    "things": ("root", "Things on the road"),
    "truck": ("things", "Overturned truck ahead in the ego's lane"),
    "fog": ("things", "Thick fog"),
}


def _write(file, labels=LABELS):
    nodes = [
        {"id": name, "parent": parent, "label": label} for name, (parent, label) in labels.items()
    ]
    file.write_text(json.dumps({"nodes": nodes}))
    return file


def _config(file, **more):
    changes = {"tree": str(file), "iterations": 0, "max_paths": None, "sets": ()}
    return SMALL.model_copy(update=changes | more)


def test_a_study_of_a_given_tree_has_its_paths(tmp_path):
    file, out = _write(tmp_path / "tree.json"), tmp_path / "out"
    study = run_study(out, _config(file))
    assert study.tree("initial") == ScenarioTree.load(file)
    assert {scenario.path[-1] for scenario in study.scenarios} == {
        "Overturned truck ahead in the ego's lane",
        "Thick fog",
    }
    stages = {line["stage"] for line in lines(out, "calls.jsonl")}
    assert "grow" not in stages
    assert "prune" in stages
    assert "was given" in (out / "report.html").read_text()

    before = content(out)
    (out / "tree.initial.json").unlink()
    (out / "scenarios.jsonl").unlink()
    run_study(out, _config(file))
    assert content(out) == before

    _write(file, LABELS | {"hail": ("things", "Hail")})
    with pytest.raises(StudyMismatch) as caught:
        run_study(out, _config(file))
    assert set(caught.value.differences) == {"tree"}
    file.unlink()
    run_study(out, _config(file))
    assert content(out) == before


@pytest.mark.parametrize("labels", [{}, {"root": LABELS["root"]}])
def test_a_tree_without_a_path_is_refused_before_any_work(tmp_path, labels):
    out = tmp_path / "out"
    with pytest.raises(DataError, match="has no path"):
        run_study(out, _config(_write(tmp_path / "tree.json", labels)))
    assert not out.exists()


def test_red_teaming_may_begin_at_the_root(tmp_path):
    file = _write(tmp_path / "tree.json", {"root": LABELS["root"]})
    study = run_study(tmp_path / "out", _config(file, iterations=3, max_paths=1))
    assert len(study.tree("initial")) == 1
    assert len(study.rounds) == 3
