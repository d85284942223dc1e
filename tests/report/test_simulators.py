"""The comparison of simulators on the page: figures, what is lacking, what is dropped and why."""

from oodscen import Study
from oodscen._io.study_files import CATALOGUES
from oodscen._registry import make_catalogue
from oodscen.data._additions import Addition
from oodscen.report._load import Material, read
from oodscen.report._render import render_part
from oodscen.report._sections import RenderedPart, collect_parts
from oodscen.report._simulators import simulators
from oodscen.stages._prune.decisions import PruneDecision
from oodscen.stages._prune.side_by_side import compare
from oodscen.testing._flat import FlatSimulator
from oodscen.tree._scenario_tree import ScenarioTree, TreeEdit

LABELS = {"dog": "A dog", "ridge": "Rain or snow", "box": "A box"}


def compared():
    tree = ScenarioTree.initial()
    for node, label in LABELS.items():
        tree = tree.apply(TreeEdit(op="add", node=node, parent="interactional", label=label))
    here = [
        PruneDecision(id=leaf.id, path=tree.path(leaf.id), keep=True, match="full", reason="yes")
        for leaf in tree.leaves
    ]
    lacks = {
        "dog": Addition(kind="asset", name="dog", category="animal"),
        "ridge": Addition(kind="weather", name="snow"),
    }
    there = []
    for one in here:
        change = {}
        if one.id in lacks:
            lack = lacks[one.id]
            change = {"lacks": (lack,), "missing": (lack.words,), "reason": "<script>lacks"}
            is_part = one.id == "ridge"
            change |= {"keep": is_part, "match": "part" if is_part else "none"}
            change |= {"label": "Rain"} if is_part else {}
        there.append(one.model_copy(update=change))
    sides = {"flat": FlatSimulator().catalogue(), "carla-0.9.16": make_catalogue("carla-0.9.16")}
    return compare(tree, sides, {"flat": here, "carla-0.9.16": there})


def markup_of(study: Study) -> str:
    data = simulators(study, read(study))
    assert data is not None
    return render_part(RenderedPart("", "simulators", data))


def test_figures_absent_kinds_and_reasons_are_shown(study: Study) -> None:
    study.store.write(CATALOGUES, compared().to_json())
    markup = markup_of(study)
    assert "flat</bdi> shows 3 and <bdi>carla-0.9.16</bdi> 2; it drops the other 1." in markup
    assert "has no animals (needed by 1 of the dropped) and no snow at all" in markup
    assert "1 paths that <bdi>carla-0.9.16</bdi> does not show, and why" in markup
    assert "in part (Rain): " in markup
    assert "&lt;script&gt;lacks" in markup
    assert "<script>" not in markup


def test_a_broken_comparison_says_so(study: Study) -> None:
    study.store.write(CATALOGUES, "[]")
    assert any(one.error for one in collect_parts(study, read(study))["pruning"])


def test_where_nobody_asked_it_is_said_how_to(study: Study) -> None:
    study.store.remove(CATALOGUES)
    assert "oodscen prune FOLDER/tree.diverse.json --llm" in markup_of(study)
    assert simulators(study, Material()) is None
