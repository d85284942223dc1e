"""The stage that writes texts: a path whose kind bears no more is done, and is not written again."""

from oodscen import ScenarioTree
from oodscen._pipeline.context import Context
from oodscen._pipeline.options import RunOptions
from oodscen._pipeline.steps.texts import SHORT_PATHS, describe
from oodscen.testing import ScriptedLLM
from oodscen.tree._scenario_tree import TreeEdit
from tests.pipeline.quick import QUICK

TREE = ScenarioTree.initial().apply(
    TreeEdit(op="add", node="debris", parent="environmental", label="Debris"),
    TreeEdit(op="add", node="box", parent="debris", label="Box on the road"),
    TreeEdit(op="add", node="tyre", parent="debris", label="Tyre on the road"),
)


def test_a_path_that_ran_dry_is_on_record_and_done(tmp_path):
    asked = []

    def answer(request):
        label = request.prompt.path[-1]
        asked.append(label)
        count = request.prompt.count if label.startswith("Box") else 1
        return {"texts": [f"The ego meets this: {label}, number {n}." for n in range(count)]}

    config = QUICK.model_copy(update={"llm": "writer", "per_path": 3, "max_paths": None})
    found = []
    for _ in range(2):
        options = RunOptions(models={"writer": ScriptedLLM(answer)}, retry=True)
        run = Context(tmp_path, config, options)
        run.prepare()
        with run.store.writing():
            found.append(describe(run, TREE))
        run.models.close()
    assert [item.id for item in found[0]] == ["box-001", "box-002", "box-003", "tyre-001"]
    assert found[0] == found[1]
    assert asked.count("Tyre on the road") == 1
    line = {"file": "scenarios.jsonl", "leaf": "tyre", "texts": 1}
    assert list(run.store.lines(SHORT_PATHS)) == [line]
