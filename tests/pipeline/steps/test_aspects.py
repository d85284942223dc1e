"""Opinions of judges on open answers: none is asked for twice, whoever judges in between."""

import shutil

import pytest

from oodscen import Study
from oodscen._pipeline import run_study
from oodscen.study._stale_verdicts import OPINIONS, Tables
from oodscen.testing import ScriptedLLM
from tests.pipeline.quick import SMALL


def judge(name, asked, *, is_right):
    def answer(request):
        asked.append(request)
        if asked.count("stop"):
            raise KeyboardInterrupt
        said = str(is_right).lower()
        return f'{{"reasoning": "", "is_same_thing": {said}, "is_same_fault": {said}}}'

    return ScriptedLLM(answer, name=name)


@pytest.mark.parametrize("retry", [False, True])
def test_a_judge_that_judges_again_is_not_asked_again(small, tmp_path, retry):
    folder, asked = shutil.copytree(small, tmp_path / "out"), {"a": [], "b": []}
    models = {name: judge(name, asked[name], is_right=name == "a") for name in asked}

    def by(name):
        run_study(folder, SMALL.model_copy(update={"judge": name}), models=models, retry=retry)
        return Study.open(folder).verdicts, len(asked[name])

    first, count = by("a")
    other, _ = by("b")
    assert first != other
    assert count > 0
    again, after = by("a")
    assert (again, after) == (first, count)
    lines = list(Study.open(folder).store.lines(OPINIONS))
    assert len({line["id"] for line in lines}) == len(lines)
    assert {line["judge"].partition("@")[0] for line in lines} == {"a", "b"}


def test_an_interrupted_change_of_judge_leaves_verdicts_that_belong(small, tmp_path):
    folder, asked = shutil.copytree(small, tmp_path / "out"), {"a": [], "b": []}
    models = {name: judge(name, asked[name], is_right=True) for name in asked}
    run_study(folder, SMALL.model_copy(update={"judge": "a"}), models=models)
    asked["b"].append("stop")
    with pytest.raises(KeyboardInterrupt):
        run_study(folder, SMALL.model_copy(update={"judge": "b"}), models=models)
    study = Study.open(folder)
    assert any(one.judge.startswith("a@") for one in study.stored_verdicts)
    assert not Tables.of(study).stale(study.stored_verdicts)


def test_opinions_of_earlier_judges_on_what_nobody_says_any_more_are_dropped(small, tmp_path):
    folder = shutil.copytree(small, tmp_path / "out")
    models = {"a": judge("a", [], is_right=True), "b": judge("b", [], is_right=True)}
    run_study(folder, SMALL.model_copy(update={"judge": "a"}), models=models)
    store = Study.open(folder).store
    lines = sorted(store.lines(OPINIONS), key=lambda line: line["id"])
    store.write_lines(OPINIONS, [{**lines[0], "id": "0" * 20}, *lines])
    run_study(folder, SMALL.model_copy(update={"judge": "b"}), models=models)
    assert lines == [line for line in store.lines(OPINIONS) if line["judge"].startswith("a@")]
