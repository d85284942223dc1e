"""The stage that writes texts: a path whose kind bears no more is done, and is not written again."""

import time

import pytest

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


class Killed(BaseException):
    pass


def test_the_record_of_short_paths_depends_on_neither_threads_nor_a_crash(tmp_path):
    def answer(request):
        label = request.prompt.path[-1]
        time.sleep(0.2 if label.startswith("Box") else 0.0)
        return {"texts": [f"The ego vehicle meets this: {label}, and stops."]}

    def run(folder, killed_at=""):
        config = QUICK.model_copy(update={"llm": "writer", "per_path": 3, "max_paths": None})
        run = Context(folder, config, RunOptions(models={"writer": ScriptedLLM(answer)}))
        run.prepare()
        append = run.store.append

        def killing(name, item):
            append(name, item)
            if name == SHORT_PATHS and item["leaf"] == killed_at:
                raise Killed

        run.store.append = killing
        with run.store.writing():
            try:
                describe(run, TREE)
            finally:
                run.models.close()
        return (folder / SHORT_PATHS).read_bytes()

    with pytest.raises(Killed):
        run(tmp_path / "killed", killed_at="tyre")
    whole = run(tmp_path / "whole")
    assert [
        line.count(leaf) for line, leaf in zip(whole.splitlines(), [b"box", b"tyre"], strict=True)
    ] == [1, 1]
    assert run(tmp_path / "killed") == run(tmp_path / "whole") == whole
