"""Other simulators beside the study's own: free with the built-in author, else only where asked for."""

import pytest

from oodscen import StudyConfig
from oodscen._io.study_files import CATALOGUES
from oodscen._pipeline.context import Context
from oodscen._pipeline.options import RunOptions
from oodscen._pipeline.steps.compare import compare_catalogues
from oodscen._registry import make_catalogue
from oodscen.author._builtin import BuiltinAuthor
from oodscen.testing import ScriptedLLM
from oodscen.tree._scenario_tree import ScenarioTree, TreeEdit
from tests.pipeline.quick import QUICK

LABELS = {
    "deer": "Deer on the road",
    "rain": "Heavy rain or heavy snowfall",
    "box": "Cardboard box",
}


@pytest.fixture
def tree() -> ScenarioTree:
    return ScenarioTree.initial().apply(
        *(
            TreeEdit(op="add", node=node, parent="environmental", label=label)
            for node, label in LABELS.items()
        )
    )


def prepared(out, config, **models):
    run = Context(out, config, RunOptions(models=models))
    run.store.prepare()
    run.prepare()
    return run


def test_the_built_in_author_compares_with_carla(tmp_path, tree):
    run = prepared(tmp_path, QUICK)
    compare_catalogues(run, tree)
    found = run.study.comparison
    assert found.catalogues == ("flat", "carla-0.9.16")
    carla = found.tallies[1]
    assert set(carla.absent) == {"animal", "snow"}
    sides = {line.id: line.sides[1] for line in found.lines}
    assert not sides["deer"].keep
    assert "no animals at all" in sides["deer"].reason
    assert (sides["rain"].match, sides["rain"].label) == ("part", "Heavy rain")
    assert "snow (weather)" in sides["rain"].reason
    assert sides["box"].keep
    before = run.store.path(CATALOGUES).read_bytes()
    calls = len(list(run.store.lines("calls.jsonl")))
    compare_catalogues(run, tree)
    assert run.store.path(CATALOGUES).read_bytes() == before
    assert len(list(run.store.lines("calls.jsonl"))) == calls


def test_another_model_is_asked_only_where_that_is_wanted(tmp_path, tree):
    author = BuiltinAuthor(QUICK.seed)
    asked = []

    def answer(request):
        asked.append(request.prompt)
        return author.complete(request).text

    config = QUICK.model_copy(update={"llm": "served"})
    run = prepared(tmp_path / "quiet", config, served=ScriptedLLM(answer))
    compare_catalogues(run, tree)
    assert asked == []
    assert not run.store.has(CATALOGUES)
    wanted = config.model_copy(update={"catalogues": ("carla-0.9.16", "flat")})
    run = prepared(tmp_path / "asked", wanted, served=ScriptedLLM(answer))
    compare_catalogues(run, tree)
    assert [len(one.paths) for one in asked] == [len(LABELS)] * 2
    assert run.study.comparison.catalogues == ("flat", "carla-0.9.16")


def test_no_catalogue_can_be_asked_for():
    assert StudyConfig().compared == ("carla-0.9.16",)
    assert StudyConfig(catalogues=()).compared == ()
    assert StudyConfig(llm="gpt-4o").compared == ()


def test_leaves_that_could_not_be_judged_are_judged_again_on_demand(tmp_path, tree):
    author = BuiltinAuthor(QUICK.seed)
    config = QUICK.model_copy(update={"llm": "served", "catalogues": ("carla-0.9.16",)})
    failed = []
    for retry, answer in ((False, "?"), (False, None), (True, None), (True, "?")):

        def answering(request, answer=answer):
            return answer or author.complete(request).text

        run = Context(
            tmp_path, config, RunOptions(models={"served": ScriptedLLM(answering)}, retry=retry)
        )
        run.prepare()
        with run.store.writing():
            compare_catalogues(run, tree)
        run.models.close()
        failed.append(run.study.comparison.tallies[1].failed)
    assert failed == [3, 3, 0, 0]


def test_a_catalogue_that_was_edited_is_compared_again(tmp_path, tree):
    file = tmp_path / "theirs.json"
    catalogue = make_catalogue("carla-0.9.16")
    file.write_text(catalogue.to_json())
    config = QUICK.model_copy(update={"catalogues": (str(file),)})
    shown = []
    for assets in (catalogue.assets, (), ()):
        file.write_text(catalogue.model_copy(update={"assets": assets}).to_json())
        run = prepared(tmp_path / "out", config)
        compare_catalogues(run, tree)
        shown.append(run.store.path(CATALOGUES).read_bytes())
    assert shown[0] != shown[1] == shown[2]
    assert "object" in run.study.comparison.tallies[1].absent
